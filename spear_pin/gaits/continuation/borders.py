"""Borders of a branch: points where the order of events changes, or where the cycle no longer closes.

Beyond a border the return map is another map, or the same map made of other pieces. If both maps agree at the border,
the branch goes on there, perhaps with a kink, or it turns back to the side where it came from. If they do not agree,
the branch ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.problem import NoValue, Problem
from spear_pin.gaits.continuation.stepping import Point, along, correct_point, orient_tangent, predict_point, step_along
from spear_pin.hybrid.orders import Order

CLOSEST = 1e-8  # arc length up to which a border is approached
BEYOND = (1e-7, 1e-6, 1e-5, 1e-4)  # arc lengths at which the other side is looked for
BENT = 10.0  # step lengths: a branch with a kink may be this far from its old tangent
JUMPS = 100.0  # residual over arc length behind a border: above this the map jumps
BACK = -0.999  # cosine between tangents: below this the branch would return on itself
CONTINUOUS, TURNED, DISCONTINUOUS, LOST = "continuous", "turned", "discontinuous", "lost"


@dataclass(frozen=True)
class Border:
    """A border that a branch meets.

    Attributes:
        kind: `CONTINUOUS` (the branch goes on beyond it), `TURNED` (the branch goes on beyond it, and the parameter
            turns back), `DISCONTINUOUS` (the branch ends: no fixed point is near beyond it), `LOST` (the branch ends
            for an unknown reason: the map does not jump).
        inner: the last point before the border.
        outer: the first point behind the border, if there is one.
        after: the order of events behind the border; empty if the cycle does not close there.
        reason: why the cycle does not close there, in a word; empty if the cycle closes.
        jump: largest component of the residual just behind the border, where the branch ends.
    """

    kind: str
    inner: Point
    outer: Point | None
    after: Order
    reason: str = ""
    jump: float = 0.0


def approach_border(problem: Problem, base: Point, length: float) -> list[tuple[Point, float]]:
    """Finds points ever closer to a border, and the steps that led to them.

    Args:
        problem: the equations.
        base: the last point of the branch.
        length: length of a step from `base` that leads to no point with the same order of events.
    """
    steps: list[tuple[Point, float]] = []
    while length > CLOSEST:
        length *= 0.5
        try:
            point = step_along(problem, base, length)
        except NoValue:
            continue
        if point.local.like(base.local):
            base = point
            steps.append((point, length))
    return steps


def border(problem: Problem, inner: Point, came: Array) -> Border:
    """Finds what lies behind the last point before a border.

    Args:
        problem: the equations.
        inner: the last point before the border.
        came: tangent of the branch some way before the point, (N,), for use where differences do not reach the border.
    """
    outer = _straight_on(problem, inner) or _turned(problem, inner, came)
    if outer is not None:
        back = outer.slope * inner.slope < 0.0
        return Border(TURNED if back else CONTINUOUS, inner, outer, outer.local.order)
    for length in BEYOND:
        try:
            residual, order = problem.glance(predict_point(problem, inner, inner.tangent, length))
        except NoValue as nothing:
            return Border(DISCONTINUOUS, inner, None, nothing.order, nothing.reason)
        if order != inner.local.order:
            jump = float(np.abs(residual).max())
            return Border(DISCONTINUOUS if jump > JUMPS * length else LOST, inner, None, order, "", jump)
    return Border(LOST, inner, None, inner.local.order)


def _straight_on(problem: Problem, inner: Point) -> Point | None:
    """Finds the first point of the branch beyond the border, where the branch keeps its direction."""
    found = (_beyond(problem, inner, inner.tangent, length) for length in BEYOND)
    return next((outer for outer in found if outer is not None), None)


def _turned(problem: Problem, inner: Point, came: Array) -> Point | None:
    """Finds the first point of a branch that turns at the border, by the tangent beyond the border."""
    for length in BEYOND:
        try:
            there = problem.local(predict_point(problem, inner, inner.tangent, length))
            if there.like(inner.local):
                continue
            tangent = along(there, inner.tangent)
        except NoValue:
            continue
        for row in (tangent, -tangent):
            outer = _beyond(problem, inner, row, length)
            if outer is not None and outer.tangent @ came > BACK:
                return outer
    return None


def _beyond(problem: Problem, inner: Point, row: Array, length: float) -> Point | None:
    """Finds the solution beyond the border at a length along a direction; its tangent points away from the border."""
    try:
        start = predict_point(problem, inner, row, length)
        found = correct_point(problem, start, row, float(row @ inner.local.u) + length, BENT * length)
        return None if found.like(inner.local) else orient_tangent(found, found.u - inner.local.u)
    except NoValue:
        return None
