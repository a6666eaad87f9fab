"""Many gaits one after the other, for robots whose cycles do not run in lanes: those in space or round a post."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.attempts import MeasureOfRun
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.gait_table import CONVERGED, NO_CONVERGENCE, GaitTable
from spear_pin.gaits.lane_cycles import NOT_VALID
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import State


def find_each(
    system: HybridSystem,
    parameters: Mapping[str, Array],
    vary: Sequence[str],
    target: Mapping[str, Array],
    guess: State,
    rtol: float,
) -> GaitTable:
    """Finds gaits one after the other by `find_gait`; see `gaits.many.find_many` for the arguments.

    Each begins from the guess and then, where that fails, from the gait found last.
    """
    n = len(next(iter(parameters.values())))
    found, goals = dict[int, Gait](), {name: np.broadcast_to(values, n) for name, values in target.items()}
    reason = np.full(n, CONVERGED, dtype=object)
    for lane in range(n):
        numbers = {name: float(values[lane]) for name, values in parameters.items()}
        wanted: dict[str | MeasureOfRun, float] = {name: float(values[lane]) for name, values in goals.items()}
        try:
            own = with_parameters(system, numbers)
        except SpearError:
            reason[lane] = NOT_VALID
            continue
        for start in (guess, *(gait.state for gait in [*found.values()][-1:])):
            try:
                found[lane] = find_gait(own, vary, wanted, guess=start, rtol=rtol)
                break
            except NoGait:
                reason[lane] = NO_CONVERGENCE
            except SpearError:  # a toe below the ground
                reason[lane] = NOT_VALID
        if lane in found:
            reason[lane] = CONVERGED
    return _table(system, parameters, vary, found, reason)


def _table(
    system: HybridSystem, parameters: Mapping[str, Array], vary: Sequence[str], found: Mapping[int, Gait], reason: Array
) -> GaitTable:
    n, robot = len(reason), system.robot
    width = max((len(gait.multipliers) for gait in found.values()), default=1)
    q, v, residual = np.full((n, robot.nq), np.nan), np.full((n, robot.nv), np.nan), np.full(n, np.nan)
    values = np.full((n, width), np.nan + 0j)
    durations = {phase: np.full(n, np.nan) for phase in system.phases}
    solved = {name: np.full(n, np.nan) for name in vary}
    for lane, gait in found.items():
        (q[lane], v[lane]), residual[lane] = gait.state, gait.residual
        values[lane, : len(gait.multipliers)] = gait.multipliers
        for phase, seconds in gait.durations.items():
            durations[phase][lane] = seconds
        for name in vary:
            solved[name][lane] = gait.parameters[name]
    return GaitTable(q, v, {**parameters, **solved}, residual, values, durations, reason.astype(str))
