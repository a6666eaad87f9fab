"""Smooth curves through points, as formulas without branches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy


@dataclass(frozen=True)
class Curve:
    """A continuous piecewise polynomial, for scalars of any kind.

    f(x) = f₀ + Σᵢ pᵢ(uᵢ) with pᵢ(0) = 0, where uᵢ is the part of the i-th piece below x: 0 before the piece, its whole
    length after it. The first piece continues below its start, the last one above its end.

    Attributes:
        starts: starts of the pieces, increasing; at the first start the argument of the first piece is 0.
        pieces: coefficients of each pᵢ, beginning with that of uᵢ.
        offset: f₀.
    """

    starts: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]
    offset: float = 0.0

    def __call__(self, x: Any, ops: Any = np) -> Any:
        """Returns the value at x.

        Args:
            x: the argument, a scalar of any kind.
            ops: has `maximum` for such scalars.
        """
        beyond = [x - self.starts[0], *(ops.maximum(x - start, 0.0) for start in self.starts[1:])]
        value = self.offset
        for piece, here, after in zip(self.pieces, beyond, [*beyond[1:], 0.0], strict=True):
            value = value + _polynomial(piece, here - after)
        return value

    def integral(self) -> Curve:
        """Returns the curve of the integral from 0 on."""
        ends = np.diff(self.starts)
        values, pieces = self.offset, []
        for i, piece in enumerate(self.pieces):
            pieces.append((values, *(c / (power + 2) for power, c in enumerate(piece))))
            if i < len(ends):
                values = values + _polynomial(piece, float(ends[i]))
        whole = Curve(self.starts, tuple(pieces))
        return Curve(self.starts, tuple(pieces), -float(whole(0.0)))


def _polynomial(coefficients: Sequence[float], u: Any) -> Any:
    """Returns c₀ u + c₁ u² + ..."""
    value: Any = 0.0
    for coefficient in reversed(coefficients):
        value = u * (coefficient + value)
    return value


def through(points: Sequence[tuple[float, float]]) -> Curve:
    """Returns the monotone cubic of Fritsch and Carlson (PCHIP) through points, straight beyond the last.

    Below the first point it is straight, too, unless this point is at 0, where the first piece continues. It has one
    continuous derivative, and rises wherever the points do.

    Args:
        points: two or more (x, y), increasing in x.
    """
    x, y = np.array(points, dtype=float).T
    with np.errstate(over="ignore"):  # of the harmonic mean of slopes that are all but zero
        cubics = scipy.interpolate.PchipInterpolator(x, y)
    slopes = cubics(x[[0, -1]], 1).tolist()
    starts, pieces = x.tolist(), [*(tuple(c) for c in cubics.c[2::-1].T.tolist()), (slopes[1],)]
    if x[0] != 0.0:
        starts, pieces = [starts[0], *starts], [(slopes[0],), *pieces]
    return Curve(tuple(starts), tuple(pieces), float(y[0]))
