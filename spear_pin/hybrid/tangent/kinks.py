"""Kinks of a law, where it is not smooth: an arc ends, the same motion continues, and the domain's rates jump."""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import POINTS, rule
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Stretch

SEEN = 1e-6  # relative jump of rates below which a kink, and its time, does not matter


def of_the_inside(slopes: Array, place: int) -> Array:
    """Extrapolates the slopes at an end that lies on a kink, (..., n), from the nearby Gauss points.

    On the kink itself the law has the slopes of either side, and rounding decides which.

    Args:
        slopes: slopes at the points, at the beginning and at the end, (..., k + 2, n).
        place: `BEGIN` or `END`.
    """
    signs = (-1.0) ** np.arange(POINTS) if place == BEGIN else np.ones(POINTS)
    beside = slopes[:, :POINTS] if place == BEGIN else slopes[:, BEGIN - POINTS : BEGIN]
    found: Array = (signs @ rule().legendre) @ beside
    return found


def later(before: Stretch, after: Stretch) -> Array:
    """Returns how much later the kink between two arcs happens, per unit of each direction, (c,).

    Every value of the domain is equal on both sides: d⁻ + ṙ⁻ τ = d⁺ + ṙ⁺ τ. The value with the largest relative jump
    of its rate gives τ.
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
