"""Minimisation under inequalities where values may not exist: sequential quadratic programming with trust regions.

A step is trusted as far as the model has been right. Where there is no value, the region shrinks, so that iterates stay
where values exist; a solver with a line search would evaluate anywhere. Where the function or a constraint has a kink,
trials that were no better tell what is across the kink.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.codesign.step import FAILURES, Cut, Local, Step, step_within

T = TypeVar("T")
Box = tuple[Array, Array]
FIRST, LARGEST = 0.1, 0.5  # radii, of the box
GOOD, BAD = 0.75, 0.1  # shares of a predicted gain
PENALTY = 2.0  # of the largest multiplier, at least
STILL = 1e-3  # a minimum has at most this gradient, relative to the function, over the box
NEARBY = 1e-4  # relative to the box: distance at which a bound or kink holds a point
BENT = 1e4  # relative curvature over the box; only a kink has a larger one
REMEMBERED = 15.0  # radii: farther points across kinks do not count
CONVERGED, STUCK, NO_VALUE = "converged", "no step makes it better", "there is no value beyond"
TOO_LONG, UNSOLVED = "iterations ran out", "the quadratic model has no solution"


@dataclass(frozen=True)
class Minimum(Generic[T]):
    """The end of a minimisation.

    Attributes:
        local: the best point.
        multipliers: Lagrange multipliers of the constraints, (m,), >= 0.
        at_bounds: multipliers of the lower and upper bounds, (2, n), >= 0.
        stationarity: largest component of the gradient that they do not balance.
        kinks: limits by kinks that hold the point, with multipliers; those of constraints are counted above, too.
        path: function and violation after each iteration.
        reason: why the minimisation ended.
    """

    local: Local[T]
    multipliers: Array
    at_bounds: Array
    stationarity: float
    kinks: tuple[tuple[float, Cut[T]], ...]
    path: tuple[tuple[float, float], ...] = ()
    reason: str = ""

    @property
    def converged(self) -> bool:
        """Whether a minimum was found: no constraint is missed, and no step improves it."""
        return self.reason == CONVERGED

    @property
    def balanced(self) -> bool:
        """Whether constraints, bounds and kinks hold the point, so that their multipliers are prices of a minimum."""
        small = self.stationarity <= STILL * max(abs(self.local.f), 1.0)
        return small or (self.converged and math.isfinite(self.stationarity))


def find_minimum(
    value: Callable[[Array, Local[T]], Local[T] | None],
    start: Local[T],
    box: Box,
    *,
    tolerance: float = 1e-6,
    iterations: int = 100,
    on_step: Callable[[int, Local[T]], object] = lambda n, local: None,
) -> Minimum[T]:
    """Finds a local minimum.

    Args:
        value: returns the function about a point, given the best point so far; None where there is no value.
        start: the starting point, (n,).
        box: lower and upper bounds, (n,) each; what varies should be of order one between them.
        tolerance: tolerance of the predicted gain, of violations, and of the radius.
        iterations: largest number of iterations.
        on_step: called after each step.
    """
    best, radius, penalty, steep = start, FIRST, 1.0, False
    hessian, plain = _plain(start), True
    path, reason, beyond = [(best.f, best.violation)], TOO_LONG, False
    across: list[Local[T]] = []
    for n in range(iterations):
        try:
            ahead = _ahead(best, hessian, box, across, radius)
        except FAILURES:
            if plain:
                reason = UNSOLVED
                break
            hessian, plain = _plain(best), True
            continue
        plain = False
        step, multipliers = ahead.s, ahead.multipliers
        penalty = max(0.5 * penalty, 1.0, PENALTY * float(ahead.prices.max(initial=0.0)))
        predicted = -(best.g @ step + 0.5 * step @ hessian @ step) + penalty * (best.violation - ahead.missed)
        size = float(np.abs(step).max())
        reach = radius if size > 0.9 * radius else 1.0  # a step that the region shortens gives little information
        if predicted <= tolerance * max(abs(best.f), 1.0) * reach:
            if ahead.on_kink and radius > NEARBY:
                radius *= 0.3  # points across a kink far away give little information here
                continue
            left = _end(best, hessian, box, across).stationarity
            if left <= STILL * max(abs(best.f), 1.0) or steep:
                reason = CONVERGED if best.violation <= tolerance else STUCK
                break
            hessian, steep = np.eye(len(best.x)) * left, True  # the first curvature came from steeper directions
            continue
        there = value(best.x + step, best)
        beyond, gained = there is None, _gain(best, there, penalty)
        if there is not None and gained < BAD * predicted and multipliers.any():
            bent = _bent(best, there, hessian, box, across, radius)
            nearer = None if bent is None else value(best.x + bent, best)
            if bent is not None and _gain(best, nearer, penalty) > gained:
                there, step, gained = nearer, bent, _gain(best, nearer, penalty)
        if there is not None and gained > 0.0:
            try:
                change = _of_lagrange(there, multipliers) - _of_lagrange(best, multipliers)
            except FAILURES:  # the search cannot continue from a value without derivatives
                there, beyond, gained = None, True, -np.inf
        if gained < BAD * predicted:
            radius = 0.3 * size
        elif gained > GOOD * predicted and size > 0.9 * radius:
            radius = min(2.0 * radius, LARGEST)
        if there is not None and gained > 0.0:
            if np.linalg.norm(change) < BENT * max(abs(best.f), 1.0) * np.linalg.norm(step):  # else it went over a kink
                hessian = _updated(hessian, step, change)
            best, steep = there, False
        elif there is not None and _known(there):
            across = [*across[-2 * len(best.x) :], there]
        path.append((best.f, best.violation))
        on_step(n + 1, best)
        if radius < tolerance:
            reason = NO_VALUE if beyond else STUCK
            break
    return replace(_end(best, hessian, box, across), path=tuple(path), reason=reason)


def _gain(best: Local[T], there: Local[T] | None, penalty: float) -> float:
    """Returns by how much a point is better, with violations at a price; -inf where there is no value."""
    if there is None:
        return -np.inf
    return best.f - there.f + penalty * (best.violation - there.violation)


def _bent(
    best: Local[T], there: Local[T], hessian: Array, box: Box, across: Sequence[Local[T]], radius: float
) -> Array | None:
    """Returns the step corrected by what a trial says of the constraints' curvature; None where it says nothing.

    Without it short steps follow a curved border: Nocedal and Wright, Numerical Optimization, section 18.11.
    """
    step = there.x - best.x
    curved = replace(best, c=there.c - best.A @ step, slopes=lambda: (best.g, best.A))
    try:
        bent = _ahead(curved, hessian, box, across, radius).s
    except FAILURES:
        return None
    return None if np.allclose(bent, step, rtol=1e-3, atol=0.0) else bent


def _plain(local: Local[T]) -> Array:
    """Returns a first curvature."""
    return np.eye(len(local.x)) * max(float(np.abs(local.g).max()), 1e-3)


def _of_lagrange(local: Local[T], multipliers: Array) -> Array:
    return np.asarray(local.g - local.A.T @ multipliers)


def _known(local: Local[T]) -> bool:
    """Tells whether a point has derivatives."""
    try:
        return bool(np.isfinite(local.g).all() and np.isfinite(local.A).all())
    except FAILURES:
        return False


def _ahead(local: Local[T], hessian: Array, box: Box, across: Sequence[Local[T]], radius: float) -> Step[T]:
    """Returns the step of the model within a radius and the bounds, by what points near enough are across kinks."""
    low, high = np.maximum(box[0] - local.x, -radius), np.minimum(box[1] - local.x, radius)
    near = [each for each in across if np.abs(each.x - local.x).max() <= REMEMBERED * radius]
    return step_within(local, hessian, low, high, near)


def _end(local: Local[T], hessian: Array, box: Box, across: Sequence[Local[T]]) -> Minimum[T]:
    """Returns a point with what holds it: constraints, bounds and kinks, and the gradient that they do not balance."""
    try:
        end = _ahead(local, hessian, box, across, NEARBY)
    except FAILURES:
        return Minimum(local, np.zeros(len(local.c)), np.zeros((2, len(local.x))), np.inf, ())
    found = np.where(local.c >= -NEARBY, end.multipliers, 0.0)  # what is missed has no price
    prices = np.where(local.c >= -NEARBY, end.prices, 0.0)
    at_bounds = np.where([box[0] - local.x > -NEARBY, box[1] - local.x < NEARBY], end.at_bounds, 0.0)
    left = local.g - local.A.T @ found - at_bounds[0] + at_bounds[1]
    for price, cut in end.kinks:
        left = left - price * cut.row
    return Minimum(local, prices, at_bounds, float(np.abs(left).max()), end.kinks)


def _updated(hessian: Array, step: Array, change: Array) -> Array:
    """Returns Powell's damped update, which stays positive definite."""
    along = hessian @ step
    curvature = float(step @ along)
    if not curvature > 0.0:
        return hessian
    share = float(step @ change)
    if share < 0.2 * curvature:
        theta = 0.8 * curvature / (curvature - share)
        change = theta * change + (1.0 - theta) * along
        share = float(step @ change)
    found: Array = hessian - np.outer(along, along) / curvature + np.outer(change, change) / share
    return found
