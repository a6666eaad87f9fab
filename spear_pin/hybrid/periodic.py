"""Periodic orbits by the reference engine: the return map on the section, its residual, Floquet multipliers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import may_vary
from spear_pin.hybrid.newton import STEP, Lanes, jacobian
from spear_pin.hybrid.orders import Order, order_of
from spear_pin.hybrid.result import EVALUATIONS, Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import chart as chart
from spear_pin.hybrid.section import section
from spear_pin.hybrid.shooting import NOT_FINITE, Cycle, Cycles, Shooting
from spear_pin.hybrid.tangent.resets import attempt
from spear_pin.hybrid.tangent.section import exact_jacobian


def return_map(system: HybridSystem, state: State, rtol: float = 1e-10) -> Run:
    """Runs one cycle from a state on the section, P of (4.11); the result has a reason if it does not return."""
    return run(system, state, 1, Options(rtol=rtol, max_evaluations=EVALUATIONS))


def displacement(system: HybridSystem, before: State, after: State) -> Array:
    """Returns P(x) - x over (q, v), without what symmetries change; see `Section.displacement`."""
    (q, v), (q_after, v_after) = before, after
    moved: Array = section(system).displacement((q[None], v[None]), (q_after[None], v_after[None]))[0]
    return moved


def residual(system: HybridSystem, state: State, rtol: float = 1e-10) -> float:
    """Returns ‖P(x) - x‖∞ of (4.12), in m, rad, m/s, rad/s; infinite if the cycle does not close."""
    result = return_map(system, state, rtol)
    return float(np.abs(displacement(system, state, result.state)).max()) if result.cycles else np.inf


def one_by_one(
    system: HybridSystem, cycle: Callable[[State, Array], Run], measures: Sequence[Callable[[Run, Array], Any]] = ()
) -> Cycle:
    """Returns a function that runs the cycles of lanes one after the other; a lane ends with one that does not close.

    Args:
        system: the system, with any parameters.
        cycle: runs one cycle from a state with values of the varied parameters, or raises a `SpearError`.
        measures: return numbers of a cycle that closes, given its run and the values of the varied parameters.
    """

    def cycles(lanes: Lanes, q: Array, v: Array, values: Array) -> Cycles:
        n = len(lanes)
        ends, measured = (np.full_like(q, np.nan), np.full_like(v, np.nan)), np.full((n, len(measures)), np.nan)
        durations = {phase: np.zeros(n) for phase in system.phases}
        failed, orders, reason = dict[int, str](), list[Order]([()] * n), np.full(n, "", dtype=object)
        for i, lane in enumerate(lanes.tolist()):
            if lane not in failed and not (np.isfinite(q[i]).all() and np.isfinite(v[i]).all()):
                failed[lane] = NOT_FINITE
            if lane not in failed:
                try:
                    result = cycle((q[i], v[i]), values[i])
                    orders[i] = order_of(system, result)
                    if result.cycles:
                        ends[0][i], ends[1][i] = result.state
                        measured[i] = [float(measure(result, values[i])) for measure in measures]
                        for phase, seconds in result.durations.items():
                            durations[phase][i] = seconds
                    else:
                        failed[lane] = result.reason
                except SpearError as error:  # a parameter out of range, an event that did not happen
                    failed[lane] = str(error)
            reason[i] = failed.get(lane, "")
        return Cycles(*ends, measured, durations, reason, np.ones(n, dtype=bool), orders)

    return cycles


def differentiate_return_map(system: HybridSystem, state: State, rtol: float = 1e-10, step: float = STEP) -> Array:
    """Finds the return map's Jacobian at a periodic orbit, in the section's chart, by central differences, (n, n).

    Raises:
        NoGait: a perturbed cycle does not close.
    """
    local = chart(system, state)
    cycle = one_by_one(system, lambda begun, _: return_map(system, begun, rtol))
    found, why = jacobian(Shooting(local.lane, cycle).mapped, np.zeros(local.dimension), step)
    if why:
        raise NoGait("a perturbed cycle does not close", residual(system, state, rtol))
    return found


def multipliers(system: HybridSystem, state: State, rtol: float = 1e-10) -> NDArray[np.complex128]:
    """Finds the Floquet multipliers of a periodic orbit, by decreasing modulus.

    They come from exact derivatives, and for cycles that have none from differences of the return map.

    Raises:
        NoGait: a perturbed cycle does not close.
    """
    exact = attempt(lambda: eigenvalues(exact_jacobian(system, state))) if may_vary(system, ()) else None
    return eigenvalues(differentiate_return_map(system, state, rtol)) if exact is None else exact


def eigenvalues(matrices: Array) -> NDArray[np.complex128]:
    """Returns eigenvalues in the order of `by_modulus`, (..., d)."""
    values = np.linalg.eigvals(matrices).astype(np.complex128)
    return np.take_along_axis(values, by_modulus(values), axis=-1)


def measure_exits(multipliers: NDArray[np.complex128]) -> Array:
    """Returns functions that are positive where all multipliers are in the unit circle, zero where some leave it, (3,).

    They are Π (1 - λ) at +1 (a fold), Π (1 + λ) at -1 (a flip), and Π over pairs of (1 - λ_i λ_j) for a complex pair
    (Neimark-Sacker).
    """
    i, j = np.triu_indices(len(multipliers), 1)
    parts = 1.0 - multipliers, 1.0 + multipliers, 1.0 - multipliers[i] * multipliers[j]
    return np.array([np.prod(part).real for part in parts])


def by_modulus(values: NDArray[np.complex128]) -> NDArray[np.int64]:
    """Returns the order of multipliers by decreasing modulus, (..., d).

    Of a conjugate pair, the one above the real axis comes first, independent of rounding.
    """
    return np.asarray(np.lexsort((-values.imag, -np.round(np.abs(values), 9)), axis=-1))
