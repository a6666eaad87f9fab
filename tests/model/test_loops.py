"""Closed loops: constraints of the tree, motion in independent coordinates, and files that are refused."""

import math

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadFile, BadValue, UnknownName
from tests.model.looped import (
    CRANK,
    CRANK_LEG,
    CRANK_LOOP,
    FIVE_BAR,
    FIVE_BAR_LOOP,
    LOWER,
    ROD,
    crank_leg,
    five_bar,
    joint,
    write,
)

STEP = 1e-6


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loops")
    return {"crank_leg": crank_leg(folder), "five_bar": five_bar(folder)}


def at(robot, *angles):
    """A configuration, 0.3 m up, whose leg hangs below its motors."""
    if robot.name == "crank_leg":
        return robot.closed([0.3, *angles, -0.45 - angles[0], 0.1])
    front, back = angles
    return robot.closed([0.3, front, -1.5, back, 1.5])


class TestCrank:
    """Against numbers of another program, which derives the motion by Lagrange's equations in two coordinates."""

    def test_the_foot_is_where_the_triangle_puts_it(self, legs):
        for x in (-0.5, 0.0, 0.4, 1.1):
            y = -CRANK * math.sin(x) + math.sqrt(ROD**2 - (CRANK * math.cos(x)) ** 2)
            assert at(legs["crank_leg"], x)[3] == pytest.approx(y, abs=1e-12)

    def test_motion_in_independent_coordinates(self, legs):
        robot = legs["crank_leg"]
        assert robot.independent == ("boom_z", "crank")
        found = robot.reduced(at(robot, 0.4), [-0.8, 3.0])
        expected = [[2.33, 0.015587219], [0.015587219, 0.002851060]]
        np.testing.assert_allclose(found.mass_matrix, expected, rtol=0, atol=5e-10)
        np.testing.assert_allclose(found.bias, [22.747629865, 0.148151724], rtol=0, atol=5e-10)
        assert found.T[3, 1] == pytest.approx(-0.051497551, abs=5e-10)


class TestFiveBar:
    def test_motion_in_independent_coordinates(self, legs):
        robot = legs["five_bar"]
        q = at(robot, 1.3, -1.1)
        np.testing.assert_allclose(robot.toe_position(q, "toe"), [0.021283552, 0.3 - 0.212125595], rtol=0, atol=5e-10)
        found = robot.reduced(q, [-1.2, 2.0, -3.0])
        coupling = [0.007478035, -0.006264939]
        legs_own = [[0.000961668, 0.000200671], [0.000200671, 0.000961668]]
        np.testing.assert_allclose(found.mass_matrix[0], [2.2, *coupling], rtol=0, atol=5e-10)
        np.testing.assert_allclose(found.mass_matrix[1:, 1:], legs_own, rtol=0, atol=5e-10)
        np.testing.assert_allclose(found.bias, [21.610164055, 0.074801002, -0.060506617], rtol=0, atol=5e-10)


@pytest.mark.parametrize(("name", "angles"), [("crank_leg", (0.4,)), ("five_bar", (1.3, -1.1))])
class TestConstraint:
    def test_jacobian_is_the_slope_of_the_gap(self, legs, name, angles):
        robot = legs[name]
        q = at(robot, *angles)
        steps = STEP * np.eye(robot.nv)
        slopes = [(robot.loop_gap(q + step) - robot.loop_gap(q - step)) / (2 * STEP) for step in steps]
        np.testing.assert_allclose(robot.loop_jacobian(q), np.transpose(slopes), rtol=0, atol=1e-9)

    def test_drift_is_the_slope_of_the_jacobian(self, legs, name, angles):
        robot = legs[name]
        q, v = at(robot, *angles), np.linspace(-1.0, 2.0, robot.nv)
        ahead, behind = (robot.loop_jacobian(q + s * STEP * v) for s in (1, -1))
        np.testing.assert_allclose(robot.loop_drift(q, v), (ahead - behind) @ v / (2 * STEP), rtol=0, atol=1e-7)

    def test_reduced_motion_stays_on_the_loops(self, legs, name, angles):
        robot = legs[name]
        rates = np.linspace(-1.0, 2.0, len(robot.independent))
        found = robot.reduced(at(robot, *angles), rates)
        assert np.abs(robot.loop_jacobian(found.q) @ found.T).max() < 1e-12
        drift = robot.loop_jacobian(found.q) @ found.c + robot.loop_drift(found.q, found.v)
        assert np.abs(drift).max() < 1e-10

    def test_closing_keeps_the_independent_coordinates(self, legs, name, angles):
        robot = legs[name]
        q = at(robot, *angles)
        own = [robot.index(joint) for joint in robot.independent]
        again = robot.closed(np.where(np.isin(np.arange(robot.nv), own), q, q + 0.05))
        np.testing.assert_allclose(again, q, rtol=0, atol=1e-12)

    def test_has_no_legs_and_closes_where_it_says(self, legs, name, angles):
        robot = legs[name]
        assert robot.legs == ()
        assert np.abs(robot.loop_gap(at(robot, *angles))).max() < 1e-13


