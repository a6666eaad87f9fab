"""Derivatives by differences within one order of events: central, or one-sided where a border is near."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.problem import NoValue
from spear_pin.hybrid.newton import NO_NEIGHBOUR, STEP, stencil
from spear_pin.hybrid.orders import Order

STEEPEST = 3e3  # slope: what is steeper jumps
Values = Callable[[Array], tuple[Array, Sequence[str], Sequence[Order]]]
"""Values of functions, (m, r), at points, (m, k), why there is none, "" where there is, and the orders of events."""


def differentiate_values(values: Values, x: Array) -> tuple[Array, Array, Order]:
    """Returns the values at a point, (r,), their Jacobian there, (r, k), and the order of events.

    Args:
        values: the functions to differentiate.
        x: the point, (k,).

    Raises:
        NoValue: there is no value at the point, or in some direction neither side has a value with the same order of
            events that does not jump.
    """
    k = len(x)
    found, why, orders = values(x + np.concatenate([np.zeros((1, k)), stencil(k)]))
    if why[0]:
        raise NoValue(why[0], orders[0])
    centre, order = found[0], orders[0]
    ahead, behind = found[1 : k + 1] - centre, centre - found[k + 1 :]
    same = np.array([not reason and each == order for reason, each in zip(why, orders, strict=True)])[1:]
    sides = np.stack([same[:k], same[k:]])
    # between two borders neither side is free; values without jump are enough for Newton's method
    smooth = np.abs(np.stack([ahead, behind])).max(axis=2) < STEEPEST * STEP  # False where there is no value
    sides |= ~sides.any(axis=0) & smooth
    if not sides.any(axis=0).all():
        raise NoValue(NO_NEIGHBOUR, order)
    slopes = (np.where(sides[0, :, None], ahead, 0.0) + np.where(sides[1, :, None], behind, 0.0)) / STEP
    return centre, (slopes / sides.sum(axis=0)[:, None]).T, order
