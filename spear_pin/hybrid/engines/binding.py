"""The rows that bind a robot at a state, by Pinocchio's kinematics: toes on the ground, and closed loops."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.rules.footing import Bound
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.robot import Robot


class Binding:
    """Rows and drifts at the state of some data of Pinocchio's.

    Args:
        robot: the robot.
        ground: the ground, whose axes toes have.
        data: the data.

    Attributes:
        directions: directions of the contact of toes.
        bound: the rows that bind toes at rest.
    """

    def __init__(self, robot: Robot, ground: Ground, data: pin.Data) -> None:
        self._model, self._data = robot.model, data
        self.directions = robot.directions
        self._ground, self._level, self._closure = ground, ground.level, robot.closure
        self._ids, self._still = {toe: robot.toe_id(toe) for toe in robot.toes}, np.zeros(robot.nv)
        self.bound = Bound(robot)
        self._known: tuple[Sequence[str], list[Array], list[Array]] | None = None

    def at(self, q: Array, v: Array) -> None:
        """Moves on to a state, for which the data are up to date."""
        self._q, self._v, self._known = q, v, None

    def rows(self, toes: Sequence[str]) -> tuple[list[Array], list[Array]]:
        """Returns J and J̇ v of some toes, then the rows and drifts of loops, if any; it remembers the last."""
        if self._known is None or self._known[0] != toes:
            self._known = toes, *self._computed(toes)
        return self._known[1], self._known[2]

    def resting(self, toes: Sequence[str], sliding: Collection[str] = ()) -> tuple[list[Array], list[Array]]:
        """Returns rows and drifts as `rows` does, for toes that rest without those along which nothing binds them."""
        rows, drifts = self.rows(toes)
        first = [0 if toe in sliding else row for toe, row in zip(toes, self.bound.first(toes), strict=True)]
        if not any(first):
            return rows, drifts
        first += [0] * (len(rows) - len(toes))
        return _trimmed(rows, first), _trimmed(drifts, first)

    def _computed(self, toes: Sequence[str]) -> tuple[list[Array], list[Array]]:
        model, data, directions = self._model, self._data, self.directions
        pin.forwardKinematics(model, data, self._q, self._v, self._still)
        rows, drifts = [], []
        for toe in toes:
            index = self._ids[toe]
            jacobian = pin.getFrameJacobian(model, data, index, WORLD_ALIGNED)
            drift = pin.getFrameClassicalAcceleration(model, data, index, WORLD_ALIGNED).vector
            rows.append(directions.along(model, data, index, jacobian))
            drifts.append(directions.accelerated(model, data, index, drift))
        if not self._level:
            turn = self._ground.seen_in
            rows, drifts = [np.array(turn(row)) for row in rows], [np.array(turn(drift)) for drift in drifts]
        if self._closure is not None:
            rows.append(self._closure.rows(data))
            drifts.append(self._closure.drift(data))
        return rows, drifts


def _trimmed(parts: Sequence[Array], first: Sequence[int]) -> list[Array]:
    return [each[i:] for i, each in zip(first, parts, strict=True)]
