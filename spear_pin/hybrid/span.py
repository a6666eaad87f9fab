"""One integration step as polynomials of time, and its parts in which a guard may not be on one side of zero.

State and dynamics along a step are polynomials. Their values lie between the least and the greatest coefficient in
Bernstein's basis. So a guard is evaluated with intervals for all times of a step at once. Where the answer may have
either sign, the part is halved, down to `SHORTEST` and, while there are few parts, down to `LEAST`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import comb
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.intervals import INTERVALS, Interval, Unsure, bounds, enclose

SHORTEST = 1e-5  # s: a guard that is on the other side of zero for less may pass unseen
LEAST, MANY = 1e-9, 500  # s, and number of parts of a step up to which this shorter time is resolved
GLANCE = 2e-4  # s: the same for a guard that does not take intervals, evaluated at both ends and halfway
DEGREE = 7  # of the integrator's interpolant
POSITIVE, NEGATIVE, UNKNOWN = 1, -1, 0
STATE, PLACE, HEIGHT = "state", "place", "height"  # known along a step without its dynamics

NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
CHECKS = np.array([0.31, 0.79])  # points at which other functions are compared with the polynomial through the nodes


def _basis(x: Array) -> Array:
    """Returns Bernstein's polynomials at n points, (n, DEGREE + 1)."""
    k = np.arange(DEGREE + 1)
    return np.array([comb(DEGREE, i) for i in k]) * x[:, None] ** k * (1.0 - x[:, None]) ** (DEGREE - k)


_FITTED = np.linalg.inv(_basis(NODES))
_CHECKED = _basis(CHECKS) @ _FITTED
_HALVES = tuple(_FITTED @ _basis(half) for half in (0.5 * NODES, 0.5 + 0.5 * NODES))


class Span:
    """A step, or a part of it.

    Args:
        whole: the step.
        begin: beginning of the part, in s.
        end: end of the part, in s.
        half: the part of which it is a half, and the number of the half; None for the step.
    """

    def __init__(self, whole: Step, begin: float, end: float, half: tuple[Span, int] | None = None) -> None:
        self.whole, self.begin, self.end, self._half = whole, begin, end, half
        self._coefficients: dict[Any, Array] = {}

    def halves(self) -> tuple[Span, Span]:
        """Returns its first and its second half."""
        middle = 0.5 * (self.begin + self.end)
        return Span(self.whole, self.begin, middle, (self, 0)), Span(self.whole, middle, self.end, (self, 1))

    def coefficients(self, what: Any) -> Array:
        """Returns the coefficients in Bernstein's basis of a quantity of the step, (8, m)."""
        if what not in self._coefficients:
            if self._half is None:
                found, *_ = self.whole.known(what)
            else:
                whole, which = self._half
                found = _HALVES[which] @ whole.coefficients(what)
            self._coefficients[what] = found
        return self._coefficients[what]

    def enclosure(self, what: Any) -> Any:
        """Returns all values of a quantity between begin and end, as an interval or an array of intervals."""
        coefficients, (_, error, shape) = self.coefficients(what), self.whole.known(what)
        low, high = coefficients.min(axis=0) - error, coefficients.max(axis=0) + error
        return enclose(low.reshape(shape), high.reshape(shape))

    def value(self, guard: Guard) -> tuple[float, float]:
        """Returns the least and the greatest value that a guard may have.

        Raises:
            Unsure: they are not known.
        """
        flow = self.whole.flow
        nv = flow.system.robot.nv
        y = self.enclosure(STATE)
        time = Interval(self.begin, self.end)
        try:
            found = guard.value(time, y[:nv], y[nv : 2 * nv], flow.held, flow.p, _Dynamics(self), INTERVALS)
        except ArithmeticError:
            raise Unsure from None
        return bounds(found)


