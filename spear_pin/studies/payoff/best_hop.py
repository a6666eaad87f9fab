"""The hop of least cost, sought among fixed points: every iterate is a hop, as long in the air as is wanted.

The numbers of law and spring that are chosen are unknowns of SLSQP; for each of its trial points Newton's method gives
the state and the stance torque, from the nearest hop that is known along its tangent. Derivatives are differences of
cycles and the implicit function theorem. What comes out is made a fixed point to the last digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, rebuilt, with_parameters
from spear_pin.hybrid.periodic import EVALUATIONS, chart
from spear_pin.hybrid.result import Options, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import Chart
from spear_pin.hybrid.simulate import sample, simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.scale import scale_of

Array = NDArray[np.float64]
LIFT_OFF = "lift_off"  # of which a hop has one: a toe that leaves again as it lands makes the cycle jump
TORQUE = "stance_torque"  # what is solved for the flight time
STEP = 1e-4  # of differences, of the unknowns in their units
ANGLE, RATE, SHARE = 0.1, 1.0, 0.1  # units of the state, in rad and 1/√(l/g), and of a range
FAR = 10.0  # of the units: the gap where no cycle closes
BAD = 1e2  # the cost where there is no hop, of that of the start
CLOSED = 1e-6  # gap of a hop, in units
CORRECTIONS = 8  # by Newton's method with the tangent of a hop nearby
REACH = 1.5  # units from one hop to the next at most
LEAP = 0.08  # of the logarithm of a flight time
OVER = 2e-3  # of a limit: it is kept
DEARER, OTHERS = 2e-3, 8  # of the cost: hops that are tried where there is no fixed point beside the cheapest
ITERATIONS, ROUNDS = 40, 30  # of the optimiser, of the search for a first hop


@dataclass(frozen=True)
class Task:
    """What is minimised.

    Attributes:
        flight_time: wanted, in s.
        cost: of a system and a cycle; its samples count.
        spare: of the same, what is left of limits, as shares of them, each >= 0 where it is kept.
        ranges: of the stance torque and each number of law or spring that is chosen, least and most.
        samples: of each phase.
        tolerance: of the optimiser, of the cost.
        rtol: of the integrator meanwhile.
    """

    flight_time: float
    cost: Callable[[HybridSystem, Trajectory], float]
    spare: Callable[[HybridSystem, Trajectory], Array]
    ranges: Mapping[str, tuple[float, float]]
    samples: int
    tolerance: float
    rtol: float


def best_hop(task: Task, system: HybridSystem, state: State) -> Gait:
    """The hop of least cost that is found from a state which is near a fixed point of a system.

    Raises:
        NoGait: none was found.
    """
    cycles = Cycles(task, system, state, chart(system, state))
    hops = _Hops(cycles, cycles.first())
    y = hops.start
    scipy.optimize.minimize(
        lambda y: hops.at(y).cost,
        y,
        jac=lambda y: hops.slopes(y)[0],
        bounds=cycles.bounds[cycles.solved :],
        constraints=[{"type": "ineq", "fun": lambda y: hops.at(y).spare, "jac": lambda y: hops.slopes(y)[1]}],
        method="SLSQP",
        options={"ftol": task.tolerance, "maxiter": ITERATIONS},
    )
    failures = []
    for x in hops.cheapest():
        try:
            gait = gait_beside(*cycles.begun(x), [TORQUE], {"flight_time": task.flight_time})
        except NoGait as error:  # on the brink of hops whose toe does not leave the ground
            failures.append(error)
            continue
        cycle = simulate(gait.system, gait.state, samples=task.samples, progress=False)
        left = task.spare(gait.system, cycle).min(initial=0.0)
        if left >= -2 * OVER:
            return gait
        failures.append(NoGait(f"beside it a limit is exceeded by {-100 * left:.2g} %", gait.residual))
    raise failures[0]


def led(task: Task, system: HybridSystem, state: State, flight_time: float) -> tuple[HybridSystem, State]:
    """A system and a state with about the flight time of a task, from those of another one by small steps.

    Raises:
        NoGait: the way ends before.
    """
    steps = math.ceil(abs(math.log(task.flight_time / flight_time)) / LEAP)
    for wanted in np.geomspace(flight_time, task.flight_time, steps + 1)[1:]:
        cycles = Cycles(replace(task, flight_time=float(wanted)), system, state, chart(system, state))
        system, state = cycles.begun(cycles.first())
    return system, state


@dataclass(frozen=True)
class _Cycle:
    """A cycle: its cost, what is left of limits, and by how much it is no hop as is wanted, in units."""

    cost: float
    gap: Array
    spare: Array

    @property
    def fits(self) -> bool:
        return bool(self.spare.min(initial=0.0) > -OVER)


@dataclass
class Cycles:
    """Cycles by their unknowns, each in a unit of about its size: the state, the stance torque, and what is chosen."""

    task: Task
    system: HybridSystem
    state: State
    chart: Chart

    @cached_property
    def solved(self) -> int:
        """How many unknowns the gap gives; those that are chosen come after."""
        return self.chart.dimension + 1

    @cached_property
    def units(self) -> Array:
        """Of the unknowns."""
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
        """The system and the state of unknowns."""
        d, values = self.chart.dimension, self.units * x
        named = dict(zip(self.task.ranges, values[d:].tolist(), strict=True))
        return with_values(self.system, named), self.chart.state(values[:d])

    def at(self, x: Array) -> _Cycle | None:
        """The cycle of unknowns; None where it does not close, or its toe leaves the ground more than once."""
        task, d = self.task, self.chart.dimension
        try:
            system, state = self.begun(x)
            ended = run(system, state, 1, Options(task.rtol, max_evaluations=EVALUATIONS, keep=True))
        except SpearError:  # a toe below the ground
            return None
        if not ended.cycles or sum(event.name == LIFT_OFF for event in ended.events) != 1:
            return None
        trajectory = sample(system, ended, task.samples)
        xi = self.chart.coordinates(ended.state) / self.units[:d] - x[:d]
        gap = np.append(xi, ended.durations["flight"] / task.flight_time - 1.0)
        return _Cycle(task.cost(system, trajectory), gap, task.spare(system, trajectory))

    def slopes(self, x: Array, own: _Cycle) -> tuple[Array, Array, Array]:
        """Derivatives of cost, gap and what is spared, by differences to either side; 0 where there is neither."""
        columns = []
        for i, (_, most) in enumerate(self.bounds):
            first = STEP if x[i] + STEP <= most else -STEP
            for step in (first, -first):
                beside = self.at(x + step * (np.arange(len(x)) == i))
                if beside is not None:
                    break
            other, step = (own, 1.0) if beside is None else (beside, step)
            pairs = (other.cost, own.cost), (other.gap, own.gap), (other.spare, own.spare)
            columns.append([(np.asarray(after) - before) / step for after, before in pairs])
        cost, gap, spare = (np.array(part).T for part in zip(*columns, strict=True))
        return cost, gap, spare

    def first(self) -> Array:
        """Unknowns of a hop as is wanted, with as little change to what is given as least squares take.

        Raises:
            NoGait: there is none.
        """
        given = np.array([parameter(self.system, name) for name in self.task.ranges])
        x = np.concatenate([np.zeros(self.chart.dimension), given]) / self.units
        x, own = np.clip(x, *self.bounds.T), None
        own = self.at(x)
        if own is None:
            raise NoGait("the cycle that the search begins with does not close", np.inf)
        for _ in range(ROUNDS):
            if np.abs(own.gap).max() < CLOSED:
                return x
            _, gap, _ = self.slopes(x, own)
            step = -np.linalg.pinv(gap, rcond=1e-6) @ own.gap
            step *= min(1.0, REACH / np.abs(step).max())
            for share in 0.5 ** np.arange(6):
                moved = np.clip(x + share * step, *self.bounds.T)
                other = self.at(moved)
                if other is not None and np.linalg.norm(other.gap) < (1.0 - 0.2 * share) * np.linalg.norm(own.gap):
                    x, own = moved, other
                    break
            else:
                break
        raise NoGait("no hop with such a flight is near", float(np.abs(own.gap).max()))


@dataclass(frozen=True)
class _Hop:
    """A hop by what is chosen: its unknowns, its cycle, and once asked for the tangent there."""

    x: Array
    cycle: _Cycle


@dataclass
class _Hops:
    """Hops by what is chosen, each solved for from the nearest one whose tangent is known."""

    cycles: Cycles
    x: Array  # of the first one
    known: dict[bytes, _Hop | None] = field(default_factory=dict)
    tangents: list[tuple[Array, Array, Array, Array, Array]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.start = self.x[self.cycles.solved :]
        cycle = self.cycles.at(self.x)
        assert cycle is not None
        self.unit, self.limits = cycle.cost or 1.0, len(cycle.spare)
        self.known[self.start.tobytes()] = _Hop(self.x, cycle)
        self.slopes(self.start)

    def at(self, y: Array) -> _Cycle:
        """The cycle, its cost over that of the start."""
        hop = self._hop(y)
        if hop is None:
            return _Cycle(BAD, np.array([FAR]), np.full(self.limits, -1.0))
        return replace(hop.cycle, cost=hop.cycle.cost / self.unit)

    def slopes(self, y: Array) -> tuple[Array, Array]:
        """Derivatives of the cost and of what is spared along the hops."""
        hop = self._hop(y)
        if hop is None:
            return np.zeros(len(y)), np.zeros((self.limits, len(y)))
        for x, cost, _, spare, along in self.tangents:
            if x is hop.x:
                return cost @ along / self.unit, spare @ along
        n = self.cycles.solved
        cost, gap, spare = self.cycles.slopes(hop.x, hop.cycle)
        along = np.concatenate([-np.linalg.lstsq(gap[:, :n], gap[:, n:], rcond=None)[0], np.eye(len(y))])
        self.tangents.append((hop.x, cost, gap, spare, along))
        return cost @ along / self.unit, spare @ along

    def _hop(self, y: Array) -> _Hop | None:
        key = y.tobytes()
        if key not in self.known:
            self.known[key] = self._solved(y)
        return self.known[key]

    def _solved(self, y: Array) -> _Hop | None:
        """The hop, by Newton's method with the Jacobian of the nearest that has one; None where that leads nowhere."""
        n = self.cycles.solved
        x, _, gap, _, along = min(self.tangents, key=lambda each: float(np.abs(each[0][n:] - y).max()))
        moved = x + along @ (y - x[n:])
        if np.abs(moved - x).max() > 2.0 * REACH:
            return None
        last = np.inf
        for _ in range(CORRECTIONS):
            cycle = self.cycles.at(moved)
            if cycle is None or not (size := float(np.abs(cycle.gap).max())) < last:
                return None
            if size < CLOSED:
                return _Hop(moved, cycle)
            moved = moved.copy()
            moved[:n] -= np.linalg.lstsq(gap[:, :n], cycle.gap, rcond=None)[0]
            last = size
        return None

    def cheapest(self) -> list[Array]:
        """The unknowns of the cheapest hops within limits, each dearer than the one before by more than a little.

        Raises:
            NoGait: there is none.
        """
        fitting = [hop for hop in self.known.values() if hop is not None and hop.cycle.fits]
        if not fitting:
            left = max(float(hop.cycle.spare.min()) for hop in self.known.values() if hop is not None)
            raise NoGait(f"none of the hops keeps to limits of joints and motors, by {-100 * left:.2g} % of one", 0.0)
        chosen: list[_Hop] = []
        for hop in sorted(fitting, key=lambda hop: hop.cycle.cost):
            if not chosen or hop.cycle.cost > (1.0 + DEARER) * chosen[-1].cycle.cost:
                chosen.append(hop)
        return [hop.x for hop in chosen[:OTHERS]]


def with_values(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """The system with other numbers; a spring that is never let go rests where the knee lands."""
    changed = with_parameters(system, values)
    if changed.spring.rest is None:
        return changed
    return rebuilt(changed, spring=replace(changed.spring, rest=changed.law.knee_touchdown))
