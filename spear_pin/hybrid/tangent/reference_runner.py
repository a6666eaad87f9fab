"""Runs cycles by the reference engine and records them: slower, for systems that are not compiled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc, states_over
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Guard, Held, Switch
from spear_pin.hybrid.orders import Order, order_of
from spear_pin.hybrid.result import FINEST, Moment, Options, Segment
from spear_pin.hybrid.rules.cycles import RETOUCH, turns_back
from spear_pin.hybrid.run import run


@dataclass(frozen=True)
class ReferenceLap:
    """A cycle, see `hybrid.arc.Record`."""

    y: Array
    phase: str
    held: Held
    spent: Mapping[str, float]
    order: Order
    arcs: list[Arc]


class ReferenceRunner:
    """Runs the cycles of a system.

    Args:
        system: the system.

    Attributes:
        why: why the last cycle that was refused was refused.
    """

    def __init__(self, system: HybridSystem) -> None:
        self._system, self._nv = system, system.robot.nv
        self.why = ""

    def lap(self, phase: str, y: Array, held: Held) -> ReferenceLap | None:
        """Runs the cycle at the finest tolerance; returns None if it does not close, or toes bounce or alternate."""
        begun = Moment(y[: self._nv], y[self._nv :], phase, held)
        found = run(self._system, begun, 1, Options(FINEST, keep=True))
        self.why = ""
        if found.reason != "complete":
            self.why = found.message
        elif any(event.name == RETOUCH for event in found.events):
            self.why = "a toe bounces"
        before, phase = "", phase
        for segment in found.segments:
            if segment.domain.phase != phase:
                before, phase = phase, segment.domain.phase
            self.why = self.why or self._not_plain(segment, before)
        if self.why:
            return None
        arcs, switches, came = list[Arc](), 0, -1.0
        for segment in found.segments:
            switches, came = 0 if segment.began != came else switches, segment.began
            event = _event(segment)
            switches += isinstance(event, Switch)
            arcs.append(self._arc(segment, event, switches))
        end = np.concatenate(found.state)
        return ReferenceLap(end, found.domain.phase, found.held, found.durations, order_of(self._system, found), arcs)

    def _not_plain(self, segment: Segment, before: str) -> str:
        """Returns why a cycle that contains a motion is not recorded, "" if it is.

        Args:
            segment: the motion.
            before: the phase before, "" in the first one.
        """
        domain = segment.domain
        if not any(domain is each for each in self._system.domains):
            return f"toes alternate in {domain.phase}"
        event = _event(segment)
        if isinstance(event, Guard) and turns_back(self._system, event, segment.pieces[-1].end, before):
            return f"{domain.name} ends as it begins: a toe bounces"
        return ""

    def _arc(self, segment: Segment, event: Any, switches: int) -> Arc:
        motion, begin, end = states_over(segment.pieces, 2 * self._nv), segment.pieces[0].begin, segment.pieces[-1].end
        y, after = motion(np.array([begin, end])).T
        return Arc(segment.domain, segment.held, begin, y, end, after, event, switches, motion)


def _event(segment: Segment) -> Guard | Switch | None:
    """Returns the event that ends a motion: a guard of its domain, or the scheduled event."""
    guards, ended = segment.domain.guards, segment.ended
    return ended if ended is None or any(ended is guard for guard in guards) else segment.domain.switch
