"""Coulomb's cone in space: how one toe meets the ground, in forces and accelerations or in impulses and velocities.

Let A = J D⁻¹ Jᵀ of the toe, along x, y and z, and let b be its acceleration (velocity) without force (impulse). The
same law holds for both: 0 ≤ F_z ⊥ (b + A F)_z ≥ 0, and the toe sticks with |F_t| ≤ μ F_z or slides along the unit
vector d with F_t = -μ F_z d.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array

ON_CIRCLE = 1e-6  # largest difference from 1 of the modulus of a root that is a direction
POLISH = 3  # steps of Newton's method, each of which doubles a root's digits
WITHIN = 1e-12  # of the normal force: a toe may stick by this much outside the cone


class Slide(NamedTuple):
    """A way to slide.

    Attributes:
        direction: unit vector along the ground, (x, y).
        normal: force or impulse normal to the ground.
        rate: component of b + A F along the direction, positive.
    """

    direction: tuple[float, float]
    normal: float
    rate: float


class Foothold(NamedTuple):
    """How a toe meets the ground.

    Attributes:
        force: force on the toe, (3,).
        mode: "open", "stick" or "slip".
        direction: direction in which the toe begins to slide, if it does.
    """

    force: Array
    mode: str
    direction: tuple[float, float] | None = None


def pivot(A: Array, direction: tuple[float, float], friction: float) -> float:
    """Returns p(d) = A_zz - μ A_zt·d, in 1/kg, the effective inverse mass of a sliding toe's normal force."""
    return float(A[2, 2] - friction * (A[2, 0] * direction[0] + A[2, 1] * direction[1]))


def slides(A: Array, b: Array, friction: float, least: float = 0.0) -> list[Slide]:
    """Finds the directions in which a toe at rest can begin to slide, the fastest first.

    They satisfy d x (b + A F)_t = 0 and d·(b + A F)_t > 0 under F = F_z (e_z - μ d), F_z = -b_z / p(d). Multiplied by
    p, the first equation is a trigonometric polynomial of second degree in the angle of d, a quartic in exp(iθ).

    Args:
        A: J D⁻¹ Jᵀ of the toe, (3, 3).
        b: acceleration without force, or velocity without impulse, (3,).
        friction: μ.
        least: least rate of a slide; on the cone's edge rounding makes the rate negative.
    """
    constant = A[2, 2] * b[:2] - b[2] * A[:2, 2]
    linear = friction * (b[2] * A[:2, :2] - np.outer(b[:2], A[2, :2]))
    once = complex(constant[1], constant[0])  # of cos θ, and minus that of sin θ, of the cross product
    twice = 0.5 * complex(linear[1, 0] + linear[0, 1], -(linear[1, 1] - linear[0, 0]))
    still = 0.5 * (linear[1, 0] - linear[0, 1])
    quartic = np.array([0.5 * twice, 0.5 * once, still, 0.5 * once.conjugate(), 0.5 * twice.conjugate()])
    found: list[Slide] = []
    for root in _roots(quartic):
        if abs(abs(root) - 1.0) > ON_CIRCLE:
            continue
        direction = _polished(quartic, math.atan2(root.imag, root.real))
        inverse = pivot(A, direction, friction)
        if inverse <= 0.0 or b[2] >= 0.0:
            continue
        normal = float(-b[2] / inverse)
        after = b[:2] + normal * (A[:2, 2] - friction * A[:2, :2] @ direction)
        rate = float(after @ direction)
        if rate > least:
            found.append(Slide(direction, normal, rate))
    return sorted(found, key=lambda slide: -slide.rate)


def foothold(A: Array, b: Array, friction: float) -> Foothold:
    """Decides how one toe meets the ground: open, sticking, or sliding along the direction in which it begins to.

    Of several ways to slide, which one in ten thousand random toes has, it takes the fastest. If no mode is consistent
    (Painlevé's paradox) the toe sticks outside the cone. For the arguments see `slides`.
    """
    if b[2] >= 0.0:
        return Foothold(np.zeros(3), "open")
    force = np.asarray(-np.linalg.solve(A, b), np.float64)
    if math.hypot(force[0], force[1]) <= friction * force[2] * (1.0 + WITHIN):
        return Foothold(force, "stick")
    ways = slides(A, b, friction)
    if not ways:
        return Foothold(force, "stick")
    (x, y), normal, _ = ways[0]
    return Foothold(np.array([-friction * x * normal, -friction * y * normal, normal]), "slip", (x, y))


def _roots(quartic: NDArray[np.complex128]) -> NDArray[np.complex128]:
    size = float(np.abs(quartic).max())
    found = np.roots(quartic) if size > 0.0 and math.isfinite(size) else np.empty(0)
    return np.asarray(found, np.complex128)


def _polished(quartic: NDArray[np.complex128], angle: float) -> tuple[float, float]:
    """Returns the unit vector at an angle, after Newton's method on the trigonometric polynomial."""
    twice, once, still = 2.0 * quartic[0], 2.0 * quartic[1], quartic[2].real
    for _ in range(POLISH):
        z = complex(math.cos(angle), math.sin(angle))
        value = (once * z + twice * z * z).real + still
        slope = (1j * once * z + 2j * twice * z * z).real
        angle -= value / slope if slope else 0.0
    return math.cos(angle), math.sin(angle)
