"""Newton's method on the return maps of many lanes, and their multipliers: what `many` is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.search import SHORTEST_CYCLE, TOLERANCE
from spear_pin.hybrid import periodic
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import Batch, simulate_many
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.per_lane import applied
from spear_pin.hybrid.periodic import STEP
from spear_pin.hybrid.record import State
from spear_pin.hybrid.section import Charts
from spear_pin.hybrid.translation import without

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
CALLS = 30  # of the engine at most, in which a lane has to converge
QUICK = 0.2  # of the residual left by a step: the Jacobian is good enough to go on with
SHORTEST = 1.0 / 32.0  # of a step


@dataclass(frozen=True)
class Problem:
    """The equations of some lanes.

    Attributes:
        system: the system.
        fixed: parameters that differ from lane to lane, (n,) each.
        vary: names of those that are solved for.
        measures: what the targets are of.
        wanted: the targets, (n, k).
        rtol: relative tolerance of the integration.
        observe: whether a measure is of what is only observed.
    """

    system: HybridSystem
    fixed: Mapping[str, Array]
    vary: tuple[str, ...]
    measures: Sequence[Callable[[HybridSystem, Array, Batch], Array]]
    wanted: Array
    rtol: float
    observe: bool = False

    def cycle(self, lanes: Indices, q: Array, v: Array, values: Array) -> tuple[Batch, NDArray[np.object_]]:
        """One cycle of some lanes from states with values of what varies, and why those fail that do."""
        given = {name: column[lanes] for name, column in self.fixed.items()}
        given |= dict(zip(self.vary, values.T, strict=True))
        reason = np.full(len(lanes), "", dtype=object)
        finite = np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)
        reason[~finite] = "not_finite"
        reason[finite & ~valid(self.system, dict(zip(self.vary, values.T, strict=True)), len(lanes))] = "not_valid"
        can = np.flatnonzero(reason == "")
        own = {name: column[can] for name, column in given.items()}
        some = simulate_many(self.system, q[can], v[can], 1, self.rtol, parameters=own, observe=self.observe)
        batch = _spread(some, can, len(lanes))
        reason[can] = np.where(some.reason == "complete", "", some.reason)
        reason[(reason == "") & (sum(batch.durations.values()) < SHORTEST_CYCLE)] = "short_cycle"
        return batch, reason

    def reference(self, lane: int, state: State, values: Array) -> NDArray[np.complex128] | None:
        """Multipliers of a lane's fixed point by the reference engine alone; None if there are none."""
        own = {name: float(column[lane]) for name, column in self.fixed.items()}
        system = with_parameters(self.system, {**own, **dict(zip(self.vary, values.tolist(), strict=True))})
        try:
            return periodic.multipliers(system, state, min(self.rtol, 1e-10))
        except NoGait:
            return None

    def evaluate(self, lanes: Indices, charts: Charts, z: Array) -> tuple[Array, NDArray[np.object_]]:
        """The residuals at unknowns z = (ξ, values), (n, d + k); NaN where a cycle does not close, and why."""
        d = charts.dimension
        q, v = charts.states(z[:, :d])
        batch, reason = self.cycle(lanes, q, v, z[:, d:])
        moved = charts.coordinates(batch.q, batch.v) - charts.coordinates(q, v)
        columns = [measure(self.system, q, batch) for measure in self.measures]
        missed = np.column_stack(columns) - self.wanted[lanes] if columns else np.empty((len(z), 0))
        values = np.concatenate([moved, missed], axis=1)
        reason[(reason == "") & ~np.isfinite(values).all(axis=1)] = "not_finite"
        values[reason != ""] = np.nan
        return values, reason


def _spread(batch: Batch, lanes: Indices, n: int) -> Batch:
    """Measurements of a batch of some lanes, as of all n lanes, NaN in the others."""

    def wide(part: Array) -> Array:
        whole = np.full((n, *part.shape[1:]), np.nan)
        whole[lanes] = part
        return whole

    durations = {phase: wide(seconds) for phase, seconds in batch.durations.items()}
    observed = {name: wide(states) for name, states in batch.observed.items()}
    repeated = np.zeros(n, bool)
    repeated[lanes] = batch.repeated
    return replace(batch, q=wide(batch.q), v=wide(batch.v), durations=durations, observed=observed, repeated=repeated)


