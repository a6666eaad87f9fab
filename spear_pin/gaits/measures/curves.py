"""Integrals and peaks of samples by quintic splines between events, so that they do not depend on the sampling."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from math import comb
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array

Mask = NDArray[np.bool_]

DEGREE = 5
INSTANT = 1e-12  # s: an event's two samples may differ by rounding
ROUNDING = 1e-12  # of Bernstein coefficients, of the largest
GAUSS = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Curves:
    """Sample times; signals are smooth between the events.

    Attributes:
        t: times, in s, (n,); two times are equal at an event.
        chosen: which samples count, (n,).
    """

    t: Array
    chosen: Mask

    @classmethod
    def of(cls, t: Array) -> Curves:
        """Returns curves of all samples, at times in s, (n,)."""
        return cls(t, np.ones(len(t), dtype=bool))

    @cached_property
    def runs(self) -> tuple[NDArray[np.int64], ...]:
        """Samples that count between one event and the next, at least two each."""
        rows = np.flatnonzero(self.chosen)
        apart = (np.diff(self.t[rows]) <= INSTANT) | (np.diff(rows) > 1)
        return tuple(run for run in np.split(rows, np.flatnonzero(apart) + 1) if len(run) > 1)

    def among(self, chosen: Mask) -> Curves:
        """Returns curves of the chosen samples, (n,)."""
        return Curves(self.t, self.chosen & chosen)

    @property
    def duration(self) -> float:
        """Time that the samples cover, in s."""
        return float(sum(self.t[run[-1]] - self.t[run[0]] for run in self.runs))

    def integral(self, values: Array, where: Array | None = None) -> float:
        """Returns ∫ of a signal over time.

        Args:
            values: signal at the samples, (n,).
            where: a signal, (n,), that is positive where time counts; by default always.
        """
        total = 0.0
        for run in self.runs:
            whole = self._spline(run, values).antiderivative()
            begin, end = self.t[run[0]], self.t[run[-1]]
            if where is None:
                total += float(whole(end) - whole(begin))
                continue
            gate = self._spline(run, where)
            marks = np.array([begin, *_roots(gate), end])
            counts = gate(0.5 * (marks[1:] + marks[:-1])) > 0.0
            total += float(np.diff(whole(marks))[counts].sum())
        return total

    def positive(self, values: Array) -> float:
        """Returns ∫ of the positive part of a signal, (n,)."""
        return self.integral(values, where=values)

    def halves(self, power: Callable[[Array, Array], Array], torque: Array, speed: Array) -> tuple[float, float]:
        """Returns ∫ of the positive and of the negative part of a power, both >= 0, from torque and speed.

        Args:
            power: returns the power for torques and speeds, (k,) each; it may jump where either changes its sign.
            torque: torque at the samples, (n,).
            speed: speed at the samples, (n,).
        """
        nodes, weights = GAUSS
        positive = negative = 0.0
        for run in self.runs:
            u, w = self._spline(run, torque), self._spline(run, speed)
            marks = np.unique(np.concatenate([self.t[run], _roots(u), _roots(w)]))

            def at(t: Array, u: Any = u, w: Any = w) -> Array:
                return np.asarray(power(u(t), w(t)), np.float64)

            marks = np.unique(np.concatenate([marks, _changes(at, marks)]))
            half, middle = 0.5 * np.diff(marks), 0.5 * (marks[1:] + marks[:-1])
            parts = half * (at((middle[:, None] + half[:, None] * nodes).ravel()).reshape(len(half), -1) @ weights)
            positive, negative = positive + float(parts[parts > 0.0].sum()), negative - float(parts[parts < 0.0].sum())
        return positive, negative

    def peak(self, values: Array) -> float:
        """Returns the largest value of a signal, (n,); -∞ where no sample counts."""
        return self.range(values)[1]

    def amount(self, values: Array) -> float:
        """Returns the largest modulus of a signal, (n,)."""
        least, greatest = self.range(values)
        return max(-least, greatest)

    def range(self, values: Array) -> tuple[float, float]:
        """Returns the least and the largest value of a signal, (n,); ∞ and -∞ where no sample counts."""
        there = values[self.chosen]
        least, greatest = float(there.min(initial=np.inf)), float(there.max(initial=-np.inf))
        for run in self.runs:
            if values[run].max() > values[run].min():
                curve = self._spline(run, values)
                times = _roots(curve.derivative())
                found = curve(times)
                found = found[_resolved(times, found, self.t[run], values[run])]
                least = min(least, float(found.min(initial=np.inf)))
                greatest = max(greatest, float(found.max(initial=-np.inf)))
        return least, greatest

    def ratio(self, above: Array, below: Array, least: float) -> float:
        """Returns the largest |above / below| where the signal below, (n,), is at least `least` > 0; else 0."""
        best = 0.0
        for run in self.runs:
            top, bottom = self._spline(run, above), self._spline(run, below)

            def at(t: Any, top: Any = top, bottom: Any = bottom) -> Any:
                return np.abs(top(t) / bottom(t))

            ends = self.t[run]
            marks = np.sort(np.concatenate([ends, _roots(bottom, least)]))
            borne = bottom(marks) >= least * (1.0 - 1e-9)
            values = np.where(borne, at(marks, bottom=lambda t, b=bottom: np.maximum(b(t), 1e-3 * least)), -np.inf)
            best = max(best, float(values.max(initial=0.0)))
            inner = values[1:-1]
            for i in 1 + np.flatnonzero((inner >= values[:-2]) & (inner >= values[2:]) & np.isfinite(inner)):
                low, high = (marks[j] if borne[j] else marks[i] for j in (i - 1, i + 1))
                if high > low:
                    found = scipy.optimize.minimize_scalar(
                        lambda t, at=at: -at(t), bounds=(low, high), method="bounded", options={"xatol": 1e-12}
                    )
                    best = max(best, float(-found.fun))
        return best

    def _spline(self, run: NDArray[np.int64], values: Array) -> Any:
        t = self.t[run]
        return scipy.interpolate.make_interp_spline(t, values[run], k=min(DEGREE, len(run) - 1))


def _roots(spline: Any, level: float = 0.0) -> Array:
    """Finds where a spline crosses a level, in order of time.

    Few of its pieces do. The others have Bernstein coefficients of one sign, and become constants, which solve at once.
    """
    pieces = scipy.interpolate.PPoly.from_spline(spline)
    powers = np.arange(len(pieces.c))[:, None]  # of the time in a piece, from its begin
    bernstein = _bernstein(len(pieces.c) - 1) @ (pieces.c[::-1] * np.diff(pieces.x) ** powers) - level
    rounding = ROUNDING * (np.abs(bernstein).max(axis=0) + abs(level))
    away = (bernstein.min(axis=0) > rounding) | (bernstein.max(axis=0) < -rounding)
    pieces.c[:, away], pieces.c[-1, away] = 0.0, level + 1.0
    found = pieces.solve(level, discontinuity=False, extrapolate=False)
    return np.asarray(np.sort(found[np.isfinite(found)]), np.float64)


@cache
def _bernstein(n: int) -> Array:
    """Returns the matrix from coefficients of powers 0 to n to those of Bernstein polynomials, (n + 1, n + 1)."""
    return np.array([[comb(k, j) / comb(n, j) for j in range(n + 1)] for k in range(n + 1)])


def _resolved(times: Array, values: Array, t: Array, samples: Array) -> Mask:
    """Tells at which times samples resolve a signal, so that its spline does not oscillate as about a jump or a kink.

    There the cubic through the four nearest samples agrees with the spline better than with a straight line.

    Args:
        times: times between the samples, (k,).
        values: values of the spline, (k,).
        t: times of the samples, (n,).
        samples: the signal, (n,).
    """
    if len(t) < 4:
        return np.zeros(len(times), dtype=bool)
    left = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    near = np.clip(left - 1, 0, len(t) - 4)[:, None] + np.arange(4)
    apart = times[:, None] - t[near]
    cubic = np.zeros(len(times))
    for j in range(4):
        others = [k for k in range(4) if k != j]
        weights = np.prod(apart[:, others], axis=1) / np.prod(t[near[:, [j]]] - t[near[:, others]], axis=1)
        cubic += weights * samples[near[:, j]]
    line = np.interp(times, t, samples)
    return np.asarray(np.abs(values - cubic) <= 0.5 * np.abs(cubic - line))


def _changes(at: Callable[[Array], Array], marks: Array) -> Array:
    """Finds where a function changes its sign between marks; it is continuous a little inside of them."""
    inside = 1e-9 * np.diff(marks)
    begins, ends = marks[:-1] + inside, marks[1:] - inside
    changes = np.flatnonzero(at(begins) * at(ends) < 0.0)
    found = [scipy.optimize.brentq(lambda t: float(at(np.array([t]))[0]), begins[i], ends[i]) for i in changes]
    return np.array(found, np.float64)
