"""Find periodic gaits: any parameters varied, any measures of the cycle as targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, NoGait, SpearError, UnknownName
from spear_pin.gaits.gait import Gait, parameter, with_parameters
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.periodic import STEP, chart, displacement, multipliers, newton, return_map
from spear_pin.hybrid.record import Options, State
from spear_pin.hybrid.run import run

Array = NDArray[np.float64]
SETTLE = 12  # cycles of simulation before Newton's method
TOLERANCE = 1e-10  # of Newton's method, or the integrator's where that is finer
RESIDUAL = 1e-9


def find_gait(
    system: HybridSystem,
    vary: Sequence[str] = (),
    target: Mapping[str | Callable[[Any], float], float] | None = None,
    *,
    guess: State | None = None,
    rtol: float = 1e-10,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> Gait:
    """Solve x = P(x) of (4.12) together with the targets, by Newton's method on the return map.

    Args:
        system: robot, law, spring and ground; its parameters are the starting values.
        vary: parameters to solve for, named as fields of the law, spring or contact.
        target: wanted values of measures of the cycle; a measure is a name among
            `system.measures`, or a function of the one-cycle `Run`.
        guess: a state (q, v) on the section; by default the system's own, run for a few cycles.
        rtol: relative tolerance of the integrator.
        on_iteration: called with the iteration and the residual.

    Raises:
        UnknownName: unknown parameter or measure.
        BadValue: not as many targets as parameters, or a target that is no finite number.
        NoGait: no periodic gait was found from here; the text says why.
    """
    target = dict(target or {})
    if len(vary) != len(target):
        raise BadValue("target", target, f"as many targets as parameters to vary, {len(vary)}")
    for name, value in target.items():
        if not callable(name) and name not in system.measures:
            raise UnknownName("target", name, system.measures)
        if not np.isfinite(value):
            raise BadValue(f"target {name}", value, "a finite number")
    measures = [name if callable(name) else system.measures[name] for name in target]
    wanted = np.array(list(target.values()))
    start = np.array([parameter(system, name) for name in vary])
    scale = np.maximum(1.0, np.abs(start))

    local = chart(system, guess if guess is not None else _settle(system, system.guess()))
    d = local.dimension

    def unknowns(z: Array) -> tuple[HybridSystem, State]:
        values = dict(zip(vary, (z[d:] * scale).tolist(), strict=True))
        return with_parameters(system, values), local.state(z[:d])

    def function(z: Array) -> Array | None:
        try:
            trial, state = unknowns(z)
            result = return_map(trial, state, rtol)
            if not result.cycles:
                return None
            measured = np.array([measure(result) for measure in measures])
        except SpearError:  # a parameter out of range, a toe below ground, an event that did not happen
            return None
        return np.concatenate([local.coordinates(result.state) - local.coordinates(state), measured - wanted])

    z = np.concatenate([np.zeros(d), start / scale])
    z, _ = newton(function, z, np.full(len(z), STEP), min(TOLERANCE, rtol), on_iteration=on_iteration)
    solved, state = unknowns(z)
    result = return_map(solved, state, rtol)
    error = float(np.abs(displacement(solved, state, result.state)).max())
    if error > RESIDUAL:
        raise NoGait("the fixed point lies where the section's chart does not reach", error)
    return Gait(
        system=solved,
        state=state,
        parameters={name: parameter(solved, name) for name in vary},
        residual=error,
        multipliers=multipliers(solved, state, rtol),
        durations=result.durations,
    )


def _settle(system: HybridSystem, state: State) -> State:
    """Follow the motion for a few cycles towards a stable gait; where it breaks off, the start is kept."""
    result = run(system, state, SETTLE, Options(rtol=1e-7))
    return result.state if result.cycles == SETTLE else state
