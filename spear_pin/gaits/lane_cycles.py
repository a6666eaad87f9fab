"""Cycles of many lanes by the batch engine, and the multipliers of their fixed points; `many` is built on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.lane_measures import MEASURES, OBSERVED
from spear_pin.gaits.tangent_cycles import tangent_cycles
from spear_pin.hybrid import periodic
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import is_unrolled, simulate_many
from spear_pin.hybrid.charts import Charts
from spear_pin.hybrid.newton import CONVERGED, Words, differentiate_stencil, stencil
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import eigenvalues
from spear_pin.hybrid.result import State
from spear_pin.hybrid.shooting import NOT_FINITE, Cycles, Slopes
from spear_pin.hybrid.tangent.resets import attempt
from spear_pin.hybrid.tangent.section import exact_jacobian

Lanes = NDArray[np.int64]
NOT_VALID, NO_MULTIPLIERS = "not_valid", "no_multipliers"


@dataclass(frozen=True)
class LaneCycles:
    """Cycles of lanes with different parameters: a `Cycle` of `hybrid.shooting`.

    Attributes:
        system: the system.
        fixed: parameters with a value for each lane, (n,) each.
        vary: names of the parameters that are solved for.
        measures: measures of the targets, by the names of `MEASURES`.
        rtol: relative tolerance of the integration.
    """

    system: HybridSystem
    fixed: Mapping[str, Array]
    vary: tuple[str, ...]
    measures: Sequence[str]
    rtol: float

    def __call__(self, lanes: Lanes, q: Array, v: Array, values: Array) -> Cycles:
        """Runs one cycle of some lanes from states with values of `vary`; returns why some fail."""
        n, solved = len(lanes), dict(zip(self.vary, values.T, strict=True))
        given = {**self.take(lanes).fixed, **solved}
        reason = np.full(n, "", dtype=object)
        finite = np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1)
        reason[~finite] = NOT_FINITE
        reason[finite & ~valid(self.system, solved, n)] = NOT_VALID
        can = np.flatnonzero(reason == "")
        own = {name: column[can] for name, column in given.items()}
        observe = any(name in OBSERVED for name in self.measures)
        batch = simulate_many(self.system, q[can], v[can], 1, self.rtol, parameters=own, observe=observe)
        reason[can] = np.where(batch.reason == "complete", "", batch.reason)
        measured = np.column_stack(
            [MEASURES[name](self.system, q[can], batch) for name in self.measures] or [q[can, :0]]
        )
        durations = {phase: spread_lanes(seconds, can, n) for phase, seconds in batch.durations.items()}
        q, v, measured = (spread_lanes(part, can, n) for part in (batch.q, batch.v, measured))
        orders = dict(zip(can.tolist(), batch.orders, strict=True))
        reference = spread_lanes(batch.repeated, can, n) == 1.0
        return Cycles(q, v, measured, durations, reason, reference, [orders.get(i, ()) for i in range(n)])

    def take(self, lanes: Lanes) -> LaneCycles:
        """Returns the cycles of some lanes."""
        return replace(self, fixed={name: column[lanes] for name, column in self.fixed.items()})

    @property
    def slopes(self) -> Slopes | None:
        """Exact derivatives, where differences take longer: unrolled cycles are so fast that they do not."""
        return None if is_unrolled(self.system) else self._slopes

    def _slopes(self, lanes: Lanes, q: Array, v: Array, values: Array) -> tuple[Array, Array, Array]:
        """Returns derivatives of the cycles; see `hybrid.shooting.Slopes`."""
        one, rows, (n, k) = np.zeros(1, dtype=np.int64), q.shape[1] + v.shape[1], values.shape
        after, ends = np.full((n, rows), np.nan), np.full((n, rows, rows + k), np.nan)
        measured = np.full((n, len(self.measures), rows + k), np.nan)
        for i, lane in enumerate(lanes.tolist()):
            cycles = tangent_cycles(self.of_lane(lane, values[i]), self.vary, self.measures)
            if cycles is not None:
                (after[i],), (ends[i],), (measured[i],) = cycles.slopes(
                    one, *(part[i : i + 1] for part in (q, v, values))
                )
        return after, ends, measured

    def of_lane(self, lane: int, values: Array) -> HybridSystem:
        """Returns the system of one lane with values of `vary`, (k,)."""
        own = {name: float(column[lane]) for name, column in self.fixed.items()}
        return with_parameters(self.system, {**own, **dict(zip(self.vary, values.tolist(), strict=True))})

    def jacobian(self, lane: int, state: State, values: Array) -> Array | float:
        """Returns the exact Jacobian of one lane's return map; NaN if it is not sooner, or there is none."""
        found = attempt(lambda: exact_jacobian(self.of_lane(lane, values), state)) if self.slopes else None
        return np.nan if found is None else found

    def alone(self, lane: int, state: State, values: Array) -> NDArray[np.complex128] | None:
        """Returns multipliers of one lane's fixed point by its cycle alone; None if there are none."""
        try:
            return periodic.multipliers(self.of_lane(lane, values), state, min(self.rtol, 1e-10))
        except NoGait:
            return None


