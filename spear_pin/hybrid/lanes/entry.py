"""Lanes that enter a phase: which domain fits them, and what happens there at once.

What `modes.fitting` and `events.Watch` decide for one state, for many.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.contact import STICK
from spear_pin.hybrid.engines.taylor import BENT, Point, Ready
from spear_pin.hybrid.events import CHANGE, GLIMPSES
from spear_pin.hybrid.lanes.groups import Flags, Group, Indices
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.modes import STARTS_TO_SLIDE
from spear_pin.hybrid.phases import AT_REST, SIGN, UNLOADED

Array = NDArray[np.float64]
AWAY = (1e-6, 1e-7, 1e-8, 1e-5, 1e-4)  # s: in one of them guards on zero become positive and no other falls


def choose(numbers: Numbers, phase: str, group: Group) -> tuple[list[tuple[Ready, Group, Point]], Group]:
    """The domain of a phase that fits each lane, evaluated there, and the lanes that none fits.

    Where toes begin to slide from rest it is the one that pushes them off best. Where the forces fit none, it is the
    first in which the toes that cannot stay would have to be held down: they leave.
    """
    domains, chosen = numbers.system.of_phase(phase), []
    best, pushing = np.full(len(group), -np.inf), np.full(len(group), -1)
    for i, domain in enumerate(domains):
        asking = best < np.inf
        if not asking.any():
            break
        some = group.take(asking)
        ready = numbers.compiled(domain, some)
        point = numbers.at(ready, some)
        push = _push(ready, point, numbers.friction(some.lanes))
        pushing[asking] = np.where(push > best[asking], i, pushing[asking])
        best[asking] = np.maximum(push, best[asking])
        if (fits := push == np.inf).any():
            chosen.append((ready, some.take(fits), point.take(fits)))
    for i in np.unique(pushing[np.isfinite(best)]):
        some = group.take(np.isfinite(best) & (pushing == i))
        ready = numbers.compiled(domains[i], some)
        chosen.append((ready, some, numbers.at(ready, some)))
    group = group.take(pushing < 0)
    for domain in domains:
        if not len(group):
            break
        ready = numbers.compiled(domain, group)
        point = numbers.at(ready, group)
        fits = _moves(ready, point) & _leaves(ready, point, numbers.friction(group.lanes))
        if fits.any():
            chosen.append((ready, group.take(fits), point.take(fits)))
        group = group.take(~fits)
    return chosen, group


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


def _moves(ready: Ready, point: Point) -> Flags:
    """Whether the sliding of every closed toe fits its mode."""
    fits = np.ones(point.slopes.shape[1], bool)
    for (_, mode), sliding in zip(ready.closed, point.sliding, strict=True):
        at_rest = np.abs(sliding) <= AT_REST
        fits &= at_rest if mode == STICK else at_rest | (sliding * SIGN[mode] > 0.0)
    return fits


def _stays(ready: Ready, point: Point, friction: Any) -> Flags:
    """Whether the forces keep each closed toe in its mode, (c, n)."""
    stays = np.empty(point.sliding.shape, bool)
    for i, (_, mode) in enumerate(ready.closed):
        tangential, normal = point.forces[i]
        if mode == STICK:
            stays[i] = np.abs(tangential) < friction * normal - UNLOADED
        else:
            pushed = point.accelerations[i] * SIGN[mode] > -STARTS_TO_SLIDE
            stays[i] = pushed | (np.abs(point.sliding[i]) > AT_REST)
        stays[i] &= normal > 0.0
    return stays & (point.pivots > 0.0).all(axis=0)


def _push(ready: Ready, point: Point, friction: Any) -> Array:
    """Least acceleration along its mode of a toe that begins to slide, in m/s², (n,), as `modes.fitting` has it.

    Infinite where none begins to, and minus infinity where the domain does not fit.
    """
    push = np.full(point.slopes.shape[1], np.inf)
    for i, (_, mode) in enumerate(ready.closed):
        if mode != STICK:
            begins = np.abs(point.sliding[i]) <= AT_REST
            push = np.where(begins, np.minimum(push, point.accelerations[i] * SIGN[mode]), push)
    fits = _moves(ready, point) & _stays(ready, point, friction).all(axis=0)
    return np.where(fits, push, -np.inf)


def _leaves(ready: Ready, point: Point, friction: Any) -> Flags:
    """Whether those that are not kept would have to be held down."""
    pulled = (point.forces[:, 1] <= 0.0) & (point.pivots > 0.0).all(axis=0)
    return np.asarray((_stays(ready, point, friction) | pulled).all(axis=0))
