"""The record of a motion: arcs from event to event, of which derivatives are taken afterwards."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.domain import Domain, Held

Array = NDArray[np.float64]


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
    """

    domain: Domain
    held: Held
    t: float
    y: Array
    end: float
    after: Array
    event: Any
    switches: int
