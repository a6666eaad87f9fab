"""Events on entering a domain: decides which guard is an immediate event.

A guard can only be crossed once it has been positive. A guard that is on zero when the domain is entered is an
immediate event if it falls, and waits to become positive if it rises. If it stays on zero, it is an event if it ends
the phase, and no event otherwise. Of several events the first in the domain's order happens.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Guard

GLIMPSES = (1e-7, 1e-6, 1e-5, 1e-4)  # s: how far a guard on zero is followed to decide whether it rises or falls
AWAY = (1e-6, 1e-7, 1e-8, 1e-5, 1e-4)  # s: steps, tried in turn, that take guards off zero before any guard falls
CHANGE = 1e-14  # smallest change of a guard's value, in its unit, that is not rounding
BENT = 1e-9  # a value that changes sign at a kink is on zero within this, in its unit
NONE = -1


def thresholds(guards: Sequence[Guard]) -> list[float]:
    """Returns the values up to which guards count as zero on entering a domain; infinite for guards that must wait."""
    return [-math.inf if guard.waits else guard.tolerance for guard in guards]


def is_bent(kink: Any) -> Any:
    """Tells whether a value that changes sign at a kink of a law is on zero."""
    return abs(kink) <= BENT


def clear(values: Iterable[Any], kinks: Iterable[Any]) -> Any:
    """Tells whether no guard and no kink is on zero, so that a step can begin.

    Args:
        values: values of the guards that are not only observed.
        kinks: values that change sign where the law is not smooth.
    """
    free: Any = True
    for value in values:
        free = free & (value > 0.0)
    for kink in kinks:
        free = free & (abs(kink) > 0.0)
    return free


def stays_on_zero(guard: Guard, value: Any, change: Any) -> Any:
    """Tells whether a waiting guard stays on zero, as far as it was followed."""
    return (abs(change) <= CHANGE) & (value >= -guard.tolerance)


def falls(guard: Guard, value: Any, change: Any) -> Any:
    """Tells whether a waiting guard is an immediate event.

    Args:
        guard: the guard.
        value: its value, in its unit.
        change: change of its value a moment later.
    """
    return (value < -guard.tolerance) | (change < -CHANGE) | ((change <= CHANGE) & guard.leaves)


def at_once(guards: Sequence[Guard], values: Array, later: Callable[[float], Array]) -> NDArray[np.int64]:
    """Returns the index of the guard that is an immediate event in each of n lanes, or `NONE`, (n,).

    Args:
        guards: guards of the domain.
        values: values of the guards, (g, n).
        later: returns their values some seconds later, (g, n).
    """
    rows = list(zip(guards, values, strict=True))
    waiting = values <= np.array(thresholds(guards))[:, None]
    found = np.full(values.shape[1], NONE)
    if not waiting.any():
        return found
    change = np.zeros_like(values)
    for h in GLIMPSES:
        change = np.where(np.abs(change) <= CHANGE, later(h) - values, change)
        still = [stays_on_zero(guard, value, row) for (guard, value), row in zip(rows, change, strict=True)]
        if not (waiting & still).any():
            break
    events = waiting & [falls(guard, value, row) for (guard, value), row in zip(rows, change, strict=True)]
    some = events.any(axis=0)
    found[some] = events[:, some].argmax(axis=0)
    return found


def ahead(slope: Callable[[Any, Array], Array], t: Any, y: Array, h: float) -> Array:
    """Returns the state after one Runge-Kutta step, in which a toe at rest may leave by its acceleration or jerk.

    Args:
        slope: returns dy/dt at a time and a state.
        t: time, in s, or the time of each lane, (n,).
        y: state, or the states of n lanes as columns.
        h: step, in s.
    """
    k1 = slope(t, y)
    k2 = slope(t + 0.5 * h, y + 0.5 * h * k1)
    k3 = slope(t + 0.5 * h, y + 0.5 * h * k2)
    k4 = slope(t + h, y + h * k3)
    return np.asarray(y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), np.float64)
