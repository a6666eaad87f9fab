"""Integrates motion in one domain up to the event that ends it, by SciPy's DOP853."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import BEND, Watch, bends
from spear_pin.hybrid.hardware import HARDWARE_TOLERANCE
from spear_pin.hybrid.result import FINEST, Options, Piece
from spear_pin.hybrid.rules import cycles as rules

MAX_STEP = 0.05  # s
KNOT, DUE = "knot", "due"  # ends besides events: a knot of a spring's curve, and the final time
SET_OUT = "set out"  # the toes that began to slide have a velocity that defines their direction


class Accuracy(NamedTuple):
    """Accuracy of an integration.

    Attributes:
        rtol: relative tolerance.
        atol: absolute tolerance.
        longest: longest step, in s.
    """

    rtol: float
    atol: float
    longest: float


def accuracy(options: Options, hardware: Any) -> Accuracy:
    """Returns the accuracy with which a system's motion is integrated, which is finer with hardware."""
    share, longest = (1.0, MAX_STEP) if hardware is None else (HARDWARE_TOLERANCE, min(MAX_STEP, hardware.max_step))
    longest = min(longest, options.max_step or MAX_STEP)
    return Accuracy(max(share * options.rtol, FINEST), share * (options.atol or 0.01 * options.rtol), longest)


@dataclass
class Motion:
    """Motion in a domain so far.

    Attributes:
        t: time since the phase began, in s.
        y: the state at that time.
        event: the guard that ends the motion, if one does.
        why: any other end of the motion: `KNOT`, `DUE`, `SET_OUT`, or a reason for a run to end.
        pieces: the motion; only its last steps if it is not kept.
        observed: name, time and state of events that change nothing.
    """

    t: float
    y: Array
    event: Guard | None = None
    why: str = ""
    pieces: list[Piece] = field(default_factory=list)
    observed: list[tuple[str, float, Array]] = field(default_factory=list)


def integrate_motion(
    flow: Flow,
    watch: Watch,
    t: float,
    y: Array,
    until: float,
    how: Accuracy,
    *,
    keep: bool,
    most: int,
    onset: bool = False,
) -> Motion:
    """Integrates a motion up to its first event, or up to a time.

    Args:
        flow: the vector field of a domain.
        watch: watch of its guards, at the beginning.
        t: time at which the motion begins, in s since the phase began.
        y: state at that time.
        until: latest time at which it ends, in s since the phase began.
        how: accuracy of the integration.
        keep: whether the motion is kept.
        most: most evaluations of the vector field.
        onset: whether the motion of toes that begin to slide ends where they have set out.
    """
    motion, times = Motion(t, y), deque[float](maxlen=rules.CREEP)
    solver = scipy.integrate.DOP853(flow, t, y, until, max_step=how.longest, rtol=how.rtol, atol=how.atol)
    if flow.sets_out:
        flow.arrive(t, y)
    while solver.status == "running":
        t0, y0, slope = solver.t, solver.y, solver.f
        solver.max_step = min(how.longest, flow.longest)
        solver.step()
        times.append(solver.t)
        motion.why = _gives_up(motion, flow, solver, times, most)
        if motion.why:
            return motion
        motion.t, motion.y = solver.t, solver.y
        ends, states = (t0, motion.t), (y0, motion.y)
        crossings = watch.step(ends, states, (slope, solver.f), solver.dense_output)
        crossings = sorted([*crossings, *bends(flow, ends, states, solver.dense_output)])
        if (crossings or keep) and _pass(motion, flow, solver.dense_output(), t0, crossings):
            motion.y = _step_to(flow, t0, y0, motion.t)
            flow.arrive(motion.t, motion.y)
            return motion
        if watch.undefined:
            motion.why = "not_finite"
            return motion
        began = onset and flow.sets_out
        flow.arrive(motion.t, motion.y)  # not earlier, as the motion does not go beyond an event
        if began and not flow.sets_out:
            motion.why = SET_OUT
            return motion
    motion.why = DUE
    return motion


def _gives_up(motion: Motion, flow: Flow, solver: scipy.integrate.DOP853, times: deque[float], most: int) -> str:
    """Returns why a step ends the motion: it failed, advances too little, or is one too many; "" if it continues."""
    if solver.status == "failed":
        finite = np.isfinite(solver.y).all() and np.isfinite(flow(motion.t, motion.y)).all()
        return "step_size" if finite else "not_finite"
    creeps = flow.domain.crossing is not None and rules.creeps(times)
    if not creeps and flow.evaluations <= most:
        return ""
    if creeps:
        motion.pieces.append(Piece(motion.t, solver.t, solver.dense_output()))
    motion.t, motion.y = solver.t, solver.y
    return "step_size" if creeps else "evaluation_cap"


def _pass(
    motion: Motion, flow: Flow, solution: Callable[[Any], Array], t0: float, crossings: list[tuple[float, int]]
) -> bool:
    """Records the observed events in a step from t0; returns whether a crossing in it ends the motion."""
    for time, index in crossings:
        guard = None if index == BEND else flow.domain.guards[index]
        if guard is None or not guard.observes:
            motion.pieces.append(Piece(t0, time, solution))
            motion.t, motion.event, motion.why = time, guard, KNOT if guard is None else ""
            return True
        motion.observed.append((guard.name, time, solution(time)))
    motion.pieces.append(Piece(t0, motion.t, solution))
    return False


def _step_to(flow: Flow, t0: float, y0: Array, time: float) -> Array:
    """Takes one step that ends on the event, which is more accurate than the interpolant of a longer step."""
    if time == t0:
        return y0
    shorter = scipy.integrate.DOP853(flow, t0, y0, time, first_step=time - t0, rtol=1.0, atol=np.inf)
    shorter.step()
    return np.asarray(shorter.y)
