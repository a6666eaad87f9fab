"""Measures of whole cycles from the samples of a motion, in the plane or in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.measures.catalogue import LEAST_STRIDE, PRESSED
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.robot import Robot


@dataclass(frozen=True)
class Sampled:
    """Measures of cycles of a motion: integrals are the mean over the cycles, peaks the largest of all.

    Attributes:
        robot: the robot that moves.
        trajectory: the robot's motion.
        cycles: numbers of whole cycles that follow each other; empty: all samples count as one cycle. If a gait closes
            in the mirror, two cycles make a stride, in which each leg does what the other does.
        halves: whether a cycle is half a stride, which covers distance along the heading with which it begins.
    """

    robot: Robot
    trajectory: Trajectory
    cycles: Sequence[int] = (1,)
    halves: bool = False

    @cached_property
    def curves(self) -> Curves:
        """The samples that count."""
        there = self.trajectory.cycle
        return Curves(self.trajectory.t, np.isin(there, self.cycles) if len(self.cycles) else np.ones_like(there, bool))

    def values(self) -> dict[str, float]:
        """Returns all measures by the names of the catalogue."""
        return {**self.times(), **self.works(), **self.torques(), **self.forces()}

    def times(self) -> dict[str, float]:
        """Returns the period; with forward motion also stride and mean speed."""
        stride = self.stride
        return {"period": self.period} | (
            {} if stride is None else {"stride": stride, "mean_speed": stride / self.period}
        )

    @property
    def period(self) -> float:
        """Duration of a cycle, in s; NaN where no time has passed."""
        return self.curves.duration / self.count or math.nan

    @property
    def count(self) -> int:
        """Number of cycles; 1 if there are no whole cycles."""
        return max(1, len(self.cycles))

    @cached_property
    def stride(self) -> float | None:
        """Distance of a cycle, in m: along x in the plane, else straight from section to section; None without x.

        Round a post it is that of the hip along its circle, positive to the left.
        """
        one, chosen = self.trajectory, self.curves.chosen
        if self.robot.arm is not None:
            rows = np.flatnonzero(chosen)
            return self.robot.arm * float(one.q[rows[-1], 0] - one.q[rows[0], 0]) / self.count
        x, y = (
            next((i for i, name in enumerate(one.coordinates) if name.endswith(axis)), None) for axis in ("_x", "_y")
        )
        if x is None:
            return None
        rows = np.flatnonzero(chosen)
        if y is None:
            return float(one.q[rows[-1], x] - one.q[rows[0], x]) / self.count
        ends = [*(int(np.argmax(one.cycle == n)) for n in self.cycles or [one.cycle[rows[0]]]), int(rows[-1])]
        ways = np.diff(one.q[ends][:, [x, y]], axis=0)
        if self.halves:
            yaw = one.q[ends[:-1], one.coordinates.index("yaw")]
            return float((np.cos(yaw) * ways[:, 0] + np.sin(yaw) * ways[:, 1]).sum()) / self.count
        return float(np.linalg.norm(ways, axis=1).sum()) / self.count

    def works(self) -> dict[str, float]:
        """Returns the work of all motors, and the work per distance."""
        rates = self.rates
        found = {"work": 0.0, "positive_work": 0.0, "absolute_work": 0.0}
        for i in range(len(self.trajectory.actuated)):
            power = self.trajectory.u[:, i] * rates[:, i]
            drive, brake = self.curves.positive(power), self.curves.positive(-power)
            for name, part in zip(found, (drive - brake, drive, drive + brake), strict=True):
                found[name] += part / self.count
        stride = self.stride
        if stride is None or abs(stride) <= LEAST_STRIDE:
            return found
        lifted = self.robot.weight * abs(stride)
        return found | {
            "cost_of_transport": found["absolute_work"] / lifted,
            "cost_of_transport_positive": found["positive_work"] / lifted,
        }

    def torques(self) -> dict[str, float]:
        """Returns the torques of one motor, and the effort of all motors."""
        found, effort = dict[str, float](), 0.0
        for i, joint in enumerate(self.trajectory.actuated):
            motors = motors_at(joint)
            square = self.curves.integral((self.trajectory.u[:, i] / motors) ** 2) / self.count
            effort += motors * square
            found[f"rms_torque_{joint}"] = math.sqrt(max(square, 0.0) / self.period)
            found[f"peak_torque_{joint}"] = self.curves.amount(self.trajectory.u[:, i]) / motors
            found[f"peak_speed_{joint}"] = self.curves.amount(self.rates[:, i])
            turned = self.trajectory.q.shape[1] - self.trajectory.v.shape[1] + self.trajectory.coordinates.index(joint)
            angle = self.trajectory.q[:, turned]  # a quaternion of the base has a number more than its velocity
            found[f"least_{joint}"], found[f"greatest_{joint}"] = self.curves.range(angle)
        found["effort"] = effort
        stride = self.stride
        if stride is not None and abs(stride) > LEAST_STRIDE:
            found["effort_per_distance"] = effort / abs(stride)
        return found

    def forces(self) -> dict[str, float]:
        """Returns the forces on the toes."""
        found = dict[str, float]()
        for i, toe in enumerate(self.trajectory.toes):
            found[f"peak_force_{toe}"] = self.curves.peak(self.trajectory.force[:, i, -1])
            found[f"friction_used_{toe}"] = self.friction_used(i)
        return found

    def of(self, kind: str) -> dict[str, float]:
        """Returns the measures of one kind, such as "peak_torque", by joint or toe."""
        there = (*self.trajectory.actuated, *self.trajectory.toes)
        found = {**self.torques(), **self.forces()}
        return {name: found[f"{kind}_{name}"] for name in there if f"{kind}_{name}" in found}

    def friction_used(self, toe: int) -> float:
        """Returns the largest ratio of tangential to normal force on a toe, by its number, where it is loaded."""
        force = self.trajectory.force[:, toe]
        along = force[:, 0] if force.shape[1] == 2 else np.hypot(force[:, 0], force[:, 1])
        return self.curves.ratio(along, force[:, -1], pressed(self.robot))

    @cached_property
    def rates(self) -> Array:
        """Speeds of the joints with motors, (n, nu)."""
        one = self.trajectory
        return np.asarray(one.v[:, [one.coordinates.index(joint) for joint in one.actuated]])


def pressed(robot: Robot) -> float:
    """Returns the normal force above which a robot's toe is loaded enough for friction to count, in N."""
    return PRESSED * robot.weight / len(robot.toes)
