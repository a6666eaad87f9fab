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

    f(x) = f₀ + Σᵢ pᵢ(uᵢ) with pᵢ(0) = 0, where uᵢ is how far x has come through the i-th piece: 0 before it, its whole
    length behind it. The first piece goes on below, the last one above.

    Attributes:
        starts: where the pieces begin, rising; the first one's is where its own argument is 0.
        pieces: coefficients of each pᵢ, from that of uᵢ on.
        offset: f₀.
    """

    starts: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]
    offset: float = 0.0

    def __call__(self, x: Any, ops: Any = np) -> Any:
        """The value.

        Args:
            x: where.
            ops: has `maximum` for such scalars.
        """
        beyond = [x - self.starts[0], *(ops.maximum(x - start, 0.0) for start in self.starts[1:])]
        value = self.offset
        for piece, here, after in zip(self.pieces, beyond, [*beyond[1:], 0.0], strict=True):
            value = value + _polynomial(piece, here - after)
        return value

    def integral(self) -> Curve:
        """The curve of the integral from 0 on."""
        ends = np.diff(self.starts)
        values, pieces = self.offset, []
        for i, piece in enumerate(self.pieces):
            pieces.append((values, *(c / (power + 2) for power, c in enumerate(piece))))
            if i < len(ends):
                values = values + _polynomial(piece, float(ends[i]))
        whole = Curve(self.starts, tuple(pieces))
        return Curve(self.starts, tuple(pieces), -float(whole(0.0)))


def _polynomial(coefficients: Sequence[float], u: Any) -> Any:
    """c₀ u + c₁ u² + ..."""
    value: Any = 0.0
    for coefficient in reversed(coefficients):
        value = u * (coefficient + value)
    return value


def through(points: Sequence[tuple[float, float]]) -> Curve:
    """The monotone cubic of Fritsch and Carlson (PCHIP) through points, straight beyond the last.

    Below the first it is straight, too, unless that is 0, from where the first piece goes on. It has one continuous
    derivative, and rises wherever the points do.

    Args:
        points: two or more (x, y), rising in x.
    """
    x, y = np.array(points, dtype=float).T
    with np.errstate(over="ignore"):  # of the harmonic mean of slopes that are all but zero
        cubics = scipy.interpolate.PchipInterpolator(x, y)
    slopes = cubics(x[[0, -1]], 1).tolist()
    starts, pieces = x.tolist(), [*(tuple(c) for c in cubics.c[2::-1].T.tolist()), (slopes[1],)]
    if x[0] != 0.0:
        starts, pieces = [starts[0], *starts], [(slopes[0],), *pieces]
    return Curve(tuple(starts), tuple(pieces), float(y[0]))