@dataclass(frozen=True)
class Roots:
    """Where Newton's method ended.

    Attributes:
        xi: coordinates on the charts, (n, d).
        values: of what varies, (n, k).
        norm: largest component of the residual, (n,); infinite where there is none.
        reason: "converged", or why not.
    """

    xi: Array
    values: Array
    norm: Array
    reason: NDArray[np.object_]


def newton(problem: Problem, charts: Charts, start: Array) -> Roots:
    """Damped Newton's method from the charts' origins, the Jacobian updated (Broyden) while a step gains a lot.

    Args:
        problem: the equations.
        charts: a chart of each lane.
        start: values of what varies, (n, k).
    """
    n, d = len(start), charts.dimension
    scale = np.concatenate([np.ones((n, d)), np.maximum(1.0, np.abs(start))], axis=1)
    x = np.concatenate([np.zeros((n, d)), start], axis=1) / scale
    m = x.shape[1]
    value, norm = np.full((n, m), np.nan), np.full(n, np.inf)
    jacobian, inverse_of, damping = np.zeros((n, m, m)), np.zeros((n, m)), np.ones(n)
    direction, fresh = inverse_of, np.zeros(n, dtype=bool)
    trying, reason = np.ones(n, dtype=bool), np.full(n, "", dtype=object)
    for _ in range(CALLS):
        active = reason == ""
        trial, differing = np.flatnonzero(active & trying), np.flatnonzero(active & ~trying)
        if not active.any():
            break
        lanes = np.concatenate([trial, np.repeat(differing, m)])
        offsets = STEP * np.tile(np.eye(m), (len(differing), 1))
        z = np.concatenate([x[trial] + damping[trial, None] * direction[trial], x[np.repeat(differing, m)] + offsets])
        values, why = problem.evaluate(lanes, charts.take(lanes), z * scale[lanes])

        columns = values[len(trial) :].reshape(len(differing), m, m)
        broken = ~np.isfinite(columns).all(axis=(1, 2))
        whys = why[len(trial) :].reshape(len(differing), m)
        for lane, row in zip(differing[broken], whys[broken], strict=True):
            reason[lane] = next(word for word in row if word)
        good = differing[~broken]
        jacobian[good] = np.swapaxes(columns[~broken] - value[good][:, None], 1, 2) / STEP
        fresh[good], damping[good], trying[good] = True, 1.0, True

        new, size = values[: len(trial)], np.abs(values[: len(trial)]).max(axis=1)
        first = ~np.isfinite(norm[trial])
        better = np.where(first, np.isfinite(size), size < (1.0 - 0.1 * damping[trial]) * norm[trial])
        lost = trial[first & ~better]
        reason[lost] = why[: len(trial)][first & ~better]
        took, refused = trial[better], trial[~better & ~first]
        step, gained = damping[took, None] * direction[took], size[better] < QUICK * norm[took]
        change = new[better] - value[took]
        quick = took[gained & ~first[better]]
        jacobian[quick] = _updated(jacobian[quick], *(part[gained & ~first[better]] for part in (step, change)))
        x[took], value[took], norm[took] = x[took] + step, new[better], size[better]
        fresh[took], damping[took] = False, 1.0
        trying[took] = gained & ~first[better]
        reason[took[norm[took] <= TOLERANCE]] = "converged"
        stale = ~fresh[refused]
        trying[refused[stale]], damping[refused[stale]] = False, 1.0
        damping[refused[~stale]] *= 0.5
        ended = refused[damping[refused] < SHORTEST]
        # as close as the integration's noise allows
        reason[ended] = np.where(norm[ended] <= 10.0 * TOLERANCE, "converged", "no_convergence")
        turned = np.concatenate([good, quick])
        direction[turned] = -applied(np.linalg.pinv(jacobian[turned]), value[turned])
    reason[reason == ""] = "no_convergence"
    solution = x * scale
    return Roots(solution[:, :d], solution[:, d:], norm, reason)


