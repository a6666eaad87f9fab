"""Integrals and peaks of signals along a cycle, with derivatives: polynomials through Gauss's points of arcs.

The polynomials go through the beginnings and ends of arcs, too, so that peaks at kinks are exact: for example, the
friction used is largest where a toe begins to slip.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import POINTS, through
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Stretch

NEAR = 1e-9  # of a peak: so near to it an instant carries it on


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

    def panels(self) -> Iterator[tuple[float, float, Array, Array]]:
        """Yields the beginning and length of each panel, and Legendre coefficients of values and derivatives."""
        lengths = self.stretch.carried.lengths.tolist()
        begin = self.stretch.arc.t
        for i, h in enumerate(lengths):
            begins, ends = i == 0, i == len(lengths) - 1
            chosen = [*range(i * POINTS, (i + 1) * POINTS), *[BEGIN] * begins, *[END] * ends]
            to = through(*[-1.0] * begins, *[1.0] * ends)
            yield begin, h, to @ self.values[chosen], to @ self.derivatives[chosen]
            begin += h


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
        begin, end = piece.values[[BEGIN, END]]
        change = change + max(end, 0.0) * piece.stretch.tau - max(begin, 0.0) * piece.stretch.since
        for _, h, values, derivatives in piece.panels():
            marks = [-1.0, *roots(values), 1.0]
            whole, slopes = legendre.legint(values), legendre.legint(derivatives)
            for left, right in zip(marks[:-1], marks[1:], strict=True):
                if legendre.legval(0.5 * (left + right), values) > 0.0:
                    total += 0.5 * h * float(legendre.legval(right, whole) - legendre.legval(left, whole))
                    change = change + 0.5 * h * (legendre.legval(right, slopes) - legendre.legval(left, slopes))
    return total, change


def peak(pieces: Sequence[Pieces]) -> tuple[float, Array]:
    """Returns the largest value of the cycle, and its derivative; at an end of an arc the end itself moves."""
    best: float = -np.inf
    change: Any = np.zeros(pieces[0].derivatives.shape[1])
    for piece in pieces:
        if piece.stretch.at_once:  # it has a duration in cycles to one side of this one
            value, rate = float(piece.values[END]), piece.rates[END]
            if rate > 0.0 and value >= best - NEAR * abs(best):
                best, change = value, piece.derivatives[END] + rate * piece.stretch.tau
            continue
        for _, value, along in extremes(piece):
            if value > best:
                best, change = value, along
    return best, change


def extremes(piece: Pieces) -> Iterator[tuple[float, float, Array]]:
    """Yields the values at an arc's ends and where the signal turns, with derivatives.

    Yields:
        the place, 0 at the arc's beginning and 1 at its end, with panels of one length; the value; its derivative.
    """
    stretch, panels = piece.stretch, [each[2:] for each in piece.panels()]
    slopes, count = [legendre.legder(values) for values, _ in panels], len(panels)
    yield 0.0, float(piece.values[BEGIN]), piece.derivatives[BEGIN] + piece.rates[BEGIN] * stretch.since
    for i, (values, derivatives) in enumerate(panels):
        turns = roots(slopes[i])
        if i + 1 < count and legendre.legval(1.0, slopes[i]) * legendre.legval(-1.0, slopes[i + 1]) < 0.0:
            turns.append(1.0)
        for x in turns:
            change: Any = legendre.legval(x, derivatives)
            yield (i + 0.5 * (x + 1.0)) / count, float(legendre.legval(x, values)), np.asarray(change)
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
        stretch, count = above.stretch, len(above.values) // POINTS
        if stretch.at_once:
            bottom, ratio = float(below.values[END]), float(above.values[END] / below.values[END])
            rate, up = (above.rates[END] - ratio * below.rates[END]) / bottom, np.sign(ratio)
            if bottom >= least and up * rate > 0.0 and abs(ratio) >= best * (1.0 - NEAR):
                along = (above.derivatives[END] - ratio * below.derivatives[END]) / bottom + rate * stretch.tau
                best, change = abs(ratio), up * along
            continue
        for i, ((_, _, a, da), (_, _, b, db)) in enumerate(zip(above.panels(), below.panels(), strict=True)):
            slope_a, slope_b = legendre.legder(a), legendre.legder(b)
            turns = roots(legendre.legsub(legendre.legmul(slope_a, b), legendre.legmul(a, slope_b)))
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


def where_it_falls(guard: Pieces, signal: Pieces) -> tuple[float, Array] | None:
    """Returns a signal where a guard first falls through zero, and its derivative; None where it does not."""
    for (_, _, g, dg), (_, _, values, derivatives) in zip(guard.panels(), signal.panels(), strict=True):
        for x in roots(g):
            fall = float(legendre.legval(x, legendre.legder(g)))
            if fall < 0.0:
                later = -legendre.legval(x, dg) / fall  # in half lengths of the panel, as the rate is
                rate = float(legendre.legval(x, legendre.legder(values)))
                change: Any = legendre.legval(x, derivatives) + rate * later
                return float(legendre.legval(x, values)), change
    return None


def roots(coefficients: Any) -> list[float]:
    """Returns where a Legendre series changes its sign inside (-1, 1), in rising order."""
    trimmed: Any = legendre.legtrim(coefficients, tol=1e-13 * max(float(np.abs(coefficients).max()), 1e-300))
    if len(trimmed) < 2:
        return []
    roots = legendre.legroots(trimmed)
    real = roots[np.abs(roots.imag) < 1e-9].real
    return sorted(float(x) for x in real if -1.0 < x < 1.0)
