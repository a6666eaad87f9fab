"""Where a law is not smooth: an arc ends, the same motion goes on, and what the domain says has other rates."""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import POINTS, rule
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Stretch

SEEN = 1e-6  # of rates: a smaller jump is none, and when it happens does not matter


def of_the_inside(slopes: Array, place: int) -> Array:
    """Slopes at an end that lies on a kink, (..., n), from Gauss's points beside it.

    There a law has those of either side, which rounding chooses.

    Args:
        slopes: at the points, at the beginning and at the end, (..., k + 2, n).
        place: `BEGIN` or `END`.
    """
    signs = (-1.0) ** np.arange(POINTS) if place == BEGIN else np.ones(POINTS)
    beside = slopes[:, :POINTS] if place == BEGIN else slopes[:, BEGIN - POINTS : BEGIN]
    found: Array = (signs @ rule().legendre) @ beside
    return found


def later(before: Stretch, after: Stretch) -> Array:
    """How much later the kink between two arcs happens, (c,).

    All that the domain says has one value on both sides: d⁻ + ṙ⁻ τ = d⁺ + ṙ⁺ τ. It is told by what has its rate jump
    most, as a share of it.
    """
    (left, dleft), (right, dright) = (
        stretch.at(place, stretch.slopes.rows[:, place]) for stretch, place in ((before, END), (after, BEGIN))
    )
    shares = np.abs(left - right) / np.maximum(np.maximum(np.abs(left), np.abs(right)), 1e-300)
    i = int(shares.argmax())
    if shares[i] < SEEN:
        return np.zeros(dleft.shape[1])
    found: Array = (dright[i] - dleft[i]) / (left[i] - right[i])
    return found
