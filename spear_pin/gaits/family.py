"""Systems that differ in a few numbers, and their cycles: by lanes, as recorded ones, or by the reference engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.lane_cycles import LaneCycles
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.targets import measure_of
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import FEW, LOCK, has_lanes, may_vary
from spear_pin.hybrid.parameters import number, numbers_of_robot, with_numbers, with_parameters
from spear_pin.hybrid.periodic import one_by_one, return_map
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.shooting import Cycle, Cycles
from spear_pin.hybrid.tangent.record import Recorder, many
from spear_pin.hybrid.tangent.resets import attempt
from spear_pin.hybrid.tangent.seeds import Seeds, seeds

KEPT = 16  # systems with other robots: three are asked for again and again
NameOrMeasure = str | Callable[[Run], float]


@dataclass(frozen=True)
class Family:
    """Systems that differ in a few numbers, and what is measured of their cycles.

    Attributes:
        system: one of the systems.
        names: names of the numbers, as `with_numbers` takes them; at most the last one belongs to the robot.
        measures: names of measures, or functions of a cycle's run.
        rtol: relative tolerance of the integration.
        watch: called with each run of the reference engine.
    """

    system: HybridSystem
    names: tuple[str, ...]
    measures: tuple[NameOrMeasure, ...]
    rtol: float
    watch: Callable[[Run], object] = lambda run: None

    @cached_property
    def of_robot(self) -> bool:
        """Whether the last number belongs to the robot."""
        return bool(self.names) and self.names[-1] in numbers_of_robot(self.system.robot)

    def member(self, values: Sequence[float]) -> HybridSystem:
        """Returns the system with given values of the numbers.

        Raises:
            BadValue: one is not valid.
        """
        given = dict(zip(self.names, map(float, values), strict=True))
        system = self.system
        if self.of_robot:
            system = self._with_robot(given.pop(self.names[-1]))
        return with_parameters(system, given)

    @cached_property
    def _with_robot(self) -> Callable[[float], HybridSystem]:
        """Returns the system with another value of the robot's number."""
        return lru_cache(KEPT)(lambda value: with_numbers(self.system, {self.names[-1]: value}))

    def values(self) -> list[float]:
        """Returns the values of the numbers in the system itself."""
        return [number(self.system, name) for name in self.names]

    def run(self, q: Array, v: Array, values: Array) -> Cycles:
        """Runs one cycle from each state with its values of the numbers, (m, k)."""
        if self._in_lanes:
            return self._by_lanes(q, v, values)
        if self.differentiable and not self.measures:
            return _joined([self._recorded(*each) for each in zip(q, v, values, strict=True)])
        return self.by_reference(np.arange(len(q)), q, v, values)

    def _recorded(self, q: Array, v: Array, values: Array) -> Cycles:
        """Runs a cycle as those with derivatives are run, or by the reference engine where it does not close so."""
        with LOCK:
            lap = attempt(lambda: self.recorder(values).lap(np.concatenate([q, v])))
        if lap is None:
            return self.by_reference(np.arange(1), q[None], v[None], values[None])
        durations = {phase: np.array([lap.spent.get(phase, 0.0)]) for phase in self.system.phases}
        after, nothing, reason = lap.y[None], np.empty((1, 0)), np.array([""], dtype=object)
        ends = after[:, : len(q)], after[:, len(q) :]
        return Cycles(*ends, nothing, durations, reason, np.zeros(1, dtype=bool), [lap.order])

    @cached_property
    def differentiable(self) -> bool:
        """Whether exact derivatives are known for such systems and measures."""
        known = has_lanes(self.system, self._own) if self.system.robot.planar else may_vary(self.system, ())
        return known and all(isinstance(name, str) for name in self.measures)

    def seeds(self, values: Array) -> Seeds:
        """Returns the derivatives of the systems' numbers by the named ones, which the robot's number alone changes."""
        return seeds(self.member(values.tolist()), self.names) if self.of_robot else self._seeds

    @cached_property
    def _seeds(self) -> Seeds:
        return seeds(self.system, self.names)

    def recorder(self, values: Array) -> Recorder:
        """Returns what runs and records the cycles of a member."""
        if self.of_robot:
            return Recorder(self.member(values.tolist()))
        given = {name: np.array([value]) for name, value in zip(self.names, values.tolist(), strict=True)}
        return Recorder(self.system, many(self.system, given))

    @cached_property
    def _in_lanes(self) -> bool:
        """Whether lanes, which are faster, can run the cycles."""
        return has_lanes(self.system, self._own) and all(measure in MEASURES for measure in self.measures)

    @property
    def _own(self) -> tuple[str, ...]:
        """Names of the numbers that do not belong to the robot."""
        return self.names[:-1] if self.of_robot else self.names

    def _by_lanes(self, q: Array, v: Array, values: Array) -> Cycles:
        parts, chosen = list[Cycles](), list[NDArray[np.int64]]()
        last = values[:, -1] if self.of_robot else np.zeros(len(q))
        for value in np.unique(last):
            same = np.flatnonzero(last == value)
            for lanes in np.split(same, range(FEW, len(same), FEW)):  # more lanes do not keep the order of events
                chosen.append(lanes)
                parts.append(self._few(q[lanes], v[lanes], values[lanes]))
        back, found = np.argsort(np.concatenate(chosen)), _joined(parts)
        durations = {phase: seconds[back] for phase, seconds in found.durations.items()}
        orders, reason, reference = [found.orders[i] for i in back], found.reason[back], found.reference[back]
        return Cycles(found.q[back], found.v[back], found.measured[back], durations, reason, reference, orders)

    def _few(self, q: Array, v: Array, values: Array) -> Cycles:
        system = self.system
        if self.of_robot:
            system, values = self._with_robot(float(values[0, -1])), values[:, :-1]
        run = LaneCycles(system, {}, self._own, [str(name) for name in self.measures], self.rtol)
        return run(np.arange(len(q)), q, v, values)

    @cached_property
    def by_reference(self) -> Cycle:
        """Cycles by the reference engine, one after the other."""

        def cycle(begun: State, values: Array) -> Run:
            result = return_map(self.member(values.tolist()), begun, self.rtol)
            self.watch(result)
            return result

        def measured(measure: Callable[[HybridSystem, Run], float]) -> Callable[[Run, Array], float]:
            return lambda result, values: measure(self.member(values.tolist()), result)

        return one_by_one(self.system, cycle, [measured(measure) for measure in self.of_runs])

    @cached_property
    def of_runs(self) -> list[Callable[[HybridSystem, Run], float]]:
        """The measures of a member and the run of its cycle."""
        return [measure_of(self.system, name) for name in self.measures]


def _joined(parts: Sequence[Cycles]) -> Cycles:
    """Returns the cycles of all parts, in their order."""
    durations = {phase: np.concatenate([each.durations[phase] for each in parts]) for phase in parts[0].durations}
    q, v, measured, reason, reference = (
        np.concatenate([getattr(each, name) for each in parts])
        for name in ("q", "v", "measured", "reason", "reference")
    )
    return Cycles(q, v, measured, durations, reason, reference, [order for each in parts for order in each.orders])
