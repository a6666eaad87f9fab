"""Orders of events: the sequence of events in a cycle, each with its domain.

The return map is smooth where the order of events is the same. On the two sides of a border the orders differ.
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
        domain: name of the domain in which it happened.
        name: name of the event.
        time: time of the event, in s, from any origin.
        passes: whether the event is a guard's and only latches, within its phase.
        leaves: whether the event is a guard's and ends the phase.
    """

    domain: str
    name: str
    time: float
    passes: bool
    leaves: bool


def make_happening(domain: Domain, event: Guard | Switch, reset: Reset | None, name: str, time: float) -> Happening:
    """Makes a happening of a domain's event, with a name and a time."""
    guarded = isinstance(event, Guard)
    leaves, latches = reset is None or reset.phase is not None, reset is not None and reset.latch is not None
    return Happening(domain.name, name, time, guarded and latches and not leaves, guarded and leaves)


def in_order(happenings: Sequence[Happening]) -> Order:
    """Returns the order of events.

    A guard that only latches in the instant in which another ends the phase is left out, for instance a spring that
    goes slack at lift-off: rounding decides which comes first.
    """
    kept: list[Happening] = []
    for each in happenings:
        while kept and each.leaves and kept[-1].passes and each.time - kept[-1].time < INSTANT:
            kept.pop()
        kept.append(each)
    return tuple((each.domain, each.name) for each in kept)


def order_of(system: HybridSystem, result: Run) -> Order:
    """Returns the order of the events of a run, of its last whole cycle if there is one."""
    events = result.events
    closed = [i + 1 for i, event in enumerate(events) if event.name == system.section]
    if result.cycles:
        events = events[closed[-2] if len(closed) > 1 else 0 : closed[-1]]
    guards = {(domain.name, guard.name): (domain, guard) for domain in system.domains for guard in domain.guards}
    found = []
    for event in events:
        if (event.domain, event.name) not in guards:  # a scheduled event, or one of motion on a switching surface
            found.append(Happening(event.domain, event.name, event.time, False, False))
            continue
        domain, guard = guards[event.domain, event.name]
        if not guard.observes:
            found.append(make_happening(domain, guard, guard.reset, event.name, event.time))
    return in_order(found)


def write_order(order: Order) -> str:
    """Writes an order in a line: domains, and after each its events."""
    words: list[str] = []
    domain = ""
    for name, event in order:
        words.append(event if name == domain else f"{name}: {event}")
        domain = name
    return ", ".join(words)


def find_differing(before: Order, after: Order) -> tuple[Order, Order]:
    """Returns the parts in which two orders differ, without their common beginning and end."""
    first, shorter = 0, min(len(before), len(after))
    while first < shorter and before[first] == after[first]:
        first += 1
    rest, last = (before[first:], after[first:]), 0
    while last < shorter - first and rest[0][-1 - last] == rest[1][-1 - last]:
        last += 1
    return rest[0][: len(rest[0]) - last], rest[1][: len(rest[1]) - last]
