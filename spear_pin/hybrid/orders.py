"""Orders of events: what happens in a cycle, one after the other, and in which domain each.

Where the order is the same the return map is smooth; it is another on the two sides of a border.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Reset, Switch
from spear_pin.hybrid.result import Run
from spear_pin.hybrid.rules.cycles import INSTANT

Order = tuple[tuple[str, str], ...]
"""(domain, event) of each event that changes something, in the order in which they happen."""


class Happening(NamedTuple):
    """An event of a cycle.

    Attributes:
        domain: in which it happened.
        name: of the event.
        time: in s, since whenever.
        passes: whether it is a guard's and only latches, within its phase.
        leaves: whether it is a guard's and ends the phase.
    """

    domain: str
    name: str
    time: float
    passes: bool
    leaves: bool


def happening(domain: Domain, event: Guard | Switch, reset: Reset | None, name: str, time: float) -> Happening:
    """An event of a domain under a name."""
    guarded = isinstance(event, Guard)
    leaves, latches = reset is None or reset.phase is not None, reset is not None and reset.latch is not None
    return Happening(domain.name, name, time, guarded and latches and not leaves, guarded and leaves)


def in_order(happenings: Sequence[Happening]) -> Order:
    """The order of events.

    A guard that latches something in the instant in which another ends the phase is left out, such as that of a spring
    that is slack at lift-off: which comes first is rounding.
    """
    kept: list[Happening] = []
    for each in happenings:
        while kept and each.leaves and kept[-1].passes and each.time - kept[-1].time < INSTANT:
            kept.pop()
        kept.append(each)
    return tuple((each.domain, each.name) for each in kept)


def order_of(system: HybridSystem, result: Run) -> Order:
    """The order of the events of a run; of its last whole cycle, if there is one."""
    events = result.events
    closed = [i + 1 for i, event in enumerate(events) if event.name == system.section]
    if result.cycles:
        events = events[closed[-2] if len(closed) > 1 else 0 : closed[-1]]
    guards = {(domain.name, guard.name): (domain, guard) for domain in system.domains for guard in domain.guards}
    found = []
    for event in events:
        if (event.domain, event.name) not in guards:  # scheduled, or of motion on a switching surface
            found.append(Happening(event.domain, event.name, event.time, False, False))
            continue
        domain, guard = guards[event.domain, event.name]
        if not guard.observes:
            found.append(happening(domain, guard, guard.reset, event.name, event.time))
    return in_order(found)


def said(order: Order) -> str:
    """An order in a line: domains, and behind each what happens in it."""
    words: list[str] = []
    domain = ""
    for name, event in order:
        words.append(event if name == domain else f"{name}: {event}")
        domain = name
    return ", ".join(words)


def differing(before: Order, after: Order) -> tuple[Order, Order]:
    """What of two orders is not the same, between what begins and what ends alike."""
    first, shorter = 0, min(len(before), len(after))
    while first < shorter and before[first] == after[first]:
        first += 1
    rest, last = (before[first:], after[first:]), 0
    while last < shorter - first and rest[0][-1 - last] == rest[1][-1 - last]:
        last += 1
    return rest[0][: len(rest[0]) - last], rest[1][: len(rest[1]) - last]
