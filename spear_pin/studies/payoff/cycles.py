"""Cycles of one leg as functions of numbers: their cost, and how far each is from a hop with the wanted flight time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.tangent_cycles import TangentCycles, tangent_cycles
from spear_pin.hybrid.arc import motion_of
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.newton import Lanes
from spear_pin.hybrid.parameters import changed, parameter, rebuilt, with_parameters
from spear_pin.hybrid.result import EVALUATIONS, Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.shooting import Cycles as Closing
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.simulate import sample
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.scale import scale_of

FLIGHT = "flight_time"
LIFT_OFF = "lift_off"  # of which a hop has one: a toe that leaves again as it lands makes the cycle jump
STEP = 1e-4  # of differences, of the unknowns in their units
ANGLE, RATE, SHARE = 0.1, 1.0, 0.1  # units of the state, in rad and 1/√(l/g), and of a range
CLOSED = 1e-4  # gap of a hop, in units: of its cost a hundredth of what samples leave open
REACH = 1.5  # units from one hop to the next at most
ROUNDS = 30  # of the search for a first hop
OVER = 2e-3  # of a limit: it is kept


@dataclass(frozen=True)
class Task:
    """What to minimise.

    Attributes:
        flight_time: wanted flight time, in s.
        cost: returns the cost for a system and a cycle; the cycle's samples count.
        spare: returns for the same what remains of limits, as shares of them, each >= 0 where the limit holds.
        ranges: least and most of the stance torque and of each chosen number of law or spring.
        samples: number of samples of each phase.
        tolerance: tolerance of the optimiser for the cost.
        rtol: relative tolerance of the integrator in the search.
    """

    flight_time: float
    cost: Callable[[HybridSystem, Trajectory], float]
    spare: Callable[[HybridSystem, Trajectory], Array]
    ranges: Mapping[str, tuple[float, float]]
    samples: int
    tolerance: float
    rtol: float


@dataclass(frozen=True)
class Cycle:
    """A cycle: its cost, what remains of limits, and its gap to a hop with the wanted flight time, in units."""

    cost: float
    gap: Array
    spare: Array

    @property
    def fits(self) -> bool:
        """Whether the cycle keeps within limits."""
        return bool(self.spare.min(initial=0.0) > -OVER)


@dataclass
class Cycles:
    """Cycles by their unknowns, each in a unit of about its size: state, stance torque, and the chosen numbers."""

    task: Task
    system: HybridSystem
    state: State
    chart: Chart

    @cached_property
    def solved(self) -> int:
        """Number of unknowns that the gap determines; the chosen numbers come after."""
        return self.chart.dimension + 1

    @cached_property
    def units(self) -> Array:
        """Units of the unknowns."""
        dq, dv = self.chart.q_basis.shape[1], self.chart.v_basis.shape[1]
        rate = RATE / scale_of(self.system.robot).time
        spans = SHARE * np.ptp(np.array(list(self.task.ranges.values())), axis=1)
        return np.concatenate([np.full(dq, ANGLE), np.full(dv, rate), spans])

    @cached_property
    def bounds(self) -> Array:
        """Least and most of the unknowns, (n, 2)."""
        d = self.chart.dimension
        ends = np.array(list(self.task.ranges.values())) / self.units[d:, None]
        return np.concatenate([np.full((d, 2), [-np.inf, np.inf]), ends])

    def begun(self, x: Array) -> tuple[HybridSystem, State]:
        """Returns the system and the state for unknowns."""
        d, values = self.chart.dimension, self.units * x
        named = dict(zip(self.task.ranges, values[d:].tolist(), strict=True))
        return with_values(self.system, named), self.chart.state(values[:d])

    def at(self, x: Array) -> Cycle | None:
        """Returns the cycle for unknowns; None where there is none that a search can use.

        It may not close, its toe may leave the ground more than once, or the fast engine may refuse it.
        """
        task, d = self.task, self.chart.dimension
        try:
            system, state = self.begun(x)
            exact = self._exact
            ended = self._run(system, state) if exact is None else self._recorded(exact, x, system, state)
        except SpearError:  # a toe below the ground
            return None
        if ended is None:
            return None
        trajectory = sample(system, ended, task.samples)
        moved = self.chart.coordinates(ended.state) - self.chart.coordinates(state)
        gap = np.append(moved / self.units[:d], ended.durations["flight"] / task.flight_time - 1.0)
        return Cycle(task.cost(system, trajectory), gap, task.spare(system, trajectory))

    def _recorded(self, exact: TangentCycles, x: Array, system: HybridSystem, state: State) -> Run | None:
        """Returns the cycle by the fast engine; None where that refuses it, or its toe leaves more than once."""
        record = exact.record(*state, (self.units * x)[self.chart.dimension :])
        if record is None or [name for _, name in record.order].count(LIFT_OFF) != 1:
            return None
        return motion_of(system.domains, state, record)

    def _run(self, system: HybridSystem, state: State) -> Run | None:
        """Returns the cycle by the reference engine; None where it does not close, or its toe leaves more than once."""
        ended = run(system, state, 1, Options(self.task.rtol, max_evaluations=EVALUATIONS, keep=True))
        leaves = sum(event.name == LIFT_OFF for event in ended.events)
        return ended if ended.cycles and leaves == 1 else None

    def glance(self, x: Array) -> tuple[Array, Array] | None:
        """Returns the gap and its derivatives by the fast engine; None where the cycle has none."""
        if self._shooting is None:
            return None
        lane, unknowns, d = np.zeros(1, dtype=np.int64), (self.units * x)[None], self.chart.dimension
        (gap,), (reason,) = self._shooting.residuals(lane, unknowns)
        if reason:
            return None
        rows = np.append(self.units[:d], self.task.flight_time)
        slopes = self._shooting.jacobians(lane, unknowns)[0] * self.units / rows[:, None]
        return (gap / rows, slopes) if np.isfinite(slopes).all() else None

    @cached_property
    def _exact(self) -> TangentCycles | None:
        """Cycles with exact derivatives; None where nothing compiles them."""
        tied = self.system if self.system.spring.rest is None else changed(self.system, AtTouchdown())
        return tangent_cycles(tied, tuple(self.task.ranges), (FLIGHT,))

    @cached_property
    def _shooting(self) -> Shooting | None:
        """Equations of a hop with its flight time, with exact derivatives; None where nothing compiles them."""
        exact = self._exact
        if exact is None:
            return None

        def cycle(lanes: Lanes, q: Array, v: Array, values: Array) -> Closing:
            return exact.one(q[0], v[0], values[0]) or Closing(
                np.full_like(q, np.nan),
                np.full_like(v, np.nan),
                np.full((1, 1), np.nan),
                {},
                np.array(["no derivative"], dtype=object),
                np.zeros(1, dtype=bool),
            )

        wanted = np.array([[self.task.flight_time]])
        return Shooting(self.chart.lane, cycle, exact.vary, wanted, exact.slopes)

    def jacobian(self, x: Array, own: Cycle) -> Array:
        """Returns derivatives of the gap, exact or by differences to either side; 0 where there is neither."""
        seen = self.glance(x)
        if seen is not None:
            return seen[1]
        columns = []
        for i, (_, most) in enumerate(self.bounds):
            first = STEP if x[i] + STEP <= most else -STEP
            for step in (first, -first):
                beside = self.at(x + step * (np.arange(len(x)) == i))
                if beside is not None:
                    break
            columns.append(np.zeros(len(own.gap)) if beside is None else (beside.gap - own.gap) / step)
        return np.array(columns).T

    def first(self) -> Array:
        """Returns unknowns of a wanted hop, with the least change of the given ones in the sense of least squares.

        Raises:
            NoGait: there is no such hop.
        """
        given = np.array([parameter(self.system, name) for name in self.task.ranges])
        x = np.concatenate([np.zeros(self.chart.dimension), given]) / self.units
        x, own = np.clip(x, *self.bounds.T), None
        own = self.at(x)
        if own is None:
            raise NoGait("the first cycle of the search does not close", np.inf)
        for _ in range(ROUNDS):
            if np.abs(own.gap).max() < CLOSED:
                return x
            step = self._correction(x, own)
            step *= min(1.0, REACH / np.abs(step).max())
            for share in 0.5 ** np.arange(6):
                moved = np.clip(x + share * step, *self.bounds.T)
                other = self.at(moved)
                if other is not None and np.linalg.norm(other.gap) < (1.0 - 0.2 * share) * np.linalg.norm(own.gap):
                    x, own = moved, other
                    break
            else:
                break
        raise NoGait("no hop near the start has this flight time", float(np.abs(own.gap).max()))

    def _correction(self, x: Array, own: Cycle) -> Array:
        """Returns the least step that closes the gap to first order, along the bounds that it would cross."""
        gap = self.jacobian(x, own)
        free = np.ones(len(x), dtype=bool)
        while True:
            step = np.zeros(len(x))
            step[free] = -np.linalg.pinv(gap[:, free], rcond=1e-6) @ own.gap
            crossing = (np.clip(x, *self.bounds.T) == x) & (np.clip(x + step, *self.bounds.T) == x) & (step != 0.0)
            if not crossing.any() or free.sum() - crossing.sum() < len(own.gap):
                return step
            free &= ~crossing


@dataclass(frozen=True)
class AtTouchdown:
    """A change that puts the rest of a fixed spring at the angle where the law lets the knee land."""

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with such a spring."""
        return replace(system, domains=tuple(map(self._domain, system.domains)))

    def _domain(self, domain: Domain) -> Domain:
        return replace(domain, guards=tuple(map(self._guard, domain.guards)))

    def _guard(self, guard: Guard) -> Guard:
        return guard if guard.reset is None else replace(guard, reset=self._reset(guard.reset))

    def _reset(self, reset: Reset) -> Reset:
        latch = reset.latch
        if latch is None or reset.phase != "stance":
            return reset

        def landed(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
            return {**latch(q, v, held, p), "knee_touchdown": p.knee_touchdown}

        return replace(reset, latch=landed)


def with_values(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns the system with other numbers; a spring that never releases rests where the knee lands."""
    changed = with_parameters(system, values)
    if changed.spring.rest is None:
        return changed
    return rebuilt(changed, spring=replace(changed.spring, rest=changed.law.knee_touchdown))