def test_a_ratio_that_depends_on_the_configuration(tmp_path):
    """A motor's crank turns a rocker by a coupler: D gains J i², the bias J i i' v², the torque i u."""

    def pivoted(name, mass, inertia):
        return f'''<link name="{name}"><inertial><mass value="{mass}"/>
        <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>'''

    urdf = "".join(
        [
            '<robot name="four_bar"><link name="world"/>',
            *(pivoted(*each) for each in (("crank", 1.0, 3e-4), ("coupler", 1e-9, 1e-12), ("rocker", 1.0, 0.01))),
            joint("crank", "revolute", "world", "crank"),
            joint("coupler", "revolute", "crank", "coupler").replace('xyz="0 0 0.0"', 'xyz="0.03 0 0"'),
            joint("rocker", "revolute", "world", "rocker").replace('xyz="0 0 0.0"', 'xyz="0.3 0 0"'),
            "</robot>",
        ]
    )
    toml = """motors = ["crank"]
independent = ["rocker"]
[loops.pin]
a = { body = "coupler", at = [0.302, 0, 0] }
b = { body = "rocker", at = [0, 0, 0.04] }
"""
    robot = load(write(tmp_path, "four_bar", urdf, toml), base="fixed")
    found = robot.reduced([1.5, -1.3, 0.6], [3.0])
    ratio = found.T[0, 0]
    assert ratio == pytest.approx(1.801770996, abs=5e-10)
    assert found.c[0] == pytest.approx(2.809435369 * 3.0**2, abs=1e-8)
    assert found.mass_matrix[0, 0] == pytest.approx(0.01 + 3e-4 * ratio**2, abs=1e-9)
    assert (ratio * 1.0 - found.bias[0]) / found.mass_matrix[0, 0] == pytest.approx(162.941296, abs=1e-6)


def link(name, mass, inertia):
    return f'''<link name="{name}"><inertial><origin xyz="0 0 -0.1"/><mass value="{mass}"/>
    <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>'''


def test_a_belt_carries_a_rotor_as_gears_do(tmp_path):
    """A rotor on the body, tied to the elbow 15 to 1, adds to D what `armature` does."""
    rotor, ratio = 1.2e-4, 15.0
    parts = [
        '<robot name="belted"><link name="world"/>',
        *(link(*each) for each in (("body", 2.0, 1.0), ("thigh", 1.0, 0.01), ("shank", 0.5, 0.004))),
        link("rotor", 1e-12, rotor),
        joint("boom_z", "prismatic", "world", "body", axis="0 0 1"),
        joint("hip", "revolute", "body", "thigh"),
        joint("elbow", "revolute", "thigh", "shank", at=-0.3),
    ]
    turning = joint("rotor", "revolute", "body", "rotor")
    plain = "".join(each for each in parts if '"rotor"' not in each) + "</robot>"
    tied = 'motors = ["hip", "rotor"]\nindependent = ["elbow"]\n[loops.belt]\njoints = { rotor = 1, elbow = -15 }\n'
    belted = load(write(tmp_path, "belted", "".join([*parts, turning, "</robot>"]), tied), base="fixed")
    geared = f"[motors.elbow]\nratio = {ratio}\nrotor_inertia = {rotor}\n"
    other = load(write(tmp_path, "geared", plain, geared), base="fixed")
    assert belted.coordinates == (*other.coordinates, "rotor") and belted.independent == other.coordinates
    q, v = [0.5, 0.4, 0.6], [0.3, -1.0, 2.0]
    found = belted.reduced([*q, 0.0], v)
    assert found.q[3] == pytest.approx(ratio * q[2])
    np.testing.assert_allclose(found.mass_matrix, other.mass_matrix(q), rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.bias, other.bias(q, v), rtol=0, atol=1e-9)


