"""Finds events in a domain: which guard is first to fall through zero, and when.

Between two integration steps a guard may fall and rise again. Guards of this package are as smooth as the motion. A
value halfway, from the cubic Hermite interpolant, and the parabola through three values show where to look closely.
A user's guards and grounds may vary faster than the motion, see `spear_pin.hybrid.span`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.own import is_own
from spear_pin.hybrid.rules.entry import ahead, at_once, stays_on_zero
from spear_pin.hybrid.span import NEGATIVE, POSITIVE, Step, glances, split_step

Interpolant = Callable[[float], Array]
BEND = -1  # stands for a guard's index
EARLY = np.geomspace(1e-4, 1.0, 25)  # where in a step it is seen whether a guard that begins on zero rises
ON_KNOT = 1e-9  # rad: within this of a knot, the motion has just passed it


class _Undefined(Exception):
    """A guard has no value at a state."""


class Watch:
    """Follows the guards of one domain step by step.

    A guard can only be crossed once it has been positive, see `rules.entry`.

    Attributes:
        at_once: index of the guard that is an event on entering, or `rules.entry.NONE`.
        undefined: whether some guard had no value where it was last evaluated.
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
        self._quick = {i for i, guard in enumerate(self._guards) if may_be_quick(flow, guard, t, y)}
        self._opaque = set[int]()  # guards that do not take intervals

    def step(
        self,
        ends: tuple[float, float],
        states: tuple[Array, Array],
        slopes: tuple[Array, Array],
        interpolate: Callable[[], Interpolant],
    ) -> list[tuple[float, int]]:
        """Returns the crossings within one integration step, earliest first, as (time, guard index).

        A guard without a value makes the watch `undefined` and has no crossing.

        Args:
            ends: beginning and end of the step, in s.
            states: y at both.
            slopes: dy/dt at both.
            interpolate: makes the step's interpolant; called only if there is a crossing to locate.
        """
        (t0, t1), (y0, y1), (f0, f1) = ends, states, slopes
        after = self._at(t1, y1)  # first, as the integrator has just evaluated it
        at_middle = self._at(0.5 * (t0 + t1), 0.5 * (y0 + y1) + (t1 - t0) / 8.0 * (f0 - f1))
        crossings: list[tuple[float, int]] = []
        within: Step | None = None
        interpolant = once(interpolate)
        for i, (before, middle, end) in enumerate(zip(self._values, at_middle, after, strict=True)):
            quick = i in self._quick
            if not quick and self._armed[i] and middle > 0.0 and end > 0.0 and not _dips(before, middle, end):
                continue  # the usual case
            try:
                if quick:
                    within = within or Step(self._flow, t0, t1, interpolant())
                    crossings += [(time, i) for time in self._parts(i, within, interpolant(), end)]
                    continue
                nodes = [(t0, before), (0.5 * (t0 + t1), middle), (t1, end)]
                time = self._crossing(i, nodes, interpolant)
            except _Undefined:
                self.undefined = True
                continue
            if time is not None:
                crossings.append((time, i))
        self._values = after
        return sorted(crossings + self._earlier(t0, crossings, interpolant)) if crossings else crossings

    def _earlier(
        self, begin: float, crossings: list[tuple[float, int]], interpolant: Callable[[], Interpolant]
    ) -> list[tuple[float, int]]:
        """Returns crossings that only the first one shows: of guards that fall just before it and rise after it."""
        until, solution, others = min(crossings)[0], interpolant(), {*self._quick, *(i for _, i in crossings)}
        found = list[tuple[float, int]]()
        for i in range(len(self._guards)):
            if i not in others and self._armed[i] and self._value(i, solution, until) < -self._guards[i].tolerance:
                if self._value(i, solution, begin) > 0.0:
                    found.append((_root(partial(self._value, i, solution), begin, until), i))
        return found

    def _parts(self, i: int, step: Step, solution: Interpolant, end: float) -> list[float]:
        """Returns the times at which a guard that may vary faster than a step falls through zero in it."""
        guard, found = self._guards[i], list[float]()
        time, before = step.span.begin, self._values[i]
        for begin, until, side in self._split(i, step):
            if side == POSITIVE or (side == NEGATIVE and self._armed[i]):
                if side == NEGATIVE:
                    found.append(begin)  # it jumps
                self._armed[i] = side == POSITIVE
            else:
                if time != begin:
                    before = self._value(i, solution, begin)
                middle = 0.5 * (begin + until)
                after = end if until == step.span.end else self._value(i, solution, until)
                nodes = [(begin, before), (middle, self._value(i, solution, middle)), (until, after)]
                crossing = self._crossing(i, nodes, lambda: solution)
                found += [] if crossing is None else [crossing]
                time, before = until, after
            if found and not guard.observes:
                break
        return found

    def _split(self, i: int, step: Step) -> Iterable[tuple[float, float, int]]:
        """Yields parts of a step in which a guard is on one side of zero, or that are short."""
        if i not in self._opaque:
            try:
                return list(split_step(self._guards[i], step))
            except Exception:  # a guard need not take intervals, and may raise anything
                self._opaque.add(i)
        return glances(step)

    def _crossing(
        self, i: int, nodes: list[tuple[float, float]], interpolant: Callable[[], Interpolant]
    ) -> float | None:
        """Returns when a guard falls through zero, if it does, given (time, value) at both ends and halfway."""
        (_, before), (_, middle), (_, end) = nodes
        if math.isnan(middle) or math.isnan(end):
            raise _Undefined
        floor = 0.0
        if self._armed[i]:
            if min(middle, end) > 0.0 and not _dips(before, middle, end):
                return None
        elif end > 0.0 or (self._guards[i].waits and middle <= 0.0 and not self._rises(i, nodes, interpolant)):
            self._armed[i] = end > 0.0
            if not self._guards[i].patience or min(middle, end) >= self._floors[i]:
                return None
            floor = self._floors[i]
        elif self._stays(i, before, middle, end):
            return None  # it stays on zero
        time = self._locate(i, nodes, interpolant(), floor)
        self._armed[i] = end > 0.0
        return time

    def _at(self, t: float, y: Array) -> list[float]:
        self._flow.visit(t, y)
        return [self._flow.value(guard, t, y) for guard in self._guards]

    def _stays(self, i: int, before: float, middle: float, end: float) -> bool:
        guard = self._guards[i]
        return bool(all(stays_on_zero(guard, before, value - before) for value in (middle, end)) and not guard.leaves)

    def _later(self, t: float, y: Array, h: float) -> Array:
        return np.array([self._at(t + h, ahead(self._flow, t, y, h))]).T

    def _rises(self, i: int, nodes: list[tuple[float, float]], interpolant: Callable[[], Interpolant]) -> bool:
        """Tells whether a guard with patience that is not positive halfway is so before."""
        guard, values = self._guards[i], [value for _, value in nodes]
        if not guard.patience or (max(values) < -guard.tolerance and not _dips(*(-value for value in values))):
            return False
        begin, end, solution = nodes[0][0], nodes[-1][0], interpolant()
        return any(self._value(i, solution, t) > 0.0 for t in begin + (end - begin) * EARLY)

    def _value(self, i: int, solution: Interpolant, t: float) -> float:
        y = solution(t)
        self._flow(t, y)
        value = self._flow.value(self._guards[i], t, y)
        if math.isnan(value):
            raise _Undefined
        return value

    def _locate(self, i: int, nodes: list[tuple[float, float]], solution: Interpolant, floor: float) -> float | None:
        """Returns when guard i first falls through a floor, given (time, value) at both ends and halfway.

        The value halfway is an estimate.
        """

        def value(t: float) -> float:
            return self._value(i, solution, t) - floor

        nodes = [(time, estimate - floor) for time, estimate in nodes]
        begin, end = nodes[0][0], nodes[-1][0]
        if not self._armed[i] and not floor:  # a guard that waits at zero may rise and fall again soon after
            nodes = [nodes[0], *((t, value(t)) for t in begin + (end - begin) * EARLY)]
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


