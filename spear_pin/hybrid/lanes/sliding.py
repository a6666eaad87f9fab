"""Moves lanes that would alternate between two phases along the switching surface, as `filippov.sliding` does."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from spear_pin.hybrid.domain import Alternation, Domain, Reset
from spear_pin.hybrid.engines.taylor import Point, Ready
from spear_pin.hybrid.lanes.groups import Group
from spear_pin.hybrid.lanes.modes import choose, first_event
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.rules.footing import along, still
from spear_pin.hybrid.rules.surface import BEYOND, MOST_AT_ONCE, alternation, begins, chatter, leads_round

Came = tuple[Domain, Reset]  # the domain that was left, and the reset that left it


def slide(
    numbers: Numbers, domain: Domain, reset: Reset, came: Came, group: Group
) -> tuple[list[tuple[Ready, Group, Point]], Group]:
    """Finds the motion between two domains for lanes, evaluates it, and returns it with the lanes that do not slide.

    Args:
        numbers: numbers of the lanes.
        domain: the domain that the lanes have just entered.
        reset: the reset by which they would leave it at once.
        came: the domain before, and the reset by which they left it.
        group: the lanes.

    Raises:
        TypeError: the motion cannot be compiled, since a latch branches on a value.
    """
    between = alternation(numbers.system, (domain, came[0]), (reset, came[1]))
    if between is None:
        return [], group
    q, v = group.y[: numbers.nv], group.y[numbers.nv :]
    feet = numbers.ground(group.lanes).seen(numbers.mechanism.feet(list(q), list(v), np), np)
    sinking = along(feet.jacobians[between.toe][1], v)
    slides = np.zeros(len(group), bool)
    found = []
    resting = group.take(np.broadcast_to(still(sinking), len(group)))
    for left, follow, landed in _at_once_after(numbers, between.touch, resting):
        for again, _, lifted in () if left is None else _at_once_after(numbers, left, landed):
            if leads_round(between, left, again):
                part = group.take(np.isin(group.lanes, lifted.lanes))
                for each in _begin(numbers, replace(between, follow=follow), part):
                    slides |= np.isin(group.lanes, each[1].lanes)
                    found.append(each)
    return found, group.take(~slides)


def _at_once_after(
    numbers: Numbers, reset: Reset, group: Group
) -> Iterator[tuple[Reset | None, tuple[Reset, ...], Group]]:
    """Yields the resets that would follow at once after a reset.

    Each item is the reset that leaves its phase, the resets before it, and the group with its held values.
    """
    assert reset.phase is not None
    waiting: list[tuple[tuple[Reset, ...], Group]] = [
        ((), numbers.latch(replace(group, t=np.zeros(len(group))), reset, begins=False))
    ]
    while waiting:
        follow, group = waiting.pop()
        for ready, part, point in choose(numbers, reset.phase, group)[0] if len(group) else ():
            first, _ = first_event(numbers, ready, part, point)
            for index in np.unique(first):
                own = part.take(first == index)
                then = None if index < 0 else ready.domain.guards[index].reset
                if then is None or then.phase is not None or len(follow) == MOST_AT_ONCE:
                    yield then, follow, own
                else:
                    waiting.append(((*follow, then), numbers.latch(own, then, begins=False)))


def _begin(numbers: Numbers, between: Alternation, group: Group) -> Iterator[tuple[Ready, Group, Point]]:
    """Yields the motion between two domains for the lanes in which the shares of the two laws allow it."""
    group = replace(group, t=np.zeros(len(group)))
    for beyond in BEYOND:
        if not len(group):
            return
        ready = numbers.compiled(chatter(between, beyond), group)
        point = numbers.at(ready, group)
        first, _ = first_event(numbers, ready, group, point)
        share = 1.0 + beyond - point.guards[0]
        slides = begins(first, [share], beyond)
        if slides.any():
            yield ready, group.take(slides), point.take(slides)
        group = group.take(~slides)
