"""The record of a motion: arcs from event to event, of which derivatives are taken afterwards."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.orders import Order


class Arc(NamedTuple):
    """Motion in one domain up to an event.

    Attributes:
        domain: the domain.
        held: what is held.
        t: when it begins, in s since the phase did.
        y: the state there, (2 nv,).
        end: when it ends, in s since the phase began.
        after: the state there, before what the event does to it.
        event: the guard or the switch that ends it; None for a kink of the law, after which the same motion goes on.
        switches: scheduled events of the phase so far, this one included.
        motion: from times, (n,), to states, (2 nv, n); None where it was not kept, or the event is at once.
        steps: of Taylor's method in it, 0 where it is of another one.
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


class Record(Protocol):
    """A cycle from a state just behind the section, where a phase begins.

    Attributes:
        y: state just behind the section at its end, (2 nv,).
        phase: the phase that begins there.
        held: what is held there.
        spent: seconds in each phase.
        order: the order of its events.
        arcs: the motion from event to event.
    """

    @property
    def y(self) -> Array: ...  # noqa: D102

    @property
    def phase(self) -> str: ...  # noqa: D102

    @property
    def held(self) -> Held: ...  # noqa: D102

    @property
    def spent(self) -> Mapping[str, float]: ...  # noqa: D102

    @property
    def order(self) -> Order: ...  # noqa: D102

    @property
    def arcs(self) -> Sequence[Arc]: ...  # noqa: D102


class Runner(Protocol):
    """What runs cycles for records.

    Attributes:
        why: what the last cycle of which there is no record was refused for.
    """

    @property
    def why(self) -> str: ...  # noqa: D102

    def lap(self, phase: str, y: Array, held: Held) -> Record | None:
        """The cycle from where a phase begins just behind the section, None where it does not close plainly."""
