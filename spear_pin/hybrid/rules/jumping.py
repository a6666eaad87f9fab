"""Jumping: computes the state to which a reset leads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from spear_pin.hybrid import own
from spear_pin.hybrid.domain import Held, Reset
from spear_pin.hybrid.dynamics import FLOATS, Operations
from spear_pin.hybrid.fields import adjust_law


def apply_jump(
    reset: Reset,
    q: Sequence[Any],
    v: Sequence[Any],
    held: Held,
    law: Any,
    place_of: Callable[[Reset], str] = str,
    ops: Operations = FLOATS,
) -> tuple[Sequence[Any], Sequence[Any]]:
    """Returns the state (q, v) after a reset's jump, or the same state if it has none.

    Args:
        reset: the reset.
        q: configuration, a sequence of scalars.
        v: velocity after the impact, a sequence of scalars.
        held: values held before.
        law: parameters of the control law.
        place_of: names the event of a reset.
        ops: elementary functions of these scalars.

    Raises:
        ArithmeticError: the jump has no value at this state.
        BadFunction: there is a mistake in a user's jump, which was called with numbers.
    """
    if reset.jump is None:
        return q, v
    jump = partial(reset.jump, q, v, held, adjust_law(law, held), ops)
    if ops is not FLOATS:
        return jump()
    what = f"jump of {place_of(reset)}"
    return own.state(what, reset.jump, own.call_function(what, reset.jump, jump), len(q), len(v))
