"""A column of numbers over time, as a page holds it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Column:
    """A number over time.

    Attributes:
        name: as `Trajectory.columns` has it, for instance `q_knee`.
        label: what has it, of those of its kind: `knee`.
        kind: what it is, in words; columns of a kind and a unit share a plot.
        unit: of its values.
        values: (n,).
        color: of its line; "" for that of its place among those of its plot.
        derived: whether it was made from others for plots, and is in no table.
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