def may_be_quick(flow: Flow, guard: Guard, t: float, y: Array) -> bool:
    """Tells whether a guard may fall and rise faster than the motion: a user's guard, or one of a user's ground."""
    if is_own(guard.value) or flow.system.ground.plane:
        return is_own(guard.value)
    asked = _Asked(flow)
    flow.visit(t, y)
    flow.value(guard, t, y, asked)
    return asked.height_was_asked


def once(interpolate: Callable[[], Interpolant]) -> Callable[[], Interpolant]:
    """Wraps a function that makes an interpolant, so that it is called only once."""
    made: list[Interpolant] = []

    def interpolant() -> Interpolant:
        if not made:
            made.append(interpolate())
        return made[0]

    return interpolant


class _Asked:
    """Wraps a flow, and records whether its height was used."""

    def __init__(self, flow: Flow) -> None:
        self._flow, self.height_was_asked = flow, False

    def height(self, frame: str) -> float:
        self.height_was_asked = True
        return self._flow.height(frame)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._flow, name)


def bends(
    flow: Flow, ends: tuple[float, float], states: tuple[Array, Array], interpolate: Callable[[], Interpolant]
) -> list[tuple[float, int]]:
    """Returns the times within one integration step at which the motion passes a knot of its flow, each with `BEND`.

    A step across a knot would be far less accurate than the tolerance.

    Args:
        flow: the motion.
        ends: beginning and end of the step, in s.
        states: y at both.
        interpolate: makes the step's interpolant.
    """
    found = []
    nv = flow.system.robot.nv
    for knot in flow.knots:
        before, after = (knot(y[:nv]) for y in states)
        if abs(before) > ON_KNOT and before * after < 0.0:
            side, solution = math.copysign(1.0, before), interpolate()
            found.append((_root(partial(_beyond, solution, knot, nv, side), *ends), BEND))
    return found


def _beyond(solution: Interpolant, knot: Callable[[Array], float], nv: int, side: float, t: float) -> float:
    return side * knot(solution(t)[:nv])


def _root(value: Callable[[float], float], left: float, right: float) -> float:
    # the interpolant may differ from the values that bracketed the root in the last digits
    if value(left) <= 0.0:
        return left
    if value(right) > 0.0:
        return right
    # as close as doubles allow or, if the guard is too flat for that, as close as possible
    root, _ = scipy.optimize.brentq(value, left, right, xtol=1e-15, rtol=8.9e-16, full_output=True, disp=False)
    return float(root)


def _dips(before: float, middle: float, end: float) -> bool:
    """Tells whether the parabola through three positive values comes close to zero between them."""
    curvature, fall = 2.0 * (before - 2.0 * middle + end), 3.0 * before - 4.0 * middle + end
    if curvature <= 0.0 or not 0.0 < fall < 2.0 * curvature:
        return False
    return before - fall**2 / (4.0 * curvature) <= 0.05 * max(before, middle, end)
