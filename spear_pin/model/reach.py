"""What a law calls hip and knee on a leg with closed loops: weighted sums of its motors' angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

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
