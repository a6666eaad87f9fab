"""What is continued: equations in unknowns and one parameter, as continuation asks for them.

Unknowns are points u of a manifold embedded in N numbers, each scaled so that 1 is a long way, the parameter last.
About a point there are n + 1 local coordinates, for n equations; of plain equations they are the numbers themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.orders import Order


@dataclass(frozen=True)
class Local:
    """The equations about a point.

    Attributes:
        u: the point, (N,).
        residual: F there, (n,).
        jacobian: dF/dc over the local coordinates, (n, n + 1).
        directions: du/dc, (N, n + 1).
        multipliers: Floquet multipliers, by decreasing modulus, (d,).
        order: the order of events.
        more: what else is known of the cycle.
    """

    u: Array
    residual: Array
    jacobian: Array
    directions: Array
    multipliers: NDArray[np.complex128]
    order: Order
    more: Any = field(default=None, compare=False)

    def like(self, other: Local) -> bool:
        """Whether the order of events is that of another, and there are as many multipliers."""
        return self.order == other.order and len(self.multipliers) == len(other.multipliers)

    def coordinates(self, direction: Array) -> Array:
        """Local coordinates, (n + 1,), of the direction nearest to one, (N,)."""
        return np.linalg.lstsq(self.directions, direction, rcond=None)[0].astype(np.float64)


class NoValue(Exception):
    """The equations have no value at a point, or no derivative.

    Attributes:
        reason: why, in a word.
        order: of the events there, as far as it is known.
    """

    def __init__(self, reason: str, order: Order = ()) -> None:
        super().__init__(reason)
        self.reason, self.order = reason, order


class Problem(Protocol):
    """Equations that can be continued."""

    def local(self, u: Array) -> Local:
        """The equations about a point.

        Raises:
            NoValue: they have none there.
        """

    def glance(self, u: Array) -> tuple[Array, Order]:
        """F at a point, (n,), and the order of events, without derivatives.

        Raises:
            NoValue: there is none.
        """

    def moved(self, local: Local, step: Array) -> Array:
        """The point that local coordinates, (n + 1,), lead to from another."""
