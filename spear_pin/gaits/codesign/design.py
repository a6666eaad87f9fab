"""Result of a design optimisation: the gait, the active bounds with their prices, and the effect of assumptions."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from spear_pin.arrays import Array
from spear_pin.files import plain
from spear_pin.gaits.codesign.problem import STABILITY, Problem, largest
from spear_pin.gaits.codesign.stability import borders
from spear_pin.gaits.codesign.trust_region import Minimum
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import nonzero, number, unit
from spear_pin.model.catalogue import mass_law
from spear_pin.model.numbers import body_numbers
from spear_pin.model.variants import SIZE, motor_mass, parameters_of
from spear_pin.showing import Shown

STEP = 1e-6  # relative to the largest allowed multiplier
MISSED = 1e-6  # of bounds, in all, relative to them
NO_PRICE = 1e-6  # relative to the objective, for a whole bound or range: smaller prices are zero


@dataclass(frozen=True)
class Chosen:
    """A parameter of a design.

    Attributes:
        start: value at the beginning.
        value: value at the end.
        low: least allowed value.
        high: greatest allowed value.
        unit: unit of these values, empty where nothing says one.
    """

    start: float
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Assumption:
    """Effect of a number that was not chosen on the best design.

    Attributes:
        value: value of the number.
        unit: unit of the number.
        derivative: change of the minimum for one more unit of the number, to first order.
    """

    value: float
    unit: str
    derivative: float


@dataclass(frozen=True, repr=False)
class Design(Shown):
    """A local minimum of a measure over parameters, within bounds.

    Example:
        >>> from spear_pin import find_gait, hopping, load, optimize_design
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> kept = {"flight_time": gait.durations["flight"]}
        >>> best = optimize_design(gait, "work", {"stiffness": (47.0, 58.0)}, kept, vary=["stance_torque"])
        >>> round(best.parameters["stiffness"].value, 3), list(best.active)
        (58.0, ['greatest stiffness'])

    Attributes:
        gait: the gait at the minimum, confirmed by the reference engine.
        minimize: name of the minimised measure.
        unit: unit of the measure.
        start: the measure at the beginning, at the gait that keeps what `keep` names.
        objective: the measure at the minimum.
        parameters: chosen parameters, by name.
        bounds: value and bound of each bounded measure, by the name of the bound.
        margins: margin of each event from happening otherwise, in its guard's unit, by name.
        active: active bounds, by name: change of the minimum for one more unit of the bound; empty if these, and kinks,
            do not balance the gradient.
        assumptions: effect of each number that was not chosen, by name; empty likewise.
        largest: modulus of the largest multiplier.
        path: the measure, and the total relative violation of bounds, after each iteration.
        stationarity: the part of the gradient that bounds do not balance, relative to the measure at the beginning,
            over whole ranges.
        cycles: number of cycles that were run and differentiated.
        reason: why the optimisation ended.
        converged: whether the end is a minimum.
    """

    gait: Gait
    minimize: str
    unit: str
    start: float
    objective: float
    parameters: Mapping[str, Chosen]
    bounds: Mapping[str, tuple[float, float]]
    margins: Mapping[str, float]
    active: Mapping[str, float]
    assumptions: Mapping[str, Assumption]
    largest: float
    path: tuple[tuple[float, float], ...]
    stationarity: float
    cycles: int
    reason: str
    converged: bool

    def __repr__(self) -> str:
        return f"Design({self.minimize} {self.start:.6g} -> {self.objective:.6g} {self.unit}, {self.reason})"

    def __str__(self) -> str:
        lines = [f"{self.minimize}: {self.start:.6g} -> {self.objective:.6g}{_behind(self.unit)}; {self.reason}"]
        if self.path[0][1] > MISSED:
            lines.append(f"  it began beyond its bounds: {_excess(self.path[0][1])}")
        if self.missed > MISSED:
            lines.append(f"  BOUNDS ARE MISSED: {_excess(self.missed)}; nothing nearby keeps them")
        for name, each in self.parameters.items():
            unit, ends = _behind(each.unit), f"{each.low:g} to {each.high:g}"
            lines.append(f"  {name:24} {each.start:10.5g} -> {each.value:10.5g}{unit} of {ends}")
        for kind, mass in self.motor_masses.items():
            lines.append(f"  mass of a {kind}'s motor {mass:.3g} kg, by {mass_law()}")
        for name, (value, bound) in self.bounds.items():
            lines.append(f"  {name:40} {value:10.5g}, bound {bound:g}")
        lines.append(f"  largest multiplier {self.largest:.4f}, {self.cycles} cycles")
        if not self.converged:
            lines.append("margins to other orders of events, in the units of their guards:")
            lines += [f"  {name:40} {value:10.3g}" for name, value in self.margins.items()]
        if self.active:
            lines.append(f"held back by, with the change of {self.minimize} for one unit more of the bound:")
            lines += [f"  {name:40} {price:+10.4g}" for name, price in self.active.items()]
        if self.assumptions:
            lines.append(f"% of {self.minimize} for one more % of what was assumed:")
            for name in self.ranked[:10]:
                lines.append(f"  {name:40} {round(self.elasticity(name), 4) + 0.0:+10.4f}")
        return "\n".join(lines)

    @property
    def motor_masses(self) -> dict[str, float]:
        """Mass of each motor whose size was chosen, in kg, by the kind of its joint."""
        kinds = (name.removesuffix(f"_{SIZE}") for name in self.parameters if name.endswith(f"_{SIZE}"))
        return {kind: motor_mass(self.gait.system.robot, kind) for kind in kinds}

    @property
    def missed(self) -> float:
        """Total relative violation of the bounds; zero for a design."""
        return self.path[-1][1]

    @property
    def ranked(self) -> list[str]:
        """Names of the assumptions, by falling influence."""
        return sorted(self.assumptions, key=lambda name: -abs(self.elasticity(name)))

    def elasticity(self, name: str) -> float:
        """Returns the change of the minimum in % for 1 % more of an assumption."""
        each = self.assumptions[name]
        return each.derivative * each.value / self.objective if self.objective else np.nan

    def to_json(self) -> str:
        """Returns the design without the gait as JSON."""
        data = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "gait"} | {
            "parameters": {name: vars(each) for name, each in self.parameters.items()},
            "assumptions": {name: vars(each) for name, each in self.assumptions.items()},
        }
        return json.dumps(plain(data), indent=1, allow_nan=False)


def _excess(violation: float) -> str:
    return f"the excesses add up to {100.0 * violation:.3g} % of a bound"


def _behind(unit: str) -> str:
    return "" if unit in ("", "1") else f" {unit}"


def design(
    problem: Problem,
    begun: Gait,
    gait: Gait,
    end: Minimum[Orbit],
    scale: float,
    cycles: int,
    names: Sequence[str],
) -> Design:
    """Returns the result for an end of the optimisation.

    Args:
        problem: the problem.
        begun: the gait at the beginning.
        gait: the gait at the end.
        end: the end of the minimisation.
        scale: scale of the minimised measure.
        cycles: number of cycles that the optimisation took.
        names: names of the assumptions.
    """
    orbit = end.local.more
    objective, c = problem.values(orbit)
    chosen = {
        name: Chosen(number(begun.system, name), number(gait.system, name), low, high, unit(gait.system, name))
        for name, (low, high) in problem.over.items()
    }
    known = [(each, problem.measure(orbit, each.measure)) for each in problem.bounds]
    bounds = {each.label: (found.value, each.value) for each, found in known if found is not None}
    goal = problem.measure(orbit, problem.minimize)
    assert goal is not None
    if problem.largest_multiplier is not None:
        bounds["largest multiplier at most"] = largest(orbit), problem.largest_multiplier
    return Design(
        gait,
        problem.minimize,
        goal.unit,
        end.path[0][0] * scale,
        objective,
        chosen,
        bounds,
        {name: margin.value for name, margin in orbit.margins.items()},
        _prices(problem, orbit, end, scale) if end.balanced else {},
        _assumptions(problem, orbit, end, scale, names) if names and end.balanced else {},
        largest(orbit),
        tuple((value * scale, missed) for value, missed in end.path),
        end.stationarity,
        cycles,
        end.reason,
        end.converged,
    )


def list_assumed(system: HybridSystem, besides: Sequence[str]) -> tuple[str, ...]:
    """Returns the names of gears, springs, ground and masses that enter the equations, except those in `besides`.

    In space masses of bodies are left out: most are of one side, and a symmetric gait has no derivative by them.
    """
    robot = system.robot
    # a parameter may change a number of a body that is chosen
    own = () if set(besides) & set(body_numbers(robot)) else parameters_of(robot)
    masses = [name for name in body_numbers(robot) if name.endswith("_mass") and robot.dimension == 2]
    if "torso_mass" in parameters_of(robot):  # which is that of the base's last joint
        masses = [name for name in masses if name.removesuffix("_mass") in robot.actuated]
    names = (*own, "stiffness", "damping", "friction", *masses)
    return nonzero(system, [name for name in names if name not in besides])


def _prices(problem: Problem, orbit: Orbit, end: Minimum[Orbit], scale: float) -> dict[str, float]:
    """Returns the change of the minimised measure for one more unit of each active bound."""
    found = dict[str, float]()
    for word, side, prices in zip(("least", "greatest"), (1.0, -1.0), end.at_bounds, strict=True):
        for name, price, span in zip(problem.over, prices, problem.span, strict=True):
            if price > NO_PRICE:
                found[f"{word} {name}"] = side * float(price) * scale / float(span)
    bounds = problem.bounds
    for bound, price in zip(bounds, end.multipliers[: len(bounds)], strict=True):
        if price > NO_PRICE:
            found[bound.label] = bound.side * float(price) * scale / bound.size
    if problem.largest_multiplier is not None:
        rho = problem.largest_multiplier
        grown = borders(orbit.jacobian, rho * (1.0 + STEP)) - borders(orbit.jacobian, rho * (1.0 - STEP))
        for label, price, change in zip(STABILITY, end.multipliers[len(bounds) :], grown, strict=True):
            if price > NO_PRICE:
                found[label] = -float(price) * scale * float(change) / (2.0 * STEP * rho)
    return found


def _assumptions(
    problem: Problem, orbit: Orbit, end: Minimum[Orbit], scale: float, names: Sequence[str]
) -> dict[str, Assumption]:
    """Returns the first-order change of the minimum with each assumption: that of Lagrange's function at the design.

    On a kink it combines the derivatives of both sides, in the shares that hold the minimum.
    """
    watch = bool(problem.largest_multiplier is not None and end.multipliers[-len(STABILITY) :].any())

    def of(orbit: Orbit) -> tuple[Array, Array]:
        return problem.slopes(Orbit(orbit.system, orbit.state, (*problem.vary, *names), orbit.motors), watch)

    goal, rows = of(orbit)
    slopes = goal - scale * rows.T @ end.multipliers
    for price, cut in end.kinks:
        if price > NO_PRICE:
            across, others = of(cut.other.more)
            i = cut.constraint
            slopes += price * ((across - goal) if i is None else scale * (rows[i] - others[i]))
    return {
        name: Assumption(number(orbit.system, name), unit(orbit.system, name), float(slope))
        for name, slope in zip(names, slopes, strict=True)
    }
