"""Newton's method and differences for many functions at once, with an iterate for each lane.

The lanes' next evaluations, trial steps of some and difference columns of others, go to the evaluator in one call. This
is fast if the evaluator treats many lanes side by side. For one lane it is the usual method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from itertools import count
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.per_lane import apply_matrices

T = TypeVar("T")
Lanes = NDArray[np.int64]
Words = NDArray[np.object_]
Evaluate = Callable[[Lanes, Array], tuple[Array, Words]]
"""Values of functions, (m, r), at unknowns, (m, k), each of the lane that is named for it, and why there is none, ""
where there is one. A lane is named more than once only for differences, which are of no use when one of them has no
value: the evaluator may leave out the others then, with the same word."""
Slopes = Callable[[Lanes, Array], Array]
"""Jacobians of the same functions, (m, r, k), at unknowns, (m, k), NaN where they are not known."""
OnIterates = Callable[[Lanes, NDArray[np.int64], Array], object]

STEP = 1e-5  # of differences; their errors are of order STEP, of order STEP² for central ones, and rtol / STEP
QUICK = 0.2  # if a step leaves less than this share of the residual, the Jacobian is updated instead of recomputed
SHORTEST = 1.0 / 32.0  # least damping of a step
ITERATIONS, PATIENCE = 15, 7  # most iterations, and number of iterations that have to halve the residual
NOISE = 10.0  # tolerances: below this, a residual that no step reduces is due to the evaluator's noise

CONVERGED, NO_START, NO_NEIGHBOUR = "converged", "no_start", "no_neighbour"
NO_PROGRESS, TOO_LONG = "no_progress", "too_long"


NO_WORDS: Words = np.array([""], dtype=object)


def ignore_iterates(lanes: Lanes, iteration: NDArray[np.int64], norm: Array) -> None:
    """Ignores the iterates."""


@dataclass(frozen=True)
class Roots:
    """Where Newton's method ended.

    Attributes:
        x: the unknowns, (n, k).
        norm: largest component of the residual, (n,); infinite where there is no value at the start.
        iteration: number of steps taken, (n,).
        end: `CONVERGED`, `NO_START` (there is no value at the start), `NO_NEIGHBOUR` (there is no value near an
            iterate), `NO_PROGRESS` (no step reduces the residual) or `TOO_LONG` (it falls too slowly), (n,).
        reason: the evaluator's reason where there is no value, (n,).
    """

    x: Array
    norm: Array
    iteration: NDArray[np.int64]
    end: Words
    reason: Words


@dataclass(frozen=True)
class _Iterates:
    """The lanes' iterates, each with its next evaluation.

    Attributes:
        x: scaled unknowns, (n, k).
        residual: residual at x, (n, r).
        norm: largest component of the residual, (n,); infinite before the first value.
        norms: norms of all iterates so far, (n, iterations + 1).
        iteration: number of steps taken, (n,); -1 before the first value.
        jacobian: Jacobian, (n, r, k); zero before the first.
        fresh: whether the Jacobian was differentiated at x, (n,).
        damping: damping of the next trial step, (n,).
        differs: whether the next evaluation is of differences instead, (n,).
        end, reason: how and why each lane ended, (n,), see `Roots`; "" while it continues.
    """

    x: Array
    residual: Array
    norm: Array
    norms: Array
    iteration: NDArray[np.int64]
    jacobian: Array
    fresh: NDArray[np.bool_]
    damping: Array
    differs: NDArray[np.bool_]
    end: Words
    reason: Words

    def take(self, lanes: Lanes | NDArray[np.bool_]) -> _Iterates:
        return _Iterates(*(getattr(self, field.name)[lanes] for field in fields(self)))

    def put(self, lanes: Lanes, others: _Iterates) -> None:
        for field in fields(self):
            getattr(self, field.name)[lanes] = getattr(others, field.name)


def newton(
    evaluate: Evaluate,
    start: Array,
    scale: Array,
    tolerance: float,
    *,
    iterations: int = ITERATIONS,
    calls: int | None = None,
    quick: float = QUICK,
    slopes: Slopes | None = None,
    always: bool = True,
    equations: int | None = None,
    longest: float = np.inf,
    shortest: float = SHORTEST,
    on_iterates: OnIterates = ignore_iterates,
) -> Roots:
    """Finds roots by damped Newton's method, with exact Jacobians where they are known.

    Elsewhere Jacobians are forward differences, updated (Broyden) while steps reduce the residual a lot. With more
    unknowns than equations each step is the shortest that solves the linear equations (Gauss-Newton).

    Args:
        evaluate: returns the residuals.
        start: initial unknowns, (n, k).
        scale: scale of each unknown, (n, k).
        tolerance: tolerance on the residual's largest component.
        iterations: most steps.
        calls: most calls of the evaluator; None for no bound.
        quick: share of the residual that a step may leave for the Jacobian to be updated, not recomputed.
        slopes: returns the Jacobians, if they are known.
        always: whether it is asked at each iterate, or only where differences would be taken otherwise.
        equations: number of residuals; None: as many as unknowns.
        longest: largest component of a step, in scales.
        shortest: least damping of a step; with 1 steps are whole.
        on_iterates: called with the lanes that have taken a step (or a first value), their numbers of steps, and the
            residuals.
    """
    k = start.shape[1]
    r = k if equations is None else equations
    lanes = _begun(start / scale, r, iterations)
    for _ in range(calls) if calls is not None else count():
        going = lanes.end == ""
        due = going & (~lanes.fresh & (lanes.iteration >= 0) if always else lanes.differs)
        if slopes is not None and len(asking := np.flatnonzero(due)):
            exact = slopes(asking, lanes.x[asking] * scale[asking]) * scale[asking, None]
            known = np.isfinite(exact).all(axis=(1, 2))
            lanes.put(asking[known], _with_jacobian(lanes.take(asking[known]), exact[known]))
        trying, differing = np.flatnonzero(going & ~lanes.differs), np.flatnonzero(going & lanes.differs)
        if not len(trying) and not len(differing):
            break
        trials, differences = lanes.take(trying), lanes.take(differing)
        steps, shares = _steps(trials, longest)
        asked = np.concatenate([trying, np.repeat(differing, k)])
        points = np.concatenate([trials.x + steps, (differences.x[:, None] + STEP * np.eye(k)).reshape(-1, k)])
        values, why = evaluate(asked, points * scale[asked])

        m = len(trying)
        better = _better(trials, steps, shares, values[:m], tolerance)
        took, refused = trying[better], trying[~better]
        lanes.put(took, _accepted(trials.take(better), steps[better], values[:m][better], tolerance, quick))
        lanes.put(refused, _refused(trials.take(~better), why[:m][~better], tolerance, shortest))
        lanes.put(differing, _differentiated(differences, values[m:].reshape(-1, k, r), why[m:].reshape(-1, k)))
        if len(took):
            on_iterates(took, lanes.iteration[took], lanes.norm[took])
    end = np.where(lanes.end == "", TOO_LONG, lanes.end).astype(object)
    return Roots(lanes.x * scale, lanes.norm, lanes.iteration, end, lanes.reason)


def root(
    about: Callable[[T], tuple[Array, Array]],
    ahead: Callable[[T, Array], T],
    start: T,
    tolerance: float,
    *,
    size: int,
    calls: int,
) -> tuple[T, float]:
    """Finds a root among points of any kind, each with coordinates of its own about it, by whole steps of `newton`.

    Args:
        about: returns the residual at a point, (r,), and its Jacobian by the coordinates about that point, (r, k).
        ahead: returns the point that coordinates, (k,), about another point lead to.
        start: the point at which it starts.
        tolerance: tolerance on the residual's largest component.
        size: bound of r and k, which may differ between points.
        calls: most points.

    Returns:
        the last point, and the largest component of the residual there.
    """
    here = there = start
    origin, jacobian = np.zeros(size), np.empty((0, 0))

    def evaluate(lanes: Lanes, x: Array) -> tuple[Array, Words]:
        nonlocal there, jacobian
        step = (x[0] - origin)[: jacobian.shape[1]]
        there = ahead(here, step) if step.any() else here
        residual, jacobian = about(there)
        known = np.isfinite(jacobian).all()
        return np.pad(residual if known else residual * np.nan, (0, size - len(residual)))[None], NO_WORDS

    def slopes(lanes: Lanes, x: Array) -> Array:
        nonlocal here, origin
        here, origin = there, x[0]
        return np.pad(jacobian, [(0, size - n) for n in jacobian.shape])[None]

    begin = np.zeros((1, size))
    found = newton(evaluate, begin, begin + 1.0, tolerance, calls=calls, slopes=slopes, shortest=1.0)
    return there if (found.x[0] != origin).any() else here, float(found.norm[0])


def _begun(x: Array, r: int, iterations: int) -> _Iterates:
    """Returns the lanes before the first value, with a step of zero length as next evaluation."""
    n, k = x.shape
    return _Iterates(
        x=x,
        residual=np.zeros((n, r)),
        norm=np.full(n, np.inf),
        norms=np.full((n, iterations + 1), np.nan),
        iteration=np.full(n, -1),
        jacobian=np.zeros((n, r, k)),
        fresh=np.zeros(n, dtype=bool),
        damping=np.ones(n),
        differs=np.zeros(n, dtype=bool),
        end=np.full(n, "", dtype=object),
        reason=np.full(n, "", dtype=object),
    )


def _better(lanes: _Iterates, steps: Array, shares: Array, values: Array, tolerance: float) -> NDArray[np.bool_]:
    """Tells whether steps lead nearer to a root, (n,): by the residual, or by the step that would follow.

    The residual alone says little where the map stretches much in one direction. What the Jacobian makes of the new
    residual is then compared with the undamped step (Deuflhard's natural monotonicity test), unless that is rounding.
    """
    share = 1.0 - 0.1 * shares
    smaller = np.abs(values).max(axis=1) < share * lanes.norm  # the first value is
    following = np.full(len(values), np.inf)
    test = lanes.fresh & ~smaller & np.isfinite(values).all(axis=1) & (lanes.norm > NOISE * tolerance)
    following[test] = np.linalg.norm(apply_matrices(np.linalg.pinv(lanes.jacobian[test]), values[test]), axis=1)
    nearer: NDArray[np.bool_] = following < share * np.linalg.norm(steps, axis=1) / shares
    return np.asarray(smaller | nearer)


def _steps(lanes: _Iterates, longest: float) -> tuple[Array, Array]:
    """Returns the damped steps, (n, k), and what shares they are of the whole ones, (n,)."""
    whole = -apply_matrices(np.linalg.pinv(lanes.jacobian), lanes.residual)
    shares = lanes.damping * np.minimum(1.0, longest / np.maximum(np.abs(whole).max(axis=1), 1e-300))
    return shares[:, None] * whole, shares


def _accepted(lanes: _Iterates, steps: Array, values: Array, tolerance: float, quick: float) -> _Iterates:
    """Accepts steps that reduce the residual; the remaining residual decides whether the Jacobian is kept."""
    size, iteration, last = np.abs(values).max(axis=1), lanes.iteration + 1, lanes.norms.shape[1] - 1
    norms, jacobian = lanes.norms.copy(), lanes.jacobian.copy()
    norms[np.arange(len(size)), iteration] = size
    earlier = norms[np.arange(len(size)), np.maximum(iteration - PATIENCE, 0)]
    too_long = (iteration == last) | ((iteration >= PATIENCE) & (size > 0.5 * earlier))
    good = (size / lanes.norm < quick) & (iteration > 0)
    jacobian[good] = broyden(jacobian[good], steps[good], (values - lanes.residual)[good])
    return replace(
        lanes,
        x=lanes.x + steps,
        residual=values,
        norm=size,
        norms=norms,
        iteration=iteration,
        jacobian=jacobian,
        fresh=np.zeros(len(size), dtype=bool),
        damping=np.ones(len(size)),
        differs=~good,
        end=np.where(size <= tolerance, CONVERGED, np.where(too_long, TOO_LONG, "")).astype(object),
    )


def _refused(lanes: _Iterates, why: Words, tolerance: float, shortest: float) -> _Iterates:
    """Refuses steps that do not reduce the residual: recomputes an old Jacobian, or else shortens the step."""
    begins = lanes.iteration < 0
    damping = np.where(lanes.fresh, 0.5 * lanes.damping, 1.0)
    left = np.where(lanes.norm <= NOISE * tolerance, CONVERGED, NO_PROGRESS)
    end = np.where(begins, NO_START, np.where(damping < shortest, left, "")).astype(object)
    reason = np.where(begins, why, "").astype(object)
    return replace(lanes, damping=damping, differs=~lanes.fresh, end=end, reason=reason)


def _differentiated(lanes: _Iterates, values: Array, why: Words) -> _Iterates:
    """Takes the Jacobians from forward differences with these values, (n, k, r), one row for each unknown."""
    whole = np.asarray(np.isfinite(values).all(axis=(1, 2), keepdims=True))
    return replace(
        _with_jacobian(lanes, np.where(whole, np.swapaxes(values - lanes.residual[:, None], 1, 2) / STEP, 0.0)),
        end=np.where(whole[:, 0, 0], "", NO_NEIGHBOUR).astype(object),
        reason=first_words(why),
    )


def _with_jacobian(lanes: _Iterates, jacobian: Array) -> _Iterates:
    """Returns the lanes with Jacobians at their present iterates."""
    n = len(jacobian)
    fresh, damping, differs = np.ones(n, dtype=bool), np.ones(n), np.zeros(n, dtype=bool)
    return replace(lanes, jacobian=jacobian, fresh=fresh, damping=damping, differs=differs)


def broyden(jacobian: Array, step: Array, change: Array) -> Array:
    """Updates Jacobians, (n, r, k), by Broyden's method after steps, (n, k), and changes of the residual, (n, r)."""
    missed = change - apply_matrices(jacobian, step)
    return np.asarray(jacobian + missed[:, :, None] * (step / (step * step).sum(axis=1, keepdims=True))[:, None, :])


def first_words(why: Words) -> Words:
    """Returns the first word in each row, (n, m), that is not empty; "" if all are."""
    return np.array([next((word for word in row if word), "") for row in why], dtype=object)


def stencil(k: int, step: float = STEP) -> Array:
    """Returns the offsets of k unknowns for central differences, (2 k, k)."""
    return step * np.concatenate([np.eye(k), -np.eye(k)])


def differentiate_stencil(values: Array, step: float = STEP) -> Array:
    """Returns the Jacobians, (n, r, k), from the values on a stencil, (n, 2 k, r)."""
    k = values.shape[1] // 2
    return np.swapaxes(values[:, :k] - values[:, k:], 1, 2) / (2.0 * step)


def jacobian(evaluate: Evaluate, x: Array, step: float = STEP) -> tuple[Array, str]:
    """Returns one lane's Jacobian by central differences, (r, k), and why there is none, "" if there is one."""
    offsets = stencil(len(x), step)
    values, why = evaluate(np.zeros(len(offsets), dtype=np.int64), x + offsets)
    return differentiate_stencil(values[None], step)[0], first_words(why[None])[0]
