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
MOST_PARTS = 4.0  # of a panel, in one pass
EARLY = 4  # number of points that do not count yet where panels are long


def points(arc: Arc, fineness: Fineness = INSIDE) -> tuple[Array, Array, Array]:
    """Returns the times of the points, in s, (k,), the lengths of the panels, in s, and the states, (2 nv, k).

    Where the motion is rough panels are shorter: where a toe stops, or begins to slide.

    Args:
        arc: the arc.
        fineness: how fine panels are.

    Raises:
        NotDifferentiable: the motion is not smooth, or cannot be followed again.
    """
    gauss, length = rule(), max(arc.end - arc.t, 0.0)
    if length <= SHORTEST:
        t = arc.t + length * gauss.nodes
        return t, np.array([length]), np.tile(arc.y[:, None], (1, len(t)))
    motion, panels = arc.motion, min(max(1, math.ceil(arc.steps / fineness.steps)), MOST_PANELS)
    assert motion is not None
    # a toe in space begins to slide along a direction that turns the faster the slower it is
    tail = ENDS.tail if SLIP in arc.domain.contacts else fineness.tail
    lengths = np.full(panels, length / panels)
    while True:
        begins = arc.t + np.cumsum(lengths) - lengths
        t = (begins[:, None] + np.outer(lengths, gauss.nodes)).ravel()
        y = motion(t)
        left = roughness(y.T.reshape(len(lengths), POINTS, -1)) / tail
        if not np.isfinite(left).all():
            raise NotDifferentiable(f"the motion in {arc.domain.name} cannot be followed again")
        if left.max() <= 1.0:
            return t, lengths, y
        if len(lengths) == MOST_PANELS:
            raise NotDifferentiable(f"the motion in {arc.domain.name} is not smooth over {length:.3g} s")
        # coefficients of a panel shorter by a factor fall by its power of the number of points, at first of fewer
        parts = np.clip(left, 1.0, MOST_PARTS ** (POINTS - EARLY)) ** (1.0 / (POINTS - EARLY))
        parts, ends = np.append(0.0, np.cumsum(parts)), np.append(0.0, np.cumsum(lengths))
        panels = min(max(len(lengths) + 1, math.ceil(parts[-1])), MOST_PANELS)
        lengths = np.diff(np.interp(np.linspace(0.0, parts[-1], panels + 1), parts, ends))
