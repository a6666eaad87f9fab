"""Switching surfaces: finds which domains alternate, the domain of that motion, and when it begins.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch alternates between them
without end, see `spear_pin.hybrid.filippov`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import ACTS, Alternation, Crossing, Domain, Guard, GuardValue, Held, Reset
from spear_pin.hybrid.fields import ADDED
from spear_pin.hybrid.rules.latching import latch_values

CHATTER = "chatter"
MOST_AT_ONCE = 8  # most immediate events within a phase before it is left
ON_EDGE = 1e-6  # margin of a share: where a force fades to zero, the motion begins with one law's share near 1
BEYOND = (0.0, 1e-4, 1e-3, 1e-2)  # how far a share may exceed its range, tried in turn


def alternation(system: HybridSystem, domains: Sequence[Domain], resets: Sequence[Reset]) -> Alternation | None:
    """Returns the alternation of two domains that lead into each other; None unless only one has a toe on the ground.

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
    """Tells whether two domains alternate: lift-off follows a touch immediately, and a touch follows lift-off.

    Args:
        between: the domains.
        left: the reset that immediately leaves the phase into which a touch leads.
        again: the reset that immediately leaves the phase into which lift-off leads.
    """
    return left is between.leave and again is between.touch


def chatter(between: Alternation | Crossing, beyond: float = 0.0) -> Domain:
    """Makes the domain of motion between other domains, which ends when a toe's switch can keep its state.

    It belongs to the phase in which the toes are in the air, and the other events of this phase may happen in it. The
    toes bear no force and their springs are not engaged.

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
    lasting = [guard for guard in airborne.guards if guard.reset is None or _lasts(guard.reset, toes)]
    made = replace(airborne, name=CHATTER, guards=(*guards, *lasting))
    return replace(made, between=between) if isinstance(between, Alternation) else replace(made, crossing=between)


def _lasts(reset: Reset, toes: set[str]) -> bool:
    """Tells whether an event may happen while toes alternate; at each touch a late switch is called off."""
    return not toes & {*reset.impact} and not any(edge.kind == ACTS for edge in reset.edges)


def _after(others: Sequence[Reset], reset: Reset) -> Reset:
    """Returns a reset that first latches the values of other resets."""

    def latch(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
        own = {name: value for name, value in held.items() if not name.startswith(ADDED)}  # p has what is added
        return latch_values(own, (*others, reset), q, v, p)

    return replace(reset, latch=latch) if others else reset


def _to_spare(i: int, end: float, beyond: float) -> GuardValue:
    """Returns a guard on the distance of a toe's share from 0 or 1."""

    def spare(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return end + (1.0 - 2.0 * end) * dyn.shares[i] + beyond  # shares are of motion on switching surfaces only

    return spare


def within(share: Any, beyond: float) -> Any:
    """Tells whether motion with a share can begin; a share that may exceed its range has to begin well inside."""
    margin = ON_EDGE if beyond == 0.0 else -0.1 * beyond
    return (share > -beyond - margin) & (share < 1.0 + beyond + margin)


def begins(event: Any, shares: Sequence[Any], beyond: float) -> Any:
    """Tells whether motion on switching surfaces can begin.

    Args:
        event: index of the guard of `chatter` that is an immediate event, or `entry.NONE`.
        shares: share of each toe.
        beyond: how far beyond 0 and 1 shares may go.
    """
    can = (event < 0) | (event >= 2 * len(shares))
    for share in shares:
        can = can & within(share, beyond)
    return can


def _name(domain: Domain, reset: Reset) -> str:
    return next(guard.name for guard in domain.guards if guard.reset is reset)
