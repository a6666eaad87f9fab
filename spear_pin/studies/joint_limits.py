"""By how much a motion exceeds what the robot's file allows its joints: torque, rate, angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot


@dataclass(frozen=True)
class Excess:
    """A limit that is not kept.

    Attributes:
        joint: the joint.
        what: "torque", "rate" or "angle".
        value: what is reached, the farthest beyond the limit.
        limit: what is allowed.
        unit: of both.
    """

    joint: str
    what: str
    value: float
    limit: float
    unit: str

    def __str__(self) -> str:
        return f"{self.what} of the {self.joint} {self.value:.3g}, its limit {self.limit:.3g} {self.unit}"


@typed
def excesses(robot: Robot, trajectory: Trajectory) -> tuple[Excess, ...]:
    """Limits of the actuated joints that a trajectory does not keep.

    Args:
        robot: whose trajectory it is.
        trajectory: its samples count, and so do those just before and after events.
    """
    found = []
    for i, joint in enumerate(robot.actuated):
        limits, row = robot.limits[joint], robot.coordinates.index(joint)
        torque = "torque", trajectory.u[:, i], limits.effort, "N·m"
        rate = "rate", trajectory.v[:, row], limits.velocity, "rad/s"
        for what, values, limit, unit in (torque, rate):
            reached = float(np.abs(values).max())
            if 0.0 < limit < min(reached, UNKNOWN):
                found.append(Excess(joint, what, reached, limit, unit))
        angles, (least, most) = trajectory.q[:, row], limits.position
        if angles.max() > most:
            found.append(Excess(joint, "angle", float(angles.max()), most, "rad"))
        if angles.min() < least:
            found.append(Excess(joint, "angle", float(angles.min()), least, "rad"))
    return tuple(found)
