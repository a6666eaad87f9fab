"""The derivative of a flow by collocation: linear equations along a motion that is known.

Along an arc Ṡ = A(t) S + B(t) is linear, and A and B are as smooth as the motion. At Gauss's points of panels it is a
linear system of equations for all columns of S at once; its solution is as accurate as polynomials of degree `POINTS`
are for the motion, which `roughness` asks for.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
POINTS = 16
TAIL = 1e-12  # of a motion's Legendre coefficients, by which the last ones are to be smaller than the largest


class Rule(NamedTuple):
    """Gauss's rule on [0, 1].

    Attributes:
        nodes: the points, (k,).
        weights: of the integral over the whole, (k,).
        partial: of the integrals up to each point, (k, k).
        legendre: from values at the points to Legendre coefficients, (k, k).
    """

    nodes: Array
    weights: Array
    partial: Array
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
    return Rule(0.5 * (x + 1.0), 0.5 * w, 0.5 * integrals @ legendre, legendre)


def roughness(states: Array) -> float:
    """Size of the last Legendre coefficients of motion at the points of panels, (panels, points, rows), by the largest.

    Below `TAIL` polynomials are as good as the motion.
    """
    coefficients = np.abs(rule(states.shape[1]).legendre @ states)
    size = coefficients.max(axis=(0, 1))
    left = coefficients[:, -2:].max(axis=(0, 1)) / np.maximum(size, max(float(size.max()) * 1e-3, 1e-300))
    return float(left.max())


def carried(A: Array, B: Array, h: float, start: Array) -> tuple[Array, Array]:
    """S at the points of panels one after the other, and at the end, where the state is (q, v) with q̇ = v.

    Args:
        A: derivatives of the acceleration by the state, (panels, points, nv, 2 nv).
        B: along directions beside, (panels, points, nv, c).
        h: length of a panel.
        start: S where the first begins, (2 nv, c).

    Returns:
        (panels, points, 2 nv, c) and (2 nv, c).
    """
    panels, k, nv, c = B.shape
    gauss = rule(k)
    twice = gauss.partial @ gauss.partial
    by_q, by_v = A[..., :nv], A[..., nv:]
    # unknown are the accelerations K at the points: v_i = v_0 + h Σ_j a_ij K_j,
    # q_i = q_0 + h c_i v_0 + h² Σ_j a²_ij K_j
    left = -h * gauss.partial[:, None, :, None] * by_v[:, :, :, None, :]
    left -= h * h * twice[:, None, :, None] * by_q[:, :, :, None, :]
    system = left.reshape(panels, k * nv, k * nv)
    system[:, np.arange(k * nv), np.arange(k * nv)] += 1.0
    right = np.concatenate([by_q, by_v + h * gauss.nodes[:, None, None] * by_q, B], axis=3)
    slopes = np.linalg.solve(system, right.reshape(panels, k * nv, -1)).reshape(panels, k, -1)
    ends, to_q = gauss.weights, gauss.weights @ gauss.partial
    found, q, v = np.empty((panels, k, 2 * nv, c)), start[:nv], start[nv:]
    for i in range(panels):
        parts = slopes[i].reshape(k * nv, 2 * nv + c)
        K = (parts[:, : 2 * nv] @ np.concatenate([q, v]) + parts[:, 2 * nv :]).reshape(k, nv * c)
        found[i, :, nv:] = v + h * (gauss.partial @ K).reshape(k, nv, c)
        found[i, :, :nv] = q + h * gauss.nodes[:, None, None] * v + h * h * (twice @ K).reshape(k, nv, c)
        q = q + h * v + h * h * (to_q @ K).reshape(nv, c)
        v = v + h * (ends @ K).reshape(nv, c)
    return found, np.concatenate([q, v])
