"""Measures of whole cycles from the samples of a motion, in the plane or in space."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.gaits.measures.catalogue import CATALOGUE
from spear_pin.gaits.measures.curves import Curves
from spear_pin.gaits.measures.signals import Signals
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot


@dataclass(frozen=True)
class Sampled(Signals):
    """Signals of cycles of a motion: integrals are the mean over the cycles, peaks the largest of all.

    Attributes:
        robot: the robot that moves.
        trajectory: the robot's motion.
        cycles: numbers of whole cycles that follow each other; empty: all samples count as one cycle. If a gait closes
            in the mirror, two cycles make a stride, in which each leg does what the other does.
        halves: whether a cycle is half a stride, which covers distance along the heading with which it begins.
        drives: drive of one motor of joints, for their electricity and heat.
    """

    robot: Robot
    trajectory: Trajectory
    cycles: Sequence[int] = (1,)
    halves: bool = False
    drives: Mapping[str, Drive] = field(default_factory=dict)

    def values(self) -> dict[str, float]:
        """Returns all measures by the names of the catalogue."""
        return {name: value for each in CATALOGUE for name, value in each.values(self).items()}

    def of(self, kind: str) -> dict[str, float]:
        """Returns the measures of one kind, such as "peak_torque", by joint or toe.

        Raises:
            UnknownName: there is no such kind.
        """
        for each in CATALOGUE:
            if each.kind == kind:
                return {name.removeprefix(f"{kind}_"): value for name, value in each.values(self).items()}
        raise UnknownName("kind of measure", kind, [each.kind for each in CATALOGUE])

    def largest(self, kind: str) -> float:
        """Returns the only measure of a kind, or the largest of all joints or toes; NaN where there is none.

        Raises:
            UnknownName: there is no such kind.
        """
        return max(self.of(kind).values(), default=math.nan)

    @cached_property
    def curves(self) -> Curves:
        """The samples that count."""
        there = self.trajectory.cycle
        return Curves(self.trajectory.t, np.isin(there, self.cycles) if len(self.cycles) else np.ones_like(there, bool))

    @property
    def count(self) -> int:
        """Number of cycles; 1 if there are no whole cycles."""
        return max(1, len(self.cycles))

    @cached_property
    def durations(self) -> dict[str, float]:
        """Duration of each phase, in s; none of half strides, where another phase stands for it in each other half."""
        if self.halves:
            return {}
        names = dict.fromkeys(self.trajectory.phase[self.curves.chosen].tolist())
        return {name: self.curves.among(self.trajectory.phase == name).duration / self.count for name in names if name}

    @property
    def period(self) -> float:
        """Duration of a cycle, in s; NaN where no time has passed."""
        return self.curves.duration / self.count or math.nan

    @cached_property
    def stride(self) -> float | None:
        """Distance of a cycle, in m: along x in the plane, else straight from section to section; None without x.

        Round a post it is that of the hip along its circle, positive to the left.
        """
        one, rows = self.trajectory, np.flatnonzero(self.curves.chosen)
        if self.robot.arm is not None:
            return self.robot.arm * float(one.q[rows[-1], 0] - one.q[rows[0], 0]) / self.count
        x, y = (
            next((i for i, name in enumerate(one.coordinates) if name.endswith(axis)), None) for axis in ("_x", "_y")
        )
        if x is None:
            return None
        if y is None:
            return float(one.q[rows[-1], x] - one.q[rows[0], x]) / self.count
        ends = [*(int(np.argmax(one.cycle == n)) for n in self.cycles or [one.cycle[rows[0]]]), int(rows[-1])]
        ways = np.diff(one.q[ends][:, [x, y]], axis=0)
        if self.halves:
            yaw = one.q[ends[:-1], one.coordinates.index("yaw")]
            return float((np.cos(yaw) * ways[:, 0] + np.sin(yaw) * ways[:, 1]).sum()) / self.count
        return float(np.linalg.norm(ways, axis=1).sum()) / self.count

    @property
    def weight(self) -> float:
        """The robot's weight, in N."""
        return self.robot.weight

    @cached_property
    def torques(self) -> dict[str, Array]:
        """Torque of one motor of each joint, in N·m, (n,) each."""
        one = self.trajectory
        return {joint: one.u[:, i] / motors_at(joint) for i, joint in enumerate(one.actuated)}

    @cached_property
    def speeds(self) -> dict[str, Array]:
        """Speed of each joint with motors, in rad/s, (n,) each."""
        one = self.trajectory
        return {joint: one.v[:, one.coordinates.index(joint)] for joint in one.actuated}

    @cached_property
    def angles(self) -> dict[str, Array]:
        """Angle of each joint with motors, in rad, (n,) each."""
        one = self.trajectory
        more = one.q.shape[1] - one.v.shape[1]  # a quaternion of the base has a number more than its velocity
        return {joint: one.q[:, more + one.coordinates.index(joint)] for joint in one.actuated}

    @cached_property
    def forces(self) -> dict[str, tuple[Array, Array]]:
        """Force on each toe along the ground, and normal to it, in N, (n,) each."""
        found = {}
        for i, toe in enumerate(self.trajectory.toes):
            *along, normal = self.trajectory.force[:, i].T
            found[toe] = along[0] if len(along) == 1 else np.hypot(*along), normal
        return found

    def electricity(self, joint: str) -> tuple[float, float] | None:
        """Returns what all motors of a joint take from their supply, and what they give back, in J; None if unknown."""
        if joint not in self.drives:
            return None
        taken, back = self.curves.halves(self.drives[joint].bus_power, self.torques[joint], self.speeds[joint])
        return taken * motors_at(joint) / self.count, back * motors_at(joint) / self.count

    def integral(self, signal: Array) -> float:
        """Returns ∫ of a signal over a cycle."""
        return self.curves.integral(signal) / self.count

    def positive(self, signal: Array) -> float:
        """Returns ∫ of the positive part of a signal over a cycle."""
        return self.curves.positive(signal) / self.count

    def peak(self, signal: Array) -> float:
        """Returns the largest value of a signal."""
        return self.curves.peak(signal)

    def amount(self, signal: Array) -> float:
        """Returns the largest modulus of a signal."""
        return self.curves.amount(signal)

    def ratio(self, above: Array, below: Array, least: float) -> float:
        """Returns the largest |above / below| where the signal below is at least `least`; 0 if it never is."""
        return self.curves.ratio(above, below, least)
