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
from numpy.typing import NDArray
from scipy.linalg import lapack

Array = NDArray[np.float64]
POINTS = 16
TAIL = 1e-10  # of a motion's Legendre coefficients, by which the last ones are to be smaller than itself


class Rule(NamedTuple):
    """Gauss's rule on [0, 1].

    Attributes:
        nodes: the points, (k,).
        weights: of the integral over the whole, (k,).
        partial: of the integrals up to each point, (k, k).
        twice: of the integrals of those, (k, k).
        legendre: from values at the points to Legendre coefficients, (k, k).
    """

    nodes: Array
    weights: Array
    partial: Array
    twice: Array
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
    return Rule(0.5 * (x + 1.0), 0.5 * w, partial, partial @ partial, legendre)


def roughness(states: Array) -> float:
    """Size of the last Legendre coefficients of motion by its own, given at points, (panels, points, rows).

    Below `TAIL` polynomials are as good as the motion.
    """
    last = np.abs(rule(states.shape[1]).legendre[-2:] @ states).max(axis=(0, 1))
    size = np.abs(states).max(axis=(0, 1))
    return float((last / np.maximum(size, max(float(size.max()) * 1e-3, 1e-300))).max())


class Carried(NamedTuple):
    """S along panels.

    Attributes:
        K: its accelerations at the points, by S where the panel begins, and beside, (panels, nv, points, 2 nv + c).
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
        panels, nv, k, _ = self.K.shape
        gauss, h, begins = rule(k), self.h, self.begins[:-1]
        K = self.K[..., : 2 * nv] @ begins[:, None] + self.K[..., 2 * nv :]
        q, v = begins[:, :nv, None], begins[:, nv:, None]
        found = np.empty((2 * nv, panels, k, K.shape[-1]))
        found[:nv] = (q + h * gauss.nodes[:, None] * v + h * h * (gauss.twice @ K)).swapaxes(0, 1)
        found[nv:] = (v + h * (gauss.partial @ K)).swapaxes(0, 1)
        return found.reshape(2 * nv, panels * k, -1)


def carried(A: Array, B: Array, h: float, start: Array) -> Carried:
    """S along panels one after the other, where the state is (q, v) with q̇ = v.

    Args:
        A: derivatives of the acceleration by the state, (panels, nv, points, 2 nv).
        B: along directions beside, (panels, nv, points, c).
        h: length of a panel.
        start: S where the first begins, (2 nv, c).
    """
    panels, nv, k, c = B.shape
    gauss = rule(k)
    by_q, by_v = A[..., :nv], A[..., nv:]
    # unknown are the accelerations K at the points: v_i = v_0 + h Σ_j a_ij K_j,
    # q_i = q_0 + h c_i v_0 + h² Σ_j a²_ij K_j
    left = by_v[..., None] * (-h * gauss.partial[:, None])
    left -= by_q[..., None] * (h * h * gauss.twice[:, None])
    system = left.reshape(panels, k * nv, k * nv)
    system.reshape(panels, -1)[:, :: k * nv + 1] += 1.0
    right = np.concatenate([by_q, by_v + h * gauss.nodes[:, None] * by_q, B], axis=3).reshape(panels, k * nv, -1)
    solved = np.array([_solved(each, rows) for each, rows in zip(system, right, strict=True)])
    K = solved.reshape(panels, nv, k, 2 * nv + c)
    ahead = np.concatenate([h * h * gauss.weights @ gauss.partial @ K, h * gauss.weights @ K], axis=1)
    ahead[..., : 2 * nv] += np.eye(2 * nv) + h * np.eye(2 * nv, k=nv)
    begins = np.empty((panels + 1, 2 * nv, c))
    begins[0] = start
    for i, panel in enumerate(ahead):
        begins[i + 1] = panel[:, : 2 * nv] @ begins[i] + panel[:, 2 * nv :]
    return Carried(K, begins, h)


def _solved(matrix: Array, right: Array) -> Array:
    """As NumPy's solver, which takes longer for so few equations."""
    *_, found, singular = lapack.dgesv(matrix, right)
    if singular:
        raise np.linalg.LinAlgError("a motion has no derivative: equations along it are singular")
    solution: Array = found
    return solution
