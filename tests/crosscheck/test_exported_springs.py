"""Springs of an exported file in MuJoCo: the forces are those of the package's laws and paths."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Clutch, Gait, Spring, hopping, load
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.model.cable import Anchor, Between, Over
from spear_pin.model.linkage import Linkage
from spear_pin.model.mjcf import to_mjcf
from spear_pin.model.mjcf_springs import list_left_out_springs, springs_of
from spear_pin.model.monopod import monopod
from spear_pin.model.path import Joints, Sum
from spear_pin.model.robot_posture import RobotPosture
from tests.cli.calls import printed

THIGH, SHANK = Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054))
AHEAD, BELOW = Anchor("thigh", (0.05, 0.0, -0.12)), Anchor("shank", (0.05, 0.0, -0.12))
ON_SHANK, ON_THIGH = Anchor("shank", (0.0, 0.0, 0.0)), Anchor("thigh", (0.0, 0.0, -0.318))
SPRINGS = {
    "over two joints": Spring(5e4, damping=0.0, rest=0.01, path=Joints({"knee": 0.03, "hip": -0.006})),
    "that pushes": Spring(20.0, damping=0.0, rest=0.5, unilateral=False, path=Joints({"hip": 1.0}, -1.0)),
    "cable": Spring(17000.0, damping=0.0, rest=0.1948, path=Between(THIGH, SHANK)),
    "to the world": Spring(500.0, damping=0.0, rest=0.5, path=Between(Anchor("universe", (0.1, 0, 1.2)), SHANK)),
    "pulley": Spring(17000.0, damping=0.0, rest=0.34, path=Over(AHEAD, ON_SHANK, BELOW, 0.03, -1.0)),
    "pulley of the thigh": Spring(17000.0, damping=0.0, rest=0.34, path=Over(AHEAD, ON_THIGH, BELOW, 0.03, -1.0)),
    "the other way": Spring(17000.0, damping=0.0, rest=0.3, path=Over(BELOW, ON_SHANK, AHEAD, 0.03, 1.0)),
}
OTHERS = {
    "latched": (Spring(), "a switch"),
    "late": (Spring(clutch=Clutch(0.004)), "a switch"),
    "hard": (Spring(rest=0.5, hardening=3.0), "not linear"),
    "tight": (Spring(rest=0.5, preload=3.0), "not linear"),
    "slider": (Spring(10.0, rest=0.5, path=Linkage("knee", 0.03, 0.1)), "along a Linkage"),
    "summed": (Spring(10.0, rest=0.5, path=Sum([(1.0, Joints({"knee": 1.0}))])), "along a Sum"),
    "elsewhere": (Spring(10.0, rest=0.5, path=Joints({"left_knee": 1.0})), "only a gait"),
    "damped": (Spring(10.0, damping=0.3, rest=0.5, path=Joints({"knee": 1.0})), "its damper"),
}


@pytest.mark.extra("mujoco")
@pytest.mark.parametrize("name", SPRINGS)
def test_a_tendon_has_the_length_and_the_force_of_the_spring(name):
    import mujoco

    robot, spring = load("spear_ii"), SPRINGS[name]
    assert not list_left_out_springs(robot, {name: spring})
    model = mujoco.MjModel.from_xml_string(to_mjcf(robot, springs={name: spring}))
    data, rng, pulled = mujoco.MjData(model), np.random.default_rng(1), 0
    for knee in np.linspace(-0.2, 2.8, 40):  # within the joint's limits
        data.qpos[:] = q = np.array([rng.normal(), 0.6, rng.uniform(-1, 1), knee])
        mujoco.mj_forward(model, data)
        posture = RobotPosture(robot, FLOATS).at(q)
        stretch = spring.path.length(posture) - spring.rest
        force = 0.0 if spring.unilateral and stretch < 0.0 else spring.torque(stretch)
        expected = np.zeros(4)
        for i, lever in spring.path.slope(posture).items():
            expected[i] = force * lever
        assert data.tendon(name).length[0] == pytest.approx(spring.path.length(posture), abs=1e-12)
        np.testing.assert_allclose(data.qfrc_spring, expected, rtol=1e-10, atol=1e-10)
        pulled += force != 0.0
    assert pulled > 10


@pytest.mark.parametrize("name", OTHERS)
def test_what_mjcf_cannot_say_is_said(name):
    spring, reason = OTHERS[name]
    robot = load("spear_ii")
    (line,) = list_left_out_springs(robot, {name: spring})
    assert line.startswith(f"spring {name}: ") and reason in line
    text = to_mjcf(robot, springs={name: spring})
    assert f"spring {name}: " in text and ("<tendon" in text) == (name == "damped")


def test_names_that_no_xml_has():
    odd = "a\x01--b<"
    text = to_mjcf(load("spear_ii"), springs={odd: SPRINGS["cable"], "--": Spring()})
    assert "\x01" not in text and text.count("<spatial") == 1


def test_a_pulley_that_turns_too_far():
    """Beyond half a turn there is no side on which MuJoCo keeps a tendon."""
    robot = load("q_spear")
    thigh, shank = (Anchor(f"posterior_{each.body}", each.at) for each in (AHEAD, BELOW))
    wide = Spring(100.0, damping=0.0, rest=0.3, path=Over(thigh, replace(shank, at=(0, 0, 0)), shank, 0.03, -1.0))
    assert "turns too far" in list_left_out_springs(robot, {"wide": wide})[0]


@pytest.mark.extra("mujoco")
def test_springs_of_a_robots_file(capsys, tmp_path):
    """A knee's rest is counted in flexion, to whichever side its joint turns."""
    import mujoco

    path = tmp_path / "dog.toml"
    path.write_text("robot = 'q_spear_full'\n[springs.knee]\nstiffness = 14.0\nrest = 0.4\n", encoding="utf-8")
    robot = load(path)
    springs = springs_of(robot)
    assert set(springs) == {leg.knee for leg in robot.legs}
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_string(to_mjcf(robot)))
    for leg in robot.legs:
        data.joint(leg.knee).qpos[0] = 0.9 * leg.side + leg.knee_zero
    mujoco.mj_forward(model, data)
    for leg in robot.legs:
        (dof,) = model.joint(leg.knee).dofadr
        assert data.qfrc_spring[dof] == pytest.approx(-14.0 * 0.5 * leg.side, rel=1e-12)
    leg = monopod(robot, robot.legs[0], locked=["boom_x"])
    assert springs_of(leg)["knee"].path == Joints({"knee": 1.0})
    result = printed(capsys, "export", path, "--mjcf", "--out", tmp_path)
    assert "<fixed" in (tmp_path / "dog.xml").read_text(encoding="utf-8") and "left out" not in str(result)


def test_springs_of_a_gait(capsys, tmp_path):
    robot = load("spear_ii", locked=["boom_x"])
    fixed, latched = SPRINGS["cable"], Spring(20.0)
    system = hopping(robot, spring={"cable": fixed, "knee": latched})
    gait = Gait(system, system.guess(), {}, 0.0, np.array([0.5 + 0j]), {"stance": 0.3, "flight": 0.2})
    gait.save(tmp_path / "hop.json")
    printed(capsys, "export", tmp_path / "hop.json", "--mjcf", "--out", tmp_path)
    text = (tmp_path / "hop.xml").read_text(encoding="utf-8")
    assert '<spatial name="cable"' in text and "spring knee: a switch releases it" in text
