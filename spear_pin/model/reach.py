"""What a law calls hip and knee on a leg with closed loops: weighted sums of its motors' angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName

Weights = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Reach:
    """Two angles of a leg: by the knee it folds and extends, by the hip it swings.

    Attributes:
        knee: weights of motors in the knee's angle, which grows as the leg folds.
        hip: weights of motors in the hip's angle, which grows as the toe swings forward; none for a leg on a guide.
    """

    knee: Weights
    hip: Weights = ()

    def check(self, motors: Sequence[str]) -> None:
        """Checks that it is of motors alone, and that they can swing the leg without folding it.

        Raises:
            UnknownName: another joint is in it.
            BadValue: the hip's angle is a multiple of the knee's.
        """
        for joint, _ in (*self.knee, *self.hip):
            if joint not in motors:
                raise UnknownName("motor in [reach]", joint, motors)
        if np.linalg.matrix_rank(self.rows(motors)) < 1 + bool(self.hip):
            raise BadValue("reach", self, "a hip whose angle is no multiple of the knee's")

    def rows(self, motors: Sequence[str]) -> Array:
        """Returns the weights of motors in the angles of hip and knee, (2, n)."""
        return np.array([[dict(weights).get(motor, 0.0) for motor in motors] for weights in (self.hip, self.knee)])

    def angles(self, values: Sequence[Any], coordinates: Sequence[str]) -> tuple[Any, Any]:
        """Returns the angles of hip and knee, or their rates, from those of all coordinates."""
        hip, knee = (
            sum((weight * values[coordinates.index(joint)] for joint, weight in weights), 0.0)
            for weights in (self.hip, self.knee)
        )
        return hip, knee

    def torques(self, hip: Any, knee: Any, motors: Sequence[str]) -> list[Any]:
        """Returns the torques of motors that do the work of torques on hip and knee."""
        pairs = [(weights, torque) for weights, torque in ((self.hip, hip), (self.knee, knee)) if weights]
        return [sum((dict(weights).get(motor, 0.0) * torque for weights, torque in pairs), 0.0) for motor in motors]
