"""End of a cycle: the section's event, unless a toe that strikes there has hardly been in the air.

A toe that comes down again within `HybridSystem.shortest_flight` after it left the ground has not flown: it re-touches.
What the automaton makes of it stays the same, for a foot switch closes all the same; but the event is named `RETOUCH`,
closes no cycle, and where no other toe bore meanwhile the time in the air counts to the phase that goes on. So does
motion on the switching surface, in which the toe never leaves the ground, however long it lasts.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import and_
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import Domain, HybridSystem, Reset

RETOUCH = "retouch"


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
