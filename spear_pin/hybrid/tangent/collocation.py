"""The derivative of a flow by collocation: linear equations along a motion that is known.

Along an arc Ṡ = A(t) S + B(t) is linear, and A and B are as smooth as the motion. At Gauss's points of panels it is a
linear system of equations for all columns of S at once; its solution is as accurate as polynomials of degree `POINTS`
are for the motion, which `smooth` asks for.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
POINTS = 16
TAIL = 1e-11  # of a motion's Legendre coefficients, by which the last ones are to be smaller than the largest


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


def smooth(states: Array) -> bool:
    """Whether polynomials through motion at the points of each panel are as good as it, (panels, points, rows)."""
    coefficients = np.abs(rule(states.shape[1]).legendre @ states)
    size = coefficients.max(axis=(0, 1))
    return bool((coefficients[:, -2:].max(axis=(0, 1)) <= TAIL * np.maximum(size, size.max() * 1e-3)).all())


def carried(A: Array, B: Array, h: float, start: Array) -> tuple[Array, Array]:
    """S at the points of panels one after the other, and at the end.

    Args:
        A: (panels, points, n, n).
        B: (panels, points, n, c).
        h: length of a panel.
        start: S where the first begins, (n, c).

    Returns:
        (panels, points, n, c) and (n, c).
    """
    panels, k, n, c = B.shape
    gauss = rule(k)
    # unknown are the slopes K at the points: K_i = A_i (S_0 + h Σ_j a_ij K_j) + B_i
    system = -h * np.einsum("ij,pimn->pimjn", gauss.partial, A).reshape(panels, k * n, k * n)
    system[:, np.arange(k * n), np.arange(k * n)] += 1.0
    right = np.concatenate([A, B], axis=3).reshape(panels, k * n, n + c)
    slopes = np.linalg.solve(system, right).reshape(panels, k, n, n + c)
    homogeneous, particular = slopes[..., :n], slopes[..., n:]
    found, S = np.empty((panels, k, n, c)), start
    for i in range(panels):
        K = homogeneous[i] @ S + particular[i]
        found[i] = S + h * np.einsum("ij,jmc->imc", gauss.partial, K)
        S = S + h * np.einsum("j,jmc->mc", gauss.weights, K)
    return found, S
