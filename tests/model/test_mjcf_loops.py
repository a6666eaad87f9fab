"""Closed loops of MJCF files: a parallelogram whose motion is known, what is left out and why, and written files."""

import warnings

import numpy as np
import pytest
from lxml import etree

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile
from spear_pin.model.mjcf import to_mjcf
from spear_pin.model.mjcf_loops import list_left_out_loops
from tests.cli.calls import printed
from tests.model.looped import CRANK_LEG, CRANK_LOOP, crank_leg, five_bar, write
from tests.model.mjcf_looped import BARS, BASE, BELT, MOTOR, PIN, bar, machine

ANGLES = (-0.7, 0.0, 0.4, 1.2)
PULLEY = bar("pulley", "0 0.1 0")


def loaded(tmp_path, text, toml=None, **options):
    """The robot of a file, with its TOML file, and what loading it says."""
    path = tmp_path / "machine.xml"
    path.write_text(text, encoding="utf-8")
    if toml is not None:
        path.with_suffix(".toml").write_text(toml, encoding="utf-8")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RobotWarning)
        robot = load(path, **options)
    return robot, [str(each.message) for each in caught]


PINS = {
    "from an anchor": PIN,
    "from sites": '<connect name="pin" site1="tip" site2="pivot"/>',
    "from the other body": f'<connect name="pin" body1="rocker" body2="coupler" anchor="0 0 {-0.1}"/>',
}


@pytest.mark.parametrize("which", PINS)
def test_opposite_sides_of_a_parallelogram_stay_parallel(tmp_path, which):
    """The rocker turns as the crank, the coupler back by as much; what turns is then a crank of twice its inertia."""
    robot, said = loaded(tmp_path, machine(PINS[which]))
    assert said == [] and robot.independent == ("lift", "crank") and robot.legs == ()
    for angle in ANGLES:
        found = robot.reduced([0.2, angle, -angle, angle], [0.0, 1.0])
        np.testing.assert_allclose(found.q, [0.2, angle, -angle, angle], rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.T, [[1, 0], [0, 1], [0, -1], [0, 1]], rtol=0, atol=1e-12)
        assert found.mass_matrix[1, 1] == pytest.approx(2 * (1e-3 + 0.2 * 0.05**2) + 0.2 * 0.1**2, abs=1e-12)


def test_a_belt_of_which_a_zero_is_elsewhere(tmp_path):
    """MuJoCo counts from `ref`, where q is zero."""
    pulley = bar("pulley", "0 0.1 0", ref='ref="0.5"')
    robot, said = loaded(tmp_path, machine(PIN + BELT, BARS + pulley))
    assert len(said) == 1 and "ref (q is MuJoCo's qpos less ref)" in said[0]
    assert [loop.joints for loop in robot.loops] == [(), (("pulley", 1.0), ("crank", 3.0))]
    assert robot.reduced([0.0, 0.4, -0.4, 0.4, 0.0], [0.0, 1.0]).q[4] == pytest.approx(-1.2, abs=1e-12)


def test_to_the_world(tmp_path):
    """By its anchor, or by a site of the world."""
    for pin in (
        f'<connect body1="coupler" anchor="{BASE} 0.03 0"/>',
        '<connect name="coupler" site1="tip" site2="hook"/>',
    ):
        robot, said = loaded(tmp_path, machine(pin))
        assert said == [] and robot.loops[0].name == "coupler" and robot.independent == ("crank", "rocker")
        q = robot.closed([0.1, 0.6, -0.5, 0.3])
        assert np.abs(q[:3]).min() > 0.01
        np.testing.assert_allclose(robot.frame_position(q, "tip"), [BASE, 0.4], rtol=0, atol=1e-12)


