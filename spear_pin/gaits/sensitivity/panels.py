"""Integrals and peaks along many cycles at once, without derivatives: polynomials of panels on a refined grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.tangent.collocation import POINTS, rule

CELLS = 64  # cells of a panel; a polynomial changes its sign at most once in a cell
POLISHED = 3  # of Newton's steps to where it does
CLIMBED, AROUND = 6, 4  # refinements around a peak, and places on each side of it


@dataclass(frozen=True)
class Panels:
    """Panels of the arcs of many cycles.

    Attributes:
        lanes: lane to which each panel belongs, (p,).
        lengths: length of each panel in s, (p,).
        count: number of cycles.
    """

    lanes: NDArray[np.int64]
    lengths: Array
    count: int

    def integral(self, values: Array) -> Array:
        """Returns ∫ over each cycle of values at Gauss's points, (p, k); zero where a cycle has no panel, (n,)."""
        return np.asarray(
            np.bincount(self.lanes, self.lengths * (values @ rule(POINTS).weights), self.count), np.float64
        )

    def positive(self, values: Array) -> Array:
        """Returns ∫ of the positive part over each cycle, (n,)."""
        coefficients = values @ rule(POINTS).legendre.T
        dense, whole = coefficients @ _grid().values.T, np.asarray(legendre.legint(coefficients.T), np.float64)
        summed = np.diff((_grid().integrals @ whole).T, axis=1)
        up = dense > 0.0
        total = np.where(up[:, :-1] & up[:, 1:], summed, 0.0).sum(axis=1)
        panel, cell = np.nonzero(up[:, :-1] != up[:, 1:])
        x = _crossing(coefficients[panel].T, dense[panel], cell)
        rises = up[panel, cell + 1]
        end = np.where(rises, _grid().x[cell + 1], _grid().x[cell])
        part = _value(end, whole[:, panel]) - _value(x, whole[:, panel])
        total += np.bincount(panel, np.where(rises, part, -part), len(total))
        return np.asarray(np.bincount(self.lanes, 0.5 * self.lengths * total, self.count), np.float64)

    def peak(self, values: Array) -> Array:
        """Returns the largest value of each cycle, (n,); -∞ where it has no panel."""
        coefficients = values @ rule(POINTS).legendre.T
        dense = coefficients @ _grid().values.T
        return self._largest(_climbed(dense, lambda x: _value(x, coefficients.T)))

    def ratio(self, above: Array, below: Array, least: float) -> Array:
        """Returns the largest |above / below| of each cycle where below ≥ least, (n,); -∞ if nowhere."""
        to = rule(POINTS).legendre.T
        tops, bottoms = above @ to, below @ to
        top, bottom = tops @ _grid().values.T, bottoms @ _grid().values.T

        def pressed(top: Array, bottom: Array) -> Array:
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.where(bottom >= least, np.abs(top / bottom), -np.inf)

        def at(x: Array) -> Array:
            return pressed(_value(x, tops.T), _value(x, bottoms.T))

        best = _climbed(pressed(top, bottom), at)
        beyond = bottom >= least
        panel, cell = np.nonzero(beyond[:, :-1] != beyond[:, 1:])
        fallen = bottoms[panel].T.copy()
        fallen[0] -= least
        x = _crossing(fallen, bottom[panel] - least, cell)
        np.maximum.at(best, panel, np.abs(_value(x, tops[panel].T)) / least)
        return self._largest(best)

    def where_it_falls(self, guard: Array, values: Array) -> Array:
        """Returns the values where a guard first falls through zero in each cycle, (n,); NaN where it does not."""
        to = rule(POINTS).legendre.T
        coefficients = guard @ to
        dense = coefficients @ _grid().values.T
        panel, cell = np.nonzero((dense[:, :-1] > 0.0) & (dense[:, 1:] <= 0.0))
        x = _crossing(coefficients[panel].T, dense[panel], cell)
        found = np.full(self.count, np.nan)
        found[self.lanes[panel][::-1]] = _value(x, (values @ to)[panel].T)[::-1]
        return found

    def _largest(self, best: Array) -> Array:
        found = np.full(self.count, -np.inf)
        np.maximum.at(found, self.lanes, best)
        return found


@dataclass(frozen=True)
class _Grid:
    """Ends of the cells on [-1, 1], (g,), and Legendre polynomials there, (g, k) and (g, k + 1)."""

    x: Array
    values: Array
    integrals: Array


@cache
def _grid() -> _Grid:
    x = np.linspace(-1.0, 1.0, CELLS + 1)
    values = np.asarray(legendre.legvander(x, POINTS), np.float64)
    return _Grid(x, values[:, :-1], values)


def _value(x: Array, coefficients: Array) -> Array:
    """Returns values of polynomials, (k, m), at one place each, (m,)."""
    return np.asarray(legendre.legval(x, coefficients, tensor=False), np.float64)


def _crossing(coefficients: Array, dense: Array, cell: NDArray[np.int64]) -> Array:
    """Finds where polynomials, (k, m), change their signs in cells, (m,)."""
    row, x = np.arange(len(cell)), _grid().x
    left, right = dense[row, cell], dense[row, cell + 1]
    found = x[cell] + (x[cell + 1] - x[cell]) * left / (left - right)
    slopes = np.asarray(legendre.legder(coefficients), np.float64)
    for _ in range(POLISHED):
        with np.errstate(divide="ignore", invalid="ignore"):
            step = _value(found, coefficients) / _value(found, slopes)
        found = np.clip(found - np.nan_to_num(step), x[cell], x[cell + 1])
    return np.asarray(found, np.float64)


def _climbed(dense: Array, at: Callable[[Array], Array]) -> Array:
    """Returns the largest value of each row: refines around the best place of the grid.

    Args:
        dense: values on the grid, (p, g).
        at: values at one place of each row, (p,).
    """
    i = dense.argmax(axis=1)
    best, x, width = dense[np.arange(len(dense)), i], _grid().x[i], 2.0 / CELLS
    for _ in range(CLIMBED):
        middle = x
        for k in range(-AROUND, AROUND + 1):
            there = np.clip(middle + k * width / AROUND, -1.0, 1.0)
            value = at(there)
            better = value > best
            best, x = np.where(better, value, best), np.where(better, there, x)
        width /= AROUND
    return np.asarray(best, np.float64)
