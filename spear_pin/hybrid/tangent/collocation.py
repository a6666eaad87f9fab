"""The derivative of a flow by collocation: linear equations along a known motion.

Along an arc Ṡ = A(t) S + B(t) is linear, and A and B are as smooth as the motion. At the Gauss points of panels this is
a linear system of equations for all columns of S at once. At the points its solution is as accurate as polynomials of
degree `POINTS` are for the motion, which `roughness` measures. At the ends of panels, and in integrals over them, it
has twice as many digits.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack

from spear_pin.arrays import Array

POINTS = 16
TAIL = 1e-11  # largest size of a motion's last Legendre coefficients, relative to the motion


class Fineness(NamedTuple):
    """How fine panels are.

    Attributes:
        tail: largest size of a motion's last Legendre coefficients, relative to the motion.
        steps: most steps of Taylor's method in a panel.
    """

    tail: float
    steps: int


INSIDE = Fineness(TAIL, 4)
"""For peaks and ratios inside of panels, of torques and forces, too, which are less smooth than the motion."""
ENDS = Fineness(1e4 * TAIL, 14)
"""For ends of panels, which have twice as many digits: of most shipped gaits they are those of the finest to 2e-12,
of the gallop, whose toes stop after they slid, to 3e-10."""


class Rule(NamedTuple):
    """Gauss's rule on [0, 1].

    Attributes:
        nodes: the points, (k,).
        weights: weights of the integral over the interval, (k,).
        partial: weights of the integrals up to each point, (k, k).
        twice: weights of the double integrals up to each point, (k, k).
        both: `twice` and `partial` for each point, (k, 2, k).
        whole: weights of the double and the single integral over the interval, (2, k).
        legendre: matrix from values at the points to Legendre coefficients, (k, k).
    """

    nodes: Array
    weights: Array
    partial: Array
    twice: Array
    both: Array
    whole: Array
    legendre: Array


@cache
def rule(points: int = POINTS) -> Rule:
    """Returns Gauss's rule with `points` points."""
    x, w = np.polynomial.legendre.leggauss(points)
    values = np.polynomial.legendre.legvander(x, points)  # P_0 to P_k
    degrees = np.arange(points)
    legendre = (values[:, :points] * w[:, None]).T * (degrees[:, None] + 0.5)
    # ∫ P_n from -1 to x is (P_{n+1} - P_{n-1}) / (2n + 1)
    below = np.concatenate([-np.ones((points, 1)), values[:, : points - 1]], axis=1)
    integrals = (values[:, 1:] - below) / (2.0 * degrees + 1.0)
    partial = 0.5 * integrals @ legendre
    twice, weights = partial @ partial, 0.5 * w
    both, whole = np.stack([twice, partial], axis=1), np.stack([weights @ partial, weights])
    return Rule(0.5 * (x + 1.0), weights, partial, twice, both, whole, legendre)


@cache
def through(*ends: float) -> Array:
    """Returns the matrix from values at Gauss's points and at panel ends to Legendre coefficients, (k, k).

    Args:
        ends: the ends that are used, -1 and 1.
    """
    gauss = rule()
    if not ends:
        return gauss.legendre
    x = np.append(2.0 * gauss.nodes - 1.0, ends)
    found: Array = np.linalg.inv(np.polynomial.legendre.legvander(x, len(x) - 1))
    found.setflags(write=False)
    return found


def roughness(states: Array) -> Array:
    """Returns the size of a motion's last Legendre coefficients in each panel, relative to the motion, (panels,).

    The motion is given at the points, (panels, points, rows). Below `TAIL` polynomials are as accurate as the motion.
    """
    last = np.abs(rule(states.shape[1]).legendre[-2:] @ states).max(axis=1)
    size = np.abs(states).max(axis=(0, 1))
    found: Array = (last / np.maximum(size, max(float(size.max()) * 1e-3, 1e-300))).max(axis=1)
    return found


