"""Minimise under inequalities where there may be no value: sequential quadratic programming with trust regions.

A step is trusted as far as the model has been right. Where there is no value the region shrinks, so that iterates stay
where values exist; solvers that evaluate wherever their line search leads do not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]
T = TypeVar("T")
FIRST, LARGEST = 0.1, 0.5  # radii, of the box
GOOD, BAD = 0.75, 0.1  # shares of a predicted gain
PENALTY = 2.0  # of the largest multiplier, at least
STILL = 1e-3  # of the function, over the whole box: what a minimum leaves of the gradient
HIGHEST = 1e6  # of a multiplier
FAILURES = RuntimeError, ArithmeticError, np.linalg.LinAlgError  # of solvers
NEARBY = 1e-4  # of the box: what holds a point is that near
NEAR = 1e-12  # a row that is shorter is none
ROUNDING = 1e-12  # by which constraints are eased, so that a box without an inside has one
CONVERGED, STUCK, NO_VALUE, TOO_LONG = (
    "converged",
    "no step makes it better",
    "there is no value beyond",
    "iterations ran out",
)
UNSOLVED = "the quadratic model has no solution"


@dataclass(frozen=True)
class Local(Generic[T]):
    """A function and its constraints about a point.

    Attributes:
        x: the point, (n,).
        f: the function.
        c: constraints, to be >= 0, (m,).
        slopes: gives the gradient of the function, (n,), and the constraints' derivatives, (m, n). It may take long,
            and is asked only where a step goes on from.
        more: what else is known there.
    """

    x: Array
    f: float
    c: Array
    slopes: Callable[[], tuple[Array, Array]]
    more: T

    @cached_property
    def _slopes(self) -> tuple[Array, Array]:
        return self.slopes()

    @property
    def g(self) -> Array:
        """The gradient, (n,)."""
        return self._slopes[0]

    @property
    def A(self) -> Array:  # noqa: N802
        """Derivatives of the constraints, (m, n)."""
        return self._slopes[1]

    @property
    def violation(self) -> float:
        """By how much constraints are missed, summed."""
        return float(np.maximum(-self.c, 0.0).sum())


@dataclass(frozen=True)
class Minimum(Generic[T]):
    """Where a minimisation ended.

    Attributes:
        local: the best point.
        multipliers: of Lagrange, of the constraints, (m,), >= 0.
        at_bounds: of the lower and upper bounds, (2, n), >= 0.
        stationarity: what of the gradient they leave, its largest component.
        path: function and violation after each iteration.
        reason: why it ended.
    """

    local: Local[T]
    multipliers: Array
    at_bounds: Array
    stationarity: float
    path: tuple[tuple[float, float], ...]
    reason: str

    @property
    def converged(self) -> bool:
        """Whether a minimum was found: no constraint is missed, and no step makes it better."""
        return self.reason == CONVERGED


def minimised(
    value: Callable[[Array, Local[T]], Local[T] | None],
    start: Local[T],
    lower: Array,
    upper: Array,
    *,
    tolerance: float = 1e-6,
    iterations: int = 100,
    on_step: Callable[[int, Local[T]], object] = lambda n, local: None,
) -> Minimum[T]:
    """A local minimum.

    Args:
        value: of a point, given the best so far; None where there is none.
        start: where it begins.
        lower: bounds, (n,).
        upper: bounds, (n,); what varies should be of order one between them.
        tolerance: of the gain that is still predicted, of violations, and of the radius.
        iterations: at most.
        on_step: called after each.
    """
    best, radius, penalty, steep = start, FIRST, 1.0, False
    hessian = np.eye(len(start.x)) * max(float(np.abs(start.g).max()), 1e-3)
    path, reason, beyond = [(best.f, best.violation)], TOO_LONG, False
    for n in range(iterations):
        low, high = np.maximum(lower - best.x, -radius), np.minimum(upper - best.x, radius)
        try:
            ahead = _step(best, hessian, low, high)
        except FAILURES:
            reason = UNSOLVED
            break
        step, multipliers = ahead.s, ahead.multipliers
        penalty = max(0.5 * penalty, 1.0, PENALTY * float(multipliers.max(initial=0.0)))
        predicted = -(best.g @ step + 0.5 * step @ hessian @ step) + penalty * (best.violation - ahead.missed)
        size = float(np.abs(step).max())
        reach = radius if size > 0.9 * radius else 1.0  # a step that the region cuts short says little
        if predicted <= tolerance * max(abs(best.f), 1.0) * reach:
            left = _held(best, hessian, lower, upper)[2]
            if left <= STILL * max(abs(best.f), 1.0) or steep:
                reason = CONVERGED if best.violation <= tolerance else STUCK
                break
            hessian, steep = np.eye(len(best.x)) * left, True  # the first curvature was of steeper directions
            continue
        there = value(best.x + step, best)
        beyond = there is None
        gained = -np.inf if there is None else best.f - there.f + penalty * (best.violation - there.violation)
        if there is not None and gained > 0.0:
            try:
                change = _of_lagrange(there, multipliers) - _of_lagrange(best, multipliers)
            except FAILURES:  # a value without derivatives is none to go on from
                there, beyond, gained = None, True, -np.inf
        if gained < BAD * predicted:
            radius = 0.3 * size
        elif gained > GOOD * predicted and size > 0.9 * radius:
            radius = min(2.0 * radius, LARGEST)
        if there is not None and gained > 0.0:
            hessian = _updated(hessian, step, change)
            best, steep = there, False
        path.append((best.f, best.violation))
        on_step(n + 1, best)
        if radius < tolerance:
            reason = NO_VALUE if beyond else STUCK
            break
    return Minimum(best, *_held(best, hessian, lower, upper), tuple(path), reason)


def _of_lagrange(local: Local[T], multipliers: Array) -> Array:
    return np.asarray(local.g - local.A.T @ multipliers)


def _held(local: Local[T], hessian: Array, lower: Array, upper: Array) -> tuple[Array, Array, float]:
    """Multipliers of what holds a point, of constraints and of bounds, and what they leave of the gradient."""
    low, high = np.maximum(lower - local.x, -NEARBY), np.minimum(upper - local.x, NEARBY)
    try:
        end = _step(local, hessian, low, high)
    except FAILURES:
        return np.zeros(len(local.c)), np.zeros((2, len(local.x))), np.inf
    found = np.where(local.c >= -NEARBY, end.multipliers, 0.0)  # what is missed has no price
    at_bounds = np.where(np.array([low > -NEARBY, high < NEARBY]), end.at_bounds, 0.0)
    left = local.g - local.A.T @ found - at_bounds[0] + at_bounds[1]
    return found, at_bounds, float(np.abs(left).max())


@dataclass(frozen=True)
class _Step:
    """A step of the model within a box.

    Attributes:
        s: the step, (n,).
        missed: by how much the linearised constraints are missed, summed: no step in the box misses them by less.
        multipliers: of the constraints, (m,).
        at_bounds: of the box, lower and upper, (2, n).
    """

    s: Array
    missed: float
    multipliers: Array
    at_bounds: Array


def _step(local: Local[T], hessian: Array, low: Array, high: Array) -> _Step:
    """The step of least model among those that miss the constraints by as little as can be."""
    n, m = len(local.x), len(local.c)
    slack = np.zeros(m)
    if m:
        cost = np.concatenate([np.zeros(n), np.ones(m)])
        box = [*zip(low, high, strict=True), *[(0.0, None)] * m]
        found = scipy.optimize.linprog(cost, -np.hstack([local.A, np.eye(m)]), local.c, bounds=box)
        if found.x is None:
            raise RuntimeError(found.message)
        slack = np.maximum(found.x[n:], 0.0)
    rows = np.concatenate([local.A, np.eye(n), -np.eye(n)])
    right = np.concatenate([-local.c - slack, low, -high]) - ROUNDING
    s, multipliers = _quadratic(hessian, local.g, rows, right)
    return _Step(np.clip(s, low, high), float(slack.sum()), multipliers[:m], multipliers[m:].reshape(2, n))


def _quadratic(hessian: Array, g: Array, rows: Array, right: Array) -> tuple[Array, Array]:
    """Minimise g·s + s·B s / 2 under rows s >= right, and the multipliers.

    As the least distance that it is in coordinates in which B is one, by non-negative least squares: Lawson and Hanson,
    Solving Least Squares Problems, chapter 23.
    """
    half = np.linalg.cholesky(hessian)
    to = scipy.linalg.solve_triangular(half, rows.T, lower=True).T
    far = scipy.linalg.solve_triangular(half, g, lower=True)
    height = right + to @ far
    scale = np.maximum(np.linalg.norm(to, axis=1), NEAR)
    above = np.column_stack([to, height]) / scale[:, None]
    y, _ = scipy.optimize.nnls(above.T, np.eye(1, len(g) + 1, len(g))[0], maxiter=100 * len(rows))
    left = 1.0 - above[:, -1] @ y
    if not left > 0.0:
        raise RuntimeError("no step meets the constraints")
    multipliers = np.asarray(np.minimum(y / left / scale, HIGHEST))
    u = to.T @ multipliers - far
    return scipy.linalg.solve_triangular(half.T, u, lower=False), multipliers


def _updated(hessian: Array, step: Array, change: Array) -> Array:
    """Powell's damped update, which stays positive definite."""
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