def test_defaults_of_equality_constraints_and_their_softness(tmp_path):
    """A <joint> that ties is no joint: it has other defaults."""
    before = '<default><joint armature="0.1"/><equality solref="0.01 1"/></default>'
    robot, said = loaded(tmp_path, machine(BELT, BARS + PULLEY, before=before, motors=MOTOR))
    assert len(said) == 1 and "solref in <joint> of 'belt'" in said[0] and "armature" not in said[0]
    assert [loop.name for loop in robot.loops] == ["belt"]
    text = machine(PIN, before='<default><equality active="false"/></default>')
    assert "<connect> 'pin' in <equality>, which is off" in loaded(tmp_path, text)[1][0]


LEFT_OUT = {
    "off": (PIN.replace("/>", ' active="false"/>'), "<connect> 'pin' in <equality>, which is off"),
    "a weld": ('<weld name="w" body1="coupler"/>', "<weld> 'w' in <equality>, which is no pin or belt"),
    "nothing": ('<connect name="c" body1="coupler"/>', "<connect> 'c' in <equality>, which has neither"),
    "one joint": ('<joint joint1="crank"/>', "<joint> 'crank' in <equality>, which ties no two joints"),
    "one joint twice": ('<joint joint1="crank" joint2="crank"/>', "which ties no two joints"),
    "another joint": ('<joint joint1="crank" joint2="elbow"/>', "which ties no two joints"),
    "an offset": ('<joint joint1="crank" joint2="rocker" polycoef="0.1"/>', "not linear without an offset"),
    "a square": ('<joint joint1="crank" joint2="rocker" polycoef="0 1 1 0 0"/>', "not linear without an offset"),
    "a joint held": ('<joint joint1="crank" joint2="rocker" polycoef="0 0 0 0 0"/>', "not linear without an offset"),
    "a site called as a body": ('<connect site1="tip" site2="rocker"/>', "whose site 'rocker' is called as a body"),
    "no such body": ('<connect name="c" body1="arm" anchor="0 0 0"/>', "'c' in <equality>: loops.c: unknown frame"),
    "within a body": ('<connect name="c" body1="rocker" body2="rocker" anchor="0 0 0"/>', "point of another body"),
    "too many": (51 * '<connect body1="coupler" anchor="0 0 0"/>', "in <equality>, which has more than 50"),
    "given twice": (PIN + PIN.replace('"pin"', '"again"'), "'pin', <connect> 'again' in <equality>: loops: loops is"),
    "rigid": (PIN + '<joint name="b" joint1="crank" joint2="rocker" polycoef="0 2"/>', "make them rigid"),
}


@pytest.mark.parametrize("what", LEFT_OUT)
def test_what_cannot_be_a_loop_is_told_in_one_line(tmp_path, what):
    loops, reason = LEFT_OUT[what]
    robot, said = loaded(tmp_path, machine(loops))
    assert robot.loops == () and robot.independent == robot.coordinates
    assert len(said) == 1 and "\n" not in said[0]
    assert said[0].startswith("machine: not taken over: <") and reason in said[0]


@pytest.mark.parametrize("flag", ["equality", "constraint"])
def test_constraints_that_are_switched_off(tmp_path, flag):
    robot, said = loaded(tmp_path, machine(before=f'<option><flag {flag}="disable"/></option>'))
    assert robot.loops == () and "<connect> 'pin' in <equality>, which is off" in said[0]


def test_a_robot_in_space_keeps_its_tree(tmp_path):
    turned = BARS.replace('axis="0 -1 0"', 'axis="0 -1 0.2"', 1)
    robot, said = loaded(tmp_path, machine(bars=turned))
    assert robot.loops == () and len(robot.model.frames) == len(loaded(tmp_path, machine(""))[0].model.frames)
    assert len(said) == 1 and "<connect> 'pin' in <equality>: loops: loops is ['pin']" in said[0]
    assert "x-z plane alone" in said[0]


