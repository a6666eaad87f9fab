"""Lanes that enter a phase: chooses the domain that fits each of them, and finds its immediate events.

This module decides for many states what `modes.fitting` and `events.Watch` decide for one.
"""

from __future__ import annotations

import numpy as np

from spear_pin.hybrid.engines.taylor import Point, Ready
from spear_pin.hybrid.lanes.groups import Flags, Group, Indices
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.rules.entry import AWAY, NONE, at_once, clear, is_bent, thresholds
from spear_pin.hybrid.rules.footing import LEAVES


def choose(numbers: Numbers, phase: str, group: Group) -> tuple[list[tuple[Ready, Group, Point]], Group]:
    """Chooses the domain of a phase that fits each lane, evaluates it, and returns it with the lanes that none fits.

    The choice is by `rules.footing.fitness`; where none fits, it is one in which all toes that cannot stay leave.
    """
    domains, chosen = numbers.system.of_phase(phase), []
    best, which = np.full(len(group), -np.inf), np.zeros(len(group), np.int64)
    for i, domain in enumerate(domains):
        asking = (best < np.inf) & domain.suits(group.held)
        if not asking.any():
            continue
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


def first_event(numbers: Numbers, ready: Ready, group: Group, point: Point) -> tuple[Indices, Flags]:
    """Returns the guard of each lane that is an event on entering a domain, or `NONE`, and whether any guard is zero.

    A kink on zero counts as well.
    """
    waiting = (point.guards <= np.array(thresholds(ready.domain.guards))[:, None]).any(axis=0)
    found = np.full(len(group), NONE)
    if waiting.any():
        some = group.take(waiting)
        later = lambda h: numbers.at(ready, numbers.ahead(ready, some, h)).guards  # noqa: E731
        found[waiting] = at_once(ready.domain.guards, point.guards[:, waiting], later)
    return found, waiting | is_bent(point.kinks).any(axis=0)


def find_sinking(numbers: Numbers, ready: Ready, group: Group, point: Point) -> Flags:
    """Tells in which lanes a guard with patience is on zero and falls: no step would show it."""
    guards = ready.domain.guards
    patient = [i for i, guard in enumerate(guards) if 0.0 < guard.patience < np.inf]
    below = point.guards[patient] <= np.array([guards[i].tolerance for i in patient])[:, None]
    if not below.any():
        return np.zeros(len(group), bool)
    falls = below & (numbers.at(ready, numbers.ahead(ready, group, AWAY[0])).guards[patient] <= 0.0)
    return np.asarray(falls.any(axis=0))


def away(numbers: Numbers, ready: Ready, group: Group) -> tuple[list[Group], Group]:
    """Returns lanes a moment later, where no guard is zero any more, and the lanes for which that fails."""
    gone, happening = [], np.isfinite(thresholds(ready.domain.guards))
    for h in AWAY:
        if not len(group):
            break
        later = numbers.ahead(ready, group, h)
        point = numbers.at(ready, later)
        free = clear(point.guards[happening], point.kinks) & np.ones(len(group), bool)
        if free.any():
            gone.append(later.take(free))
        group = group.take(~free)
    return gone, group
