"""Virtual constraints: outputs y = H q - h(s) of (5.9), zeroed by input-output linearisation.

The desired evolution h is a Bézier polynomial in a phase variable s, (5.10) and (5.19). Beyond s = 1 it continues along
its tangent; if the last coefficients are equal, it holds its end value. Controlled variables and phase variable are
linear in q, with one exception: the angle of a leg whose thigh and shank differ in length also changes as its knee
bends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from math import comb
from operator import mul
from typing import Any, TypeAlias

import numpy as np

from spear_pin.hybrid.dynamics import Dynamics, Row
from spear_pin.model.legs import lean

SLOWEST = 1.0  # 1/s: least rate of s; Q-SPEAR's gaits begin their phases faster


@dataclass(frozen=True)
class Leaning:
    """A row times q, minus the lean of a leg by its knee: with pitch and hip in the row, the angle of hip to toe.

    Attributes:
        row: the linear part.
        knee: index of the knee.
        thigh: length of the thigh, in m.
        shank: length of the shank, in m.
        turn: sign and zero of the knee, whose angle of the convention is sign (q - zero); None: +1 and 0.
    """

    row: Row
    knee: int
    thigh: float
    shank: float
    turn: tuple[float, float] | None = None

    def lean(self, q: Sequence[Any], ops: Any) -> tuple[Any, Any, Any]:
        """Returns the lean of the leg, in rad, its slope and its curvature over the knee's own angle."""
        if self.turn is None:
            return lean(self.thigh, self.shank, q[self.knee], ops)
        sign, zero = self.turn
        leans, slope, curvature = lean(self.thigh, self.shank, sign * (q[self.knee] - zero), ops)
        return leans, sign * slope, curvature


@dataclass(frozen=True)
class Sum:
    """A weighted sum of variables.

    Attributes:
        terms: weights and variables.
    """

    terms: tuple[tuple[Any, Variable], ...]


@dataclass(frozen=True)
class Shifted:
    """A variable plus a constant.

    Attributes:
        variable: the variable.
        by: the constant.
    """

    variable: Variable
    by: float


Variable: TypeAlias = "Row | Leaning | Sum | Shifted"
"""A function of the configuration; a row is linear. `ops` of what reckons with it has sin, cos and atan2."""


@dataclass(frozen=True)
class Outputs:
    """Controlled variables, and the phase variable on which they depend.

    Attributes:
        rows: H, or other variables instead, one for each controlled variable.
        phase: c in s = (c q - origin) / span, or another variable instead.
        motors: columns of the motors that control them, as many as rows.
    """

    rows: tuple[Variable, ...]
    phase: Variable
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
    """Returns a row times a vector over the coordinates."""
    total = 0.0
    for index, weight in row:
        total = total + weight * vector[index]
    return total


def value(variable: Variable, q: Sequence[Any], ops: Any = np) -> Any:
    """Returns a variable at a configuration."""
    if isinstance(variable, Sum):
        return sum(weight * value(term, q, ops) for weight, term in variable.terms)
    if isinstance(variable, Shifted):
        return value(variable.variable, q, ops) + variable.by
    if isinstance(variable, Leaning):
        return dot(variable.row, q) - variable.lean(q, ops)[0]
    return dot(variable, q)


def gradient(variable: Variable, q: Sequence[Any], ops: Any = np) -> Row:
    """Returns the row that, times v, is the rate of a variable."""
    if isinstance(variable, Sum):
        parts = ((weight, gradient(term, q, ops)) for weight, term in variable.terms)
        return tuple((index, weight * slope) for weight, row in parts for index, slope in row)
    if isinstance(variable, Shifted):
        return gradient(variable.variable, q, ops)
    if isinstance(variable, Leaning):
        return (*variable.row, (variable.knee, -variable.lean(q, ops)[1]))
    return variable


def drift(variable: Variable, q: Sequence[Any], v: Sequence[Any], ops: Any = np) -> Any:
    """Returns the second derivative of a variable in time at v̇ = 0."""
    if isinstance(variable, Sum):
        return sum(weight * drift(term, q, v, ops) for weight, term in variable.terms)
    if isinstance(variable, Shifted):
        return drift(variable.variable, q, v, ops)
    if isinstance(variable, Leaning):
        return -variable.lean(q, ops)[2] * (v[variable.knee] * v[variable.knee])
    return 0.0


def bezier(alpha: Sequence[Any], s: Any) -> tuple[Any, Any, Any]:
    """Returns value, slope and curvature at s of a Bézier polynomial with given coefficients (at least two)."""
    return _weighted(alpha, _bases(len(alpha) - 1, s))


def _weighted(alpha: Sequence[Any], bases: Sequence[Sequence[Any]]) -> tuple[Any, Any, Any]:
    # coefficients come last: polynomials of one degree at the same s share everything else
    value, slope, curvature = (sum(map(mul, alpha, basis)) for basis in bases)
    return value, slope, curvature


