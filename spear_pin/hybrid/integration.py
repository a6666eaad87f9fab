"""Motion in one domain, integrated up to the event that ends it, by SciPy's DOP853."""

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
KNOT, DUE = "knot", "due"  # ends besides events: a knot of a spring's curve, and the time until which it goes


class Accuracy(NamedTuple):
    """How a motion is integrated.

    Attributes:
        rtol: relative tolerance.
        atol: absolute tolerance.
        longest: step, in s.
    """

    rtol: float
    atol: float
    longest: float


def accuracy(options: Options, hardware: Any) -> Accuracy:
    """How motion of a system is integrated, which hardware makes finer."""
    share, longest = (1.0, MAX_STEP) if hardware is None else (HARDWARE_TOLERANCE, min(MAX_STEP, hardware.max_step))
    longest = min(longest, options.max_step or MAX_STEP)
    return Accuracy(max(share * options.rtol, FINEST), share * (options.atol or 0.01 * options.rtol), longest)


@dataclass
class Motion:
    """Motion in a domain, as far as it has come.

    Attributes:
        t: time since the phase began, in s.
        y: the state then.
        event: the guard that ends it, if one does.
        why: what else ends it: `KNOT`, `DUE`, or a reason for a run to end.
        pieces: the motion; without keeping it, the last steps of it.
        observed: events that change nothing: name, time and state.
    """

    t: float
    y: Array
    event: Guard | None = None
    why: str = ""
    pieces: list[Piece] = field(default_factory=list)
    observed: list[tuple[str, float, Array]] = field(default_factory=list)


def integrated(
    flow: Flow, watch: Watch, t: float, y: Array, until: float, how: Accuracy, *, keep: bool, most: int
) -> Motion:
    """The motion up to its first event, or a time.

    Args:
        flow: the vector field of a domain.
        watch: of its guards, at the beginning.
        t: when it begins, in s since the phase began.
        y: the state there.
        until: when it ends at the latest.
        how: it is integrated.
        keep: whether the motion is kept.
        most: evaluations.
    """
    motion, solver, times = Motion(t, y), _solver(flow, t, y, until, how), deque[float](maxlen=rules.CREEP)
    while solver.status == "running":
        t0, y0, slope = solver.t, solver.y, solver.f
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
        flow.arrive(motion.t, motion.y)  # not before: to what is beyond an event motion does not come
    motion.why = DUE
    return motion


def _gives_up(motion: Motion, flow: Flow, solver: scipy.integrate.DOP853, times: deque[float], most: int) -> str:
    """Why a step ends the motion: it failed, hardly gets on any more, or is one too many; "" where it goes on."""
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
    """Pass what is only observed in a step from t0; whether something in it ends the motion."""
    for time, index in crossings:
        guard = None if index == BEND else flow.domain.guards[index]
        if guard is None or not guard.observes:
            motion.pieces.append(Piece(t0, time, solution))
            motion.t, motion.event, motion.why = time, guard, KNOT if guard is None else ""
            return True
        motion.observed.append((guard.name, time, solution(time)))
    motion.pieces.append(Piece(t0, motion.t, solution))
    return False


def _solver(flow: Flow, t: float, y: Array, until: float, how: Accuracy) -> scipy.integrate.DOP853:
    return scipy.integrate.DOP853(flow, t, y, until, max_step=how.longest, rtol=how.rtol, atol=how.atol)


def _step_to(flow: Flow, t0: float, y0: Array, time: float) -> Array:
    """One step of the method that ends on the event: more accurate than the interpolant of a longer one."""
    if time == t0:
        return y0
    shorter = scipy.integrate.DOP853(flow, t0, y0, time, first_step=time - t0, rtol=1.0, atol=np.inf)
    shorter.step()
    return np.asarray(shorter.y)
