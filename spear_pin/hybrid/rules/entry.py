"""Events on entering a domain: which guard is an event at once.

A guard can only be crossed once it has been positive. One that is on zero when the domain is entered is an event at
once if it falls from there, and waits to become positive if it rises. One that stays there is an event if it ends the
phase, and none within it. Of several the first in the domain's order happens.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Guard

GLIMPSES = (1e-7, 1e-6, 1e-5)  # s: how far a guard on zero is followed to tell whether it rises or falls
AWAY = (1e-6, 1e-7, 1e-8, 1e-5, 1e-4)  # s: steps, tried in turn, that take guards on zero off it before none falls
CHANGE = 1e-14  # of a guard's value, in its unit: less is rounding
BENT = 1e-9  # what changes sign at a kink is on zero within this, in its unit
NONE = -1


def thresholds(guards: Sequence[Guard]) -> list[float]:
    """Values up to which guards count as on zero where the domain is entered; infinite for those that have to wait."""
    return [-math.inf if guard.waits else guard.tolerance for guard in guards]


def bent(kink: Any) -> Any:
    """Whether what changes sign at a kink of a law is on zero."""
    return abs(kink) <= BENT


def clear(values: Iterable[Any], kinks: Iterable[Any]) -> Any:
    """Whether no guard and no kink is on zero, so that a step can begin there.

    Args:
        values: of the guards that are more than observed.
        kinks: what changes sign where the law is not smooth.
    """
    free: Any = True
    for value in values:
        free = free & (value > 0.0)
    for kink in kinks:
        free = free & (abs(kink) > 0.0)
    return free


def stays_on_zero(guard: Guard, value: Any, change: Any) -> Any:
    """Whether a guard that waits stays on zero, as far as that was followed."""
    return (abs(change) <= CHANGE) & (value >= -guard.tolerance)


def falls(guard: Guard, value: Any, change: Any) -> Any:
    """Whether a guard that waits is an event at once.

    Args:
        guard: the guard.
        value: its value, in its unit.
        change: by how much it differs a moment later.
    """
    return (value < -guard.tolerance) | (change < -CHANGE) | ((change <= CHANGE) & guard.leaves)


def at_once(guards: Sequence[Guard], values: Array, later: Callable[[float], Array]) -> NDArray[np.int64]:
    """Index of the guard that is an event at once in each of n lanes, or `NONE`, (n,).

    Args:
        guards: the domain's.
        values: of the guards, (g, n).
        later: their values some seconds after, (g, n).
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
    """State one Runge-Kutta step on: a toe at rest leaves by its acceleration or jerk.

    Args:
        slope: dy/dt at a time and a state.
        t: time, in s, or that of each lane, (n,).
        y: state, or those of n lanes as columns.
        h: step, in s.
    """
    k1 = slope(t, y)
    k2 = slope(t + 0.5 * h, y + 0.5 * h * k1)
    k3 = slope(t + 0.5 * h, y + 0.5 * h * k2)
    k4 = slope(t + h, y + h * k3)
    return np.asarray(y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), np.float64)
