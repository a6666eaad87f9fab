"""Time within a phase, an instant and a cycle: which events are due, are too many, or close a cycle.

The section's event closes a cycle, unless a toe that strikes at it has hardly been in the air.

A toe that lands within `HybridSystem.shortest_flight` after it left the ground has not flown: it re-touches. The
automaton treats this like any touchdown, since a foot switch closes all the same. But the event is named `RETOUCH` and
closes no cycle. If no other toe bore meanwhile, the time in the air counts to the phase that continues. So does the
time of motion on the switching surface, in which the toe never leaves the ground.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce
from operator import and_
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.fields import adjust_law

RETOUCH = "retouch"
ALTERNATE = "toes alternate"
INSTANT = 1e-7  # s: events closer together than this count as one instant
AT_ONCE = 1e-9  # s: a phase shorter than this was left as soon as it was entered
INSTANT_EVENTS = 20  # number of events in one instant that count as a Zeno point
CYCLE_EVENTS = 1000
CREEP = 50  # steps of two toes' motion within an instant: where their shares cease to exist they have infinite rates


def due(domain: Domain, switches: int, law: Any, held: Held) -> Any:
    """Returns the time since the phase began, in s, at which the next switch is due; infinite if there is none.

    Args:
        domain: the domain.
        switches: number of switches in this phase so far.
        law: parameters of the control law.
        held: held values.
    """
    return math.inf if domain.switch is None else domain.switch.time(switches + 1, adjust_law(law, held))


def count_crowd(before: Any, since: Any) -> Any:
    """Counts the events in this instant before this one.

    Args:
        before: the count at the last event.
        since: time since the last event, in s.
    """
    return (since < INSTANT) * (before + 1)


def too_many(crowd: int, events: int) -> str:
    """Returns why a run ends because of the number of its events, "" if it does not.

    Args:
        crowd: number of events in this instant before this one, see `count_crowd`.
        events: number of events in the cycle, including the present one.
    """
    return "zeno" if crowd >= INSTANT_EVENTS else "no_cycle" if events >= CYCLE_EVENTS else ""


def creeps(times: Sequence[float]) -> bool:
    """Tells whether the last `CREEP` steps of an integration, with these end times in s, lasted only an instant."""
    return len(times) == CREEP and times[-1] - times[0] < INSTANT


def left_at_once(guard: Guard, t: Any) -> Any:
    """Tells whether a phase is left as soon as it was entered, t seconds ago, which may be chatter."""
    return (t <= AT_ONCE) & (guard.reset is not None and guard.reset.phase is not None)


def whole(seconds: Any) -> Any:
    """Tells whether crossings of the section, so many seconds apart, bound a cycle; two in one instant do not."""
    return seconds >= INSTANT


def retouches(system: HybridSystem, reset: Reset, aloft: Sequence[Any] | NDArray[np.float64]) -> Any:
    """Tells whether all toes that strike at an event only re-touch.

    Args:
        system: the system.
        reset: reset of the event.
        aloft: time since each toe was on the ground, in s: numbers, or arrays (n,) of lanes.

    Returns:
        a truth value, or n of them, (n,); False where no toe strikes.
    """
    hardly = (aloft[system.robot.toes.index(toe)] < system.shortest_flight for toe in reset.impact)
    return reduce(and_, hardly) if reset.impact else False


def flight_times(system: HybridSystem) -> tuple[float, float]:
    """Returns the least and the greatest duration, in s, of a phase of flight that ends at the section.

    A single toe has been in the air for no longer than that phase; one of several toes may have been.
    """
    return system.shortest_flight if len(system.robot.toes) == 1 else 0.0, system.phase_limit


def counts_to(domain: Domain, reset: Reset, again: bool) -> str:
    """Returns the phase to which the time of a phase counts when a reset ends it.

    Args:
        domain: the last domain of the phase.
        reset: the reset into another phase.
        again: whether the reset is that of a re-touch.
    """
    assert reset.phase is not None
    return reset.phase if again and not domain.on_ground else domain.spent_in
