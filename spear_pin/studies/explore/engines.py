"""Two ways to follow a hop from touchdown to touchdown and to find the periodic one near: with and without heyoka."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from spear_pin.errors import NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.many import find_many
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.result import Options, State
from spear_pin.hybrid.run import run
from spear_pin.studies.explore.knobs import Knobs


@dataclass(frozen=True)
class Engine:
    """Two functions by which hops are followed and solved for.

    Attributes:
        name: of the engine.
        extra: the extra of the package that it needs, if it needs one.
        advance: the state some hops after another on the section, and how many there were before the run ended.
        solve: the periodic hop near a state on the section, or None.
    """

    name: str
    extra: str | None
    advance: Callable[[Knobs, State, int], tuple[State, int]]
    solve: Callable[[Knobs, State], Gait | None]


@lru_cache(4)
def _template(knee_ratio: float) -> HybridSystem:
    """System that lanes differ from: one with a spring of its own would be compiled again."""
    return Knobs(knee_ratio=knee_ratio).system


def _lane(knobs: Knobs) -> tuple[HybridSystem, dict[str, list[float]]]:
    """A system, and the numbers of its only lane."""
    numbers = {name: [value] for name, value in knobs.values.items() if name != "knee_ratio"}
    return _template(knobs.knee_ratio), numbers


def _advance_lane(knobs: Knobs, state: State, hops: int) -> tuple[State, int]:
    if not hops:
        return state, 0
    system, parameters = _lane(knobs)
    batch = simulate_many(system, state[0][None], state[1][None], hops, parameters=parameters)
    return (batch.q[0], batch.v[0]), int(batch.cycles[0])


def _solve_lane(knobs: Knobs, state: State) -> Gait | None:
    system, parameters = _lane(knobs)
    table = find_many(system, parameters, guess=state)
    if not table.converged[0]:
        return None
    durations = {phase: float(seconds[0]) for phase, seconds in table.durations.items()}
    found = table.q[0], table.v[0]
    return Gait(knobs.system, found, {}, float(table.residual[0]), table.multipliers[0], durations)


def _advance_run(knobs: Knobs, state: State, hops: int) -> tuple[State, int]:
    if not hops:
        return state, 0
    result = run(knobs.system, state, hops, Options())
    return result.state, result.cycles


def _solve_run(knobs: Knobs, state: State) -> Gait | None:
    try:
        return find_gait(knobs.system, guess=state)
    except NoGait:
        return None


TAYLOR = Engine("Taylor", "fast", _advance_lane, _solve_lane)
REFERENCE = Engine("reference", None, _advance_run, _solve_run)


def best_engine() -> Engine:
    """The fastest that is installed."""
    return TAYLOR if taylor.available() else REFERENCE