REFUSED = {
    "no such body": ('body = "rod"', 'body = "bar"', "unknown frame 'bar'"),
    "no such joint": (
        "[loops.pin]",
        "[loops.belt]\njoints = { crank = 1, knee = -1 }\n[loops.pin]",
        "unknown joint 'knee'",
    ),
    "one joint": ("[loops.pin]", "[loops.belt]\njoints = { crank = 1 }\n[loops.pin]", "at least two joints"),
    "no weight": ("[loops.pin]", "[loops.belt]\njoints = { crank = 1, rod = 0 }\n[loops.pin]", "other than 0"),
    "a weight that is no number": (
        "[loops.pin]",
        "[loops.belt]\njoints = { crank = 1, rod = nan }\n[loops.pin]",
        "a finite number",
    ),
    "one end": ("b = {", "# b = {", "a table with b"),
    "both ends on one body": ('body = "foot"', 'body = "rod"', "another body than rod"),
    "a place of two numbers": (f"[0, 0, {-ROD}]", "[0, 0]", "three numbers"),
    "too far apart": ('body = "foot", at = [0, 0, 0]', 'body = "universe", at = [2, 0, 0]', "and stay apart"),
    "given twice": (
        "[loops.pin]",
        f'[loops.more]\na = {{ body = "rod", at = [0, 0, {-ROD}] }}\nb = {{ body = "foot", at = [0, 0, 0] }}\n'
        "[loops.pin]",
        "none follows from the others",
    ),
    "rigid": ("[loops.pin]", "[loops.belt]\njoints = { crank = 1, rod = -2 }\n[loops.pin]", "make them rigid"),
    "an unknown key": ("b = {", "c = 1\nb = {", "unknown key"),
    "legs beside loops": ("[loops.pin]", "[legs.leg]\nside = 1\n[loops.pin]", "with loops: a leg is a chain"),
    "not in a loop": (
        'motors = ["crank"]',
        'motors = ["crank"]\nindependent = ["boom_z"]',
        "independent joint in a loop",
    ),
    "too many": (
        'motors = ["crank"]',
        'motors = ["crank"]\nindependent = ["crank", "rod"]',
        "expected 1 of crank, rod, slide",
    ),
    "none": ('motors = ["crank"]', "motors = []", "expected 1 of crank, rod, slide"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_wrong_file_is_refused_in_one_line(tmp_path, what):
    old, new, said = REFUSED[what]
    assert old in CRANK_LOOP
    with pytest.raises(BadFile) as caught:
        load(write(tmp_path, "crank_leg", CRANK_LEG, CRANK_LOOP.replace(old, new, 1)), base="fixed")
    message = str(caught.value)
    assert "\n" not in message and "crank_leg.toml" in message and said in message


def test_motors_that_are_asked_for_do_not_change_which_joints_are_independent(tmp_path):
    path = write(tmp_path, "crank_leg", CRANK_LEG, CRANK_LOOP)
    assert load(path, base="fixed", motors="all").independent == ("boom_z", "crank")
    assert load(path, base="fixed", motors=["rod"]).independent == ("boom_z", "crank")


def test_a_continuous_joint_is_refused(tmp_path):
    """Its cosine and sine are no coordinates of a loop."""
    turning = CRANK_LEG.replace('"crank" type="revolute"', '"crank" type="continuous"')
    with pytest.raises(BadFile, match="none of whose joints is continuous"):
        load(write(tmp_path, "crank_leg", turning, CRANK_LOOP), base="fixed")


def test_a_belt_of_a_locked_joint_is_refused(tmp_path):
    named = CRANK_LEG.replace('joint name="rod"', 'joint name="elbow"')
    toml = CRANK_LOOP.partition("[loops")[0] + "[loops.belt]\njoints = { crank = 1, elbow = -1 }\n"
    with pytest.raises(UnknownName, match="unknown joint of the loop 'belt' 'elbow'; valid: boom_z, crank, slide"):
        load(write(tmp_path, "crank_leg", named, toml), base="fixed", locked=["elbow"])


def test_a_second_end_is_where_the_first_is_at_zero_angles(tmp_path):
    toml = CRANK_LOOP.replace('{ body = "foot", at = [0, 0, 0] }', '{ body = "foot" }')
    robot = load(write(tmp_path, "crank_leg", CRANK_LEG, toml), base="fixed")
    assert np.abs(robot.loop_gap(np.zeros(4))).max() < 1e-15
    np.testing.assert_allclose(robot.model.frames[-1].placement.translation, [CRANK, 0, -ROD], rtol=0, atol=1e-15)


def test_loops_in_space_are_refused(tmp_path):
    tilted = FIVE_BAR.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>', 1)
    with pytest.raises(BadFile, match="x-z plane alone"):
        load(write(tmp_path, "five_bar", tilted, FIVE_BAR_LOOP), base="fixed")


def test_a_configuration_that_cannot_close_is_refused(tmp_path):
    """Lower links of 0.05 m reach each other only while the thighs are close."""
    short = load(write(tmp_path, "five_bar", FIVE_BAR, FIVE_BAR_LOOP.replace(str(-LOWER), "-0.05")), base="fixed")
    assert np.abs(short.loop_gap(short.closed([0.3, 0.2, -0.5, -0.2, 0.5]))).max() < 1e-12
    with pytest.raises(BadValue, match="closes pin"):
        short.closed([0.3, 1.5, -1.5, -1.5, 1.5])


def test_a_toggle_is_refused(legs):
    """Both knees at one place: the lower links turn about it freely."""
    with pytest.raises(BadValue, match="toggle"):
        legs["five_bar"].reduced([0.3, 0.0, 1.5, 0.0, 1.5], [0.0, 0.0, 0.0])
