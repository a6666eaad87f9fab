"""Why a gait is implausible: it exceeds limits of the robot's joints, or its multipliers are all zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot

FORGOTTEN = 1e-3  # of every multiplier: less is left of a disturbance after a cycle than a leg forgets


@dataclass(frozen=True)
class Excess:
    """A limit that a motion exceeds.

    Attributes:
        joint: the joint.
        what: "torque", "rate" or "angle".
        value: value that is reached, the farthest beyond the limit; a torque is that of one motor.
        limit: largest allowed value.
        unit: unit of both.
    """

    joint: str
    what: str
    value: float
    limit: float
    unit: str

    def __str__(self) -> str:
        one = " (one motor)" * (self.what == "torque" and motors_at(self.joint) > 1)
        return f"{self.what} of the {self.joint}{one} {self.value:.3g}, its limit {self.limit:.3g} {self.unit}"


@typed
def excesses(robot: Robot, trajectory: Trajectory) -> tuple[Excess, ...]:
    """Lists limits of the actuated joints that a trajectory exceeds.

    Args:
        robot: the robot of the trajectory.
        trajectory: a trajectory; its samples count, and so do those just before and after events.
    """
    found, curves = [], Curves.of(trajectory.t)
    for i, joint in enumerate(robot.actuated):
        limits, row = robot.limits[joint], robot.coordinates.index(joint)
        motors = motors_at(joint)
        torque = "torque", trajectory.u[:, i] / motors, limits.effort / motors, "N·m"
        rate = "rate", trajectory.v[:, row], limits.velocity, "rad/s"
        for what, values, limit, unit in (torque, rate):
            reached = curves.amount(values)
            if 0.0 < limit < min(reached, UNKNOWN):
                found.append(Excess(joint, what, reached, limit, unit))
        (lowest, highest), (least, most) = curves.range(trajectory.q[:, row]), limits.position
        if highest > most:
            found.append(Excess(joint, "angle", highest, most, "rad"))
        if lowest < least:
            found.append(Excess(joint, "angle", lowest, least, "rad"))
    return tuple(found)


def list_exceeded(gait: Gait) -> str:
    """Lists limits that a cycle of a gait exceeds, in words; an optimiser keeps them at its nodes, but not between."""
    run = simulate(gait.system, gait.state, 1, progress=False)
    return "; ".join(map(str, excesses(gait.system.robot, run)))


@typed
def doubts(gait: Gait, found: Sequence[Excess] = ()) -> tuple[str, ...]:
    """Lists reasons why a correctly computed gait is implausible; empty if it is plausible.

    Args:
        gait: the gait.
        found: limits that its motion exceeds, from `excesses`.
    """
    said = [str(excess) for excess in found]
    if np.abs(gait.multipliers).max() < FORGOTTEN:
        said.append(
            f"multipliers all below {FORGOTTEN:g}: each cycle forgets the last, as where torques outweigh the robot"
        )
    return tuple(said)


@typed
def plausibility(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns the limits that a played motion exceeds, and why its gait is implausible.

    Args:
        gait: the gait.
        trajectory: motion of the gait, or one that was pushed away from it.

    Returns:
        beyond_limits: `excesses`, each as a dictionary; implausible: `doubts`, in words.
    """
    found = excesses(gait.system.robot, trajectory)
    return {"beyond_limits": [asdict(each) for each in found], "implausible": doubts(gait, found)}
