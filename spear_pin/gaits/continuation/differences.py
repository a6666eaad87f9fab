"""Derivatives by differences that keep to one order of events: central, or to one side where a border is near."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.continuation.problem import NoValue
from spear_pin.hybrid.newton import STEP, stencil
from spear_pin.hybrid.orders import Order

Array = NDArray[np.float64]
Values = Callable[[Array], tuple[Array, Sequence[str], Sequence[Order]]]
"""Values of functions, (m, r), at points, (m, k), why there is none, "" where there is, and the orders of events."""


def differentiated(values: Values, x: Array, step: float = STEP) -> tuple[Array, Array, Order]:
    """Values at a point, (r,), their Jacobian there, (r, k), and the order of events.

    Args:
        values: the functions.
        x: the point, (k,).
        step: of the differences, in each unknown.

    Raises:
        NoValue: there is no value at the point, or in some direction to neither side one of the same order.
    """
    k = len(x)
    found, why, orders = values(x + np.concatenate([np.zeros((1, k)), stencil(k, step)]))
    if why[0]:
        raise NoValue(why[0], orders[0])
    centre, order = found[0], orders[0]
    good = np.array([not reason and each == order for reason, each in zip(why, orders, strict=True)])[1:]
    ahead, behind = found[1 : k + 1] - centre, centre - found[k + 1 :]
    weights = np.stack([good[:k], good[k:]]).astype(float)
    if not weights.any(axis=0).all():
        raise NoValue("no_neighbour", order)
    ahead[~good[:k]], behind[~good[k:]] = 0.0, 0.0
    slopes = (weights[0][:, None] * ahead + weights[1][:, None] * behind) / (weights.sum(axis=0)[:, None] * step)
    return centre, slopes.T, order