class TestBeside:
    def test_a_toml_file_names_what_is_independent(self, tmp_path):
        motors = MOTOR + '<motor joint="rocker"/>'
        robot, said = loaded(tmp_path, machine(motors=motors))
        assert robot.loops == () and "independent is ['crank', 'rocker']; expected 1 of" in said[0]
        robot, said = loaded(tmp_path, machine(motors=motors), 'independent = ["rocker"]\n')
        assert said == [] and robot.independent == ("lift", "rocker")

    def test_a_toml_file_overrides_and_adds(self, tmp_path):
        other = '[loops.pin]\na = { body = "coupler", at = [0.2, 0, 0] }\nb = { body = "rocker" }\n'
        belt = "[loops.more]\njoints = { pulley = 1, rocker = 2 }\n"
        robot, said = loaded(tmp_path, machine(bars=BARS + PULLEY), other + belt)
        assert said == [] and [loop.name for loop in robot.loops] == ["pin", "more"]
        q = robot.closed([0.0, 0.4, -0.3, 0.4, 0.0])
        place = robot.frame_position(q, "pin_a")
        np.testing.assert_allclose(place, robot.frame_position(q, "pin_b"), rtol=0, atol=1e-12)
        assert np.linalg.norm(place - robot.frame_position(q, "coupler")) == pytest.approx(0.2)

    def test_a_toml_file_that_counts_on_loops_is_refused_with_them(self, tmp_path):
        with pytest.raises(BadFile, match=r"machine\.toml: independent is \['lift'\]|independent joint in a loop"):
            loaded(tmp_path, machine(), 'independent = ["lift"]\n')

    def test_legs_of_a_toml_file_go_first(self, tmp_path):
        toml = 'toes = ["tip"]\n[legs.leg]\nhip = "crank"\nknee = "coupler"\ntoe = "tip"\nside = 1\n'
        robot, said = loaded(tmp_path, machine(), toml)
        assert [leg.knee for leg in robot.legs] == ["coupler"] and robot.loops == ()
        assert len(said) == 1 and "with loops: a leg is a chain" in said[0]


class TestWritten:
    @pytest.mark.parametrize("make", [crank_leg, five_bar], ids=["crank_leg", "five_bar"])
    def test_it_is_read_again(self, tmp_path, make):
        robot = make(tmp_path)
        again, _ = loaded(tmp_path, to_mjcf(robot))
        assert again.independent == robot.independent and again.loops == robot.loops
        rng = np.random.default_rng(1)
        for q in rng.uniform(-1.0, 1.0, (3, robot.nv)):
            np.testing.assert_allclose(again.loop_gap(q), robot.loop_gap(q), rtol=0, atol=1e-15)
            np.testing.assert_allclose(again.loop_jacobian(q), robot.loop_jacobian(q), rtol=0, atol=1e-15)

    def test_a_belt(self, tmp_path):
        toml = CRANK_LOOP.partition("[loops")[0] + "[loops.belt]\njoints = { rod = 2, crank = 1 }\n"
        robot = load(write(tmp_path, "belted", CRANK_LEG, toml), base="fixed")
        again, _ = loaded(tmp_path, to_mjcf(robot))
        np.testing.assert_allclose(again.loop_jacobian(np.zeros(4)), [[0.0, 0.5, 1.0, 0.0]])

    def test_of_three_joints_is_left_out_and_said(self, capsys, tmp_path):
        toml = 'independent = ["crank", "rod"]\n[loops.sum]\njoints = { crank = 1, rod = 1, slide = 9 }\n'
        path = write(tmp_path, "summed", CRANK_LEG, toml)
        robot = load(path, base="fixed", motors="all")
        assert list_left_out_loops(robot) == ["loop sum: MuJoCo ties two joints, not 3"]
        text = to_mjcf(robot)
        assert list_left_out_loops(robot)[0] in text and "<equality" not in text
        result = printed(capsys, "export", path, "--mjcf", "--base", "fixed", "--motors", "all", "--out", tmp_path)
        assert result["left_out"] == list_left_out_loops(robot)

    def test_the_first_posture_closes_loops(self, tmp_path):
        robot = crank_leg(tmp_path)
        (key,) = etree.fromstring(to_mjcf(robot)).iter("key")
        q = np.array([float(number) for number in key.get("qpos").split()])
        assert np.abs(robot.loop_gap(q)).max() < 1e-12
        assert robot.toe_position(q, "toe")[1] == pytest.approx(0.0, abs=1e-12)
