"""Two ways to follow a motion from section to section and to find a nearby periodic one: with and without heyoka."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.gaits.attempts import WHY
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.gait_table import CONVERGED, REASONS
from spear_pin.gaits.lane_cycles import LaneCycles, multipliers
from spear_pin.gaits.many import find_many
from spear_pin.gaits.search import find_gait, gait_beside
from spear_pin.gaits.tolerances import TOLERANCE
from spear_pin.hybrid import batch
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import section
from spear_pin.hybrid.shooting import Cycles, Shooting
from spear_pin.studies.explore.knobs import Knobs

RTOL = 1e-9
CALLS = 13  # of the engine, in which Newton's method has to end
LATE = "Newton's method takes longer than a few seconds"


class Solve(Protocol):
    """Solver for the periodic motion near a state, with varied parameters and targets; gives None if there is none."""

    def __call__(
        self, knobs: Knobs, state: State, vary: Sequence[str] = (), target: Mapping[str, float] | None = None
    ) -> Gait | None:
        """Returns the gait."""


class Beside(Protocol):
    """Solver for the periodic motion near a state by Newton's method from there alone, from given parameters.

    Raises:
        NoGait: it does not end in one, or not before the time `until`, by `time.perf_counter`.
    """

    def __call__(
        self, knobs: Knobs, state: State, vary: Mapping[str, float], target: Mapping[str, float], until: float
    ) -> Gait:
        """Returns the gait."""


@dataclass(frozen=True)
class Engine:
    """Functions that follow motions and solve for periodic ones.

    Attributes:
        name: name of the engine.
        extra: the extra of the package that it needs, if it needs one.
        advance: returns the state some cycles after another on the section, and how many cycles the run completed.
        solve: returns the periodic motion near a state on the section, or None.
        beside: returns the periodic motion near another.
    """

    name: str
    extra: str | None
    advance: Callable[[Knobs, State, int], tuple[State, int]]
    solve: Solve
    beside: Beside


def _advance_lane(knobs: Knobs, state: State, cycles: int) -> tuple[State, int]:
    if not cycles:
        return state, 0
    system, numbers = knobs.subject.lane(knobs.values)
    parameters = {name: [value] for name, value in numbers.items()}
    batch = simulate_many(system, state[0][None], state[1][None], cycles, parameters=parameters)
    return (batch.q[0], batch.v[0]), int(batch.cycles[0])


def _solve_lane(
    knobs: Knobs, state: State, vary: Sequence[str] = (), target: Mapping[str, float] | None = None
) -> Gait | None:
    system, numbers = knobs.subject.lane(knobs.values)
    table = find_many(system, {name: [value] for name, value in numbers.items()}, vary, target, guess=state)
    if not table.converged[0]:
        return None
    durations = {phase: float(seconds[0]) for phase, seconds in table.durations.items()}
    solved = {name: float(table.parameters[name][0]) for name in vary}
    found = table.q[0], table.v[0]
    own = with_parameters(knobs.system, solved)
    return Gait(own, found, solved, float(table.residual[0]), table.multipliers[0], durations)


@dataclass(frozen=True)
class _Either(LaneCycles):
    """Cycles by whichever engine runs them; if both do, multipliers differ in the fourth decimal.

    Attributes:
        until: time at which to give up, by `time.perf_counter`.
        ended: reasons why cycles did not close, the latest last.
    """

    until: float = math.inf
    ended: list[str] = field(default_factory=list)

    def __call__(self, lanes: NDArray[np.int64], q: Array, v: Array, values: Array) -> Cycles:
        if time.perf_counter() > self.until:
            raise NoGait(self.said(LATE), np.inf)
        cycles = super().__call__(lanes, q, v, values)
        self.ended.extend(cycles.reason[cycles.reason != ""])
        return replace(cycles, reference=np.zeros_like(cycles.reference))

    def said(self, why: str) -> str:
        """Returns why there is no gait, with the reason why the last cycle near it did not close."""
        return f"{why}; near it {REASONS[self.ended[-1]]}" if self.ended else why


def _beside_lane(
    knobs: Knobs, state: State, vary: Mapping[str, float], target: Mapping[str, float], until: float
) -> Gait:
    system, numbers = knobs.subject.lane(knobs.values)
    fixed = {name: np.array([value]) for name, value in numbers.items() if name not in vary}
    cycle = _Either(system, fixed, tuple(vary), tuple(target), RTOL, until=until)
    ground = section(system, fixed)
    q, v = state[0][None], state[1][None]
    slides = ground.sliding(q, v)[0]
    charts = ground.charts(q, v, slides)
    shooting = Shooting(charts, cycle, tuple(vary), np.array([list(target.values())]))
    roots = shooting.solve(np.array([list(vary.values())]), TOLERANCE, CALLS)
    if roots.end[0] != CONVERGED:
        why = WHY[roots.end[0]].format(n=roots.iteration[0])
        raise NoGait(cycle.said(why), float(roots.norm[0]))
    q, v = shooting.states(np.zeros(1, dtype=np.int64), roots.x)
    found = multipliers(cycle, ground.charts(q, v, slides), roots.x[:, charts.dimension :])
    if found.reason[0] != CONVERGED:
        raise NoGait(REASONS[found.reason[0]], float(found.residual[0]))
    solved = dict(zip(vary, roots.x[0, charts.dimension :].tolist(), strict=True))
    durations = {phase: float(seconds[0]) for phase, seconds in found.durations.items()}
    own = with_parameters(knobs.system, solved)
    return Gait(own, (q[0], v[0]), solved, float(found.residual[0]), found.multipliers[0], durations)


def _advance_run(knobs: Knobs, state: State, cycles: int) -> tuple[State, int]:
    if not cycles:
        return state, 0
    result = run(knobs.system, state, cycles, Options())
    return result.state, result.cycles


def _solve_run(
    knobs: Knobs, state: State, vary: Sequence[str] = (), target: Mapping[str, float] | None = None
) -> Gait | None:
    try:
        return find_gait(knobs.system, vary, target, guess=state)  # type: ignore[arg-type]
    except NoGait:
        return None


def _beside_run(
    knobs: Knobs, state: State, vary: Mapping[str, float], target: Mapping[str, float], until: float
) -> Gait:
    if time.perf_counter() > until:
        raise NoGait(LATE, np.inf)
    return gait_beside(with_parameters(knobs.system, vary), state, list(vary), target, RTOL)


TAYLOR = Engine("Taylor", "fast", _advance_lane, _solve_lane, _beside_lane)
REFERENCE = Engine("reference", None, _advance_run, _solve_run, _beside_run)


def best_engine() -> Engine:
    """Returns the fastest engine that is installed."""
    return TAYLOR if batch.available() else REFERENCE
