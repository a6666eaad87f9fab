"""Following a branch one way from one of its points to where it ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from spear_pin.gaits.continuation import borders
from spear_pin.gaits.continuation.borders import Border, approach_border, border
from spear_pin.gaits.continuation.problem import NoValue, Problem
from spear_pin.gaits.continuation.signs import Special, locate_zero, specials
from spear_pin.gaits.continuation.stepping import TOLERANCE, Point, find_at_parameter, step_along

FINE = 1e-3  # shortest arc length of a step; if it fails, there is a border
ENTERING = 1e-4  # of the first step behind a border
FIRST = 0.2  # of the longest step
STRAIGHT, CURVED = 0.05, 0.3  # rad between tangents: below the first steps grow, above the second shrink
GROWTH = 2.0
RANGE, BORDER, LOST, CLOSED, LIMIT = "range", "border", "lost", "closed", "points"
Met = Border | Special


@dataclass
class Way:
    """The points and borders that were met on the way.

    Attributes:
        points: points of the branch, in order, the start first.
        met: borders and special points, each with its index in `points`.
        end: why the way ends: `RANGE` (the parameter's range ends), `BORDER` (at the last border), `LOST` (no point
            beyond was found, and no border), `CLOSED` (the branch is back at its start), `LIMIT` (the largest number of
            points is reached).
    """

    points: list[Point]
    met: list[tuple[int, Met]] = field(default_factory=list)
    end: str = ""


def follow(
    problem: Problem,
    start: Point,
    bounds: tuple[float, float],
    longest: float,
    most: int,
    on_point: Callable[[Point], object] = lambda point: None,
) -> Way:
    """Follows a branch along its tangent.

    Args:
        problem: the equations.
        start: a point of the branch; its tangent points in the direction to follow.
        bounds: bounds of the scaled parameter.
        longest: longest step along the arc.
        most: largest number of points.
        on_point: called with each point.
    """
    way, length = Way([start]), FIRST * longest
    while not way.end:
        base = way.points[-1]
        if len(way.points) >= most:
            way.end = LIMIT
            break
        point = _tried(problem, base, length)
        if point is None:
            if length > FINE:
                length *= 0.5
                continue
            _meet(problem, way, base, length)
            length = ENTERING
        elif _angle(base, point) > CURVED and length > FINE:
            length *= 0.5
            continue
        else:
            _add(problem, way, point, length, bounds, start)
            length = min(longest, length * GROWTH) if _angle(base, point) < STRAIGHT else length
        on_point(way.points[-1])
    return way


def _tried(problem: Problem, base: Point, length: float) -> Point | None:
    """Returns the next point, or None if there is none with the same order of events."""
    try:
        point = step_along(problem, base, length)
    except NoValue:
        return None
    return point if point.local.like(base.local) else None


def _angle(one: Point, other: Point) -> float:
    return float(np.arccos(np.clip(one.tangent @ other.tangent, -1.0, 1.0)))


def _add(problem: Problem, way: Way, point: Point, length: float, bounds: tuple[float, float], start: Point) -> None:
    """Adds a point, the special points on the step to it, and the end if the point lies beyond one."""
    base, parameter = way.points[-1], point.local.u[-1]
    if not bounds[0] <= parameter <= bounds[1]:
        bound, way.end = bounds[0] if parameter < bounds[0] else bounds[1], RANGE
        if abs(base.local.u[-1] - bound) <= TOLERANCE:
            return
        length, point = locate_zero(problem, base, point, length, lambda each: each.local.u[-1] - bound)
        try:
            point = find_at_parameter(problem, point, bound)
        except NoValue:
            pass  # it is as near to it as the arc tells
    elif _closes(base, point, start, length):
        way.end, point = CLOSED, start
    _mark(problem, way, base, point, length)
    way.points.append(point)


def _mark(problem: Problem, way: Way, base: Point, point: Point, length: float) -> None:
    for special in specials(problem, base, point, length):
        way.points.append(special.point)
        way.met.append((len(way.points) - 1, special))


def _closes(base: Point, point: Point, start: Point, length: float) -> bool:
    """Tells whether the start lies on the step and the branch goes on there as it began."""
    before, after = (float(start.tangent @ (each.local.u - start.local.u)) for each in (base, point))
    near = np.linalg.norm(point.local.u - start.local.u) < length
    return bool(near and base is not start and before < 0.0 <= after and start.tangent @ point.tangent > 0.0)


def _meet(problem: Problem, way: Way, base: Point, length: float) -> None:
    """Goes up to a border, and beyond it if the branch goes on."""
    came = base.tangent
    for point, taken in approach_border(problem, base, length):
        _mark(problem, way, base, point, taken)
        base = point
    if base is not way.points[-1]:
        way.points.append(base)
    met = border(problem, base, came)
    way.met.append((len(way.points) - 1, met))
    if met.outer is None:
        way.end = LOST if met.kind == borders.LOST else BORDER
    else:
        way.points.append(met.outer)