def spread_lanes(part: NDArray[np.generic], lanes: Lanes, n: int) -> Array:
    """Spreads numbers of some lanes over all n lanes, with NaN in the others."""
    whole = np.full((n, *part.shape[1:]), np.nan)
    whole[lanes] = part
    return whole


@dataclass(frozen=True)
class Spectra:
    """Multipliers of fixed points, in the order of `hybrid.periodic.multipliers`, (n, d); see `GaitTable`."""

    multipliers: NDArray[np.complex128]
    residual: Array
    durations: Mapping[str, Array]
    reason: Words


def multipliers(cycle: LaneCycles, charts: Charts, values: Array) -> Spectra:
    """Returns eigenvalues of the return maps' Jacobians, and residuals of the whole states.

    Jacobians are exact where that is sooner, and else central differences.

    Args:
        cycle: runs the cycles.
        charts: charts around the fixed points.
        values: values of the varied parameters, (n, k).
    """
    n, d = len(charts), charts.dimension
    jacobians = np.empty((n, d, d))
    for i in range(n):
        jacobians[i] = cycle.jacobian(i, (charts.q[i], charts.v[i]), values[i])
    rest = np.flatnonzero(np.isnan(jacobians).any(axis=(1, 2)))
    offsets = np.concatenate([np.zeros((n, d)), np.tile(stencil(d), (len(rest), 1))])
    lanes = np.concatenate([np.arange(n), np.repeat(rest, 2 * d)])  # the fixed points themselves in the same call
    own = charts.take(lanes)
    after = cycle(lanes, *own.states(offsets), values[lanes])
    closes, centre = after.reason == "", slice(n)
    beside = np.where(closes[:, None], own.coordinates(after.q, after.v), np.nan)[n:]
    jacobians[rest] = differentiate_stencil(beside.reshape(len(rest), 2 * d, d))
    closes = closes[centre]
    whole = closes & np.isfinite(jacobians).all(axis=(1, 2))
    found = np.full((n, d), np.nan + 0j)
    found[whole] = eigenvalues(jacobians[whole])
    # between lanes that one engine ran and those that the other did, differences show the engines' errors
    for i in np.intersect1d(rest[whole[rest]], lanes[after.reference]):
        spectrum = cycle.alone(int(i), (charts.q[i], charts.v[i]), values[i])
        whole[i], found[i] = spectrum is not None, np.nan if spectrum is None else spectrum
    moved = charts.section.displacement((own.q[centre], own.v[centre]), (after.q[centre], after.v[centre]))
    residual = np.where(closes, np.abs(moved).max(axis=1), np.inf)
    durations = {phase: seconds[centre] for phase, seconds in after.durations.items()}
    why = np.where(whole, CONVERGED, np.where(closes, NO_MULTIPLIERS, after.reason[centre])).astype(object)
    return Spectra(found, residual, durations, why)


def valid(system: HybridSystem, values: Mapping[str, Array], n: int) -> NDArray[np.bool_]:
    """Tells in which of n lanes every parameter is within its range."""
    good = np.ones(n, dtype=bool)
    for name, column in values.items():
        parameter(system, name)  # it says what names there are
        good &= np.isfinite(column)
        if not _accepts(system, name, column[good]):
            good &= np.array([_accepts(system, name, column[i : i + 1]) for i in range(n)])
    return good


def _accepts(system: HybridSystem, name: str, column: Array) -> bool:
    """Tells whether the least and the largest of some values are valid."""
    try:
        for value in {column.min(), column.max()} if len(column) else ():
            with_parameters(system, {name: float(value)})
    except SpearError:
        return False
    return True
