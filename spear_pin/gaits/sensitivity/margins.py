"""Distance of a cycle from another order of events: the least value of each guard that does not fire."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.sensitivity.along_arcs import evaluate_guard, long
from spear_pin.gaits.sensitivity.measure import DualMeasure
from spear_pin.gaits.sensitivity.signals import Pieces, extremes
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Derivative, Stretch

ZERO = 1e-9  # relative to a guard's largest value: a guard with a smaller value begins at zero


def margins(cycle: Derivative, before: str = "") -> dict[str, DualMeasure]:
    """Returns the least margin of each armed event, by the event's name; zero where the event meets another.

    The margin of an event that does not happen is the least value of its guard. If the event happens, the margin is the
    least value before the guard finally falls to zero. If the event happens at once, the margin is how far the guard is
    below zero there. Each margin is in the guard's unit: N for a force, m for a height, rad for an angle. If several
    guards make the same event, the least number counts. Scheduled events have no margin; guards can meet them, too.

    Args:
        cycle: the cycle.
        before: an event up to which motion counts. An event that happens before then has no margin left.
    """
    found = dict[str, DualMeasure]()
    for motion in motions(cycle.stretches):
        event, candidates = motion[-1].arc.event, [*of_motion(motion)]
        if before and event is not None and event.name != before and long(motion):
            candidates.append((event.name, 0.0, np.zeros(cycle.dy.shape[1])))
        for name, value, derivative in candidates:
            if name not in found or value < found[name].value:
                found[name] = DualMeasure(value, derivative, "")
        if before and event is not None and event.name == before:
            break
    return found


def motions(stretches: Sequence[Stretch]) -> Iterator[list[Stretch]]:
    """Groups arcs that continue each other, as at kinks, into motions from event to event; the section's is last."""
    motion = list[Stretch]()
    for stretch in stretches:
        motion.append(stretch)
        if stretch.arc.event is not None and stretch.arc.event.reset is not None:
            yield motion
            motion = []


def of_motion(motion: Sequence[Stretch]) -> Iterator[tuple[str, float, Array]]:
    """Lists candidates for the least margin from event to event: an event's name, the value, and the derivative."""
    domain, event, lasting = motion[-1].arc.domain, motion[-1].arc.event, long(motion)
    if not lasting:
        at_once = motion[-1]
        for g, guard in enumerate(domain.guards):
            if guard is event:  # a guard at zero may also belong to an event that does not happen at once
                left = evaluate_guard(at_once, g) if at_once.late else evaluate_guard(at_once, g).times(-1.0)
                _, value, derivative = next(extremes(left))
                yield guard.name, value, derivative
        return
    for g, guard in enumerate(domain.guards):
        if guard.observes:
            continue
        pieces = [evaluate_guard(each, g) for each in lasting]
        values = np.concatenate([each.values for each in pieces])
        least = max(guard.tolerance, ZERO * float(np.abs(values).max()))
        if np.ptp(values) <= ZERO * least:  # what is held disarms it
            continue
        first, *others = extremes_of(pieces)
        if guard is event:  # of which the last value is zero; a largest one on the way is no margin
            others = [other for other in others[:-1] if other[0] < first[0]]
        risen = abs(first[0]) > least  # else its own event has just put it on zero, from where it rises
        waits = guard.waits and first[0] <= 0.0  # until it has risen
        for value, derivative in (first, *others):
            if (risen or abs(value) > least) and not (waits and value <= 0.0):
                yield guard.name, value, derivative


def extremes_of(pieces: Sequence[Pieces]) -> Iterator[tuple[float, Array]]:
    """Lists values at the ends of a motion of several arcs and at its turning points, with derivatives."""
    for i, piece in enumerate(pieces):
        for place, value, derivative in extremes(piece):
            turns = place == 1.0 and i + 1 < len(pieces) and piece.rates[END] * pieces[i + 1].rates[BEGIN] < 0.0
            if 0.0 < place < 1.0 or turns or (place == 0.0 and i == 0) or (place == 1.0 and i + 1 == len(pieces)):
                yield value, derivative
