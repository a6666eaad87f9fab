"""Strides near a gait in space: their end states and times of landing, as functions of state and inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.attempts import WHY
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.inputs import inputs_of
from spear_pin.gaits.spatial.automaton import speed_ahead
from spear_pin.gaits.spatial.legs import SIDES
from spear_pin.gaits.tangent_cycles import tangent_cycles
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.dual import Dual, derivatives, duals, value_of
from spear_pin.hybrid.newton import CONVERGED, Lanes, Words, newton
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.hybrid.symmetry import YAW
from spear_pin.hybrid.tangent.collocation import ENDS
from spear_pin.hybrid.tangent.resets import attempt
from spear_pin.hybrid.tangent.section import cycle_on_section

DIFFERENCE = 1e-5  # of the unknowns


def footfall_gap(times: Mapping[str, Any], pair: str, event: str = "touchdown") -> Any:
    """Returns the time from the first touchdown, or "lift_off", of a pair's left foot to the right foot's, in s.

    Args:
        times: times of events by name, in s, of any scalars; NaN is returned where one is missing.
        pair: "posterior" or "anterior".
        event: what the feet do.
    """
    left, right = (times.get(f"{pair}_{side}_{event}", math.nan) for side in SIDES)
    return right - left


def first_times(run: Run) -> dict[str, float]:
    """Returns when each event happens first, in s, by name."""
    return {each.name: each.time for each in reversed(run.events)}


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
        self._cycles = tangent_cycles(system, inputs, ())
        units = [each.one for each in inputs_of(system, inputs)]
        self._inputs = [(name, parameter(system, name), one) for name, one in zip(inputs, units, strict=True)]
        self.n = self._chart.dimension
        self.unknowns = self.n + len(inputs)

    def numbers(self, x: Array) -> dict[str, float]:
        """Returns the changed inputs by name."""
        changes = zip(self._inputs, x[self.n :].tolist(), strict=True)
        return {name: value + unit * by for (name, value, unit), by in changes}

    def system(self, x: Array) -> HybridSystem:
        """Returns the system with the changed inputs."""
        return with_parameters(self._system, self.numbers(x))

    def state(self, x: Array) -> State:
        """Returns the state on the section."""
        return self._chart.state(x[: self.n])

    def values(self, x: Array) -> Array:
        """Returns the state's change in a stride, (n,), the turn, the speed, and times between touchdowns, (2,).

        Raises:
            NoGait: the stride does not close, or a foot does not land.
        """
        begin, numbers = self.state(x), np.array([*self.numbers(x).values()])
        record = None if self._cycles is None else self._cycles.record(*begin, numbers)
        if record is not None:
            y, period = record.y, sum(record.spent.values())
            times = _first_times(record.arcs, [arc.end for arc in record.arcs])
        else:
            run = self._run(x)
            y, period, times = np.concatenate(run.state), sum(run.durations.values()), first_times(run)
        closes = self._chart.coordinates((y[: len(y) // 2], y[len(y) // 2 :])) - x[: self.n]
        found = np.array([*closes, *self._measured(begin[0], y, period, times)])
        if not np.isfinite(found).all():
            raise NoGait("a foot does not land in each stride", np.inf)
        return found

    def _run(self, x: Array) -> Run:
        """Runs the stride by the reference engine."""
        try:
            run = return_map(self.system(x), self.state(x), self._rtol)
        except SpearError as error:
            raise NoGait(str(error), np.inf) from None
        if not run.cycles:
            raise NoGait(f"a stride does not close: {run.message}", np.inf)
        return run

    def _measured(self, begin: Array, end: Any, period: Any, times: Mapping[str, Any]) -> list[Any]:
        """Returns the turn, the speed along the first heading, and times between touchdowns, of any scalars."""
        gaps = [footfall_gap(times, pair) / self._second for pair in LEGS]
        return [end[YAW] - begin[YAW], speed_ahead(begin, end, period), *gaps]

    def solved(
        self, x: Array, off: Callable[[Array], Array], held: Callable[[Array], Array], tolerance: float, longest: float
    ) -> Array:
        """Finds unknowns near others for wanted values by Newton's method, with the smallest of all steps.

        Args:
            x: the unknowns at which it starts.
            off: returns by how much values are off.
            held: tells which of them count, (n + 4,).
            tolerance: how much values may be off.
            longest: largest change of an unknown in a step.

        Raises:
            NoGait: Newton's method finds none.
        """
        size = self.n + 4

        def evaluate(lanes: Lanes, points: Array) -> tuple[Array, Words]:
            found, why = np.full((len(points), size), np.nan), np.full(len(points), "", dtype=object)
            for i, point in enumerate(points):
                try:
                    found[i] = off(self.values(point))
                except NoGait as failure:
                    why[i] = failure.reason
            return found, why

        def slopes(lanes: Lanes, points: Array) -> Array:
            try:
                return np.array([held(self.values(point))[:, None] * self.slopes(point) for point in points])
            except NoGait:
                return np.full((len(points), size, self.unknowns), np.nan)

        given = x[None], np.ones((1, self.unknowns)), tolerance
        roots = newton(evaluate, *given, slopes=slopes, always=False, equations=size, longest=longest)
        if roots.end[0] != CONVERGED:
            why = WHY[roots.end[0]].format(n=roots.iteration[0])
            raise NoGait(": ".join(filter(None, [why, roots.reason[0]])), float(roots.norm[0]))
        return np.asarray(roots.x[0])

    def slopes(self, x: Array) -> Array:
        """Returns derivatives of the values, (n + 4, n + k), exact where the stride has derivatives.

        Elsewhere they are central differences. Where both feet of a pair land at once, these do not see the kink.

        Raises:
            NoGait: a stride beside does not close, or a foot does not land.
        """
        exact = attempt(lambda: self._exact(x))
        if exact is not None and np.isfinite(exact).all():
            return exact
        steps = DIFFERENCE * np.eye(self.unknowns)
        return np.array([(self.values(x + each) - self.values(x - each)) / (2.0 * DIFFERENCE) for each in steps]).T

    def _exact(self, x: Array) -> Array | None:
        """Returns exact derivatives of the values, or None where two feet land at once, or there are none."""
        if self._cycles is None:
            return None
        n, units = self.n, np.array([unit for _, _, unit in self._inputs])
        seeds = np.pad(self._cycles.seeds[:, 2 * self._system.robot.nv :] * units, ((0, 0), (n, 0)))
        cycle = cycle_on_section(self.system(x), self._chart, seeds, ENDS, x[:n])
        if cycle.together:
            return None
        ends = [Dual(stretch.arc.end, stretch.tau) for stretch in cycle.stretches]
        times = _first_times([stretch.arc for stretch in cycle.stretches], ends)
        end = duals(cycle.y, cycle.dy)
        measured = self._measured(cycle.stretches[0].arc.y, end, sum(cycle.durations.values()), times)
        if not np.isfinite([float(value_of(each)) for each in measured]).all():
            return None
        closes = self._chart.changes(cycle.y, cycle.dy) - np.eye(n, self.unknowns)
        return np.concatenate([closes, derivatives(measured, self.unknowns)])


def _first_times(arcs: Sequence[Arc], ends: Sequence[Any]) -> dict[str, Any]:
    """Returns when each event happens first, in s, by name, from times since the arcs' phases began."""
    begun, found = 0.0, dict[str, Any]()
    for arc, end in zip(arcs, ends, strict=True):
        if arc.event is not None:
            found.setdefault(RETOUCH if arc.again else arc.event.name, begun + end)
        if arc.begins_phase:
            begun = begun + end
    return found
