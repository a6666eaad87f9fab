"""A hop whose numbers a user changes: the hop to which a leg settles, or the reason why there is none.

Every answer begins at the same state, that of the default hop just after touchdown, and depends on the numbers alone.
So the numbers name a hop. Where two kinds of hops exist, it is the one to which the robot comes from that state.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spear_pin.errors import NoGait
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.periodic import displacement
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knobs
from spear_pin.studies.explore.motion import Motion, periodic, show_motion

SETTLE = 12  # hops before it is asked whether they repeat
LONGEST = 4  # hops of the longest pattern that is looked for
NEAR = 0.01  # m, rad, m/s, rad/s between states that count as the same
SHOWN = 2  # whole hops that are shown before an end, and of what nearly repeats
TRANSIENT = 6  # hops that are shown from the default hop on


def settle_hops(knobs: Knobs, engine: Engine) -> Motion:
    """Returns hops to which the default hop settles, after a dozen of them, when the numbers change at once.

    Args:
        knobs: the numbers.
        engine: engine that follows the hops.

    Raises:
        NoGait: the flight time is kept, and no stance torque was found for it.
    """
    if knobs.kept:
        return _kept(knobs)
    begun, done = engine.advance(knobs, knobs.subject.start, SETTLE)
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
        return show_motion(knobs, "unsettled", text, begun, LONGEST)
    if length > 1:
        hops = show_motion(knobs, "pattern", "", state, length)
        text = f"Periodic over {length} hops, not over one: they take {_lasting(hops.trajectory)}."
        return replace(hops, message=text)
    try:
        return periodic(knobs, find_gait(knobs.system, guess=state))
    except NoGait:
        text = (
            f"Not settled: {SETTLE} hops after the default hop each nearly repeats the last; no periodic hop was found."
        )
        return show_motion(knobs, "unsettled", text, begun, SHOWN)


def transient(knobs: Knobs, engine: Engine) -> Motion:
    """Returns the first hops after the numbers of the default hop change at once, just after touchdown."""
    hops = show_motion(knobs, "transient", "", knobs.subject.start, TRANSIENT)
    text = f"A transient: {_counted(hops.trajectory.cycles)}, touchdown to touchdown, after the default hop."
    if not hops.trajectory.complete:
        text += f" Then it ends: {hops.trajectory.message}."
    return replace(hops, message=text)


def _kept(knobs: Knobs) -> Motion:
    """Returns the hop with the default flight time, for which the stance torque is solved."""
    subject = knobs.subject
    ((solved, measure),) = subject.held(kept=True).items()
    knob = subject.knobs[solved]
    knobs = knobs.turned(**{solved: knob.default})  # so that it does not matter where the slider stood
    try:
        gait = find_gait(knobs.system, [solved], {measure: subject.wanted}, guess=subject.start)
    except NoGait as error:
        raise NoGait(f"no stance torque was found with {subject.keeps}", error.residual) from None
    torque = gait.parameters[solved]
    if not knob.admits(torque):
        raise NoGait(f"{subject.keeps} takes {torque:.3f} N·m of stance torque, beyond the slider", gait.residual)
    return periodic(knobs.turned(**{solved: torque}), gait)


def _ended(knobs: Knobs, engine: Engine, done: int) -> Motion:
    """Returns the last whole hops of a run that breaks off after some hops, and the reason."""
    skipped = max(0, done - SHOWN)
    start = engine.advance(knobs, knobs.subject.start, skipped)[0] if skipped else knobs.subject.start
    hops = show_motion(knobs, "ended", "", start, done - skipped + 1)
    hopped = f"{_counted(done)} after" if done else "during the first hop after"
    return replace(
        hops,
        message=f"No periodic hop is reached: the run ends {hopped} the default hop. Why: {hops.trajectory.message}.",
    )


def _counted(hops: int) -> str:
    return "1 hop" if hops == 1 else f"{hops} hops"


def _lasting(trajectory: Trajectory) -> str:
    """Returns the durations of the hops, from touchdown to touchdown, in words."""
    landings = [trajectory.t[0], *(event.time for event in trajectory.named("touchdown"))]
    *others, last = (f"{seconds:.3f}" for seconds in np.diff(landings))
    return f"{', '.join(others)} and {last} s"
