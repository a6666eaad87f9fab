"""Strides near a gait in space: their end states and times of landing, as functions of state and inputs."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.orbits.balance import unit_of
from spear_pin.gaits.spatial.automaton import forward_speed
from spear_pin.gaits.spatial.legs import SIDES
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import may_vary
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.symmetry import YAW
from spear_pin.hybrid.tangent.collocation import ENDS
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.hybrid.tangent.section import cycle_on_section
from spear_pin.hybrid.tangent.seeds import seeds


def footfall_gap(run: Run, pair: str, event: str = "touchdown") -> float:
    """Returns the time from the first touchdown, or "lift_off", of a pair's left foot to the right foot's, in s."""
    times = {each.name: each.time for each in reversed(run.events)}
    left, right = (times.get(f"{pair}_{side}_{event}", np.nan) for side in SIDES)
    return float(right - left)


class Strides:
    """Strides as functions of section coordinates and scaled changes of inputs.

    Attributes:
        n: number of coordinates of the section.
        unknowns: number of these coordinates and the inputs.
    """

    def __init__(self, system: HybridSystem, state: State, inputs: Sequence[str], second: float, rtol: float) -> None:
        """Prepares strides near a gait.

        Args:
            system: a system in space.
            state: state on its section.
            inputs: names of the law's numbers.
            second: unit in which a time between touchdowns is counted, in s.
            rtol: relative tolerance of the integrator.
        """
        self._system, self._second, self._rtol, self._chart = system, second, rtol, chart(system, state)
        self._inputs = [(name, parameter(system, name), unit_of(name, system.robot)) for name in inputs]
        self.n = self._chart.dimension
        self.unknowns = self.n + len(inputs)

    def system(self, x: Array) -> HybridSystem:
        """Returns the system with the changed inputs."""
        changes = zip(self._inputs, x[self.n :].tolist(), strict=True)
        return with_parameters(self._system, {name: value + unit * by for (name, value, unit), by in changes})

    def state(self, x: Array) -> State:
        """Returns the state on the section."""
        return self._chart.state(x[: self.n])

    def values(self, x: Array) -> Array:
        """Returns the state's change in a stride, (n,), the turn, the speed, and times between touchdowns, (2,).

        Raises:
            NoGait: the stride does not close, or a foot does not land.
        """
        system = self.system(x)
        try:
            run = return_map(system, self.state(x), self._rtol)
        except SpearError as error:
            raise NoGait(str(error), np.inf) from None
        if not run.cycles:
            raise NoGait(f"a stride does not close: {run.message}", np.inf)
        closes = self._chart.coordinates(run.state) - x[: self.n]
        measured = [system.measures["turn"](run), forward_speed(run)]
        gaps = [footfall_gap(run, pair) / self._second for pair in LEGS]
        found = np.array([*closes, *measured, *gaps])
        if not np.isfinite(found).all():
            raise NoGait("a foot does not land in each stride", np.inf)
        return found

    def slopes(self, x: Array, step: float, at: Array | None = None) -> Array:
        """Returns derivatives of the values, (n + 4, n + k), exact where the stride has derivatives.

        Args:
            x: the unknowns.
            step: step of the differences that are taken elsewhere.
            at: the values at x, for differences of one side; without them differences are central.

        Raises:
            NoGait: a stride beside does not close, or a foot does not land.
        """
        try:
            exact = self._exact(x)
        except REFUSALS:
            exact = None
        if exact is not None and np.isfinite(exact).all():
            return exact
        columns = []
        for each in step * np.eye(self.unknowns):
            ahead = self.values(x + each)
            columns.append((ahead - self.values(x - each)) / (2.0 * step) if at is None else (ahead - at) / step)
        return np.array(columns).T

    def _exact(self, x: Array) -> Array | None:
        """Returns exact derivatives of the values, or None where two feet land at once, or there are none."""
        system, n = self.system(x), self.n
        if not may_vary(system, ()):
            return None
        names, _, units = zip(*self._inputs, strict=True)
        own = seeds(system, names).numbers * np.array(units)
        whole = np.concatenate([np.zeros((len(own), n)), own], axis=1)
        cycle = cycle_on_section(system, self._chart, whole, ENDS, x[:n])
        if cycle.together:
            return None
        period = sum(float(each.x) for each in cycle.durations.values())
        longer = sum(np.asarray(each.d) for each in cycle.durations.values())
        begin = cycle.stretches[0].arc.y
        c, s = math.cos(begin[YAW]), math.sin(begin[YAW])
        way, ways = (c * each[0] + s * each[1] for each in (cycle.y - begin, cycle.dy))
        landing = dict[str, Array]()  # derivatives of the instants
        begun, last = np.zeros(self.unknowns), np.zeros(self.unknowns)  # of the phase, whose clock begins at zero
        for stretch in cycle.stretches:
            begins = stretch.arc.t == 0.0 and not stretch.since.any()
            begun, last = (begun + last if begins else begun), stretch.tau
            if stretch.arc.event is not None:
                landing.setdefault(stretch.arc.event.name, begun + last)
        gaps = []
        for pair in LEGS:
            left, right = (landing.get(f"{pair}_{side}_touchdown") for side in SIDES)
            if left is None or right is None:
                return None
            gaps.append((right - left) / self._second)
        closes = self._chart.changes(cycle.y, cycle.dy) - np.eye(n, self.unknowns)
        return np.array([*closes, cycle.dy[YAW], (ways - way / period * longer) / period, *gaps])
