"""The minimised measure, its parameters and bounds at one gait: values and gradients along the branch of gaits."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, UnknownName, list_names
from spear_pin.gaits.codesign.stability import borders, slopes
from spear_pin.gaits.codesign.step import Local
from spear_pin.gaits.sensitivity.measure import DualMeasure
from spear_pin.gaits.sensitivity.orbit import Orbit, branch
from spear_pin.gaits.targets import measures_of
from spear_pin.hybrid.parameters import number
from spear_pin.model.motor import Drive, Motor

OnCycle = Callable[[], object]
MARGIN, BEFORE = "margin_", "_before_"
OF_MOTORS = "energy|heat_.*|heating_.*|electricity.*|reserve_.*"
STABILITY = ("multiplier at +1", "multiplier at -1", "multipliers in a complex pair")
ROUNDING = 1e-5  # by which multipliers may miss their bound at an end
WATCHED = 0.8  # share of the largest allowed multiplier above which derivatives are needed


class Bound(NamedTuple):
    """A bound of a measure; side is -1 for an upper bound, 1 for a lower one."""

    measure: str
    side: float
    value: float

    @property
    def label(self) -> str:
        """Name of the bound."""
        return f"{self.measure} at {'most' if self.side < 0.0 else 'least'}"

    @property
    def size(self) -> float:
        """Unit in which the bound is counted."""
        return abs(self.value) or 1.0


@dataclass(frozen=True)
class Problem:
    """A measure to minimise.

    Attributes:
        minimize: name of the measure.
        over: least and greatest values of the parameters, by name.
        vary: names of parameters that are solved for.
        keep: as many measures, and the values that they keep.
        at_most: upper bounds of measures.
        at_least: lower bounds of measures.
        largest_multiplier: upper bound of every multiplier's modulus; None: there is no bound.
        motors: motors for `heat_JOINT` and `energy`, or drives for `electricity` and `reserve_JOINT`, by joint;
            both for `heating_JOINT`.
    """

    minimize: str
    over: Mapping[str, tuple[float, float]]
    vary: tuple[str, ...]
    keep: Mapping[str, float]
    at_most: Mapping[str, float]
    at_least: Mapping[str, float]
    largest_multiplier: float | None
    motors: Mapping[str, Motor | Drive]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of parameters whose derivatives are needed."""
        return (*self.vary, *self.over)

    @property
    def lower(self) -> Array:
        """Least values, (n,)."""
        return np.array([low for low, _ in self.over.values()])

    @property
    def span(self) -> Array:
        """Greatest values less the least, (n,)."""
        return np.array([high - low for low, high in self.over.values()])

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """Bounds of measures, in the order of `Local.c`; those of the multipliers are the last."""
        upper = [Bound(name, -1.0, value) for name, value in self.at_most.items()]
        return (*upper, *(Bound(name, 1.0, value) for name, value in self.at_least.items()))

    def measure(self, orbit: Orbit, name: str) -> DualMeasure | None:
        """Returns a measure of a gait, or a margin; None where there is none of that name."""
        if not name.startswith(MARGIN):
            return orbit.measures.get(name)
        event, _, other = name.removeprefix(MARGIN).partition(BEFORE)
        return (orbit.margins_before(other) if other else orbit.margins).get(event)

    def named(self, orbit: Orbit) -> None:
        """Checks that a gait has the measures.

        Raises:
            UnknownName: the gait lacks a measure.
            BadValue: the gait would have the measure with other motors.
        """
        targets = measures_of(orbit.system)  # the end is searched for with them
        kept = [name for name in orbit.measures if name in targets]
        for name in self.keep:
            if name not in kept:
                raise UnknownName("measure to keep", name, kept)
        events = {event.name for domain in orbit.system.domains for event in (*domain.guards, domain.switch) if event}
        for name in (self.minimize, *self.at_most, *self.at_least):
            _, _, other = name.partition(BEFORE)
            if name.startswith(MARGIN) and other and other not in events:
                raise UnknownName("event", other, sorted(events))
            if self.measure(orbit, name) is None:
                if re.fullmatch(OF_MOTORS, name):
                    named = list_names([*self.motors]) or "none"
                    expected = f"a measure of a joint that motors names ({named})"
                    raise BadValue("measure", name, f"{expected}; electricity needs a Drive there, with its supply")
                raise UnknownName("measure", name, [*orbit.measures, *(MARGIN + each for each in orbit.margins)])

    def values(self, orbit: Orbit) -> tuple[float, Array]:
        """Returns the minimised measure, and the constraints in units of their size, (m,), >= 0 where they are met."""
        goal, values = self.measure(orbit, self.minimize), []
        if goal is None:
            raise NoGait(f"the gait has no {self.minimize}", np.nan, remedy="to minimise another measure")
        for each in self.bounds:
            # an event that is not armed has no margin, and needs none
            found = self.measure(orbit, each.measure)
            values.append(1.0 if found is None else each.side * (found.value - each.value) / each.size)
        if self.largest_multiplier is not None:
            values.extend(borders(orbit.jacobian, self.largest_multiplier).tolist())
        return goal.value, np.array(values)

    def slopes(self, orbit: Orbit, watch: bool, on_cycle: OnCycle = lambda: None) -> tuple[Array, Array]:
        """Returns derivatives of `values` along the branch by an orbit's free names, (n,) and (m, n).

        Args:
            orbit: orbit of the gait; its names that are not solved for are free.
            watch: whether derivatives of the multipliers are needed, which take a cycle each; else they are zero.
            on_cycle: called before each cycle.
        """
        others, goal = len(orbit.names) - len(self.vary), self.measure(orbit, self.minimize)
        assert goal is not None
        chain, rows = branch(orbit, list(self.keep)), []
        for each in self.bounds:
            found = self.measure(orbit, each.measure)
            rows.append(np.zeros(others) if found is None else each.side * found.derivative @ chain / each.size)
        if self.largest_multiplier is not None:
            of = slopes(orbit, list(self.keep), self.largest_multiplier, on_cycle) if watch else None
            rows.extend(np.zeros((len(STABILITY), others)) if of is None else of)
        return goal.derivative @ chain, np.array(rows).reshape(-1, others)

    def local(self, orbit: Orbit, scale: float, on_cycle: OnCycle = lambda: None) -> Local[Orbit]:
        """Returns the problem about a gait, with parameters scaled to 0 … 1 within their ranges.

        Args:
            orbit: orbit of the gait, with derivatives by `names`.
            scale: scale of the minimised measure.
            on_cycle: called before each cycle.
        """
        goal, c = self.values(orbit)
        allowed = np.inf if self.largest_multiplier is None else self.largest_multiplier
        x = (np.array([number(orbit.system, name) for name in self.over]) - self.lower) / self.span

        def derived() -> tuple[Array, Array]:
            g, A = self.slopes(orbit, largest(orbit) > WATCHED * allowed, on_cycle)
            return g * self.span / scale, A * self.span

        return Local(x, goal / scale, c, derived, orbit)

    def stable(self, orbit: Orbit) -> bool:
        """Tells whether all multipliers are within their bound, up to rounding."""
        return self.largest_multiplier is None or largest(orbit) <= self.largest_multiplier * (1.0 + ROUNDING)

    def hidden(self, orbit: Orbit) -> bool:
        """Tells whether multipliers are outside though no border function is negative, because an even number left."""
        if self.largest_multiplier is None or self.stable(orbit):
            return False
        return bool((borders(orbit.jacobian, self.largest_multiplier) >= 0.0).all())


def largest(orbit: Orbit) -> float:
    """Returns the modulus of the largest multiplier."""
    return float(np.abs(np.linalg.eigvals(orbit.jacobian)).max())