def _updated(jacobian: Array, step: Array, change: Array) -> Array:
    """Broyden's update of Jacobians, (n, m, m), after steps with changes of the residual, (n, m) each."""
    missed = change - applied(jacobian, step)
    return np.asarray(jacobian + missed[:, :, None] * (step / (step * step).sum(axis=1, keepdims=True))[:, None, :])


@dataclass(frozen=True)
class Spectra:
    """Multipliers of fixed points, in the order of `hybrid.periodic.multipliers`, (n, d); see `GaitTable`."""

    multipliers: NDArray[np.complex128]
    residual: Array
    durations: Mapping[str, Array]
    reason: NDArray[np.object_]


def multipliers(problem: Problem, charts: Charts, values: Array) -> Spectra:
    """Eigenvalues of the return maps' Jacobians by central differences, and the residuals of the whole states.

    Args:
        problem: the equations.
        charts: charts around the fixed points.
        values: of what varies, (n, k).
    """
    n, d = len(values), charts.dimension
    offsets = np.concatenate([np.zeros((1, d)), STEP * np.eye(d), -STEP * np.eye(d)])
    count = len(offsets)
    lanes = np.repeat(np.arange(n), count)
    own = charts.take(lanes)
    q, v = own.states(np.tile(offsets, (n, 1)))
    batch, reason = problem.cycle(lanes, q, v, values[lanes])
    mapped = own.coordinates(batch.q, batch.v).reshape(n, count, d)
    jacobians = np.swapaxes(mapped[:, 1 : d + 1] - mapped[:, d + 1 :], 1, 2) / (2.0 * STEP)
    closes = (reason == "").reshape(n, count)
    found = np.full((n, d), np.nan + 0j)
    whole = closes.all(axis=1) & np.isfinite(jacobians).all(axis=(1, 2))
    eigenvalues = np.linalg.eigvals(jacobians[whole]).astype(np.complex128)
    # by modulus; of a pair, the one above the real axis first, however rounding falls
    order = np.lexsort((-eigenvalues.imag, -np.round(np.abs(eigenvalues), 9)), axis=-1)
    found[whole] = np.take_along_axis(eigenvalues, order, axis=1)
    # between lanes that one engine ran and those that the other did, differences show the engines' errors
    for i in np.flatnonzero(whole & batch.repeated.reshape(n, count).any(axis=1)):
        spectrum = problem.reference(int(i), (charts.q[i], charts.v[i]), values[i])
        whole[i], found[i] = spectrum is not None, np.nan if spectrum is None else spectrum
    centre = slice(None, None, count)
    shifted = without(charts.section.translations, (batch.q - q)[centre])
    moved = np.concatenate([shifted, (batch.v - v)[centre]], axis=1)
    residual = np.where(closes[:, 0], np.abs(moved).max(axis=1), np.inf)
    durations = {phase: seconds[centre] for phase, seconds in batch.durations.items()}
    why = np.where(whole, "converged", np.where(closes[:, 0], "no_multipliers", reason[centre])).astype(object)
    return Spectra(found, residual, durations, why)


def valid(system: HybridSystem, values: Mapping[str, Array], n: int) -> NDArray[np.bool_]:
    """In which of n lanes every parameter is within its range."""
    good = np.ones(n, dtype=bool)
    for name, column in values.items():
        parameter(system, name)  # it says what names there are
        good &= np.isfinite(column)
        if not _accepts(system, name, column[good]):
            good &= np.array([_accepts(system, name, column[i : i + 1]) for i in range(n)])
    return good


def _accepts(system: HybridSystem, name: str, column: Array) -> bool:
    """Whether the least and the largest of some values are valid."""
    try:
        for value in {column.min(), column.max()} if len(column) else ():
            with_parameters(system, {name: float(value)})
    except SpearError:
        return False
    return True
