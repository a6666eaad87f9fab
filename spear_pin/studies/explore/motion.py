"""A motion for display after its numbers changed, with the verdict on it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.explore.knobs import Knobs

LONG = 160  # letters: kinds with more are not told

Verdict = Literal["periodic", "pattern", "unsettled", "ended", "transient"]


@dataclass(frozen=True)
class Motion:
    """Cycles of a motion, with the verdict on them.

    Attributes:
        knobs: the numbers of the motion.
        verdict: "periodic": each cycle repeats the last; "pattern": cycles repeat in groups; "unsettled": cycles do not
            repeat; "ended": the run breaks off; "transient": cycles from the default one on, whatever follows.
        message: the verdict in a sentence or two.
        start: state (q, v) on the section at which the displayed cycles begin.
        trajectory: the displayed cycles.
        gait: the periodic gait, with its multipliers.
    """

    knobs: Knobs
    verdict: Verdict
    message: str
    start: State
    trajectory: Trajectory
    gait: Gait | None = None

    @property
    def kind(self) -> str:
        """Events in a cycle of a periodic motion, in order, in words; else empty."""
        return "" if self.gait is None else kind_of(self.trajectory)


def kind_of(trajectory: Trajectory) -> str:
    """Says what kind of cycle a motion has: how often the toe bounces, where it does, and the order of the events."""
    touches = sum(event.name == RETOUCH and event.domain != CHATTER for event in trajectory.events)
    bounces = f"the toe bounces {('once', 'twice')[touches - 1] if touches < 3 else f'{touches} times'}: " * bool(
        touches
    )
    return bounces + ", ".join(event.name.replace("_", " ") for event in trajectory.events)


def show_motion(
    knobs: Knobs, verdict: Verdict, message: str, start: State, cycles: int, gait: Gait | None = None
) -> Motion:
    """Returns some cycles from a state, for a gait with its solved numbers."""
    system = knobs.system if gait is None else gait.system
    return Motion(knobs, verdict, message, start, simulate(system, start, cycles, progress=False), gait)


def periodic(knobs: Knobs, gait: Gait) -> Motion:
    """Returns a cycle of a gait, two where they make a stride, with its largest multiplier and a short kind."""
    stable = "stable" if gait.stable else "unstable"
    text = f"Periodic and {stable}: the largest multiplier is {abs(gait.multipliers[0]):.3f}."
    motion = show_motion(knobs, "periodic", text, gait.state, 2 if gait.system.mirrored_toes else 1, gait)
    return replace(motion, message=text if len(motion.kind) > LONG else f"{text} Kind: {motion.kind}.")
