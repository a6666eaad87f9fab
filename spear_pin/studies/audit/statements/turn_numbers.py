"""Numbers of gaits that turn in space."""

from __future__ import annotations

from spear_pin import Gait, simulate
from spear_pin.studies.bound.turn import summarize_turn

TURNS = ("turn_4", "turn_9", "turn_13", "turn_9_2.25", "turn_9_2.75")


def adduction_over_knee() -> tuple[float, ...]:
    """Returns the largest speed, then the range, of an adduction over a knee's in a stride, in each of `TURNS`."""
    shares = []
    for name in TURNS:
        gait = Gait.load(name)
        joints = summarize_turn(gait, simulate(gait.system, gait.state, 2, progress=False))["joints"]
        shares.append([joints["adduction"][of] / joints["knee"][of] for of in ("speed", "range")])
    return tuple(speed for speed, _ in shares) + tuple(span for _, span in shares)
