"""Tasks to compute: cycles from a few states on the section, and where they end at the finest tolerance."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np

from spear_pin import Gait, find_gait, hopping, load, simulate
from spear_pin.arrays import Array
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run

FINEST = 1e-12
AGREES = 1e-6  # of the end state's largest component, in m, rad, m/s, rad/s
STATES = 5  # that every lane runs: the fixed point and four more
CHECKED = 16  # lanes of a batch that are compared


class Absent(Exception):
    """A peer that cannot be run here; the text says why."""


@dataclass(frozen=True)
class Lane:
    """One way to compute cycles.

    Attributes:
        name: what computes.
        settings: at which tolerances, and how.
        call: computes some cycles and returns where they end, (n, 2 nv).
        cycles: number of cycles a call computes.
        clock: CPU seconds of so many calls, where the lane takes its own time.
        note: what is to be said of the last call.
        first: where the first cycles end, if that is not what `call` returns.
    """

    name: str
    settings: str
    call: Callable[[], Array]
    cycles: int = STATES
    clock: Callable[[int], float] | None = None
    note: Callable[[], str] = lambda: ""
    first: Callable[[], Array] | None = None

    def seconds(self, calls: int) -> float:
        """CPU time of so many calls."""
        if self.clock is not None:
            return self.clock(calls)
        begin = time.process_time()
        for _ in range(calls):
            self.call()
        return time.process_time() - begin


@dataclass(frozen=True)
class Task:
    """Cycles of a gait from states on the section, (n, nq) and (n, nv), the fixed point first."""

    gait: Gait
    q: Array
    v: Array

    @cached_property
    def ends(self) -> Array:
        """Where the first cycles end."""
        return np.array([self.end(FINEST, i) for i in range(min(len(self.q), CHECKED))])

    def end(self, rtol: float, i: int) -> Array:
        """Where the cycle from a state ends, by the reference engine."""
        result = run(self.gait.system, (self.q[i], self.v[i]), 1, Options(rtol))
        assert result.reason == "complete", result.message
        return np.concatenate(result.state)

    def at(self, i: int) -> Gait:
        """The gait with a state of the task in place of its own."""
        return replace(self.gait, state=(self.q[i], self.v[i]))

    def error(self, ends: Array) -> float:
        """The largest difference from where the cycles end."""
        return float(np.abs(ends - self.ends[: len(ends)]).max())


@cache
def hop(lanes: int = STATES) -> Task:
    """The hop of SPEAR-II in place with 0.2 s of flight; perturbed ones keep its order of events."""
    robot = load("spear_ii", locked=["boom_x"])
    gait = find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2}, rtol=FINEST)
    return _around(gait, lanes, np.array([0.02, 0.1, 0.1]))


@cache
def bound(lanes: int = STATES, shipped: str = "long_stride") -> Task:
    """The bounding stride from states off the zero dynamics: landing leg and torso are all perturbed."""
    gait = Gait.load(shipped)
    size = chart(gait.system, gait.state).dimension
    return _around(gait, lanes, np.full(size, 2e-3))


@cache
def bound_on(lanes: int = STATES) -> Task:
    """The bounding stride from states a stride later: outputs are zero to rounding, as they are on the gait."""
    off = bound(lanes)
    later = simulate_many(off.gait.system, off.q, off.v, 1, 1e-10)
    complete = later.reason == "complete"
    q, v = np.where(complete[:, None], later.q, off.q[0]), np.where(complete[:, None], later.v, off.v[0])
    q[:, 0] = 0.0
    return Task(off.gait, q, v)


def _around(gait: Gait, lanes: int, size: Array) -> Task:
    local, rng = chart(gait.system, gait.state), np.random.default_rng(3)
    shifts = [np.zeros(len(size)), *(rng.uniform(-1.0, 1.0, (lanes - 1, len(size))) * size)]
    states = [local.state(xi) for xi in shifts]
    return Task(gait, np.array([q for q, _ in states]), np.array([v for _, v in states]))


def reference(task: Task, rtol: float, sampled: bool = False) -> Lane:
    """Our reference engine: the core of `simulate`, or with `sampled` all of it."""

    def call() -> Array:
        if not sampled:
            return np.array([task.end(rtol, i) for i in range(STATES)])
        states = zip(task.q[:STATES], task.v[:STATES], strict=True)
        runs = [simulate(task.gait.system, state, 1, rtol, progress=False) for state in states]
        last = [cycle.named(task.gait.system.section)[-1] for cycle in runs]
        return np.array([np.concatenate([event.q, event.v]) for event in last])

    return Lane("`simulate`" if sampled else "`simulate`, unsampled", f"rtol {rtol:.0e}", call)


def taylor(task: Task, lanes: int, rtol: float, where: str = "", cycles: int = 1, unroll: bool | None = None) -> Lane:
    """Our Taylor engine: `simulate_many`; with one lane, call by call."""
    system, calls = task.gait.system, STATES if lanes == 1 else 1
    repeated = 0

    def run_all(cycles: int) -> Array:
        nonlocal repeated
        groups = [slice(i, i + lanes) for i in range(calls)]
        batches = [simulate_many(system, task.q[part], task.v[part], cycles, rtol, unroll=unroll) for part in groups]
        repeated = sum(int(batch.repeated.sum()) for batch in batches)
        ends = np.concatenate([np.concatenate([batch.q, batch.v], axis=1) for batch in batches])
        return ends[:CHECKED]

    def note() -> str:
        return ", ".join(
            filter(None, [where, "unrolled" if unroll else "", f"{repeated} repeated" if repeated else ""])
        )

    name = f"`simulate_many`, {lanes} lane{'s'[: lanes > 1]}" + (f", {cycles} cycles" if cycles > 1 else "")
    return Lane(
        name,
        f"rtol {rtol:.0e}",
        lambda: run_all(cycles),
        lanes * calls * cycles,
        note=note,
        first=lambda: run_all(1),
    )
