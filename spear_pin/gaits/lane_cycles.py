"""Cycles of many lanes by the batch engine, and the multipliers of their fixed points; `many` is built on it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.lane_measures import MEASURES, OBSERVED
from spear_pin.hybrid import periodic
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.charts import Charts
from spear_pin.hybrid.newton import CONVERGED, Words, differentiated, stencil
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import eigenvalues
from spear_pin.hybrid.result import State
from spear_pin.hybrid.shooting import NOT_FINITE, Cycles

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
        given = {name: column[lanes] for name, column in self.fixed.items()} | solved
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
        durations = {phase: spread(seconds, can, n) for phase, seconds in batch.durations.items()}
        q, v, measured = (spread(part, can, n) for part in (batch.q, batch.v, measured))
        orders = dict(zip(can.tolist(), batch.orders, strict=True))
        reference = spread(batch.repeated, can, n) == 1.0
        return Cycles(q, v, measured, durations, reason, reference, [orders.get(i, ()) for i in range(n)])

    def alone(self, lane: int, state: State, values: Array) -> NDArray[np.complex128] | None:
        """Returns multipliers of one lane's fixed point by its cycle alone; None if there are none."""
        own = {name: float(column[lane]) for name, column in self.fixed.items()}
        system = with_parameters(self.system, {**own, **dict(zip(self.vary, values.tolist(), strict=True))})
        try:
            return periodic.multipliers(system, state, min(self.rtol, 1e-10))
        except NoGait:
            return None


def spread(part: NDArray[np.generic], lanes: Lanes, n: int) -> Array:
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
    """Returns eigenvalues of the return maps' Jacobians by central differences, and residuals of the whole states.

    Args:
        cycle: runs the cycles.
        charts: charts around the fixed points.
        values: values of the varied parameters, (n, k).
    """
    n, d = len(charts), charts.dimension
    offsets = np.concatenate([np.zeros((1, d)), stencil(d)])  # the fixed point itself in the same call
    count = len(offsets)
    lanes = np.repeat(np.arange(n), count)
    own = charts.take(lanes)
    q, v = own.states(np.tile(offsets, (n, 1)))
    after = cycle(lanes, q, v, values[lanes])
    jacobians = differentiated(own.coordinates(after.q, after.v).reshape(n, count, d)[:, 1:])
    closes = (after.reason == "").reshape(n, count)
    found = np.full((n, d), np.nan + 0j)
    whole = closes.all(axis=1) & np.isfinite(jacobians).all(axis=(1, 2))
    found[whole] = eigenvalues(jacobians[whole])
    # between lanes that one engine ran and those that the other did, differences show the engines' errors
    for i in np.flatnonzero(whole & after.reference.reshape(n, count).any(axis=1)):
        spectrum = cycle.alone(int(i), (charts.q[i], charts.v[i]), values[i])
        whole[i], found[i] = spectrum is not None, np.nan if spectrum is None else spectrum
    centre = slice(None, None, count)
    moved = charts.section.displacement((q[centre], v[centre]), (after.q[centre], after.v[centre]))
    residual = np.where(closes[:, 0], np.abs(moved).max(axis=1), np.inf)
    durations = {phase: seconds[centre] for phase, seconds in after.durations.items()}
    why = np.where(whole, CONVERGED, np.where(closes[:, 0], NO_MULTIPLIERS, after.reason[centre])).astype(object)
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
