"""Outline of the ground: points of its surface along x."""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.ground import HIGHEST, Ground

SPACING = 0.01  # m between points of what is no plane
HALVINGS = 40


def outline(ground: Ground, low: float, high: float) -> Array:
    """Returns places (x, z) on the ground between two x, in m, (n, 2): two for a plane, many for another shape."""
    if type(ground).above is Ground.above:
        return np.array([(x, ground.under(x)) for x in (low, high)])
    places = np.linspace(low, high, max(2, round((high - low) / SPACING) + 1))
    return np.array([(x, _height(ground, x)) for x in places.tolist()])


def _height(ground: Ground, x: float) -> float:
    """Returns the height at which the distance from the ground changes its sign above a place."""
    below, over = ground.under(x) - HIGHEST, ground.under(x) + HIGHEST
    for _ in range(HALVINGS):
        middle = 0.5 * (below + over)
        below, over = (middle, over) if ground.above(x, middle) < 0.0 else (below, middle)
    return 0.5 * (below + over)
