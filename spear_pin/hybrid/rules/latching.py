"""Latching: computes the values held after events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

from spear_pin.hybrid import own
from spear_pin.hybrid.clutch import Clock, after_edges, after_turns, from_now_on
from spear_pin.hybrid.domain import Held, Reset
from spear_pin.hybrid.dual import value_of
from spear_pin.hybrid.fields import adjust_law
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import parts_of


def standing(robot: Robot, q: Sequence[Any], v: Sequence[Any]) -> dict[str, Any]:
    """Returns on which parts of their arcs round feet stand, or would stand, as a phase begins."""
    if not robot.arcs:
        return {}
    q, v = [*map(value_of, q)], [*map(value_of, v)]
    return {parts_of(toe): arc.parts(q, v) for toe, arc in robot.arcs.items()}


def latch_values(
    held: Held,
    resets: Iterable[Reset],
    q: Any,
    v: Any,
    law: Any,
    place_of: Callable[[Reset], str] = str,
    *,
    begins: bool = False,
    clock: Clock | None = None,
) -> Held:
    """Returns the values held after resets, one after the other; values that no reset latches stay unchanged.

    Args:
        held: values held before.
        resets: resets of events, in their order.
        q: configuration, a sequence of scalars.
        v: velocity after the impact, a sequence of scalars.
        law: parameters of the control law.
        place_of: names the event of a reset.
        begins: whether a cycle, or the second half of a stride, begins: only then numbers of the law are adjusted.
        clock: the time, and what switches of springs depend on; without it they stay as they are.

    Raises:
        ArithmeticError: a latch has no value at this state.
        BadFunction: there is a mistake in a user's latch, which was called with numbers.
    """
    numbers = isinstance(q[0], float)
    for reset in resets:
        if begins and reset.adjust is not None:
            held = {**held, **reset.adjust(q, v, held, law)}
        if clock is not None:
            held = after_turns(reset.turns, after_edges(reset.edges, held, q, clock), clock)
        latch, p = reset.latch, adjust_law(law, held)
        if latch is not None and numbers and own.is_own(latch):
            what = f"latch of {place_of(reset)}"
            new = own.call_function(what, latch, partial(latch, q, v, held, p))
            held = {**held, **own.read_latched(what, latch, new)}
        elif latch is not None:
            held = {**held, **latch(q, v, held, p)}
        if clock is not None and reset.phase is not None:
            held = {**from_now_on(held, clock.t), **standing(clock.system.robot, q, v)}
    return held
