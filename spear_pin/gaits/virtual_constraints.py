"""Virtual constraints: outputs y = H q - h(s) of (5.9), zeroed by input-output linearisation.

The desired evolution h is a Bézier polynomial in a phase variable s that is linear in q, (5.10) and
(5.19). Beyond s = 1 it goes on along its tangent; for a polynomial whose last coefficients are equal
that is to hold its end value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import comb
from operator import mul
from typing import Any

from spear_pin.hybrid.dynamics import Dynamics, Row


@dataclass(frozen=True)
class Outputs:
    """Controlled variables, and the phase that they are a function of.

    Attributes:
        rows: H, one row for each controlled variable.
        phase: c in s = (c q - origin) / span.
        motors: columns of the motors that do it, as many as rows.
    """

    rows: tuple[Row, ...]
    phase: Row
    motors: tuple[int, ...]


@dataclass(frozen=True)
class Evolution:
    """The desired evolution of the outputs within one phase of motion.

    Attributes:
        alpha: Bézier coefficients of each output.
        origin: c q where s = 0.
        span: change of c q from s = 0 to s = 1.
        past: 1 beyond s = 1, else 0.
    """

    alpha: tuple[tuple[Any, ...], ...]
    origin: Any
    span: Any
    past: Any = 0.0


def dot(row: Row, vector: Sequence[Any]) -> Any:
    """A row times a vector over the coordinates."""
    total = 0.0
    for index, weight in row:
        total = total + weight * vector[index]
    return total


def bezier(alpha: Sequence[Any], s: Any) -> tuple[Any, Any, Any]:
    """Value, slope and curvature of a Bézier polynomial, given its coefficients (at least two), at s."""
    return _weighted(alpha, _bases(len(alpha) - 1, s))


def _weighted(alpha: Sequence[Any], bases: Sequence[Sequence[Any]]) -> tuple[Any, Any, Any]:
    # coefficients come last: polynomials of one degree at the same s share everything else
    value, slope, curvature = (sum(map(mul, alpha, basis)) for basis in bases)
    return value, slope, curvature


def _bases(n: int, s: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """The Bernstein polynomials of degree n, their slopes and their curvatures."""
    rest, ups, downs = 1.0 - s, [1.0], [1.0]
    for _ in range(n):
        ups.append(ups[-1] * s)
        downs.append(downs[-1] * rest)
    value, lower, lowest = (
        [count * (ups[k] * downs[m - k]) for k, count in enumerate(_counts(m))] for m in (n, n - 1, n - 2)
    )
    return value, _derived(lower), _derived(_derived(lowest))


@cache
def _counts(n: int) -> list[int]:
    """Binomial coefficients; none for a degree below zero."""
    return [comb(n, k) for k in range(n + 1)]


def _derived(basis: Sequence[Any]) -> list[Any]:
    """Derivatives of those one degree higher."""
    return [len(basis) * (less - more) for less, more in pairwise([0.0, *basis, 0.0])]


def progress(outputs: Outputs, evolution: Evolution, q: Sequence[Any]) -> Any:
    """The phase variable s, (5.10) or (5.19)."""
    return (dot(outputs.phase, q) - evolution.origin) / evolution.span


def desired(outputs: Outputs, evolution: Evolution, q: Sequence[Any]) -> list[tuple[Any, Any, Any]]:
    """h, dh/ds and d²h/ds² of each output."""
    s = progress(outputs, evolution, q)
    inside = s + evolution.past * (1.0 - s)
    bases = {n: _bases(n - 1, inside) for n in dict.fromkeys(map(len, evolution.alpha))}
    evolutions = []
    for alpha in evolution.alpha:
        value, slope, curvature = _weighted(alpha, bases[len(alpha)])
        # not (1 - past) * curvature: to what is compiled, a parameter times a symbol costs next to nothing
        evolutions.append((value + slope * (s - inside), slope, curvature - evolution.past * curvature))
    return evolutions


def errors(outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """The outputs y of (5.9) and their rates."""
    return _missed(outputs, desired(outputs, evolution, q), dot(outputs.phase, v) / evolution.span, q, v)


def _missed(
    outputs: Outputs, wanted: Sequence[tuple[Any, Any, Any]], rate: Any, q: Sequence[Any], v: Sequence[Any]
) -> tuple[list[Any], list[Any]]:
    y, dy = [], []
    for row, (value, slope, _) in zip(outputs.rows, wanted, strict=True):
        y.append(dot(row, q) - value)
        dy.append(dot(row, v) - slope * rate)
    return y, dy


def zeroing(
    outputs: Outputs,
    evolution: Evolution,
    q: Sequence[Any],
    v: Sequence[Any],
    epsilon: Any,
    others: Sequence[tuple[int, Any]],
    dyn: Dynamics,
) -> Sequence[Any]:
    """Torques of the outputs' motors that give ÿ = -y/ε² - 2ẏ/ε, (5.15) and (5.20) with (5.16).

    Args:
        outputs: what is controlled.
        evolution: how it shall evolve.
        q: configuration.
        v: velocity.
        epsilon: ε, in s: the outputs decay like exp(-t/ε).
        others: the other motors, as (column, torque).
        dyn: the dynamics at (q, v), which has `imposing`.
    """
    evolutions = desired(outputs, evolution, q)
    rate = dot(outputs.phase, v) / evolution.span
    y, dy = _missed(outputs, evolutions, rate, q, v)
    rows: list[Row] = []
    wanted = []
    for i, (_, slope, curvature) in enumerate(evolutions):
        tilt = slope / evolution.span  # H - h' ds/dq is the output's gradient
        rows.append((*outputs.rows[i], *((index, -tilt * weight) for index, weight in outputs.phase)))
        wanted.append(curvature * (rate * rate) - (y[i] / epsilon + 2.0 * dy[i]) / epsilon)
    torques: Sequence[Any] = dyn.imposing(rows, wanted, outputs.motors, others)
    return torques


def resume(
    outputs: Outputs, shapes: Sequence[Sequence[float]], q: Sequence[float], v: Sequence[float], span: float
) -> Evolution:
    """The evolution that begins with y = ẏ = 0 at (q, v), the event update (5.22).

    Args:
        outputs: what is controlled.
        shapes: the coefficients of each output from the third on.
        q: configuration after the event.
        v: velocity after the event.
        span: change of the phase's coordinate up to s = 1.
    """
    rate = dot(outputs.phase, v) / span
    alpha = []
    for row, shape in zip(outputs.rows, shapes, strict=True):
        begin = dot(row, q)
        alpha.append((begin, begin + dot(row, v) / rate / (len(shape) + 1), *shape))
    return Evolution(tuple(alpha), dot(outputs.phase, q), span)
