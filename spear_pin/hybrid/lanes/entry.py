"""Lanes that enter a phase: which domain fits them, and what happens there at once.

What `modes.fitting` and `events.Watch` decide for one state, for many.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.engines.taylor import BENT, Point, Ready
from spear_pin.hybrid.events import CHANGE, GLIMPSES
from spear_pin.hybrid.lanes.groups import Flags, Group, Indices
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.rules.footing import LEAVES

Array = NDArray[np.float64]
AWAY = (1e-6, 1e-7, 1e-8, 1e-5, 1e-4)  # s: in one of them guards on zero become positive and no other falls


def choose(numbers: Numbers, phase: str, group: Group) -> tuple[list[tuple[Ready, Group, Point]], Group]:
    """The domain of a phase that fits each lane, evaluated there, and the lanes that none fits.

    By `rules.footing.fitness`; where none fits, it is one in which all toes that cannot stay leave.
    """
    domains, chosen = numbers.system.of_phase(phase), []
    best, which = np.full(len(group), -np.inf), np.zeros(len(group), np.int64)
    for i, domain in enumerate(domains):
        asking = best < np.inf
        if not asking.any():
            break
        some = group.take(asking)
        ready = numbers.compiled(domain, some)
        point = numbers.at(ready, some)
        fits = ready.fitness(point)
        which[asking] = np.where(fits > best[asking], i, which[asking])
        best[asking] = np.maximum(fits, best[asking])
        if (found := fits == np.inf).any():
            chosen.append((ready, some.take(found), point.take(found)))
    others = (best >= LEAVES) & (best < np.inf)
    for i in np.unique(which[others]):
        some = group.take(others & (which == i))
        ready = numbers.compiled(domains[i], some)
        chosen.append((ready, some, numbers.at(ready, some)))
    return chosen, group.take(~(best >= LEAVES))


def at_once(numbers: Numbers, ready: Ready, group: Group, point: Point) -> tuple[Indices, Flags]:
    """Of each lane the guard that is an event on entering a domain, or -1, and whether something is on zero there."""
    tolerances = np.array([guard.tolerance for guard in ready.domain.guards])[:, None]
    waiting = (point.guards <= tolerances) & _happening(ready)
    on_zero: Flags = np.asarray(waiting.any(axis=0) | (np.abs(point.kinks) <= BENT).any(axis=0))
    found = np.full(len(group), -1)
    if not on_zero.any():
        return found, on_zero
    some, now, waiting = group.take(on_zero), point.guards[:, on_zero], waiting[:, on_zero]
    change = np.zeros_like(now)
    for h in GLIMPSES:
        later = numbers.at(ready, numbers.ahead(ready, some, h)).guards
        change = np.where(np.abs(change) <= CHANGE, later - now, change)
        if (np.abs(change) > CHANGE)[waiting].all():
            break
    leaving = np.array([guard.leaves for guard in ready.domain.guards])[:, None]
    falls = waiting & ((now < -tolerances) | (change < -CHANGE) | (leaving & (change <= CHANGE)))
    found[on_zero] = np.where(falls.any(axis=0), falls.argmax(axis=0), -1)
    return found, on_zero


def away(numbers: Numbers, ready: Ready, group: Group) -> tuple[list[Group], Group]:
    """Lanes a moment later, where no guard is on zero any more, and those that do not get there."""
    clear = []
    for h in AWAY:
        if not len(group):
            break
        later = numbers.ahead(ready, group, h)
        point = numbers.at(ready, later)
        free = ((point.guards > 0.0) | ~_happening(ready)).all(axis=0) & (np.abs(point.kinks) > 0.0).all(axis=0)
        if free.any():
            clear.append(later.take(free))
        group = group.take(~free)
    return clear, group


def _happening(ready: Ready) -> Flags:
    """Which guards are more than observed, (g, 1)."""
    return np.array([not guard.observes for guard in ready.domain.guards])[:, None]
