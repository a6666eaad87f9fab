"""Turn the hop's numbers and see what becomes of it: the hop that SPEAR-II settles into, or why there is none.

Every answer begins at the same state, that of the hop with the default numbers just after touchdown, and is a function
of the numbers alone. So a hop can be named by them; where two kinds of hops exist side by side, it is the one that the
robot comes to from there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Literal

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.periodic import displacement
from spear_pin.hybrid.result import State
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knobs

SETTLE = 12  # hops before it is asked whether they repeat
LONGEST = 4  # hops of the longest pattern that is looked for
NEAR = 0.01  # m, rad, m/s, rad/s between states that count as the same
SHOWN = 2  # whole hops that are shown before an end, and of what nearly repeats
TRANSIENT = 6  # hops that are shown from the default hop on

Verdict = Literal["periodic", "pattern", "unsettled", "ended", "transient"]


@dataclass(frozen=True)
class Hops:
    """Hops of SPEAR-II, with the verdict on them.

    Attributes:
        knobs: the numbers it does it with.
        verdict: "periodic": each hop repeats the last; "pattern": they repeat in groups; "unsettled": they do not
            repeat; "ended": the run breaks off; "transient": hops from the default hop on, whatever they lead to.
        message: the same in a sentence or two.
        start: the state (q, v), just after touchdown, from which they are shown.
        trajectory: the hops that are shown.
        gait: the periodic hop, with its multipliers.
    """

    knobs: Knobs
    verdict: Verdict
    message: str
    start: State
    trajectory: Trajectory
    gait: Gait | None = None


def settled(knobs: Knobs, engine: Engine) -> Hops:
    """Hops to which the default hop leads, after a dozen of them, when the numbers are changed at once.

    Args:
        knobs: the numbers.
        engine: follows the hops and solves for the periodic one.
    """
    begun, done = engine.advance(knobs, default_state(), SETTLE)
    if done < SETTLE:
        return _ended(knobs, engine, done)
    state = begun
    for length in range(1, LONGEST + 1):
        state, one = engine.advance(knobs, state, 1)
        if not one:
            return _ended(knobs, engine, SETTLE + length - 1)
        if np.abs(displacement(knobs.system, begun, state)).max() < NEAR:
            break
    else:
        text = f"Not settled: {SETTLE} hops after the default hop it does not repeat within {LONGEST} hops."
        return _shown(knobs, "unsettled", text, begun, LONGEST)
    if length > 1:
        hops = _shown(knobs, "pattern", "", state, length)
        text = f"Periodic over {length} hops, not over one: they take {_lasting(hops.trajectory)}."
        return replace(hops, message=text)
    gait = engine.solve(knobs, state)
    if gait is None:
        text = (
            f"Not settled: {SETTLE} hops after the default hop each nearly repeats the last; no periodic hop was found."
        )
        return _shown(knobs, "unsettled", text, begun, SHOWN)
    kind = "stable" if gait.stable else "unstable"
    text = f"Periodic and {kind}: the largest multiplier is {abs(gait.multipliers[0]):.3f}."
    return _shown(knobs, "periodic", text, gait.state, 1, gait)


def transient(knobs: Knobs, engine: Engine) -> Hops:
    """The first hops after the numbers of the default hop are changed at once, just after touchdown."""
    hops = _shown(knobs, "transient", "", default_state(), TRANSIENT)
    text = f"A transient: {_counted(hops.trajectory.cycles)}, touchdown to touchdown, after the default hop."
    if not hops.trajectory.complete:
        text += f" Then it ends: {hops.trajectory.message}."
    return replace(hops, message=text)


VIEWS: Mapping[str, Callable[[Knobs, Engine], Hops]] = MappingProxyType({"settled": settled, "transient": transient})


@lru_cache(1)
def default_state() -> State:
    """Just after touchdown of the periodic hop with the default numbers: where all else begins."""
    return find_gait(Knobs().system).state


def _ended(knobs: Knobs, engine: Engine, done: int) -> Hops:
    """The last whole hops of a run that breaks off after so many, and how it does."""
    skipped = max(0, done - SHOWN)
    start, _ = engine.advance(knobs, default_state(), skipped)
    hops = _shown(knobs, "ended", "", start, done - skipped + 1)
    hopped = f"{_counted(done)} after" if done else "during the first hop after"
    return replace(
        hops,
        message=f"No periodic hop is reached: the run ends {hopped} the default hop. Why: {hops.trajectory.message}.",
    )


def _counted(hops: int) -> str:
    return "1 hop" if hops == 1 else f"{hops} hops"


def _lasting(trajectory: Trajectory) -> str:
    """Seconds of the hops, from touchdown to touchdown, in words."""
    landings = [trajectory.t[0], *(event.time for event in trajectory.named("touchdown"))]
    *others, last = (f"{seconds:.3f}" for seconds in np.diff(landings))
    return f"{', '.join(others)} and {last} s"


def _shown(knobs: Knobs, verdict: Verdict, message: str, start: State, hops: int, gait: Gait | None = None) -> Hops:
    trajectory = simulate(knobs.system, start, hops, progress=False)
    return Hops(knobs, verdict, message, start, trajectory, gait)
