"""Bifurcations of fixed points in one parameter: functions that change sign there, and where on the arc they do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.problem import NoValue, Problem
from spear_pin.gaits.continuation.stepping import Point, step_along
from spear_pin.hybrid.periodic import measure_exits

Multipliers = NDArray[np.complex128]
FOLD, FLIP, TORUS = "fold", "flip", "neimark_sacker"
SADDLE, CROSSING, KINK = "neutral_saddle", "unit_multiplier", "kink"
EXACT = 1e-9  # of the arc length
SAME = 1e-3  # share of a step: closer special points are one
BLUR = (5e-5, 2e-4)  # arc lengths: farther than differences reach, and four times that
BENT = 10.0  # lengths of these: a branch with a kink may be this far from its tangent
NOTHING = 1e-3  # change of a test function that is none
SMALL = 1e-3  # relative to nearby values: a test function that is larger at its sign change jumps
NONE: Multipliers = np.empty(0, dtype=np.complex128)


@dataclass(frozen=True)
class Special:
    """A point of a branch where a multiplier meets the unit circle, or where multipliers or the tangent jump.

    Attributes:
        kind: `FOLD` (the parameter turns), `FLIP` (a multiplier is -1: the period doubles), `TORUS` (a complex pair is
            on the unit circle), `SADDLE` (two real multipliers have the product 1, which does not change stability),
            `CROSSING` (a multiplier is 1 where the parameter does not turn), `KINK` (multipliers or the tangent jump,
            though the order of events is the same on both sides).
        point: the point.
        critical: the multipliers concerned, (1,) or (2,); empty for a kink.
    """

    kind: str
    point: Point
    critical: Multipliers


def _signs(point: Point) -> Array:
    """Returns what changes sign where the parameter turns, a multiplier is 1 or -1, or two have the product 1, (4,)."""
    return np.append(point.slope, measure_exits(point.local.multipliers))


def specials(problem: Problem, base: Point, end: Point, length: float) -> list[Special]:
    """Finds the special points between two points with the same order of events, in the order of the arc.

    Args:
        problem: the equations.
        base: the first point.
        end: the point that the step from `base` leads to.
        length: length of the step.
    """
    found: list[tuple[float, Special]] = []
    for k in np.flatnonzero(_signs(base) * _signs(end) < 0.0).tolist():

        def test(point: Point, k: int = k) -> float:
            return float(_signs(point)[k])

        at, point = locate_zero(problem, base, end, length, test)
        jumps = abs(test(point)) > SMALL * max(abs(test(base)), abs(test(end))) or _jumps(problem, point, test)
        found.append((at, Special(KINK, point, NONE) if jumps else _named(k, point)))
    found.sort(key=lambda each: each[0])
    return [special for i, (at, special) in enumerate(found) if not _said(found[:i], found, at, special, length)]


def _said(
    before: list[tuple[float, Special]], every: list[tuple[float, Special]], at: float, special: Special, length: float
) -> bool:
    """Tells whether another special point says the same: a fold a multiplier at 1, or another function a kink."""
    others = {CROSSING: (FOLD, every), KINK: (KINK, before)}
    if special.kind not in others:
        return False
    kind, among = others[special.kind]
    return any(other.kind == kind and abs(at - where) <= SAME * length for where, other in among)


def _jumps(problem: Problem, point: Point, test: Callable[[Point], float]) -> bool:
    """Tells whether a function changes as much close to a point as farther off; differences blur a jump there."""
    try:
        sides = [[test(step_along(problem, point, side * far, BENT)) for side in (-1.0, 1.0)] for far in BLUR]
    except NoValue:
        return False
    close, farther = (abs(after - before) for before, after in sides)
    return close > NOTHING and farther < 2.0 * close


def locate_zero(
    problem: Problem, base: Point, end: Point, length: float, test: Callable[[Point], float]
) -> tuple[float, Point]:
    """Finds where a function that changes sign on a step is zero, and the point there.

    Args:
        problem: the equations.
        base: the first point.
        end: the point that the step from `base` leads to.
        length: length of the step.
        test: the function whose zero is found.
    """
    seen = {0.0: base, length: end}

    def value(at: float) -> float:
        if at not in seen:
            seen[at] = step_along(problem, base, at, reach=2.0)
        return test(seen[at])

    try:
        root = float(scipy.optimize.brentq(value, 0.0, length, xtol=EXACT * max(length, 1e-3)))
        value(root)
    except NoValue:  # beside a border: as near as it came
        root = min(seen, key=lambda at: abs(test(seen[at])))
    return root, seen[root]


def _named(k: int, point: Point) -> Special:
    """Names the special point at which one of `_signs` changes."""
    values = point.local.multipliers
    if k < 3:
        nearest = values[[int(np.argmin(np.abs(values - (-1.0 if k == 2 else 1.0))))]]
        return Special((FOLD, CROSSING, FLIP)[k], point, nearest)
    i, j = np.triu_indices(len(values), 1)
    k = int(np.argmin(np.abs(values[i] * values[j] - 1.0)))
    pair = values[[i[k], j[k]]]
    return Special(TORUS if np.abs(pair.imag).max() > 0.0 else SADDLE, point, pair)
