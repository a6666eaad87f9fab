"""Virtual constraints: outputs y = H q - h(s) of (5.9), zeroed by input-output linearisation.

The desired evolution h is a Bézier polynomial in a phase variable s, (5.10) and (5.19). Beyond s = 1 it continues along
its tangent; if the last coefficients are equal, it holds its end value. Controlled variables and phase variable are
linear in q, with one exception: the angle of a leg whose thigh and shank differ in length also changes as its knee
bends.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import comb, perm
from operator import mul, sub
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from spear_pin.hybrid.dynamics import Row
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


class Jet(NamedTuple):
    """A variable at a state, and what it does there.

    Attributes:
        value: its value.
        row: its gradient, which times v̇ and plus the drift is its second derivative in time.
        rate: its rate.
        drift: its second derivative in time at v̇ = 0.
    """

    value: Any
    row: tuple[tuple[int, Any], ...]
    rate: Any
    drift: Any


def jet(variable: Variable, q: Sequence[Any], v: Sequence[Any], ops: Any = np) -> Jet:
    """Returns a variable at a state, its gradient, rate and drift."""
    if not isinstance(variable, (Sum, Shifted, Leaning)):
        return Jet(dot(variable, q), tuple(variable), dot(variable, v), 0.0)
    if isinstance(variable, Sum):
        total, rates, drifts, slopes = 0.0, 0.0, 0.0, list[tuple[int, Any]]()
        for weight, term in variable.terms:
            own, row, rate, drift = jet(term, q, v, ops)
            total, rates, drifts = total + weight * own, rates + weight * rate, drifts + weight * drift
            slopes += [(index, weight * slope) for index, slope in row]
        return Jet(total, tuple(slopes), rates, drifts)
    if isinstance(variable, Shifted):
        moved = jet(variable.variable, q, v, ops)
        return moved._replace(value=moved.value + variable.by)
    leans, slope, curvature = variable.lean(q, ops)
    knee, rate = variable.knee, v[variable.knee]
    row = (*variable.row, (knee, -slope))
    return Jet(dot(variable.row, q) - leans, row, dot(row, v), -curvature * (rate * rate))


def bezier(alpha: Sequence[Any], s: Any) -> tuple[Any, Any, Any]:
    """Returns value, slope and curvature at s of a Bézier polynomial with given coefficients."""
    return _weighted(alpha, _bases(len(alpha) - 1, s))


def _weighted(alpha: Sequence[Any], bases: Sequence[Sequence[Any]]) -> tuple[Any, Any, Any]:
    # coefficients come last: polynomials of one degree at the same s share everything else
    value, slope, curvature = bases
    return sum(map(mul, alpha, value)), sum(map(mul, alpha, slope)), sum(map(mul, alpha, curvature))


def _bases(n: int, s: Any) -> tuple[list[Any], list[Any], list[Any]]:
    """Returns the Bernstein polynomials of degree n, their slopes and their curvatures."""
    rest, ups, downs = 1.0 - s, [1.0], [1.0]
    for _ in range(n):
        ups.append(ups[-1] * s)
        downs.append(downs[-1] * rest)
    value, lower, lowest = [
        [*map(mul, counts, map(mul, ups, downs[n - down :: -1]))] for down, counts in enumerate(_counts(n))
    ]
    return value, _differences(lower), _differences(_differences(lowest))


@cache
def _counts(n: int) -> tuple[list[int], ...]:
    """Returns binomial coefficients of n, n times those of n - 1, and n (n - 1) times those of n - 2, if there are."""
    return tuple([perm(n, down) * comb(n - down, k) for k in range(n - down + 1)] for down in range(3))


def _differences(basis: Sequence[Any]) -> list[Any]:
    """Returns derivatives of the polynomials one degree higher, from polynomials times that degree."""
    return [*map(sub, [0.0, *basis], [*basis, 0.0])]


def progress(outputs: Outputs, evolution: Evolution, q: Sequence[Any], ops: Any = np) -> Any:
    """Returns the phase variable s, (5.10) or (5.19)."""
    return (value(outputs.phase, q, ops) - evolution.origin) / evolution.span


def evaluate_desired(evolution: Evolution, s: Any) -> list[tuple[Any, Any, Any]]:
    """Returns h, dh/ds and d²h/ds² of each output where the phase variable is s."""
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
    found = [(y, dy) for y, dy, _, _ in _outputs(outputs, evolution, q, v, ops)]
    return [y for y, _ in found], [dy for _, dy in found]


def _outputs(
    outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any], ops: Any
) -> Iterator[tuple[Any, Any, Row, Any]]:
    """Yields y and ẏ of each output, the row that times v̇ is part of ÿ, and the rest of ÿ, of (5.9)."""
    phase = jet(outputs.phase, q, v, ops)
    rate = phase.rate / evolution.span
    wanted = evaluate_desired(evolution, (phase.value - evolution.origin) / evolution.span)
    for variable, (height, slope, curvature) in zip(outputs.rows, wanted, strict=True):
        own = jet(variable, q, v, ops)
        tilt = slope / evolution.span  # H - h' ds/dq is the output's gradient
        row = (*own.row, *[(index, -tilt * weight) for index, weight in phase.row])
        rest = own.drift - tilt * phase.drift - curvature * (rate * rate)
        yield own.value - height, own.rate - slope * rate, row, rest


def accelerations(
    outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any], ops: Any = np
) -> list[Any]:
    """Returns ÿ of the outputs of (5.9) at an acceleration."""
    return [dot(row, a) + rest for _, _, row, rest in _outputs(outputs, evolution, q, v, ops)]


def demand_accelerations(
    outputs: Outputs, evolution: Evolution, q: Sequence[Any], v: Sequence[Any], epsilon: Any, ops: Any = np
) -> tuple[list[Row], list[Any]]:
    """Returns rows and the values of rows times v̇ that give ÿ = -y/ε² - 2ẏ/ε, (5.15) and (5.20) with (5.16).

    Args:
        outputs: the controlled outputs.
        evolution: the desired evolution.
        q: configuration.
        v: velocity.
        epsilon: ε, in s: the outputs decay like exp(-t/ε).
        ops: elementary functions for the type of q and v.
    """
    rows: list[Row] = []
    wanted = []
    for y, dy, row, rest in _outputs(outputs, evolution, q, v, ops):
        rows.append(row)
        wanted.append(-(y / epsilon + 2.0 * dy) / epsilon - rest)
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
    phase = jet(outputs.phase, q, v, ops)
    alpha = []
    for variable, shape in zip(outputs.rows, shapes, strict=True):
        begin = jet(variable, q, v, ops)
        slope = begin.rate / (phase.rate / span)
        alpha.append((begin.value, begin.value + slope / (len(shape) + 1), *shape))
    return Evolution(tuple(alpha), phase.value, span)


def begin_evolution(
    outputs: Outputs, shapes: Sequence[Sequence[float]], q: Sequence[float], v: Sequence[float], span: float
) -> Evolution:
    """Returns the evolution that begins with y = ẏ = 0, with bounded slopes; see `resume` for the arguments.

    Where s hardly moves, no bounded slope gives ẏ = 0. The slope then fades to zero with the rate of s, so that the
    evolution is continuous in the state.
    """
    whole = resume(outputs, shapes, q, v, span)
    within = np.minimum(abs(jet(outputs.phase, q, v).rate / span) / SLOWEST, 1.0) ** 2
    return replace(whole, alpha=tuple((a, a + within * (b - a), *rest) for a, b, *rest in whole.alpha))
