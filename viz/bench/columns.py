"""A column of numbers over time in a page."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Column:
    """A number over time.

    Attributes:
        name: name in `Trajectory.columns`, for instance `q_knee`.
        label: label among those of its kind: `knee`.
        kind: kind in words; columns with the same kind and unit share a plot.
        unit: unit of the values.
        values: values, (n,).
        color: color of its line; "" takes the color of its place in its plot.
        derived: whether it was computed from other columns for plots, and is not in a table.
    """

    name: str
    label: str
    kind: str
    unit: str
    values: NDArray[np.float64]
    color: str = ""
    derived: bool = False

    @property
    def moves(self) -> bool:
        """Whether its values differ."""
        return bool(np.any(self.values != self.values[0]))
