"""The record of a motion: arcs from event to event, from which derivatives are computed afterwards."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.result import Piece, Run, Segment, State


class Arc(NamedTuple):
    """Motion in one domain up to an event.

    Attributes:
        domain: the domain.
        held: held values.
        t: time at which the arc begins, in s since the phase began.
        y: state at the beginning, (2 nv,).
        end: time at which the arc ends, in s since the phase began.
        after: state at the end, before the event changes it.
        event: the guard or the switch that ends it; None where the same motion goes on, smoothly or at a kink of the
            law.
        switches: scheduled events of the phase so far, this one included.
        motion: function from times, (n,), to states, (2 nv, n); None if it was not kept, or the event is immediate.
        steps: number of steps of Taylor's method, 0 for another method.
        again: whether toes only touch again in the event, which then closes no cycle.
        smooth: whether the same motion goes on smoothly.
    """

    domain: Domain
    held: Held
    t: float
    y: Array
    end: float
    after: Array
    event: Any
    switches: int
    motion: Callable[[Array], Array] | None = None
    steps: int = 0
    again: bool = False
    smooth: bool = False

    @property
    def begins_phase(self) -> bool:
        """Whether its event begins a phase, maybe the same one, whose clock starts at zero."""
        return self.event is not None and self.event.reset is not None and self.event.reset.phase is not None


@dataclass(frozen=True)
class Record:
    """A cycle from a state just after the section, where a phase begins.

    Attributes:
        y: state just after the section at the cycle's end, (2 nv,).
        phase: the phase that begins at that state.
        held: values held at that state.
        spent: time in each phase, in s.
        order: the order of its events.
        arcs: the motion from event to event.
    """

    y: Array
    phase: str
    held: Held
    spent: Mapping[str, float]
    order: Order
    arcs: Sequence[Arc]


def states_over(pieces: Sequence[Piece], rows: int) -> Callable[[Array], Array]:
    """Returns a function from times, (n,), to states, (rows, n), by an integrator's own interpolants."""
    ends = np.array([piece.end for piece in pieces[:-1]])

    def states(times: Array) -> Array:
        found, of = np.empty((rows, len(times))), np.searchsorted(ends, times)
        for i in np.unique(of):
            found[:, of == i] = pieces[i].state(times[of == i])[:rows]
        return found

    return states


def motion_of(domains: Sequence[Domain], start: State, record: Record) -> Run:
    """Returns the motion of a recorded cycle as a run, to be sampled; the run has neither events nor work.

    Args:
        domains: domains of a system, which stand for those of the same keys in the record.
        start: (q, v) at the beginning.
        record: the cycle, whose arcs keep their motion.
    """
    own, segments, began = {domain.key: domain for domain in domains}, list[Segment](), 0.0
    for arc in record.arcs:
        pieces = [] if arc.motion is None else [Piece(arc.t, arc.end, arc.motion)]
        segments.append(Segment(own[arc.domain.key], arc.held, 0, began, pieces))
        began += arc.end if arc.begins_phase else 0.0
    nv = len(record.y) // 2
    reached, last = (record.y[:nv], record.y[nv:]), segments[-1].domain
    return Run(start, reached, record.held, last, segments, durations=record.spent, cycles=1, reason="complete")
