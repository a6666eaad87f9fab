"""Gauss's points along an arc, in as many panels as the motion needs."""

from __future__ import annotations

import math

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.contact import SLIP
from spear_pin.hybrid.tangent.collocation import ENDS, INSIDE, POINTS, Fineness, roughness, rule
from spear_pin.hybrid.tangent.derivative import SHORTEST
from spear_pin.hybrid.tangent.resets import NotDifferentiable

MOST_PANELS = 64  # most panels of an arc
EARLY = 4  # number of points that do not count yet where panels are long


def points(arc: Arc, fineness: Fineness = INSIDE) -> tuple[Array, float, Array]:
    """Returns the times of the points, in s, (k,), the length of a panel, in s, and the states, (2 nv, k).

    Args:
        arc: the arc.
        fineness: how fine panels are.

    Raises:
        NotDifferentiable: the motion is not smooth, or cannot be followed again.
    """
    gauss, length = rule(), max(arc.end - arc.t, 0.0)
    if length <= SHORTEST:
        t = arc.t + length * gauss.nodes
        return t, length, np.tile(arc.y[:, None], (1, len(t)))
    motion, panels = arc.motion, min(max(1, math.ceil(arc.steps / fineness.steps)), MOST_PANELS)
    assert motion is not None
    # a toe in space begins to slide along a direction that turns the faster the slower it is
    tail = ENDS.tail if SLIP in arc.domain.contacts else fineness.tail
    while True:
        h = length / panels
        t = (arc.t + h * (np.arange(panels)[:, None] + gauss.nodes)).ravel()
        y = motion(t)
        left = roughness(y.T.reshape(panels, POINTS, -1))
        if left <= tail:
            return t, h, y
        if not math.isfinite(left):
            raise NotDifferentiable(f"the motion in {arc.domain.name} cannot be followed again")
        if panels == MOST_PANELS:
            raise NotDifferentiable(f"the motion in {arc.domain.name} is not smooth over {length:.3g} s")
        # coefficients of a panel shorter by a factor fall by its power of the number of points, at first of fewer
        wanted = panels * (left / tail) ** (1.0 / (POINTS - EARLY))
        panels = min(max(panels + 1, math.ceil(wanted)), MOST_PANELS)
