"""Dual numbers: a value with its derivative along one direction, or along several at a time.

Value and derivative are any scalars with +, -, * and /: heyoka's expressions, numbers with an array of derivatives,
arrays of states with arrays of derivatives. Laws, guards, latches and impacts take dual numbers as they take numbers.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.dynamics import FLOATS, Operations
from spear_pin.hybrid.elimination import solve_sparse
from spear_pin.model.scalars import negate, plus, times, vanishes


class Dual:
    """A value with its derivative.

    It has no `float()`, which would lose the derivative silently.

    Args:
        x: the value.
        d: the derivative, which broadcasts against it.
    """

    __slots__ = ("d", "x")
    __hash__ = None  # type: ignore[assignment]  # dual numbers are compared by value

    def __init__(self, x: Any, d: Any) -> None:
        self.x, self.d = x, d

    def __repr__(self) -> str:
        return f"Dual({self.x!r}, {self.d!r})"

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **settings: Any) -> Any:
        """Applies NumPy's functions of numbers, which some latches use."""
        if method != "__call__" or settings or ufunc not in _UFUNCS:
            return NotImplemented
        # NumPy's own numbers would ask again
        return _UFUNCS[ufunc](*(each.item() if isinstance(each, np.generic) else each for each in inputs))

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            return Dual(self.x + other.x, plus(self.d, other.d))
        return Dual(self.x + other, self.d)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.x, negate(self.d))

    def __pos__(self) -> Dual:
        return self

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            return Dual(self.x - other.x, plus(self.d, negate(other.d)))
        return Dual(self.x - other, self.d)

    def __rsub__(self, other: Any) -> Any:
        return Dual(other - self.x, negate(self.d))

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            return Dual(self.x * other.x, plus(times(self.d, other.x), times(other.d, self.x)))
        return 0.0 if vanishes(other) else Dual(self.x * other, times(self.d, other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            x = self.x / other.x
            return Dual(x, plus(self.d, negate(times(other.d, x))) / other.x)
        return Dual(self.x / other, self.d / other)

    def __rtruediv__(self, other: Any) -> Any:
        if vanishes(other):
            return 0.0
        x = other / self.x
        return Dual(x, negate(times(self.d, x)) / self.x)

    def __pow__(self, power: Any) -> Any:
        return Dual(self.x**power, times(self.d, power * self.x ** (power - 1)))

    def __abs__(self) -> Any:
        return -self if self.x < 0.0 else self

    def __lt__(self, other: Any) -> Any:
        return self.x < value_of(other)

    def __le__(self, other: Any) -> Any:
        return self.x <= value_of(other)

    def __gt__(self, other: Any) -> Any:
        return self.x > value_of(other)

    def __ge__(self, other: Any) -> Any:
        return self.x >= value_of(other)

    def __eq__(self, other: object) -> Any:
        return self.x == value_of(other)

    def __ne__(self, other: object) -> Any:
        return self.x != value_of(other)

    def __bool__(self) -> bool:
        return bool(self.x)


def value_of(scalar: Any) -> Any:
    """Returns the value of a scalar, dual or not; nested tuples and mappings of scalars keep their form."""
    if isinstance(scalar, Dual):
        return scalar.x
    if isinstance(scalar, tuple):
        return tuple(map(value_of, scalar))
    if isinstance(scalar, dict):
        return {name: value_of(item) for name, item in scalar.items()}
    return scalar


def derivative_of(scalar: Any) -> Any:
    """Returns the derivative of a scalar, 0 for a scalar without one."""
    return scalar.d if isinstance(scalar, Dual) else 0.0


def duals(values: Sequence[float] | Array, slopes: Array) -> list[Dual]:
    """Makes dual numbers of n values with their derivatives along c directions, (n, c)."""
    return [Dual(float(x), d) for x, d in zip(values, slopes, strict=True)]


def make_varying(values: Array, slopes: Array) -> list[Any]:
    """Makes dual numbers as `duals` does; what does not change along any direction stays a number."""
    return [Dual(x, d) if d.any() else x for x, d in zip(values.tolist(), slopes, strict=True)]


def derivatives(scalars: Sequence[Any], c: int) -> Array:
    """Returns the derivatives of n scalars, dual or not, along c directions, (n, c)."""
    found = np.zeros((len(scalars), c))
    for i, scalar in enumerate(scalars):
        if isinstance(scalar, Dual):
            found[i] = scalar.d
    return found


def operations(base: Any, step: Callable[[Any], Any], solve: Callable[[Any, Any], Any] = solve_sparse) -> Operations:
    """Returns the elementary functions of dual and other numbers.

    Args:
        base: elementary functions of the values.
        step: the derivative of max(x, 0).
        solve: the solution of a linear system.
    """

    def chain(name: str, slope: Callable[[Any, Any], Any]) -> Callable[[Any], Any]:
        function = getattr(base, name)

        def of(a: Any) -> Any:
            if not isinstance(a, Dual):
                return function(a)
            x = function(a.x)
            return Dual(x, times(a.d, slope(a.x, x)))

        return of

    def atan2(a: Any, b: Any) -> Any:
        y, x = value_of(a), value_of(b)
        turned = plus(times(derivative_of(a), x), negate(times(derivative_of(b), y)))
        return base.atan2(y, x) if vanishes(turned) else Dual(base.atan2(y, x), turned / (x * x + y * y))

    def maximum(a: Any, b: Any) -> Any:
        x, y = value_of(a), value_of(b)
        da, db = derivative_of(a), derivative_of(b)
        more = plus(da, negate(db))
        d = db if vanishes(more) else plus(db, times(more, step(x - y)))
        return base.maximum(x, y) if vanishes(d) else Dual(base.maximum(x, y), d)

    return Operations(
        sin=chain("sin", lambda x, y: base.cos(x)),
        cos=chain("cos", lambda x, y: -base.sin(x)),
        tan=chain("tan", lambda x, y: 1.0 + y * y),
        tanh=chain("tanh", lambda x, y: 1.0 - y * y),
        sqrt=chain("sqrt", lambda x, y: 0.5 / y),
        exp=chain("exp", lambda x, y: y),
        atan2=atan2,
        maximum=maximum,
        solve=solve,
    )


def solve_arrays(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> Sequence[Any]:
    """Solves a linear system of dual numbers whose derivatives, or values too, are arrays."""
    return solve_all(matrix, [right])[0]


def solve_all(matrix: Sequence[Sequence[Any]], rights: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """Solves linear systems of one matrix as `solve_arrays` does; it pivots by values. M x = r has M x' = r' - M' x."""
    entries = [each for row in (*matrix, *rights) for each in row]
    found = [each for each in entries if isinstance(each, Dual)]
    if not found:
        return [solve_sparse(matrix, right) for right in rights]
    *lead, c = np.broadcast_shapes(*{np.shape(part) for each in found for part in (each.x, each.d)})
    m, k = len(matrix), len(rights)
    values, slopes = np.zeros((len(entries), *lead, 1)), np.zeros((len(entries), *lead, c))
    for i, each in enumerate(entries):
        if isinstance(each, Dual):
            values[i], slopes[i] = each.x, each.d
        elif not vanishes(each):
            values[i] = each
    M = np.moveaxis(values[: m * m, ..., 0].reshape(m, m, *lead), (0, 1), (-2, -1))
    x = np.linalg.solve(M, np.moveaxis(values[m * m :, ..., 0].reshape(k, m, *lead), (0, 1), (-1, -2)))
    dM, dr = slopes[: m * m].reshape(m, m, *lead, c), slopes[m * m :].reshape(k, m, *lead, c)
    left = np.moveaxis(dr, (0, 1), (-2, -3)) - np.einsum("ij...c,...jk->...ikc", dM, x)
    dx = np.linalg.solve(M, left.reshape(*lead, m, k * c)).reshape(*lead, m, k, c)
    return [
        [Dual(x[..., i, j, None] if lead else float(x[i, j]), dx[..., i, j, :]) for i in range(m)] for j in range(k)
    ]


def _larger(a: Any, b: Any) -> Any:
    return a if value_of(a) >= value_of(b) else b


def _smaller(a: Any, b: Any) -> Any:
    return a if value_of(a) <= value_of(b) else b


NUMBERS = operations(FLOATS, lambda x: float(x > 0.0), solve_arrays)
"""Those of numbers with arrays of derivatives."""

_UFUNCS: dict[Any, Callable[..., Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.true_divide: operator.truediv,
    np.negative: operator.neg,
    np.absolute: operator.abs,
    np.square: lambda a: a * a,
    np.maximum: _larger,
    np.minimum: _smaller,
    **{getattr(np, name): getattr(NUMBERS, name) for name in ("sin", "cos", "tan", "tanh", "sqrt", "exp")},
}


ARRAYS = operations(np, lambda x: np.heaviside(x, 0.0), solve_arrays)
"""Those of arrays, with arrays of derivatives or without."""
