"""Points of a branch with their tangents, and the step to the next point: prediction along the tangent, correction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.problem import Local, NoValue, Problem
from spear_pin.hybrid.newton import root

TOLERANCE = 1e-10  # of the equations
ITERATIONS = 8  # of Newton's method
FARTHEST = 0.5  # share of the step: a larger correction leads to another branch
NOISE = 20.0  # tolerances: a residual that no longer falls is as small as rounding allows
FAR, NO_CONVERGENCE, SINGULAR = "far", "no_convergence", "singular"


@dataclass(frozen=True)
class Point:
    """A solution.

    Attributes:
        local: the equations about it.
        tangent: unit tangent of the branch, in the direction in which it is followed, (N,).
    """

    local: Local
    tangent: Array

    @property
    def slope(self) -> float:
        """The parameter's component of the tangent, which changes sign at a fold."""
        return float(self.tangent[-1])


def along(local: Local, before: Array) -> Array:
    """Returns the unit tangent at a solution, (N,), on the side of another direction.

    Raises:
        NoValue: there is no unique tangent.
    """
    _, sizes, rows = np.linalg.svd(local.jacobian)
    if not np.isfinite(sizes).all():
        raise NoValue(SINGULAR, local.order)
    tangent = local.directions @ rows[-1]
    return np.asarray(tangent / np.linalg.norm(tangent) * (1.0 if tangent @ before >= 0.0 else -1.0))


def orient_tangent(local: Local, before: Array) -> Point:
    """Returns a solution with its tangent on the side of another direction."""
    return Point(local, along(local, before))


def step_along(problem: Problem, base: Point, length: float, reach: float = FARTHEST) -> Point:
    """Finds the point of the branch at an arc length from another point; a negative length goes backward.

    Args:
        problem: the equations.
        base: where the step begins.
        length: length of the step along the tangent.
        reach: how far the correction may lead, in lengths of the step.

    Raises:
        NoValue: there is no such point; the reason says why.
    """
    row = base.tangent
    start = predict_point(problem, base, row, length)
    found = correct_point(problem, start, row, float(row @ base.local.u) + length, reach * abs(length))
    return orient_tangent(found, row)


def predict_point(problem: Problem, base: Point, direction: Array, length: float) -> Array:
    """Returns the point that a direction leads to from another point."""
    return problem.moved(base.local, length * base.local.coordinates(direction))


def find_at_parameter(problem: Problem, base: Point, parameter: float) -> Point:
    """Finds the point of the branch near another point at a value of the (scaled) parameter.

    Raises:
        NoValue: there is no such point.
    """
    row = np.zeros_like(base.tangent)
    row[-1] = 1.0
    length = (parameter - base.local.u[-1]) / base.slope
    start = predict_point(problem, base, base.tangent, length)
    found = correct_point(problem, start, row, parameter, FARTHEST * abs(length) + TOLERANCE)
    return orient_tangent(found, base.tangent)


def correct_point(problem: Problem, start: Array, row: Array, value: float, reach: float) -> Local:
    """Finds the solution near a point by Newton's method, on the plane where row · u has a given value.

    Args:
        problem: the equations.
        start: the point at which Newton's method starts, (N,).
        row: normal of the plane, (N,).
        value: value of row · u on the plane.
        reach: largest distance of the solution from the point.

    Raises:
        NoValue: there is no such solution; the reason says why.
    """

    def about(local: Local) -> tuple[Array, Array]:
        off = np.append(local.residual, row @ local.u - value)
        return off, np.vstack([local.jacobian, row @ local.directions])

    def ahead(local: Local, step: Array) -> Local:
        u = problem.moved(local, step)
        if not np.linalg.norm(u - start) <= max(reach, 10.0 * TOLERANCE):
            raise NoValue(FAR, local.order)
        return problem.local(u)

    size = len(start) + 1
    found, off = root(about, ahead, problem.local(start), TOLERANCE, size=size, calls=ITERATIONS)
    if not off <= NOISE * TOLERANCE:
        raise NoValue(NO_CONVERGENCE, found.order)
    return found
