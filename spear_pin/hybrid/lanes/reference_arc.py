"""Follows one arc of a lane by the reference engine, where the domain that fits is not the first to suit the toes.

So it is where a toe in space begins to slide: it has a direction that only the reference engine finds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import states_over
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.engines.taylor import FAILED, KINK, TIME_LIMIT
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.integration import DUE, KNOT, MAX_STEP, SET_OUT, accuracy, integrate_motion
from spear_pin.hybrid.modes import choose
from spear_pin.hybrid.result import EVALUATIONS, FINEST, Options
from spear_pin.hybrid.rules.entry import NONE

ENDS = {DUE: TIME_LIMIT, KNOT: KINK, SET_OUT: KINK}


class ReferenceArc(NamedTuple):
    """An arc.

    Attributes:
        domain: its domain.
        t: time at which it ends, in s since the phase began.
        y: state there, (2 nv,).
        end: the guard's index, or `TIME_LIMIT`, `KINK` or `FAILED`.
        observed: states at events that change nothing, by name.
        motion: function from times to states; None if it is not kept, or the event is immediate.
        smooth: whether the motion goes on smoothly in the same domain.
    """

    domain: Domain
    t: float
    y: Array
    end: int
    observed: dict[str, Array]
    motion: Callable[[Array], Array] | None
    smooth: bool = False


def follow(
    system: HybridSystem,
    phase: str,
    held: Held,
    t: float,
    y: Array,
    until: Callable[[Domain], float],
    *,
    keep: bool,
    longest: float,
) -> ReferenceArc:
    """Follows the motion in the domain that fits up to its first event, or up to a time, at the finest tolerance.

    Args:
        system: the system, with the numbers of the lane.
        phase: the phase.
        held: held values.
        t: time since the phase began, in s.
        y: the state, (2 nv,).
        until: returns the latest time at which the motion in a domain ends.
        keep: whether the motion is kept.
        longest: longest step, in s.
    """
    whole = np.concatenate([y, np.zeros(len(flow_names(system)))])
    flow = choose(system, phase, held, t, whole)
    watch = Watch(flow, t, whole)
    if watch.at_once != NONE or watch.undefined:
        return ReferenceArc(flow.domain, t, y, FAILED if watch.undefined else watch.at_once, {}, None)
    last, how = until(flow.domain), accuracy(Options(FINEST, max_step=min(longest, MAX_STEP)), None)
    motion = integrate_motion(flow, watch, t, whole, last, how, keep=keep, most=EVALUATIONS, onset=True)
    n = len(y)
    end = ENDS.get(motion.why, FAILED)
    if motion.event is not None:
        end = next(i for i, guard in enumerate(flow.domain.guards) if guard is motion.event)
    observed = {name: state[:n] for name, _, state in motion.observed}
    states = states_over(motion.pieces, n) if keep else None
    return ReferenceArc(flow.domain, motion.t, motion.y[:n], end, observed, states, motion.why == SET_OUT)
