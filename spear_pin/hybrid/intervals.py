"""Arithmetic of intervals: encloses the values of a function whose scalar arguments lie between two numbers each.

A guard or a ground written for any scalars takes intervals as it takes numbers and symbols. Up to rounding, the answer
contains all values that the function can have, and may contain more. A comparison has an answer only if it is the same
for all of an interval.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from spear_pin.hybrid.dynamics import Operations
from spear_pin.hybrid.elimination import solve

HALF, WHOLE = math.pi, 2.0 * math.pi  # turns


class Unsure(Exception):
    """Raised when the answer is not the same for all of an interval; shorter intervals may have one."""


class Interval:
    """All numbers from one to another, both included.

    Args:
        low: the least.
        high: the greatest.
    """

    __slots__ = ("high", "low")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, low: float, high: float) -> None:
        self.low, self.high = low, high

    def __repr__(self) -> str:
        return f"Interval({self.low:g}, {self.high:g})"

    def __add__(self, other: Any) -> Any:
        low, high = bounds(other)
        return Interval(self.low + low, self.high + high)

    def __sub__(self, other: Any) -> Any:
        low, high = bounds(other)
        return Interval(self.low - high, self.high - low)

    def __rsub__(self, other: Any) -> Any:
        low, high = bounds(other)
        return Interval(low - self.high, high - self.low)

    def __mul__(self, other: Any) -> Any:
        low, high = bounds(other)
        products = self.low * low, self.low * high, self.high * low, self.high * high
        return Interval(min(products), max(products))

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Any) -> Any:
        low, high = bounds(other)
        if low <= 0.0 <= high:
            raise Unsure
        return self * Interval(1.0 / high, 1.0 / low)

    def __rtruediv__(self, other: Any) -> Any:
        return Interval(*bounds(other)) / self

    def __pow__(self, power: Any) -> Any:
        if not isinstance(power, (int, float)):
            return NotImplemented
        if power % 1 and self.low <= 0.0:
            raise Unsure
        if power < 0:
            return 1.0 / self**-power
        ends = self.low**power, self.high**power
        least = 0.0 if power and power % 2 == 0 and self.low < 0.0 < self.high else min(ends)
        return Interval(least, max(ends))

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __pos__(self) -> Interval:
        return self

    def __abs__(self) -> Interval:
        ends = abs(self.low), abs(self.high)
        return Interval(0.0 if self.low < 0.0 < self.high else min(ends), max(ends))

    def __lt__(self, other: Any) -> bool:
        low, high = bounds(other)
        return _sure(self.high < low, self.low >= high)

    def __le__(self, other: Any) -> bool:
        low, high = bounds(other)
        return _sure(self.high <= low, self.low > high)

    def __gt__(self, other: Any) -> bool:
        return not self <= other

    def __ge__(self, other: Any) -> bool:
        return not self < other

    def __eq__(self, other: object) -> bool:
        low, high = bounds(other)
        return _sure(self.low == self.high == low == high, self.high < low or self.low > high)

    def __bool__(self) -> bool:
        return not self == 0.0

    # NumPy finds these methods by their names, too

    def sin(self) -> Interval:
        """Returns the interval of all sines."""
        return _wave(math.sin, self.low, self.high, 0.5 * math.pi)

    def cos(self) -> Interval:
        """Returns the interval of all cosines."""
        return _wave(math.cos, self.low, self.high, 0.0)

    def tan(self) -> Interval:
        """Returns the interval of all tangents."""
        if math.floor(self.low / HALF + 0.5) != math.floor(self.high / HALF + 0.5):
            raise Unsure
        return Interval(math.tan(self.low), math.tan(self.high))

    def tanh(self) -> Interval:
        """Returns the interval of all hyperbolic tangents."""
        return Interval(math.tanh(self.low), math.tanh(self.high))

    def exp(self) -> Interval:
        """Returns the interval of all exponentials."""
        return Interval(math.exp(min(self.low, 700.0)), math.exp(self.high) if self.high < 700.0 else math.inf)

    def sqrt(self) -> Interval:
        """Returns the interval of all square roots."""
        if self.high < 0.0:
            raise ValueError("math domain error")
        if self.low < 0.0:
            raise Unsure
        return Interval(math.sqrt(self.low), math.sqrt(self.high))


def enclose(low: Any, high: Any) -> Any:
    """Makes intervals from the entries of one array to those of another: an array of their shape, or one interval."""
    if np.ndim(low) == 0:
        return Interval(float(low), float(high))
    found = np.empty(np.shape(low), dtype=object)
    found.ravel()[:] = [Interval(*ends) for ends in zip(np.ravel(low).tolist(), np.ravel(high).tolist(), strict=True)]
    return found


def bounds(value: Any) -> tuple[float, float]:
    """Returns the least and the greatest number of an interval; a plain number twice."""
    if isinstance(value, Interval):
        return value.low, value.high
    number = float(value)
    return number, number


def _sure(true: bool, false: bool) -> bool:
    if not true and not false:
        raise Unsure
    return true


def _wave(function: Callable[[float], float], low: float, high: float, crest: float) -> Interval:
    """Returns the interval of values of a wave of period 2π that is greatest at a crest."""
    ends = function(low), function(high)
    peak, trough = (math.floor((high - at) / WHOLE) > math.floor((low - at) / WHOLE) for at in (crest, crest + HALF))
    return Interval(-1.0 if trough else min(ends), 1.0 if peak else max(ends))


def _of_one(name: str) -> Callable[[Any], Any]:
    plain = getattr(math, name)
    return lambda value: getattr(value, name)() if isinstance(value, Interval) else plain(value)


def _maximum(a: Any, b: Any) -> Any:
    (low, high), (least, greatest) = bounds(a), bounds(b)
    return Interval(max(low, least), max(high, greatest))


def _atan2(y: Any, x: Any) -> Any:
    (bottom, top), (left, right) = bounds(y), bounds(x)
    if left <= 0.0 and bottom <= 0.0 <= top:  # the interval crosses the branch cut
        raise Unsure
    corners = [math.atan2(b, a) for b in (bottom, top) for a in (left, right)]
    return Interval(min(corners), max(corners))


INTERVALS = Operations(
    **{name: _of_one(name) for name in ("sin", "cos", "tan", "tanh", "sqrt", "exp")},
    atan2=_atan2,
    maximum=_maximum,
    solve=solve,
)
"""Elementary functions of intervals, and of numbers."""
