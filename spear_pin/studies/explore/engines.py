"""Two ways to follow a motion from section to section: with and without heyoka."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from spear_pin.hybrid import batch
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.result import Options, State
from spear_pin.hybrid.run import run
from spear_pin.studies.explore.knobs import Knobs


@dataclass(frozen=True)
class Engine:
    """A function that follows motions.

    Attributes:
        name: name of the engine.
        extra: the extra of the package that it needs, if it needs one.
        advance: returns the state some cycles after another on the section, and how many cycles the run completed.
    """

    name: str
    extra: str | None
    advance: Callable[[Knobs, State, int], tuple[State, int]]


def _advance_lane(knobs: Knobs, state: State, cycles: int) -> tuple[State, int]:
    found = simulate_many(knobs.system, state[0][None], state[1][None], cycles)
    return (found.q[0], found.v[0]), int(found.cycles[0])


def _advance_run(knobs: Knobs, state: State, cycles: int) -> tuple[State, int]:
    result = run(knobs.system, state, cycles, Options())
    return result.state, result.cycles


TAYLOR = Engine("Taylor", "fast", _advance_lane)
REFERENCE = Engine("reference", None, _advance_run)


def best_engine() -> Engine:
    """Returns the fastest engine that is installed."""
    return TAYLOR if batch.available() else REFERENCE