class Step:
    """Quantities of a step, computed when they are first needed.

    Args:
        flow: the motion.
        begin: beginning of the step, in s.
        end: end of the step, in s.
        solution: the integrator's interpolant.
    """

    def __init__(self, flow: Flow, begin: float, end: float, solution: Callable[[Any], Array]) -> None:
        self.flow, self._solution = flow, solution
        self._times = begin + (end - begin) * np.concatenate([NODES, CHECKS])
        self._states = np.ascontiguousarray(solution(self._times).T)
        self._fitted: dict[Any, tuple[Array, Array, tuple[int, ...]]] = {}
        self.span = Span(self, begin, end)

    def known(self, what: Any) -> tuple[Array, Array, tuple[int, ...]]:
        """Returns the coefficients of a quantity, (8, m), by how much it may differ from them, (m,), and its shape."""
        if what not in self._fitted:
            values = np.array(self._values(what), dtype=float)
            if not np.isfinite(values).all():
                raise ValueError("no value somewhere in the step")
            flat = values.reshape(len(values), -1)
            nodes, checks = flat[: len(NODES)], flat[len(NODES) :]
            error = np.zeros(flat.shape[1]) if what == STATE else 2.0 * np.abs(_CHECKED @ nodes - checks).max(axis=0)
            self._fitted[what] = _FITTED @ nodes, error, values.shape[1:]
        return self._fitted[what]

    def _values(self, what: Any) -> Any:
        """Returns a quantity at the nodes and at `CHECKS`."""
        if what == STATE:
            return self._states
        name, arguments = what
        if name in (PLACE, HEIGHT):
            (frame,) = arguments
            places = self._places(frame)
            return places if name == PLACE else self.flow.system.ground.above(places[:, 0], places[:, 2])
        found = []
        for t, y in zip(self._times.tolist(), self._states, strict=True):
            self.flow.visit(t, y)
            value = getattr(self.flow, name)
            found.append(value(*arguments) if callable(value) else value)
        return found

    def _places(self, frame: str) -> Array:
        """Returns the positions of a frame at the nodes and at `CHECKS`, (n, 3), in m."""
        model, index = self.flow.system.robot.model, self.flow.frame(frame)
        data, found = pin.Data(model), np.empty((len(self._states), 3))
        for place, y in zip(found, self._states, strict=True):
            pin.forwardKinematics(model, data, y[: model.nq])
            place[:] = self.flow.directions.place(model, data, index)
        return found


class _Dynamics:
    """The dynamics along a span, `dyn` of guards that take intervals."""

    def __init__(self, span: Span) -> None:
        self._span, self._flow = span, span.whole.flow

    def height(self, frame: str) -> Any:
        """Returns the distance of a frame from the ground, in m."""
        ground = self._flow.system.ground
        if ground.plane:
            return self._span.enclosure((HEIGHT, (frame,)))
        x, _, z = self._span.enclosure((PLACE, (frame,)))
        return ground.above(x, z, INTERVALS)

    @property
    def friction_coefficient(self) -> float:
        """μ of the ground."""
        return self._flow.friction_coefficient

    def __getattr__(self, name: str) -> Any:
        if callable(getattr(self._flow, name)):
            return lambda *arguments: self._span.enclosure((name, arguments))
        return self._span.enclosure((name, ()))


def split_step(guard: Guard, step: Step) -> Iterator[tuple[float, float, int]]:
    """Yields parts of a step, in order, and the side of zero on which a guard is, or `UNKNOWN` in short parts.

    Values within the guard's tolerance of zero are not resolved further.

    Raises:
        Exception: any exception that the guard raises for intervals, which it need not take.
    """
    waiting, short = [step.span], 0
    while waiting:
        span = waiting.pop()
        length = span.end - span.begin
        short += length <= SHORTEST
        try:
            low, high = span.value(guard)
        except Unsure:
            low, high = -np.inf, np.inf
        if low > 0.0:
            yield span.begin, span.end, POSITIVE
        elif high <= 0.0 and not guard.patience:
            yield span.begin, span.end, NEGATIVE
        elif low >= -guard.tolerance or length <= (LEAST if short <= MANY else SHORTEST):
            yield span.begin, span.end, UNKNOWN
        else:
            waiting += reversed(span.halves())


def glances(step: Step) -> Iterator[tuple[float, float, int]]:
    """Yields parts of a step for a guard that does not take intervals."""
    begin, end = step.span.begin, step.span.end
    times = np.linspace(begin, end, int(np.ceil((end - begin) / GLANCE)) + 1).tolist()
    for before, after in pairwise(times):
        yield before, after, UNKNOWN
