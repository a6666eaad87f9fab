"""Orders of events: what happens in a cycle, one after the other, and in which domain each.

Where the order is the same the return map is smooth; it is another on the two sides of a border.
"""

from __future__ import annotations

from collections.abc import Sequence

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import Run

Order = tuple[tuple[str, str], ...]
"""(domain, event) of each event that changes something, in the order in which they happen."""


def order_of(system: HybridSystem, result: Run) -> Order:
    """The order of the events of a run; its last whole cycle's, if there is one."""
    seen = {(d.name, guard.name) for d in system.domains for guard in d.guards if guard.observes}
    pairs = [(event.domain, event.name) for event in result.events]
    closed = [i for i, (_, name) in enumerate(pairs) if name == system.section]
    begin = closed[-2] + 1 if len(closed) > 1 else 0
    until = closed[-1] + 1 if result.cycles and closed else len(pairs)
    return tuple(pair for pair in pairs[begin if result.cycles else 0 : until] if pair not in seen)


def said(order: Sequence[tuple[str, str]]) -> str:
    """An order in a line: domains, and behind each what happens in it."""
    words: list[str] = []
    domain = ""
    for name, event in order:
        words.append(event if name == domain else f"{name}: {event}")
        domain = name
    return ", ".join(words) or "nothing"


def differing(before: Order, after: Order) -> tuple[Order, Order]:
    """What of two orders is not the same, between what begins and what ends alike."""
    first = next((i for i, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), min(map(len, (before, after))))
    rest = before[first:], after[first:]
    last = 0
    while last < min(map(len, rest)) and rest[0][-1 - last] == rest[1][-1 - last]:
        last += 1
    return rest[0][: len(rest[0]) - last], rest[1][: len(rest[1]) - last]
