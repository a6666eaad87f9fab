"""Integrals and peaks of signals along a cycle, with derivatives: polynomials through Gauss's points of arcs.

The polynomials go through the beginnings and ends of arcs, too, so that peaks at kinks are exact: for example, the
friction used is largest where a toe begins to slip. A polynomial lies within the range of its Bernstein coefficients,
so that most panels need no roots.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import POINTS, rule, through
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Stretch

NEAR = 1e-9  # of a peak: so near to it an instant carries it on
SIZE = POINTS + 2  # coefficients of a panel between the ends of an arc
CLEAR = 1e-9  # of a polynomial: it has no root where it is farther from zero, whatever the rounding


@dataclass(frozen=True)
class Pieces:
    """A signal along an arc.

    Attributes:
        stretch: the arc.
        values: at Gauss's points, at the beginning and at the end, (k,).
        derivatives: at a fixed clock of the phase, (k, c).
        rates: rates of the values along the motion, at the beginning and at the end, (2,).
    """

    stretch: Stretch
    values: Array
    derivatives: Array
    rates: Array

    def plus(self, other: Pieces | float, change: Array | float = 0.0) -> Pieces:
        """Returns the sum with another signal along the same arc, or with a number that has a derivative, (c,)."""
        if isinstance(other, Pieces):
            values, derivatives = self.values + other.values, self.derivatives + other.derivatives
            return Pieces(self.stretch, values, derivatives, self.rates + other.rates)
        return Pieces(self.stretch, self.values + other, self.derivatives + change, self.rates)

    def times(self, other: Pieces | float, change: Array | float = 0.0) -> Pieces:
        """Returns the product with another signal along the same arc, or with a number that has a derivative, (c,)."""
        if isinstance(other, Pieces):
            derivatives = self.derivatives * other.values[:, None] + self.values[:, None] * other.derivatives
            ends = [BEGIN, END]
            rates = self.rates * other.values[ends] + self.values[ends] * other.rates
            return Pieces(self.stretch, self.values * other.values, derivatives, rates)
        derivatives = other * self.derivatives + self.values[:, None] * change
        return Pieces(self.stretch, other * self.values, derivatives, other * self.rates)

    @cached_property
    def series(self) -> Array:
        """Legendre coefficients of the values in each panel, (panels, SIZE)."""
        inside = self.values[:-2].reshape(-1, POINTS)
        found = np.zeros((len(inside), SIZE))
        found[:, :POINTS] = inside @ rule().legendre.T
        for i in {0, len(inside) - 1}:
            rows, to = self._of(i)
            found[i, : len(rows)] = to @ self.values[rows]
        return found

    @cached_property
    def hulls(self) -> Array:
        """Bernstein coefficients of the values in each panel, (panels, SIZE)."""
        return np.asarray(self.series @ bernstein().T, np.float64)

    def slopes(self, i: int) -> Array:
        """Returns Legendre coefficients of the derivatives in a panel, (k, c)."""
        rows, to = self._of(i)
        return np.asarray(to @ self.derivatives[rows], np.float64)

    def _of(self, i: int) -> tuple[list[int], Array]:
        """Returns which values a panel's polynomials go through, and the matrix from them to Legendre coefficients."""
        begins, ends = i == 0, (i + 1) * POINTS == len(self.values) - 2
        rows = [*range(i * POINTS, (i + 1) * POINTS), *[BEGIN] * begins, *[END] * ends]
        return rows, through(*[-1.0] * begins, *[1.0] * ends)

    def turns(self, above: float = -np.inf) -> Iterator[tuple[int, float, float]]:
        """Yields where the signal turns: the panel, the place on [-1, 1] and the value.

        Args:
            above: panels whose values are nowhere larger are left out.
        """
        rising = self.series @ _derivative().T
        hulls = rising @ bernstein().T
        joins = np.append(hulls[:-1, -1] * hulls[1:, 0] < 0.0, False)
        for i in np.flatnonzero((self.hulls.max(axis=1) > above) & (_may_vanish(hulls) | joins)).tolist():
            for x in [*roots(rising[i]), *[1.0] * int(joins[i])]:
                yield i, x, float(legendre.legval(x, self.series[i]))


