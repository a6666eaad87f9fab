"""Find events in a domain: which guard is first to fall through zero, and when.

Between two integration steps a guard may fall and rise again; a value halfway, from the cubic
Hermite interpolant, and the parabola through the three tell where to look more closely.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.rules.entry import ahead, at_once, stays_on_zero

Interpolant = Callable[[float], Array]
BEND = -1  # in the place of a guard's index
ON_KNOT = 1e-9  # rad: it has just been passed


class _Undefined(Exception):
    """A guard has no value there."""


class Watch:
    """The guards of one domain, followed step by step.

    A guard can only be crossed once it has been positive, see `rules.entry`.

    Attributes:
        at_once: index of the guard that is an event on entering, or `rules.entry.NONE`.
        undefined: whether some guard had no value where it was last looked at.
    """

    def __init__(self, flow: Flow, t: float, y: Array) -> None:
        self._flow, self._guards = flow, flow.domain.guards
        self._values = self._at(t, y)
        self._armed = [value > guard.tolerance for value, guard in zip(self._values, self._guards, strict=True)]
        self._floors = [
            min(value, 0.0) - guard.patience for value, guard in zip(self._values, self._guards, strict=True)
        ]
        self.undefined = any(math.isnan(value) for value in self._values)
        self.at_once = int(at_once(self._guards, np.array([self._values]).T, lambda h: self._later(t, y, h))[0])

    def step(
        self,
        ends: tuple[float, float],
        states: tuple[Array, Array],
        slopes: tuple[Array, Array],
        interpolate: Callable[[], Interpolant],
    ) -> list[tuple[float, int]]:
        """Crossings within one integration step, earliest first, as (time, guard index).

        A guard without a value makes the watch `undefined` and has no crossing.

        Args:
            ends: beginning and end of the step.
            states: y there.
            slopes: dy/dt there.
            interpolate: makes the step's interpolant; called only if there is something to locate.
        """
        (t0, t1), (y0, y1), (f0, f1) = ends, states, slopes
        after = self._at(t1, y1)  # first: the integrator has just been there
        at_middle = self._at(0.5 * (t0 + t1), 0.5 * (y0 + y1) + (t1 - t0) / 8.0 * (f0 - f1))
        crossings: list[tuple[float, int]] = []
        solution: Interpolant | None = None
        for i, (before, middle, end) in enumerate(zip(self._values, at_middle, after, strict=True)):
            if math.isnan(middle) or math.isnan(end):
                self.undefined = True
                continue
            floor = 0.0
            if self._armed[i]:
                if min(middle, end) > 0.0 and not _dips(before, middle, end):
                    continue
            elif end > 0.0 or (self._guards[i].waits and middle <= 0.0):
                self._armed[i] = end > 0.0
                if not self._guards[i].patience or min(middle, end) >= self._floors[i]:
                    continue
                floor = self._floors[i]
            elif self._stays(i, middle, end):
                continue  # it stays on zero
            solution = solution or interpolate()
            nodes = [(t0, self._values[i]), (0.5 * (t0 + t1), middle), (t1, end)]
            try:
                time = self._locate(i, nodes, solution, floor)
            except _Undefined:
                self.undefined = True
                continue
            self._armed[i] = end > 0.0
            if time is not None:
                crossings.append((time, i))
        self._values = after
        return sorted(crossings)

    def _at(self, t: float, y: Array) -> list[float]:
        self._flow.visit(t, y)
        return [self._flow.value(guard, t, y) for guard in self._guards]

    def _stays(self, i: int, middle: float, end: float) -> bool:
        before, guard = self._values[i], self._guards[i]
        return bool(all(stays_on_zero(guard, before, value - before) for value in (middle, end)) and not guard.leaves)

    def _later(self, t: float, y: Array, h: float) -> Array:
        return np.array([self._at(t + h, ahead(self._flow, t, y, h))]).T

    def _locate(self, i: int, nodes: list[tuple[float, float]], solution: Interpolant, floor: float) -> float | None:
        """When guard i first falls through a floor, given (time, value) at both ends and halfway, there an estimate."""

        def value(t: float) -> float:
            y = solution(t)
            self._flow(t, y)
            result = self._flow.value(self._guards[i], t, y)
            if math.isnan(result):
                raise _Undefined
            return result - floor

        nodes = [(time, estimate - floor) for time, estimate in nodes]
        begin, end = nodes[0][0], nodes[-1][0]
        if not self._armed[i] and not floor:  # it waits at zero: it may rise and fall again soon after
            nodes = [nodes[0], *((t, value(t)) for t in begin + (end - begin) * np.geomspace(1e-4, 1.0, 25))]
            if all(g <= 0.0 for _, g in nodes):
                return begin
        else:
            nodes = [nodes[0], (nodes[1][0], value(nodes[1][0])), nodes[2]]
        rising = next(k for k, (_, g) in enumerate(nodes) if g > 0.0)
        for (left, _), (right, g) in pairwise(nodes[rising:]):
            if g <= 0.0:
                return _root(value, left, right)
        dip = scipy.optimize.minimize_scalar(value, bounds=(begin, end), method="bounded")
        return _root(value, begin, float(dip.x)) if dip.fun <= 0.0 else None


def bends(
    flow: Flow, ends: tuple[float, float], states: tuple[Array, Array], interpolate: Callable[[], Interpolant]
) -> list[tuple[float, int]]:
    """Times within one integration step at which the motion passes a knot of its flow, each with `BEND`.

    Integrated across, it would be far less accurate than the tolerance asks for.

    Args:
        flow: the motion.
        ends: beginning and end of the step.
        states: y there.
        interpolate: makes the step's interpolant.
    """
    found = []
    for index, angle in flow.knots:
        before, after = (float(y[index]) - angle for y in states)
        if abs(before) > ON_KNOT and before * after < 0.0:
            side, solution = math.copysign(1.0, before), interpolate()
            found.append((_root(partial(_beyond, solution, index, angle, side), *ends), BEND))
    return found


def _beyond(solution: Interpolant, index: int, angle: float, side: float, t: float) -> float:
    return side * (float(solution(t)[index]) - angle)


def _root(value: Callable[[float], float], left: float, right: float) -> float:
    # the interpolant may differ from the values that bracketed the root in the last digits
    if value(left) <= 0.0:
        return left
    if value(right) > 0.0:
        return right
    # as close as doubles allow, and where the guard is too flat for that, as close as it gets
    root, _ = scipy.optimize.brentq(value, left, right, xtol=1e-15, rtol=8.9e-16, full_output=True, disp=False)
    return float(root)


def _dips(before: float, middle: float, end: float) -> bool:
    """Whether the parabola through three positive values comes close to zero between them."""
    curvature, fall = 2.0 * (before - 2.0 * middle + end), 3.0 * before - 4.0 * middle + end
    if curvature <= 0.0 or not 0.0 < fall < 2.0 * curvature:
        return False
    return before - fall**2 / (4.0 * curvature) <= 0.05 * max(before, middle, end)
