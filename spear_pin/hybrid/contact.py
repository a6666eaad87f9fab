"""Point contact with Coulomb friction: modes, the ground, and the dynamics of toes that stick and slip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg.lapack import dgesv

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.kinds import typed

CONTACTS = OPEN, STICK, SLIP_FORWARD, SLIP_BACKWARD, SLIP, PINNED = "open", "stick", "slip+", "slip-", "slip", "pinned"
SIGN = {SLIP_FORWARD: 1.0, SLIP_BACKWARD: -1.0}
SLIPS, RESTS = (SLIP_FORWARD, SLIP_BACKWARD, SLIP), (STICK, PINNED)
WAYS = {2: (SLIP_FORWARD, SLIP_BACKWARD), 3: (SLIP,)}
"""Modes of a toe that slides, in the plane and in space, where it does along a direction of its own."""
SLOW = 3e-6  # m/s: a toe in space that slides more slowly, and decelerates, is stopped
SETTING_OUT = 4e-5  # m/s: up to this speed a toe that began to slide keeps the direction to which its velocity turns


@typed
@dataclass(frozen=True)
class Contact:
    """Level ground at height zero; `spear_pin.Ground` has more options.

    Attributes:
        friction: coefficient of Coulomb friction, static and kinetic (assumption; not in the source).

    Example:
        >>> from spear_pin import Contact, hopping, load
        >>> hopping(load("spear_ii"), contact=Contact(friction=0.5)).contact
        Contact(friction=0.5)
    """

    friction: float = 0.8

    def __post_init__(self) -> None:
        """Checks the fields."""
        require(f"{type(self).__name__}.friction", self.friction, lambda mu: mu > 0, "a number > 0")


def solve(matrix: Any, right: Any) -> Array:
    """Solves a linear system, and returns its solution, (n,) or (n, k), with n at least 1.

    It skips NumPy's checks, which take several microseconds.

    Args:
        matrix: the matrix, (n, n).
        right: the right-hand side, (n,) or (n, k).

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular.
    """
    *_, solution, info = dgesv(matrix, right)
    if info > 0:
        raise np.linalg.LinAlgError("Singular matrix")
    return np.asarray(solution, np.float64)


def solve_constrained(D: Array, force: Array, A: Array, G: Array, drift: Array) -> tuple[Array, Array, Array]:
    """Solves D a = force + G λ under A a + drift = 0.

    A sticking toe has A = J and G = Jᵀ. A toe that slips with the sign s has A = J_z and G = J_zᵀ - μ s J_xᵀ,
    (3.17)-(3.18) including the direction of friction.

    Args:
        D: mass matrix, (nv, nv).
        force: generalised force minus bias, (nv,); further columns (nv, k) are forces that add to it.
        A: constraint rows, (m, nv).
        G: force directions, (nv, m).
        drift: Ȧ v, (m,).

    Returns:
        a (nv,), λ (m,), with as many columns as `force`, and the Schur complement A D⁻¹ G (m, m). For a slipping toe
        the complement is the pivot; where it is not positive the equation has no solution or two (Painlevé).
    """
    forces = force[:, None] if force.ndim == 1 else force
    k = forces.shape[1]
    solved = solve(D, np.concatenate((forces, G), axis=1))
    free, response = solved[:, :k], solved[:, k:]
    schur = A @ response
    approach = A @ free
    approach[:, 0] += drift
    multiplier = solve(schur, -approach)
    a = free + response @ multiplier
    if force.ndim == 1:
        a, multiplier = a[:, 0], multiplier[:, 0]
    return np.asarray(a, np.float64), np.asarray(multiplier, np.float64), np.asarray(schur, np.float64)


def impose_rows(
    D: Array, force: Array, J: Array, drift: Array, rows: ArrayLike, wanted: Sequence[float], driven: Sequence[int]
) -> Array:
    """Finds forces along some coordinates that make rows · a = wanted while toes stay at rest.

    The equations are D a = force + Jᵀ λ + u and J a + drift = 0, (3.17)-(3.18), where u acts on the driven coordinates
    alone. The rows take the place of the equations of these coordinates, from which u follows.

    Args:
        D: mass matrix, (nv, nv).
        force: all other generalised forces, minus the bias, (nv,).
        J: Jacobians of the toes, (m, nv).
        drift: J̇ v, (m,).
        rows: rows over the coordinates, (k, nv).
        wanted: values of rows · a, (k,).
        driven: indices of k coordinates.

    Returns:
        the forces along the driven coordinates, (k,).

    Raises:
        numpy.linalg.LinAlgError: the decoupling matrix is singular.
    """
    nv, n = len(D), len(D) + len(J)
    system, right = np.zeros((n, n)), np.concatenate((force, -drift))
    system[:nv, :nv], system[nv:, :nv], system[:nv, nv:] = D, J, -J.T
    equations, forces = system[driven], right[driven]
    system[driven], right[driven] = 0.0, wanted
    system[driven, :nv] = rows
    return np.asarray(equations @ solve(system, right) - forces, np.float64)
