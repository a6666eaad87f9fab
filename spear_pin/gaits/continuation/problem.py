"""What continuation needs: equations in unknowns and one parameter.

Unknowns are points u of a manifold embedded in N numbers. Each number is scaled to order one, and the parameter is the
last. About a point there are n + 1 local coordinates for n equations. Plain equations have the numbers themselves as
local coordinates.
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
        residual: F at the point, (n,).
        jacobian: dF/dc over the local coordinates, (n, n + 1).
        directions: du/dc, (N, n + 1).
        multipliers: Floquet multipliers, by decreasing modulus, (d,).
        order: the order of events.
        more: what else is known about the cycle.
    """

    u: Array
    residual: Array
    jacobian: Array
    directions: Array
    multipliers: NDArray[np.complex128]
    order: Order
    more: Any = field(default=None, compare=False)

    def like(self, other: Local) -> bool:
        """Tells whether another point has the same order of events and as many multipliers."""
        return self.order == other.order and len(self.multipliers) == len(other.multipliers)

    def coordinates(self, direction: Array) -> Array:
        """Returns the local coordinates, (n + 1,), of the direction nearest to a given direction, (N,)."""
        return np.linalg.lstsq(self.directions, direction, rcond=None)[0].astype(np.float64)


class NoValue(Exception):
    """Raised where the equations have no value at a point, or no derivative.

    Attributes:
        reason: why, in a word.
        order: order of the events there, as far as it is known.
    """

    def __init__(self, reason: str, order: Order = ()) -> None:
        super().__init__(reason)
        self.reason, self.order = reason, order


class Problem(Protocol):
    """Equations that can be continued."""

    def local(self, u: Array) -> Local:
        """Returns the equations about a point.

        Raises:
            NoValue: the equations have no value there.
        """

    def glance(self, u: Array) -> tuple[Array, Order]:
        """Returns F at a point, (n,), and the order of events, without derivatives.

        Raises:
            NoValue: there is no value there.
        """

    def moved(self, local: Local, step: Array) -> Array:
        """Returns the point that local coordinates, (n + 1,), lead to from another point."""
