"""`optimize_design` finds the best robot and gait together, within bounds."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.codesign.design import Design, design, list_assumed
from spear_pin.gaits.codesign.problem import Problem
from spear_pin.gaits.codesign.step import Local
from spear_pin.gaits.codesign.trust_region import NO_VALUE, find_minimum
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.sensitivity.closing import close_cycle, find_changed
from spear_pin.gaits.sensitivity.drives import check_gears
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid import batch
from spear_pin.hybrid.batch import check_equations
from spear_pin.hybrid.parameters import number
from spear_pin.hybrid.periodic import eigenvalues
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.kinds import typed
from spear_pin.model.motor import NO_MOTORS, Drive, Motor

NO_MEASURES: Mapping[str, float] = MappingProxyType({})


@typed
def optimize_design(
    gait: Gait,
    minimize: str,
    over: Mapping[str, tuple[float, float]],
    keep: Mapping[str, float] = NO_MEASURES,
    *,
    vary: Sequence[str] | None = None,
    at_most: Mapping[str, float] = NO_MEASURES,
    at_least: Mapping[str, float] = NO_MEASURES,
    largest_multiplier: float | None = None,
    motors: Mapping[str, Motor | Drive] = NO_MOTORS,
    assuming: Sequence[str] | None = None,
    tolerance: float = 1e-6,
    iterations: int = 100,
    on_iteration: Callable[[int, float, float], object] = lambda n, value, missed: None,
) -> Design:
    """Finds a local minimum of a measure over parameters of robot, spring and law, along gaits of the simulation.

    Newton's method with exact derivatives follows the gaits. The next design comes from a quadratic model, within a
    region in which models have been right and gaits exist. The reference engine confirms the end.

    Args:
        gait: the gait at the beginning; it need not have the values to keep.
        minimize: name of a measure: one of `gait.sensitivity`, with motors `energy` and `heat_JOINT`, with drives of
            all joints `electricity`, or `margin_EVENT`.
        over: least and greatest values of parameters, by the names of numbers of law, springs, ground or robot.
        keep: measures and the values that they keep.
        vary: as many parameters, which are solved for; by default those that the gait was solved for.
        at_most: upper bounds of measures, such as `peak_torque_knee`.
        at_least: lower bounds, such as `margin_spring_switch`: margin of an event from happening otherwise, or
            `margin_lift_off_before_torque_switch`: the same, of motion before another event.
        largest_multiplier: upper bound of the moduli of the multipliers.
        motors: by the name of each joint, a motor or a drive. `energy` counts the heat of motors behind gears that lose
            nothing; drives give `electricity_JOINT` and `reserve_JOINT`, both `heating_JOINT`. Gears and motors have
            the robot's ratio and size, which may vary.
        assuming: names of numbers whose effect on the minimum the result gives; by default those of gears, springs,
            ground and masses.
        tolerance: the search ends when the predicted relative gain is below this.
        iterations: largest number of iterations.
        on_iteration: called with the iteration, the minimised measure, and the relative violation of bounds.

    Raises:
        MissingExtra: heyoka is not installed.
        UnknownName: there is no parameter, measure or joint that has such a name.
        BadValue: a range is empty, the gait lies outside a range, `keep` and `vary` differ in length, a drive has
            another ratio than the robot, or the gait has hardware.
        NoGait: no gait near the given one has the values to keep.
        NotDifferentiable: the gait has no derivative.

    Example:
        >>> from spear_pin import find_gait, hopping, load, optimize_design
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> kept = {"flight_time": gait.durations["flight"]}
        >>> best = optimize_design(gait, "work", {"stiffness": (47.0, 58.0)}, kept, vary=["stance_torque"])
        >>> best.converged, list(best.parameters)
        (True, ['stiffness'])
    """
    check_equations(gait.system)
    check_gears(gait.system, motors)
    batch.require()
    solved_for = tuple(vary) if vary is not None else tuple(gait.parameters) if keep else ()
    problem = Problem(
        minimize, dict(over), solved_for, dict(keep), dict(at_most), dict(at_least), largest_multiplier, dict(motors)
    )
    _check(gait, problem, tolerance, iterations)
    assumptions = list_assumed(gait.system, problem.names) if assuming is None else tuple(assuming)
    for name in assumptions:
        number(gait.system, name)
        if name in problem.names:
            raise BadValue("assuming", name, "parameters that are in neither over nor vary")
    cycles, why = 0, ""

    def count() -> None:
        nonlocal cycles
        cycles += 1

    begun = Orbit(gait.system, gait.state, problem.names, problem.motors)
    problem.named(begun)
    if len(problem.vary) != len(problem.keep):
        raise BadValue("keep", dict(problem.keep), f"as many measures as vary has parameters, {len(problem.vary)}")
    orbit = close_cycle(begun, problem.keep, count)
    scale = abs(problem.values(orbit)[0]) or 1.0

    def value(x: Array, near: Local[Orbit]) -> Local[Orbit] | None:
        nonlocal why
        change = dict(zip(over, ((x - near.x) * problem.span).tolist(), strict=True))
        try:
            there = find_changed(near.more, problem.keep, change, count)
            if problem.hidden(there) and not problem.hidden(near.more):
                raise NoGait("two multipliers leave the circle at once", np.nan)
            local = problem.local(there, scale, count)
        except (NoGait, *REFUSALS) as failure:
            why = failure.reason if isinstance(failure, NoGait) else str(failure)
            return None
        return local

    def tell(n: int, best: Local[Orbit]) -> None:
        on_iteration(n, best.f * scale, best.violation)

    start, box = problem.local(orbit, scale, count), (np.zeros(len(over)), np.ones(len(over)))
    end = find_minimum(value, start, box, tolerance=tolerance, iterations=iterations, on_step=tell)
    best, reason = end.local.more, end.reason
    if reason == NO_VALUE:
        reason = f"{NO_VALUE}: {why}"
    elif end.converged and not problem.stable(best):
        reason = "multipliers are outside of their circle"
    try:
        found = gait_beside(best.system, best.state, solved_for, problem.keep)
    except NoGait as failure:
        found, reason = (
            build_unconfirmed(best, solved_for),
            f"the reference engine does not confirm it: {failure.reason}",
        )
    return design(problem, gait, found, replace(end, reason=reason), scale, cycles, assumptions)


def build_unconfirmed(orbit: Orbit, vary: Sequence[str]) -> Gait:
    """Returns the gait as the fast engine finds it."""
    return Gait(
        system=orbit.system,
        state=orbit.state,
        parameters={name: number(orbit.system, name) for name in vary},
        residual=float(np.abs(orbit.displacement).max()),
        multipliers=eigenvalues(orbit.jacobian),
        durations={phase: float(seconds.x) for phase, seconds in orbit.cycle.durations.items()},
    )


def _check(gait: Gait, problem: Problem, tolerance: float, iterations: int) -> None:
    """Refuses empty ranges, and names that do not fit together."""
    if not problem.over:
        raise BadValue("over", {}, "one parameter or more, each with its least and greatest value")
    for name, bounds in problem.over.items():
        value = number(gait.system, name)
        if len(bounds) != 2 or not (np.isfinite(bounds).all() and bounds[0] < bounds[1]):
            raise BadValue(f"over[{name!r}]", bounds, "a least and a greatest value, finite")
        if not bounds[0] <= value <= bounds[1]:
            raise BadValue(f"over[{name!r}]", bounds, f"a range with the gait's own value in it, {value:g}")
        if name in problem.vary:
            raise BadValue("over", name, "parameters other than those that are solved for")
    for name in problem.vary:
        number(gait.system, name)
    if len(set(problem.vary)) != len(problem.vary):
        raise BadValue("vary", problem.vary, "each parameter once")
    check_wanted(gait.system, problem.keep)
    if problem.minimize in problem.keep:
        raise BadValue("minimize", problem.minimize, "a measure that is not in keep")
    for name, least in problem.at_least.items():
        if least > problem.at_most.get(name, np.inf):
            raise BadValue(
                f"at_least[{name!r}]", least, f"at most {problem.at_most[name]:g}, the value of at_most[{name!r}]"
            )
    for name, kept in problem.keep.items():
        if not problem.at_least.get(name, -np.inf) <= kept <= problem.at_most.get(name, np.inf):
            raise BadValue(f"keep[{name!r}]", kept, "a value within at_least and at_most of the same measure")
    require("tolerance", tolerance, lambda share: 0.0 < share < 1.0, "a number between 0 and 1")
    require("iterations", iterations, lambda n: n >= 1, "a whole number >= 1")
    if problem.largest_multiplier is not None:
        require("largest_multiplier", problem.largest_multiplier, lambda limit: limit > 0.0, "a number > 0, or None")
    for what, limits in (("at_most", problem.at_most), ("at_least", problem.at_least)):
        for name, bound in limits.items():
            require(f"{what}[{name!r}]", bound, math.isfinite, "a finite number")
