"""Time within a phase, an instant and a cycle: what is due, what is too much, what closes a cycle.

The section's event closes a cycle, unless a toe that strikes there has hardly been in the air.

A toe that comes down again within `HybridSystem.shortest_flight` after it left the ground has not flown: it re-touches.
What the automaton makes of it stays the same, for a foot switch closes all the same; but the event is named `RETOUCH`,
closes no cycle, and where no other toe bore meanwhile the time in the air counts to the phase that goes on. So does
motion on the switching surface, in which the toe never leaves the ground, however long it lasts.
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
from spear_pin.hybrid.domain import Domain, Guard, Reset

RETOUCH = "retouch"
INSTANT = 1e-7  # s: events closer together than this count as one instant
AT_ONCE = 1e-9  # s: a phase shorter than this was left as soon as it was entered
INSTANT_EVENTS = 20  # so many in one instant are a Zeno point
CYCLE_EVENTS = 1000
CREEP = 50  # steps of two toes' motion within an instant: where their shares cease to exist they have infinite rates


def due(domain: Domain, switches: int, law: Any) -> Any:
    """Time since the phase began, in s, at which its next scheduled switch is due; infinite if there is none.

    Args:
        domain: the domain.
        switches: how many have been in this phase.
        law: parameters of the control law.
    """
    return math.inf if domain.switch is None else domain.switch.time(switches + 1, law)


def crowded(before: Any, since: Any) -> Any:
    """How many events there have been in an instant before this one.

    Args:
        before: the same of the last event.
        since: time since that, in s.
    """
    return (since < INSTANT) * (before + 1)


def too_many(crowd: int, events: int) -> str:
    """Why a run ends by the number of its events, if it does.

    Args:
        crowd: as of `crowded`.
        events: of the cycle, with the present one.
    """
    return "zeno" if crowd >= INSTANT_EVENTS else "no_cycle" if events >= CYCLE_EVENTS else ""


def creeps(times: Sequence[float]) -> bool:
    """Whether the last `CREEP` steps of an integration, whose ends in s these are, went on for an instant only."""
    return len(times) == CREEP and times[-1] - times[0] < INSTANT


def left_at_once(guard: Guard, t: Any) -> Any:
    """Whether a phase is left for another as soon as it was entered, t seconds ago: it may be chatter."""
    return (t <= AT_ONCE) & (guard.reset is not None and guard.reset.phase is not None)


def whole(seconds: Any) -> Any:
    """Whether crossings of the section, so many seconds apart, bound a cycle; two in one instant do not."""
    return seconds >= INSTANT


def retouches(system: HybridSystem, reset: Reset, aloft: Sequence[Any] | NDArray[np.float64]) -> Any:
    """Whether all the toes that strike at an event touch again only.

    Args:
        system: the system.
        reset: of the event.
        aloft: how long ago each toe was on the ground, in s: numbers, or arrays (n,) of lanes.

    Returns:
        a truth value, or (n,) of them; False where none strikes.
    """
    hardly = (aloft[system.robot.toes.index(toe)] < system.shortest_flight for toe in reset.impact)
    return reduce(and_, hardly) if reset.impact else False


def flight_times(system: HybridSystem) -> tuple[float, float]:
    """Durations, in s, between which a phase of flight lies that ends at the section.

    Where there is one toe it has been in the air for no longer than that phase; of several one may have.
    """
    return system.shortest_flight if len(system.robot.toes) == 1 else 0.0, system.phase_limit


def counts_to(domain: Domain, reset: Reset, again: bool) -> str:
    """The phase to which the time of a phase counts that a reset ends.

    Args:
        domain: its last domain.
        reset: into another phase.
        again: whether it is that of a re-touch.
    """
    assert reset.phase is not None
    return reset.phase if again and not domain.on_ground else domain.spent_in
