"""Floquet multipliers and their derivatives along a branch, from the change of the exact Jacobian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number
from spear_pin.hybrid.periodic import by_modulus
from spear_pin.hybrid.tangent.resets import NotDifferentiable

Multipliers = NDArray[np.complex128]
STEP = 2.0**-11  # of a parameter


def step_of(orbit: Orbit, name: str, share: float = STEP) -> float:
    """Returns the step of a parameter, a share of its value, for differences of exact Jacobians."""
    return share * (abs(number(orbit.system, name)) or 1.0)


def along_branch(
    orbit: Orbit, over: Sequence[str], dy: Array, dz: Mapping[str, Array]
) -> tuple[Multipliers, Multipliers]:
    """Returns multipliers by decreasing modulus, (d,), and their derivatives along a branch of gaits, (d, m).

    A simple multiplier λ with the eigenvectors l and r has λ' = lᴴ M' r / (lᴴ r). M' is an extrapolated difference of
    exact Jacobians, because the Jacobian stays smooth where two multipliers nearly meet and bend sharply. The
    derivative is NaN where the order of events changes too near.

    Args:
        orbit: the gait.
        over: names of the parameters.
        dy: derivatives of the state by the parameters, (2 nv, m).
        dz: derivatives of what is solved for, by name, (m,) each.
    """
    values, left, right = scipy.linalg.eig(orbit.jacobian, left=True, right=True)
    order = by_modulus(values)
    values, left, right = values[order], left[:, order], right[:, order]
    slopes = np.full((len(values), len(over)), np.nan, complex)
    for j, name in enumerate(over):
        h = step_of(orbit, name)
        given = {other: float(slope[j]) for other, slope in dz.items()}
        try:
            far, near = (_difference(orbit, {name: 1.0, **given}, dy[:, j], step) for step in (h, 0.5 * h))
        except (NotDifferentiable, BadValue):
            continue  # the branch ends so near
        change = left.conj().T @ ((4.0 * near - far) / 3.0) @ right
        slopes[:, j] = np.diag(change) / np.einsum("ij,ij->j", left.conj(), right)
    return np.asarray(values, np.complex128), slopes


def moduli(multipliers: Multipliers, slopes: Multipliers) -> tuple[Array, Array]:
    """Returns the moduli, (d,), and their derivatives, (d, m), NaN where the multiplier is zero."""
    sizes = np.abs(multipliers)
    return sizes, np.real(np.conj(multipliers)[:, None] * slopes) / np.where(sizes > 0.0, sizes, np.nan)[:, None]


def _difference(orbit: Orbit, along: Mapping[str, float], dy: Array, h: float) -> Array:
    """Returns the Jacobian's change per unit along numbers and state, in the coordinates of the gait's own chart."""
    ends = []
    for step in (h, -h):
        there = orbit.beside({name: step * slope for name, slope in along.items()}, step * dy)
        if there.cycle.order != orbit.cycle.order:
            raise NotDifferentiable("another order of events is too near")
        here, other = orbit.chart, there.chart
        to = scipy.linalg.block_diag(here.q_basis.T @ other.q_basis, here.v_basis.T @ other.v_basis)
        ends.append(to @ there.jacobian @ np.linalg.inv(to))
    found: Array = (ends[0] - ends[1]) / (2.0 * h)
    return found
