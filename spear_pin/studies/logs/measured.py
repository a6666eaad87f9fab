"""What the measured joints of a leg say of its whole configuration and motion, in stance and in flight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.robot import Robot
from spear_pin.studies.logs.log import Log

STANCE, FLIGHT = "stance", "flight"
BASE = "boom_x", "boom_z"  # coordinates that say where the robot is
SETTLED, STEPS, RANK = 1e-12, 30, 1e-6


@dataclass(frozen=True)
class Measured:
    """The joints of a robot with one toe whose positions a log has.

    Attributes:
        robot: the robot.
        joints: names of the joints.
    """

    robot: Robot
    joints: tuple[str, ...]

    @cached_property
    def gravity(self) -> float:
        """Acceleration of free fall, in m/s²."""
        return float(np.linalg.norm(self.robot.model.gravity.linear))

    @cached_property
    def rows(self) -> list[int]:
        """Rows of the joints in q."""
        return [self.robot.index(name) for name in self.joints]

    @cached_property
    def base(self) -> list[int]:
        """Rows of the coordinates, not measured, that say where the robot is."""
        return [self.robot.index(name) for name in BASE if name in self.robot.coordinates and name not in self.joints]

    @cached_property
    def leading(self) -> dict[str, list[int]]:
        """Rows of joints whose rates determine the motion, in stance with the toe at rest, in flight with the base's.

        Raises:
            BadValue: the rates of the measured joints do not determine it.
        """
        q = self.configuration(np.zeros(len(self.rows)), None)
        return {name: self._leading(self._rows(name, q)) for name in (STANCE, FLIGHT)}

    def _leading(self, rows: Array) -> list[int]:
        found = list[int]()
        for row in self.rows:
            more = np.vstack([rows, np.eye(self.robot.nv)[row]])
            if np.linalg.matrix_rank(more, RANK) > np.linalg.matrix_rank(rows, RANK):
                rows, found = more, [*found, row]
        if np.linalg.matrix_rank(rows, RANK) < self.robot.nv:
            others = [name for name in self.robot.coordinates if name not in (*self.joints, *BASE)]
            raise BadValue("log", list(self.joints), f"positions of more joints: one of {', '.join(others)} at least")
        return found

    def configuration(self, positions: Array, near: Array | None) -> Array:
        """Returns the configuration, (nv,), with the toe on the ground, from measured positions, (m,).

        Args:
            positions: the measured positions.
            near: a configuration nearby; None for any.
        """
        robot, toe = self.robot, self.robot.toes[0]
        q = robot.closed(np.zeros(robot.nq)) if near is None else near.copy()
        q[self.rows] = positions
        free = [i for i in range(robot.nv) if i not in self.rows]
        for _ in range(STEPS):
            gap = np.append(robot.loop_gap(q), self._height(q))
            if not free or np.abs(gap).max() < SETTLED:
                break
            slope = np.vstack([robot.loop_jacobian(q), robot.toe_jacobian(q, toe)[-1:]])
            q[free] -= np.linalg.lstsq(slope[:, free], gap, rcond=None)[0]
        return q

    def state(self, name: str, positions: Array, rates: Array, near: Array, base: Array | None = None) -> Array:
        """Returns a state, (2 nv,), from measured positions and the leading rates.

        Args:
            name: "stance", with the toe at rest, or "flight", with the base's rates.
            positions: positions of the joints, (m,).
            rates: rates of those that lead.
            near: a configuration nearby, (nv,).
            base: the base's rates, for flight.
        """
        q = self.configuration(positions, near)
        rows = np.vstack([self._rows(name, q), np.eye(self.robot.nv)[self.leading[name]]])
        own = np.zeros(0) if base is None else base
        wanted = np.concatenate([np.zeros(len(rows) - len(own) - len(rates)), own, rates])
        return np.concatenate([q, np.linalg.lstsq(rows, wanted, rcond=None)[0]])

    def lengths(self, positions: Array, near: Array | None = None) -> Array:
        """Returns how far the base is above the toe, (n,), in m, from positions, (n, m); NaN where these are."""
        found = np.full(len(positions), np.nan)
        for i in np.flatnonzero(np.isfinite(positions).all(axis=1)):
            near = self.configuration(positions[i], near)
            found[i] = self.length(near)
        return found

    def heights(self, positions: Array) -> Array:
        """Returns how far the centre of mass is above the toe, (n,), in m, from measured positions, (n, m)."""
        found, near = [], None
        for each in positions:
            near = self.configuration(each, near)
            found.append(self.robot.potential_energy(near) / self.robot.weight)
        return np.array(found)

    def length(self, q: Array) -> float:
        """Returns how far the base is above the toe at a configuration, in m."""
        still = q.copy()
        still[[i for i, name in enumerate(self.robot.coordinates) if name in BASE]] = 0.0
        return -self._height(still)

    def _height(self, q: Array) -> float:
        return float(self.robot.toe_position(q, self.robot.toes[0])[-1])

    def _rows(self, name: str, q: Array) -> Array:
        """Returns rows of nv that loops and the toe at rest make zero, or, in flight, those of the base."""
        toe = self.robot.toe_jacobian(q, self.robot.toes[0])
        return np.vstack([self.robot.loop_jacobian(q), toe if name == STANCE else np.eye(self.robot.nv)[self.base]])


def find_measured(robot: Robot, log: Log) -> Measured:
    """Returns the joints of a robot that a log has; where the base is follows from them while the toe is at rest.

    Raises:
        BadValue: the robot is none in the plane with one toe.
        UnknownName: the log has the position of none of its joints.
    """
    if not robot.planar or len(robot.toes) != 1:
        raise BadValue("robot", robot.name, "a planar robot with one toe")
    valid = [name for name in robot.coordinates if name not in BASE]
    joints = tuple(name for name in valid if name in log.values)
    if not joints:
        raise UnknownName(f"joint of {robot.name} in the log {log.source}", [*log.values], valid)
    return Measured(robot, joints)
