"""Latching: what is held after events."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from spear_pin.hybrid.domain import Held, Reset


def latched(held: Held, resets: Iterable[Reset], q: Any, v: Any, law: Any) -> Held:
    """Values held after resets, one after the other; unchanged those that they do not latch.

    Args:
        held: before.
        resets: of events, in their order.
        q: configuration, a sequence of scalars.
        v: velocity after the impact, a sequence of scalars.
        law: parameters of the control law.

    Raises:
        ArithmeticError: a latch has no value there.
    """
    for reset in resets:
        if reset.latch is not None:
            held = {**held, **reset.latch(q, v, held, law)}
    return held
