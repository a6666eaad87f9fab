"""Search for periodic gaits: any parameters varied, any measures of the cycle as targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from spear_pin.errors import BadValue, NoGait, UnknownName
from spear_pin.gaits.attempts import ENOUGH, Hopeless, MeasureOfRun, search_gait
from spear_pin.gaits.diagnosis import explain_failure
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.targets import check_wanted, measures_of
from spear_pin.gaits.tolerances import TOLERANCE
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.result import EVALUATIONS, State
from spear_pin.kinds import typed

FACTORS = (1.0, 0.9, 1.1, 0.8, 1.2)  # factors on the varied parameters' starting values, tried in turn


@typed
def find_gait(
    system: HybridSystem,
    vary: Sequence[str] = (),
    target: Mapping[str | MeasureOfRun, float] | None = None,
    *,
    guess: State | None = None,
    rtol: float = 1e-10,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> Gait:
    """Solves x = P(x) of (4.12) together with the targets, by Newton's method on the return map.

    Cycles come with exact derivatives without hardware and with all targets as measures by name; in the plane this
    needs heyoka. Elsewhere the reference engine runs them, with derivatives by differences. The reference engine
    confirms every gait: the residual is to `rtol`.

    Where that fails, the function tries other starting values of the parameters. Then it carries the fixed point of
    each start to the targets step by step.

    Args:
        system: robot, law, spring and ground; its parameters are the starting values.
        vary: parameters to solve for, named as fields of the law, spring or contact.
        target: wanted values of measures of the cycle; a measure is a name of `spear_pin.gaits.measures.catalogue`, or
            a function of the one-cycle `Run`.
        guess: a state (q, v) on the section; by default the system's own, run for a few cycles.
        rtol: relative tolerance of the integrator.
        on_iteration: called with the iteration and the residual.

    Raises:
        UnknownName: unknown parameter or measure.
        BadValue: `vary` and `target` differ in length, or no cycle has a target: it is not a finite number, or it is a
            flight too short to close a cycle, see `HybridSystem.shortest_flight`.
        NoGait: no periodic gait was found from here; the text says why, and for a hop the likely cause and what to try.

    Example:
        >>> from spear_pin import find_gait, hopping, load
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> gait = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})
        >>> round(gait.parameters["stance_torque"], 2), gait.stable  # N·m
        (7.83, True)
    """
    target = dict(target or {})
    if len(vary) != len(target):
        raise BadValue("target", target, f"as many targets as parameters to vary, {len(vary)}")
    for name in target:
        if not callable(name) and name not in measures_of(system):
            raise UnknownName("target", name, measures_of(system))
    check_wanted(system, target)
    search = search_gait(system, vary, target, rtol, on_iteration)
    start = np.array([parameter(system, name) for name in vary])
    factors = FACTORS if vary else FACTORS[:1]
    begun = [with_parameters(system, dict(zip(vary, (k * start).tolist(), strict=True))) for k in factors]
    attempts = [(search.directly, i) for i in range(len(begun))]
    attempts += [(search.by_continuation, i) for i in range(2)] if vary else []
    settled: list[State] = []
    failures: list[NoGait] = []
    try:
        for approach, i in attempts:
            if len(settled) == i:
                settled.append(guess if guess is not None else search.settled(begun[i]))
            try:
                return search.gait(*approach(begun[i], settled[i]))
            except NoGait as failure:
                failures.append(failure)
            tried = len(failures) >= len(begun)
            if search.effort.reached or (tried and search.effort.evaluations > ENOUGH):
                break  # another start of the path would end at the same place
    except Hopeless:
        residual = min((failure.residual for failure in failures), default=np.inf)
        failures = [
            NoGait(f"cycles take more than {EVALUATIONS} evaluations each; a cycle of a gait takes fewer", residual)
        ]
    nearest = min(failures, key=lambda each: each.residual)
    raise explain_failure(nearest, system, vary, target, search.effort.reached) from None


def gait_beside(
    system: HybridSystem,
    state: State,
    vary: Sequence[str],
    target: Mapping[str, float],
    rtol: float = 1e-10,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> Gait:
    """Finds the fixed point near a state that is nearly one, by Newton's method from there alone.

    Args:
        system: robot, law, spring and ground; its parameters are the starting values.
        state: (q, v) on the section.
        vary: names of the parameters to solve for.
        target: wanted values of as many measures, by name.
        rtol: relative tolerance of the integrator.
        on_iteration: called with the iteration and the residual.

    Raises:
        NoGait: Newton's method does not converge to a gait.
    """
    search = search_gait(system, vary, target, rtol, on_iteration)
    try:
        return search.gait(*search.newton(system, state, search.wanted, rtol, min(TOLERANCE, rtol)))
    except Hopeless:
        raise NoGait(f"cycles take more than {EVALUATIONS} evaluations each", np.inf) from None
