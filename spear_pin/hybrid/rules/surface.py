"""Switching surfaces: which domains alternate, the domain of that motion, and when it begins.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch alternates between them
without end, see `spear_pin.hybrid.filippov`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Alternation, Crossing, Domain, Guard, GuardValue, Held, Reset
from spear_pin.hybrid.rules.latching import latched

CHATTER = "chatter"
MOST_AT_ONCE = 8  # events within a phase before it is left
ON_EDGE = 1e-6  # of a share: where a force fades to zero, the motion begins with one law's share all but whole
BEYOND = (0.0, 1e-4, 1e-3, 1e-2)  # of a share: tried in turn


def alternation(system: HybridSystem, domains: Sequence[Domain], resets: Sequence[Reset]) -> Alternation | None:
    """Alternation of two domains that lead into each other: None unless just one has a toe on the ground.

    Args:
        system: the system.
        domains: the two domains.
        resets: the reset by which each of them is left.
    """
    for (grounded, airborne), (leave, touch) in ((domains, resets), (domains[::-1], resets[::-1])):
        closed = [
            toe
            for toe, on, off in zip(system.robot.toes, grounded.contacts, airborne.contacts, strict=True)
            if on != OPEN and off == OPEN
        ]
        if len(closed) == 1 and airborne.between is None:
            return Alternation(grounded, airborne, touch, leave, closed[0])
    return None


def leads_round(between: Alternation, left: Reset | None, again: Reset | None) -> bool:
    """Whether two domains alternate: a touch is followed at once by leaving, and that by a touch.

    Args:
        between: the domains.
        left: the reset by which the phase is left at once that a touch leads into.
        again: the one by which that is left at once that leaving leads into.
    """
    return left is between.leave and again is between.touch


def chatter(between: Alternation | Crossing, beyond: float = 0.0) -> Domain:
    """The domain of motion between others; it ends when a toe's switch can stay as it is.

    It belongs to the phase in which the toes are in the air, whose other events may happen in it: they bear nothing
    and their springs are not engaged.

    Args:
        between: the domains.
        beyond: how far beyond 0 and 1 a share may go.
    """
    surfaces = ((between, between),) if isinstance(between, Alternation) else between.surfaces
    airborne, toes, guards = surfaces[0][0].airborne, set[str](), list[Guard]()
    for i, (alone, beside) in enumerate(surfaces):
        lands, leaves = _name(beside.airborne, beside.touch), _name(alone.grounded, alone.leave)
        others = surfaces[1 - i][0].touching if len(surfaces) == 2 else ()  # it alternates on: it has just touched
        guards += [
            Guard(lands, _to_spare(i, 1.0, beyond), _after(others, beside.touch), tolerance=ON_EDGE),
            Guard(leaves, _to_spare(i, 0.0, beyond), alone.leave, tolerance=ON_EDGE),
        ]
        toes.add(alone.toe)
    lasting = [guard for guard in airborne.guards if guard.reset is None or not toes & {*guard.reset.impact}]
    made = replace(airborne, name=CHATTER, guards=(*guards, *lasting))
    return replace(made, between=between) if isinstance(between, Alternation) else replace(made, crossing=between)


def _after(others: Sequence[Reset], reset: Reset) -> Reset:
    """A reset that latches what others do first."""

    def latch(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
        return latched(held, (*others, reset), q, v, p)

    return replace(reset, latch=latch) if others else reset


def _to_spare(i: int, end: float, beyond: float) -> GuardValue:
    """Distance of a toe's share from 0 or 1."""

    def spare(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return end + (1.0 - 2.0 * end) * dyn.shares[i] + beyond  # shares are of motion on switching surfaces only

    return spare


def within(share: Any, beyond: float) -> Any:
    """Whether motion with a share can begin; where the share may go beyond its ends, it has to be well inside."""
    margin = ON_EDGE if beyond == 0.0 else -0.1 * beyond
    return (share > -beyond - margin) & (share < 1.0 + beyond + margin)


def begins(event: Any, shares: Sequence[Any], beyond: float) -> Any:
    """Whether motion on switching surfaces can begin.

    Args:
        event: index of the guard of `chatter` that is an event at once, or `entry.NONE`.
        shares: of each toe.
        beyond: how far beyond 0 and 1 they may go.
    """
    can = (event < 0) | (event >= 2 * len(shares))
    for share in shares:
        can = can & within(share, beyond)
    return can


def _name(domain: Domain, reset: Reset) -> str:
    return next(guard.name for guard in domain.guards if guard.reset is reset)
