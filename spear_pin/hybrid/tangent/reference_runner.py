"""Runs cycles by the reference engine and records them: slower, for systems that are not compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc, Record, states_over
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Guard, Held, Switch
from spear_pin.hybrid.orders import order_of
from spear_pin.hybrid.result import EVALUATIONS, FINEST, Moment, Options, Segment
from spear_pin.hybrid.rules.cycles import ALTERNATE, RETOUCH
from spear_pin.hybrid.run import run


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

    def lap(self, phase: str, y: Array, held: Held) -> Record | None:
        """Runs the cycle at the finest tolerance; returns None if it does not close, or toes alternate."""
        begun = Moment(y[: self._nv], y[self._nv :], phase, held)
        found = run(self._system, begun, 1, Options(FINEST, max_evaluations=EVALUATIONS, keep=True))
        own = {id(domain) for domain in self._system.domains}
        alternate = any(id(segment.domain) not in own for segment in found.segments)
        self.why = found.message if found.reason != "complete" else ALTERNATE if alternate else ""
        if self.why:
            return None
        arcs, switches, came = list[Arc](), 0, -1.0
        retouched = {event.time for event in found.events if event.name == RETOUCH}
        for segment in found.segments:
            switches, came = 0 if segment.began != came else switches, segment.began
            event = _event(segment)
            switches += isinstance(event, Switch)
            again = event is not None and segment.began + segment.pieces[-1].end in retouched
            arcs.append(self._arc(segment, event, switches)._replace(again=again))
        end = np.concatenate(found.state)
        return Record(end, found.domain.phase, found.held, found.durations, order_of(self._system, found), arcs)

    def _arc(self, segment: Segment, event: Any, switches: int) -> Arc:
        motion, begin, end = states_over(segment.pieces, 2 * self._nv), segment.pieces[0].begin, segment.pieces[-1].end
        y, after = motion(np.array([begin, end])).T
        return Arc(segment.domain, segment.held, begin, y, end, after, event, switches, motion)


def _event(segment: Segment) -> Guard | Switch | None:
    """Returns the event that ends a motion: a guard of its domain, or the scheduled event."""
    guards, ended = segment.domain.guards, segment.ended
    return ended if ended is None or any(ended is guard for guard in guards) else segment.domain.switch