def integral(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """Returns ∫ over the cycle, and its derivative; an arc's ends move by the τ of their events."""
    total, change = 0.0, np.zeros(pieces[0].derivatives.shape[1])
    for piece in pieces:
        weights, stretch = piece.stretch.weights, piece.stretch
        total += float(weights @ piece.values)
        begin, end = piece.values[[BEGIN, END]]
        change = change + weights @ piece.derivatives + end * stretch.tau - begin * stretch.since
    return total, change


def positive(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """Returns ∫ of the positive part over the cycle, and its derivative; moving changes of sign add nothing."""
    total, change = 0.0, np.zeros(pieces[0].derivatives.shape[1])
    for piece in pieces:
        stretch, (begin, end) = piece.stretch, piece.values[[BEGIN, END]].tolist()
        change = change + max(end, 0.0) * stretch.tau - max(begin, 0.0) * stretch.since
        up = (piece.hulls.min(axis=1) >= 0.0) & (piece.hulls.max(axis=1) > 0.0)
        weights = stretch.weights[:-2] * np.repeat(up, POINTS)
        total += float(weights @ piece.values[:-2])
        change = change + weights @ piece.derivatives[:-2]
        for i in np.flatnonzero(~up & (piece.hulls.max(axis=1) > 0.0)).tolist():
            values, half = piece.series[i], 0.5 * float(stretch.carried.lengths[i])
            marks = [-1.0, *roots(values), 1.0]
            whole, slopes = legendre.legint(values), legendre.legint(piece.slopes(i))
            for left, right in zip(marks[:-1], marks[1:], strict=True):
                if legendre.legval(0.5 * (left + right), values) > 0.0:
                    total += half * float(legendre.legval(right, whole) - legendre.legval(left, whole))
                    change = change + half * (legendre.legval(right, slopes) - legendre.legval(left, slopes))
    return total, change


def peak(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """Returns the largest value of the cycle, and its derivative; at an end of an arc the end itself moves."""
    best: float = -np.inf
    change: Any = np.zeros(pieces[0].derivatives.shape[1])
    for piece in pieces:
        stretch = piece.stretch
        if stretch.at_once:  # it has a duration in cycles to one side of this one
            value, rate = float(piece.values[END]), piece.rates[END]
            if rate > 0.0 and value >= best - NEAR * abs(best):
                best, change = value, piece.derivatives[END] + rate * stretch.tau
            continue
        for end, moved in ((BEGIN, stretch.since), (END, stretch.tau)):
            if piece.values[end] > best:
                best, change = float(piece.values[end]), piece.derivatives[end] + piece.rates[end] * moved
        for i, x, value in piece.turns(best):
            if value > best:
                best, change = value, legendre.legval(x, piece.slopes(i))
    return best, change


def extremes(piece: Pieces) -> Iterator[tuple[float, float, Array]]:
    """Yields the values at an arc's ends and where the signal turns, with derivatives.

    Yields:
        the place, 0 at the arc's beginning and 1 at its end, with panels of one length; the value; its derivative.
    """
    stretch, count = piece.stretch, len(piece.series)
    yield 0.0, float(piece.values[BEGIN]), piece.derivatives[BEGIN] + piece.rates[BEGIN] * stretch.since
    for i, x, value in piece.turns():
        change: Any = legendre.legval(x, piece.slopes(i))
        yield (i + 0.5 * (x + 1.0)) / count, value, np.asarray(change)
    yield 1.0, float(piece.values[END]), piece.derivatives[END] + piece.rates[END] * stretch.tau


def largest_ratio(
    pairs: Sequence[tuple[Pieces, Pieces]], least: float, dleast: Array | float = 0.0
) -> tuple[float, Array]:
    """Returns the largest |a / b| of pairs of signals where b is at least a number, and its derivative.

    Where b falls to the least value, the place itself moves.

    Args:
        pairs: pairs of a and b.
        least: the least value of b.
        dleast: derivative of `least`, (c,).
    """
    best: float = -np.inf
    change: Any = np.zeros(pairs[0][0].derivatives.shape[1])
    along: Any
    for above, below in pairs:
        stretch, count = above.stretch, len(above.series)
        if stretch.at_once:
            bottom, ratio = float(below.values[END]), float(above.values[END] / below.values[END])
            rate, up = (above.rates[END] - ratio * below.rates[END]) / bottom, np.sign(ratio)
            if bottom >= least and up * rate > 0.0 and abs(ratio) >= best * (1.0 - NEAR):
                along = (above.derivatives[END] - ratio * below.derivatives[END]) / bottom + rate * stretch.tau
                best, change = abs(ratio), up * along
            continue
        for i in _candidates(above, below, least, best):
            a, b, da, db = above.series[i], below.series[i], above.slopes(i), below.slopes(i)
            slope_a, slope_b = legendre.legder(a), legendre.legder(b)
            places, to = _of_products()
            at_a, at_b, rise_a, rise_b = (legendre.legval(places, each) for each in (a, b, slope_a, slope_b))
            turns = roots(to @ (rise_a * at_b - at_a * rise_b))
            falls = roots(legendre.legsub(b, [least]))
            for x in (-1.0, *turns, *falls, 1.0):
                bottom, top = float(legendre.legval(x, b)), float(legendre.legval(x, a))
                if bottom < least * (1.0 - 1e-9) or abs(top / bottom) <= best:
                    continue
                best, ratio = abs(top / bottom), top / bottom
                dtop, dbottom = np.asarray(legendre.legval(x, da)), np.asarray(legendre.legval(x, db))
                along, rates = (dtop - ratio * dbottom) / bottom, (above.rates - ratio * below.rates) / bottom
                if x in falls:
                    fall = float(legendre.legval(x, slope_b))
                    rate = (float(legendre.legval(x, slope_a)) - ratio * fall) / bottom
                    along = along - rate / fall * (dbottom - dleast)
                elif x == -1.0 and i == 0:
                    along = along + rates[BEGIN] * stretch.since
                elif x == 1.0 and i == count - 1:
                    along = along + rates[END] * stretch.tau
                change = np.asarray(np.sign(ratio) * along)
    return best, change


def _candidates(above: Pieces, below: Pieces, least: float, best: float) -> list[int]:
    """Returns the panels in which |a / b| may be larger than it is so far, and than it is at the points."""
    inside = below.values >= least
    reached = np.max(np.abs(above.values[inside] / below.values[inside]), initial=best)
    smallest = np.maximum(below.hulls.min(axis=1), least * (1.0 - NEAR))
    pressed = below.hulls.max(axis=1) >= least * (1.0 - NEAR)
    reach = np.abs(above.hulls).max(axis=1) / smallest
    return [int(i) for i in np.flatnonzero(pressed & (reach >= reached * (1.0 - NEAR)))]


def where_it_falls(guard: Pieces, signal: Pieces) -> tuple[float, Array] | None:
    """Returns a signal where a guard first falls through zero, and its derivative; None where it does not."""
    for i in np.flatnonzero(_may_vanish(guard.hulls)).tolist():
        g, values = guard.series[i], signal.series[i]
        for x in roots(g):
            fall = float(legendre.legval(x, legendre.legder(g)))
            if fall < 0.0:
                later = -legendre.legval(x, guard.slopes(i)) / fall  # in half lengths of the panel, as the rate is
                rate = float(legendre.legval(x, legendre.legder(values)))
                change: Any = legendre.legval(x, signal.slopes(i)) + rate * later
                return float(legendre.legval(x, values)), change
    return None


def roots(coefficients: Any) -> list[float]:
    """Returns where a Legendre series changes its sign inside (-1, 1), in rising order."""
    if len(coefficients) <= SIZE and not _may_vanish(bernstein(len(coefficients)) @ coefficients):
        return []
    trimmed: Any = legendre.legtrim(coefficients, tol=1e-13 * max(float(np.abs(coefficients).max()), 1e-300))
    if len(trimmed) < 2:
        return []
    roots = legendre.legroots(trimmed)
    real = roots[np.abs(roots.imag) < 1e-9].real
    return sorted(float(x) for x in real if -1.0 < x < 1.0)


def _may_vanish(hulls: Array) -> NDArray[np.bool_]:
    """Tells whether polynomials may have a root on [-1, 1], by their Bernstein coefficients, (..., k)."""
    clear = CLEAR * np.abs(hulls).max(axis=-1)
    return np.asarray((hulls.min(axis=-1) <= clear) & (hulls.max(axis=-1) >= -clear))


@cache
def bernstein(size: int = SIZE) -> Array:
    """Returns the matrix from Legendre coefficients to Bernstein coefficients on [-1, 1], (k, k).

    The coefficients of P_n are (-1)^(n - i) times binomials of n over i; their degree is then raised to the last one's.
    """
    last, over = size - 1, math.comb
    found = np.array(
        [
            [
                sum((-1) ** (n - i) * over(n, i) ** 2 * over(last - n, j - i) for i in range(min(j, n) + 1))
                / over(last, j)
                for n in range(size)
            ]
            for j in range(size)
        ]
    )
    found.setflags(write=False)
    return found


@cache
def _of_products() -> tuple[Array, Array]:
    """Returns places on [-1, 1], and the matrix from values of a product of two series there to its coefficients."""
    gauss = rule(2 * SIZE)
    return 2.0 * gauss.nodes - 1.0, gauss.legendre


@cache
def _derivative() -> Array:
    """Returns the matrix from Legendre coefficients to those of the derivative by the place, (SIZE, SIZE)."""
    found = np.zeros((SIZE, SIZE))
    found[:-1] = legendre.legder(np.eye(SIZE))
    found.setflags(write=False)
    return found
