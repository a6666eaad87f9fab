"""The step of a quadratic model within a box, under linear constraints, up to the next kink."""

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
ROUNDING = 1e-12  # constraints are relaxed by this, so that every box has interior points


@dataclass(frozen=True)
class Local(Generic[T]):
    """A function and its constraints about a point.

    Attributes:
        x: the point, (n,).
        f: value of the function.
        c: constraints, (m,), which should be >= 0.
        slopes: returns the gradient of the function, (n,), and the constraints' derivatives, (m, n). It may take long,
            and is called where a step begins, or where a trial was no better.
        more: what else is known at the point.
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
        """Sum of the violations of the constraints."""
        return float(np.maximum(-self.c, 0.0).sum())


class Cut(NamedTuple, Generic[T]):
    """Limit row · s >= end of a step, by what another point across a kink says.

    Attributes:
        row: normal of the limit, (n,).
        end: least value of row · s.
        constraint: the other point's constraint that is missed beyond the limit; None: the other point's function is
            larger there.
        other: the other point.
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
        missed: sum of the violations of the linearised constraints; no step in the box has a smaller one.
        multipliers: multipliers of the constraints, (m,).
        at_bounds: multipliers of the box, lower and upper, (2, n).
        kinks: limits by kinks that hold the step, with multipliers.
    """

    s: Array
    missed: float
    multipliers: Array
    at_bounds: Array
    kinks: tuple[tuple[float, Cut[T]], ...]

    @property
    def on_kink(self) -> bool:
        """Whether a kink holds the step."""
        return any(price > 0.0 for price, _ in self.kinks)

    @property
    def prices(self) -> Array:
        """Multipliers of the constraints, (m,), including those of points across kinks."""
        found = self.multipliers.copy()
        for price, cut in self.kinks:
            if cut.constraint is not None:
                found[cut.constraint] += price
        return found


def step_within(local: Local[T], hessian: Array, low: Array, high: Array, across: Sequence[Local[T]]) -> Step[T]:
    """Finds the step of least model among those that violate the constraints least.

    A trial that was no better may be across a kink, where function and constraints are others. Steps end where these
    would be worse. A minimum on the kink is a minimum of both functions, in shares that add up to one. If the other
    function's share exceeds one, the kink is not a valley, and the step goes on.

    Args:
        local: the function about the point where the step begins.
        hessian: curvature of the model, (n, n), positive definite.
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
    """Lists limits of steps from a point, by what another point across a kink says.

    Steps end where the other point's function is larger, or where its constraints are missed. A statement of the other
    point that makes the first point itself worse than it is does not count, because then there is no kink.
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
    """Returns by how much rows · s >= right are missed, with the least total over steps in the box."""
    n, m = rows.shape[1], len(rows)
    cost = np.concatenate([np.zeros(n), np.ones(m)])
    box = [*zip(low, high, strict=True), *[(0.0, None)] * m]
    found = scipy.optimize.linprog(cost, -np.hstack([rows, np.eye(m)]), -right, bounds=box)
    if found.x is None:
        raise RuntimeError(found.message)
    return np.asarray(np.maximum(found.x[n:], 0.0), np.float64)


def _quadratic(hessian: Array, g: Array, rows: Array, right: Array) -> tuple[Array, Array]:
    """Minimises g·s + s·B s / 2 under rows s >= right; returns s and the multipliers.

    In coordinates in which B is one, the problem is a least distance. It is solved by non-negative least squares:
    Lawson and Hanson, Solving Least Squares Problems, chapter 23.
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
