"""The step of a quadratic model within a box, under linear constraints, as far as the next kink."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, NamedTuple, TypeVar

import numpy as np
import scipy

from spear_pin.arrays import Array

T = TypeVar("T")
HIGHEST = 1e6  # of a multiplier
FAILURES = RuntimeError, ArithmeticError, np.linalg.LinAlgError  # of solvers
NEAR = 1e-12  # a row that is shorter is none
ROUNDING = 1e-12  # by which constraints are eased, so that a box without an inside has one


@dataclass(frozen=True)
class Local(Generic[T]):
    """A function and its constraints about a point.

    Attributes:
        x: the point, (n,).
        f: the function.
        c: constraints, to be >= 0, (m,).
        slopes: gives the gradient of the function, (n,), and the constraints' derivatives, (m, n). It may take long,
            and is asked where a step goes on from, or was no better.
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


class Cut(NamedTuple, Generic[T]):
    """Where a step ends, at row · s = end from above, for what another point says that is across a kink.

    Attributes:
        row: (n,).
        end: what row · s is at least.
        constraint: which of the other point's constraints is missed beyond; None: its function is the larger.
        other: the point.
    """

    row: Array
    end: float
    constraint: int | None
    other: Local[T]


@dataclass(frozen=True)
class Step(Generic[T]):
    """A step of the model within a box.

    Attributes:
        s: the step, (n,).
        missed: by how much the linearised constraints are missed, summed: no step in the box misses them and those
            across kinks by less.
        multipliers: of the constraints, (m,).
        at_bounds: of the box, lower and upper, (2, n).
        kinks: where it ends by kinks, with multipliers.
    """

    s: Array
    missed: float
    multipliers: Array
    at_bounds: Array
    kinks: tuple[tuple[float, Cut[T]], ...]

    @property
    def on_kink(self) -> bool:
        """Whether a kink holds it."""
        return any(price > 0.0 for price, _ in self.kinks)

    @property
    def prices(self) -> Array:
        """Multipliers of the constraints, (m,), those of what is across kinks among them."""
        found = self.multipliers.copy()
        for price, cut in self.kinks:
            if cut.constraint is not None:
                found[cut.constraint] += price
        return found


def step_within(local: Local[T], hessian: Array, low: Array, high: Array, across: Sequence[Local[T]]) -> Step[T]:
    """The step of least model among those that miss the constraints by as little as can be.

    A trial that was no better may be across a kink, where the function and the constraints are others: steps end where
    those would be worse. A minimum on the kink is one of both functions, in shares that add up to one; if the other's
    is more, the kink is no valley, and the step goes on.

    Args:
        local: where it begins.
        hessian: of the model, (n, n), positive definite.
        low: least step, (n,).
        high: greatest step, (n,).
        across: points that may be across kinks.

    Raises:
        RuntimeError, LinAlgError: the model has no solution.
    """
    kinks = [cut for other in across for cut in cuts(local, other)]
    while True:
        try:
            step = _solved(local, hessian, low, high, kinks)
        except FAILURES:
            if not kinks:
                raise
            kinks = kinks[1:]
            continue
        shares = [price if cut.constraint is None else 0.0 for price, cut in step.kinks]
        if sum(shares) <= 1.0:
            return step
        kinks = [each for each, share in zip(kinks, shares, strict=True) if share < max(shares)]


def cuts(local: Local[T], other: Local[T]) -> Iterator[Cut[T]]:
    """Where steps from a point end for what another one says that is across a kink.

    Where its function is the larger, and where its constraints are missed; but for what it says of the point itself
    that is worse than it is there, for then that is no kink.
    """
    back = local.x - other.x
    ahead = other.f - local.f + float(other.g @ back)
    if ahead <= 0.0:
        yield Cut(local.g - other.g, ahead, None, other)
    left = other.c + other.A @ back
    for i in np.flatnonzero((other.c < 0.0) & (left >= local.c)):
        yield Cut(other.A[i], -float(left[i]), int(i), other)


def _solved(local: Local[T], hessian: Array, low: Array, high: Array, kinks: Sequence[Cut[T]]) -> Step[T]:
    n, m = len(local.x), len(local.c)
    sides, ends = np.array([cut.row for cut in kinks]).reshape(-1, n), np.array([cut.end for cut in kinks])
    rows, right = np.concatenate([local.A, sides]), np.concatenate([-local.c, ends])
    eased = np.array([True] * m + [cut.constraint is not None for cut in kinks])
    slack = np.zeros(len(rows))
    if eased.any():
        slack[eased] = _slack(rows[eased], right[eased], low, high)
    box, bounds = np.concatenate([np.eye(n), -np.eye(n)]), np.concatenate([low, -high])
    whole = np.concatenate([right - slack, bounds]) - ROUNDING
    s, found = _quadratic(hessian, local.g, np.concatenate([rows, box]), whole)
    prices, at_bounds = found[m : len(rows)].tolist(), found[len(rows) :].reshape(2, n)
    held = tuple(zip(prices, kinks, strict=True))
    return Step(np.clip(s, low, high), float(slack[:m].sum()), found[:m], at_bounds, held)


def _slack(rows: Array, right: Array, low: Array, high: Array) -> Array:
    """By how much rows · s >= right are missed, by as little in all as steps in the box allow."""
    n, m = rows.shape[1], len(rows)
    cost = np.concatenate([np.zeros(n), np.ones(m)])
    box = [*zip(low, high, strict=True), *[(0.0, None)] * m]
    found = scipy.optimize.linprog(cost, -np.hstack([rows, np.eye(m)]), -right, bounds=box)
    if found.x is None:
        raise RuntimeError(found.message)
    return np.asarray(np.maximum(found.x[n:], 0.0), np.float64)


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
