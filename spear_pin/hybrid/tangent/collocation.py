"""The derivative of a flow by collocation: linear equations along a motion that is known.

Along an arc Ṡ = A(t) S + B(t) is linear, and A and B are as smooth as the motion. At Gauss's points of panels it is a
linear system of equations for all columns of S at once. At the points its solution is as accurate as polynomials of
degree `POINTS` are for the motion, which `roughness` asks for; at the ends of panels, and in integrals over them, it
has twice as many digits.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack

from spear_pin.arrays import Array

POINTS = 16
TAIL = 1e-11  # of a motion's Legendre coefficients, by which the last ones are to be smaller than itself


class Fineness(NamedTuple):
    """Of panels.

    Attributes:
        tail: as `TAIL`, at most.
        steps: of Taylor's method in a panel, at most.
    """

    tail: float
    steps: int


INSIDE = Fineness(TAIL, 4)
"""For peaks and ratios inside of panels, of torques and forces, too, which are less smooth than the motion."""
ENDS = Fineness(1e4 * TAIL, 14)
"""For ends of panels, which have twice as many digits: of shipped gaits they are those of the finest to 2e-12."""


class Rule(NamedTuple):
    """Gauss's rule on [0, 1].

    Attributes:
        nodes: the points, (k,).
        weights: of the integral over the whole, (k,).
        partial: of the integrals up to each point, (k, k).
        twice: of the integrals of those, (k, k).
        both: `twice` and `partial`, of each point, (k, 2, k).
        whole: weights of both integrals over the whole, (2, k).
        legendre: from values at the points to Legendre coefficients, (k, k).
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
    """Gauss's rule."""
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
    """From values at Gauss's points, and at ends of the panel beside them, to Legendre coefficients, (k, k).

    Args:
        ends: which ends, -1 and 1.
    """
    gauss = rule()
    if not ends:
        return gauss.legendre
    x = np.append(2.0 * gauss.nodes - 1.0, ends)
    found: Array = np.linalg.inv(np.polynomial.legendre.legvander(x, len(x) - 1))
    found.setflags(write=False)
    return found


def roughness(states: Array) -> float:
    """Size of the last Legendre coefficients of motion by its own, given at points, (panels, points, rows).

    Below `TAIL` polynomials are as good as the motion.
    """
    rows = states.shape[2]
    last = np.abs(rule(states.shape[1]).legendre[-2:] @ states).reshape(-1, rows).max(axis=0)
    size = np.abs(states).reshape(-1, rows).max(axis=0)
    return float((last / np.maximum(size, max(float(size.max()) * 1e-3, 1e-300))).max())


class Carried(NamedTuple):
    """S along panels.

    Attributes:
        K: its accelerations at the points, times h, (panels, nv, points, c).
        begins: S where the panels begin, and where the last one ends, (panels + 1, 2 nv, c).
        h: length of a panel.
    """

    K: Array
    begins: Array
    h: float

    @property
    def end(self) -> Array:
        """S where the last panel ends, (2 nv, c)."""
        last: Array = self.begins[-1]
        return last

    def inside(self) -> Array:
        """S at the points, (2 nv, panels · points, c)."""
        panels, nv, k, c = self.K.shape
        gauss, h, begins = rule(k), self.h, self.begins[:-1]
        q, v = begins[:, :nv, None], begins[:, nv:, None]
        found = np.empty((2 * nv, panels, k, c))
        found[:nv] = (q + h * (gauss.nodes[:, None] * v + gauss.twice @ self.K)).swapaxes(0, 1)
        found[nv:] = (v + gauss.partial @ self.K).swapaxes(0, 1)
        return found.reshape(2 * nv, panels * k, c)


def carried(slopes: Array, h: float, start: Array) -> Carried:
    """S along panels one after the other, where the state is (q, v) with q̇ = v.

    Args:
        slopes: derivatives of the acceleration at the points, by the state and along c directions beside,
            (panels, points, nv, 2 nv + c).
        h: length of a panel.
        start: S where the first begins, (2 nv, c).
    """
    panels, k, nv, columns = slopes.shape
    c, gauss, size = columns - 2 * nv, rule(k), k * nv
    # unknown are the accelerations at the points, times h: v_i = v_0 + Σ_j a_ij K_j,
    # q_i = q_0 + h c_i v_0 + h Σ_j a²_ij K_j
    given = np.multiply(slopes, h, order="C")
    by = given[..., : 2 * nv].reshape(panels, k, nv, 2, nv).swapaxes(3, 4).reshape(panels, k, nv * nv, 2)
    equations = (by @ (gauss.both * [[-h], [-1.0]]) + _unit(k, nv)).reshape(panels, size, size)
    given[..., nv : 2 * nv] += (h * gauss.nodes[:, None, None]) * given[..., :nv]
    given = given.reshape(panels, size, columns)
    K, begins, ends = np.empty((panels, size, c)), np.empty((panels + 1, 2 * nv, c)), gauss.whole * [[h], [1.0]]
    begins[0] = start
    for i in range(panels):
        S, end = begins[i], begins[i + 1]
        K[i] = _solved(equations[i], given[i, :, : 2 * nv] @ S + given[i, :, 2 * nv :])
        end[:] = S + (ends @ K[i].reshape(nv, k, c)).swapaxes(0, 1).reshape(2 * nv, c)
        end[:nv] += h * S[nv:]
    return Carried(K.reshape(panels, nv, k, c), begins, h)


@cache
def _unit(k: int, nv: int) -> Array:
    """1 where an equation's own unknown stands, (points, nv nv, points).

    Equations are of each point, and there of each coordinate; unknowns of each coordinate, and of that at each point.
    """
    unit: Array = np.einsum("ij,ab->iabj", np.eye(k), np.eye(nv)).reshape(k, nv * nv, k)
    unit.setflags(write=False)
    return unit


def _solved(matrix: Array, right: Array) -> Array:
    """As NumPy's solver, which takes longer for so few equations."""
    *_, found, singular = lapack.dgesv(matrix, right)
    if singular:
        raise np.linalg.LinAlgError("a motion has no derivative: equations along it are singular")
    solution: Array = found
    return solution