def _bases(n: int, s: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """Returns the Bernstein polynomials of degree n, their slopes and their curvatures."""
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
    """Returns binomial coefficients; none for a degree below zero."""
    return [comb(n, k) for k in range(n + 1)]


def _derived(basis: Sequence[Any]) -> list[Any]:
    """Returns derivatives of the polynomials one degree higher."""
    return [len(basis) * (less - more) for less, more in pairwise([0.0, *basis, 0.0])]


def progress(outputs: Outputs, evolution: Evolution, q: Sequence[Any], ops: Any = np) -> Any:
    """Returns the phase variable s, (5.10) or (5.19)."""
    return (value(outputs.phase, q, ops) - evolution.origin) / evolution.span


def desired(outputs: Outputs, evolution: Evolution, q: Sequence[Any], ops: Any = np) -> list[tuple[Any, Any, Any]]:
    """Returns h, dh/ds and d²h/ds² of each output."""
    s = progress(outputs, evolution, q, ops)
    inside = s + evolution.past * (1.0 - s)
    bases = {n: _bases(n - 1, inside) for n in dict.fromkeys(map(len, evolution.alpha))}
    evolutions = []
    for alpha in evolution.alpha:
        height, slope, curvature = _weighted(alpha, bases[len(alpha)])
        # not (1 - past) * curvature: in compiled code a parameter times a symbol costs next to nothing
        evolutions.append((height + slope * (s - inside), slope, curvature - evolution.past * curvature))
    return evolutions


def errors(
    outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any], ops: Any = np
) -> tuple[list[Any], list[Any]]:
    """Returns the outputs y of (5.9) and their rates."""
    rate = dot(gradient(outputs.phase, q, ops), v) / evolution.span
    return _missed(outputs, desired(outputs, evolution, q, ops), rate, q, v, ops)


def _missed(
    outputs: Outputs, wanted: Sequence[tuple[Any, Any, Any]], rate: Any, q: Sequence[Any], v: Sequence[Any], ops: Any
) -> tuple[list[Any], list[Any]]:
    y, dy = [], []
    for variable, (height, slope, _) in zip(outputs.rows, wanted, strict=True):
        y.append(value(variable, q, ops) - height)
        dy.append(dot(gradient(variable, q, ops), v) - slope * rate)
    return y, dy


def zeroing(
    outputs: Outputs,
    evolution: Evolution,
    q: Sequence[Any],
    v: Sequence[Any],
    epsilon: Any,
    others: Sequence[tuple[int, Any]],
    dyn: Dynamics,
    ops: Any = np,
) -> Sequence[Any]:
    """Returns torques of the outputs' motors that give ÿ = -y/ε² - 2ẏ/ε, (5.15) and (5.20) with (5.16).

    Args:
        outputs: the controlled outputs.
        evolution: the desired evolution.
        q: configuration.
        v: velocity.
        epsilon: ε, in s: the outputs decay like exp(-t/ε).
        others: the other motors, as (column, torque).
        dyn: the dynamics at (q, v), which has `imposing`.
        ops: elementary functions for the type of q and v.
    """
    rows, wanted = demanded(outputs, evolution, q, v, epsilon, ops)
    torques: Sequence[Any] = dyn.imposing(rows, wanted, outputs.motors, others)
    return torques


def demanded(
    outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any], epsilon: Any, ops: Any = np
) -> tuple[list[Row], list[Any]]:
    """Returns rows and the values of rows times v̇ that give ÿ = -y/ε² - 2ẏ/ε; see `zeroing` for the arguments."""
    evolutions = desired(outputs, evolution, q, ops)
    ahead = gradient(outputs.phase, q, ops)
    rate = dot(ahead, v) / evolution.span
    y, dy = _missed(outputs, evolutions, rate, q, v, ops)
    phase_drift = drift(outputs.phase, q, v, ops) / evolution.span
    rows: list[Row] = []
    wanted = []
    for i, (_, slope, curvature) in enumerate(evolutions):
        tilt = slope / evolution.span  # H - h' ds/dq is the output's gradient
        rows.append((*gradient(outputs.rows[i], q, ops), *((index, -tilt * weight) for index, weight in ahead)))
        own = slope * phase_drift - drift(outputs.rows[i], q, v, ops)
        wanted.append(curvature * (rate * rate) + own - (y[i] / epsilon + 2.0 * dy[i]) / epsilon)
    return rows, wanted


def resume(
    outputs: Outputs,
    shapes: Sequence[Sequence[float]],
    q: Sequence[float],
    v: Sequence[float],
    span: float,
    ops: Any = np,
) -> Evolution:
    """Returns the evolution that begins with y = ẏ = 0 at (q, v), the event update (5.22).

    Args:
        outputs: the controlled outputs.
        shapes: the coefficients of each output from the third on.
        q: configuration after the event.
        v: velocity after the event.
        span: change of the phase's coordinate up to s = 1.
        ops: elementary functions for the type of q and v.
    """
    rate = dot(gradient(outputs.phase, q, ops), v) / span
    alpha = []
    for variable, shape in zip(outputs.rows, shapes, strict=True):
        begin = value(variable, q, ops)
        alpha.append((begin, begin + dot(gradient(variable, q, ops), v) / rate / (len(shape) + 1), *shape))
    return Evolution(tuple(alpha), value(outputs.phase, q, ops), span)


def begun(
    outputs: Outputs, shapes: Sequence[Sequence[float]], q: Sequence[float], v: Sequence[float], span: float
) -> Evolution:
    """Returns the evolution that begins with y = ẏ = 0, with bounded slopes; see `resume` for the arguments.

    Where s hardly moves, no bounded slope gives ẏ = 0. The slope then fades to zero with the rate of s, so that the
    evolution is continuous in the state.
    """
    whole = resume(outputs, shapes, q, v, span)
    within = np.minimum(abs(dot(gradient(outputs.phase, q), v) / span) / SLOWEST, 1.0) ** 2
    return replace(whole, alpha=tuple((a, a + within * (b - a), *rest) for a, b, *rest in whole.alpha))
