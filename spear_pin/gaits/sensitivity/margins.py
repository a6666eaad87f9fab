"""How far a cycle is from another order of events: what is left of each guard that does not fire, with derivatives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.sensitivity.along_arcs import guarded
from spear_pin.gaits.sensitivity.measure import Measure
from spear_pin.gaits.sensitivity.signals import extremes
from spear_pin.hybrid.tangent.derivative import Derivative, Stretch

Array = NDArray[np.float64]
ZERO = 1e-9  # of a guard's largest value: it begins on zero


def margins(cycle: Derivative) -> dict[str, Measure]:
    """The least margin of each event that is armed, by its name; zero where it meets another.

    Of an event that does not happen it is the least value of its guard, of one that happens the guard's value where its
    domain is entered, and of one that happens at once how far the guard is below zero there. Each is in the guard's
    unit: N of a force, m of a height, rad of an angle. Scheduled events have none; guards are margins to them, too.
    """
    found = dict[str, Measure]()
    for stretch in cycle.stretches:
        for name, value, derivative in of_arc(stretch):
            if name not in found or value < found[name].value:
                found[name] = Measure(value, derivative, "")
    return found


def of_arc(stretch: Stretch) -> Iterator[tuple[str, float, Array]]:
    """What may be the least margin of an event: its name, the value, and the derivative."""
    arc = stretch.arc
    if stretch.at_once:
        for g, guard in enumerate(arc.domain.guards):
            if guard is arc.event:
                below = guarded(stretch, g).times(-1.0)
                yield guard.name, float(below.values[-2]), below.derivatives[-2] + below.rates[0] * stretch.since
        return
    for g, guard in enumerate(arc.domain.guards):
        if guard.observes:
            continue
        piece = guarded(stretch, g)
        least = max(guard.tolerance, ZERO * float(np.abs(piece.values).max()))
        if np.ptp(piece.values) <= ZERO * least:  # what is held disarms it
            continue
        every = list(extremes(piece))
        risen = abs(every[0][1]) > least  # else its own event has just put it on zero, from where it rises
        for place, value, derivative in every:
            if (place == 0.0 or guard is not arc.event) and (risen or abs(value) > least):
                yield guard.name, value, derivative
