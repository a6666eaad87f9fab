"""Limits that a motion does not keep, and what else makes a gait implausible."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.studies.joint_limits import Excess, doubts, excesses, plausibility


@pytest.fixture(scope="module")
def motion(hop):
    return hop.system.robot, simulate(hop.system, hop.state, 1)


def with_limits(robot, joints=("knee",), **limits):
    """The robot with other limits of some joints."""
    model = robot.model.copy()
    rows = [robot.index(joint) for joint in joints]
    for name, value in limits.items():
        column = getattr(model, name).copy()
        column[rows] = value
        setattr(model, name, column)
    return robot.with_model(model)


def test_kept(motion):
    robot, trajectory = motion
    wide = {"upperEffortLimit": 1e3, "upperVelocityLimit": 1e2, "lowerPositionLimit": -9.0, "upperPositionLimit": 9.0}
    assert excesses(with_limits(robot, **wide), trajectory) == ()


@pytest.mark.parametrize(
    ("name", "limit", "what"),
    [
        ("upperEffortLimit", 3.0, "torque"),
        ("upperVelocityLimit", 2.0, "rate"),
        ("upperPositionLimit", 1.2, "angle"),
        ("lowerPositionLimit", 0.99, "angle"),
    ],
)
def test_exceeded(motion, name, limit, what):
    """What is reached is the farthest beyond, between samples as well."""
    robot, trajectory = motion
    (found,) = excesses(with_limits(robot, **{name: limit}), trajectory)
    knee = robot.coordinates.index("knee")
    q, v, u = trajectory.q[:, knee], trajectory.v[:, knee], trajectory.u[:, 1]
    reached = {"torque": abs(u).max(), "rate": abs(v).max(), "angle": q.min() if name.startswith("lower") else q.max()}
    assert (found.joint, found.what, found.limit) == ("knee", what, limit)
    assert found.value == pytest.approx(reached[what], rel=1e-3) and f"{what} of the knee" in str(found)


@pytest.mark.parametrize("unknown", [0.0, np.inf, 1e9])
def test_unknown(motion, unknown):
    """Files that know no limit say 0, or a number that none reaches."""
    robot, trajectory = motion
    free = with_limits(robot, upperEffortLimit=unknown, upperVelocityLimit=unknown)
    assert excesses(free, trajectory) == ()


def test_one_motor_of_a_pair_is_said():
    """In the plane a joint is that of both legs of a pair."""
    said = {
        ("anterior_hip", "torque"): "torque of the anterior_hip (one motor) 61.3, its limit 50 N·m",
        ("anterior_hip", "rate"): "rate of the anterior_hip 61.3, its limit 50 N·m",
        ("anterior_left_hip", "torque"): "torque of the anterior_left_hip 61.3, its limit 50 N·m",
    }
    assert {joint: str(Excess(*joint, 61.3, 50.0, "N·m")) for joint in said} == said


def test_what_is_not_to_be_believed(motion, hop):
    """A limit that is not kept, and a cycle that forgets the last."""
    robot, trajectory = motion
    found = excesses(with_limits(robot, upperEffortLimit=3.0), trajectory)
    assert doubts(hop, ()) == () and doubts(hop, found) == (str(found[0]),)
    told = plausibility(
        replace(hop, system=replace(hop.system, robot=with_limits(robot, upperEffortLimit=3.0))), trajectory
    )
    assert told["implausible"] == (str(found[0]),) and told["beyond_limits"] == [vars(found[0])]
    (said,) = doubts(replace(hop, multipliers=np.zeros(3, dtype=complex)))
    assert "multipliers all below 0.001" in said


def test_torques_are_those_of_one_motor():
    """Of a pair of legs, whose joint has twice the limit that a leg's has."""
    gait = Gait.load("long_stride")
    robot, trajectory = gait.system.robot, simulate(gait.system, gait.state, 1, progress=False)
    weak = with_limits(robot, robot.actuated, upperEffortLimit=100.0)
    found = [each for each in excesses(weak, trajectory) if each.what == "torque"]
    assert [each.joint for each in found] == ["posterior_hip", "posterior_knee", "anterior_knee"]
    assert [each.value for each in found] == pytest.approx([61.333, 58.559, 68.333], abs=1e-3)
    assert {each.limit for each in found} == {50.0}