class Carried(NamedTuple):
    """S along panels.

    Attributes:
        K: accelerations of S at the points, times the panel's length, (panels, nv, points, c).
        begins: S at the beginning of each panel and at the end of the last, (panels + 1, 2 nv, c).
        lengths: length of each panel, in s, (panels,).
    """

    K: Array
    begins: Array
    lengths: Array

    @property
    def end(self) -> Array:
        """S at the end of the last panel, (2 nv, c)."""
        last: Array = self.begins[-1]
        return last

    def inside(self) -> Array:
        """Returns S at the points, (2 nv, panels · points, c)."""
        panels, nv, k, c = self.K.shape
        gauss, h, begins = rule(k), self.lengths[:, None, None, None], self.begins[:-1, :, None]
        q, v = begins[:, :nv], begins[:, nv:]
        found = np.empty((2 * nv, panels, k, c))
        found[:nv] = (q + h * (gauss.nodes[:, None] * v + gauss.twice @ self.K)).swapaxes(0, 1)
        found[nv:] = (v + gauss.partial @ self.K).swapaxes(0, 1)
        return found.reshape(2 * nv, panels * k, c)


def carry_along(slopes: Array, lengths: Array, start: Array) -> Carried:
    """Computes S along successive panels, where the state is (q, v) with q̇ = v.

    Args:
        slopes: derivatives of the acceleration at the points, with respect to the state and along c further
            directions, (panels, points, nv, 2 nv + c).
        lengths: length of each panel, in s, (panels,).
        start: S at the beginning of the first panel, (2 nv, c).
    """
    panels, k, nv, columns = slopes.shape
    c, gauss, size = columns - 2 * nv, rule(k), k * nv
    # the unknowns are the accelerations at the points, times h: v_i = v_0 + Σ_j a_ij K_j,
    # q_i = q_0 + h c_i v_0 + h Σ_j a²_ij K_j
    h = lengths[:, None, None, None]
    given = np.multiply(slopes, h, order="C")
    by = given[..., : 2 * nv].reshape(panels, k, nv, 2, nv).swapaxes(3, 4).reshape(panels, k, nv * nv, 2)
    scale = np.stack([lengths, np.ones(panels)], axis=1)[:, None, :, None]  # of positions and of velocities
    equations = (_unit(k, nv) - by @ (gauss.both * scale)).reshape(panels, size, size)
    given[..., nv : 2 * nv] += (h * gauss.nodes[:, None, None]) * given[..., :nv]
    given = given.reshape(panels, size, columns)
    K, begins, ends = np.empty((panels, size, c)), np.empty((panels + 1, 2 * nv, c)), gauss.whole * scale[:, 0]
    begins[0] = start
    for i in range(panels):
        S, end = begins[i], begins[i + 1]
        K[i] = _solved(equations[i], given[i, :, : 2 * nv] @ S + given[i, :, 2 * nv :])
        end[:] = S + (ends[i] @ K[i].reshape(nv, k, c)).swapaxes(0, 1).reshape(2 * nv, c)
        end[:nv] += lengths[i] * S[nv:]
    return Carried(K.reshape(panels, nv, k, c), begins, lengths)


@cache
def _unit(k: int, nv: int) -> Array:
    """Returns an array with 1 at each equation's own unknown, (points, nv nv, points).

    Equations are sorted by point, then by coordinate; unknowns by coordinate, then by point.
    """
    unit: Array = np.einsum("ij,ab->iabj", np.eye(k), np.eye(nv)).reshape(k, nv * nv, k)
    unit.setflags(write=False)
    return unit


def _solved(matrix: Array, right: Array) -> Array:
    """Solves linear equations, faster than NumPy's solver does for so few."""
    *_, found, singular = lapack.dgesv(matrix, right)
    if singular:
        raise np.linalg.LinAlgError("a motion has no derivative: equations along it are singular")
    solution: Array = found
    return solution
