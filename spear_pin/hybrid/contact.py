"""Point contact with Coulomb friction: stick and slip dynamics, plastic impact with friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import require

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """The ground.

    Attributes:
        friction: coefficient of Coulomb friction, static and kinetic (assumption; not in the source).
    """

    friction: float = 0.8

    def __post_init__(self) -> None:
        """Check the fields."""
        require("Contact.friction", self.friction, lambda mu: mu > 0, "a number > 0")


@dataclass(frozen=True)
class Impact:
    """A plastic impact.

    Attributes:
        v: velocity afterwards, (nv,).
        impulse: Λ = (Λ_x, Λ_z) on the toe, in N·s.
        loss: kinetic energy lost, in J: -½ Λᵀ (J v⁺ + J v⁻).
        slides: whether the toe still slides afterwards.
    """

    v: Array
    impulse: Array
    loss: float
    slides: bool


def constrained(D: Array, force: Array, A: Array, G: Array, drift: Array) -> tuple[Array, Array, Array]:
    """Solve D a = force + G λ under A a + drift = 0.

    For a sticking toe A = J and G = Jᵀ; for one that slips with the sign s, A = J_z and
    G = J_zᵀ - μ s J_xᵀ, (3.17)-(3.18) with the direction of friction in them.

    Args:
        D: mass matrix, (nv, nv).
        force: generalised force less bias, (nv,).
        A: constraint rows, (m, nv).
        G: force directions, (nv, m).
        drift: Ȧ v, (m,).

    Returns:
        a (nv,), λ (m,), and the Schur complement A D⁻¹ G (m, m); for a slipping toe this is the
        pivot, and where it is not positive the equation has no solution or two (Painlevé).
    """
    solved = np.linalg.solve(D, np.column_stack([force, G]))
    free, response = solved[:, 0], solved[:, 1:]
    schur = A @ response
    multiplier = np.linalg.solve(schur, -(drift + A @ free))
    a = free + response @ multiplier
    return np.asarray(a, np.float64), np.asarray(multiplier, np.float64), np.asarray(schur, np.float64)


def plastic_impact(D: Array, J: Array, v: Array, friction: float) -> Impact:
    """Impact of one toe on the ground with zero normal restitution, by Routh's method.

    The normal impulse grows until the toe no longer approaches; meanwhile the toe slides with
    Coulomb friction, and once its sliding stops it sticks if the cone allows, or slides back.
    Where the impulse that stops the toe at once lies inside the cone, and the toe stops before the
    impact ends, this is D (v⁺ - v⁻) = Jᵀ Λ with J v⁺ = 0.

    Args:
        D: mass matrix, (nv, nv).
        J: toe Jacobian, rows x and z, (2, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
    """
    response = np.linalg.solve(D, J.T)
    (a_tt, a_tn), (_, a_nn) = (J @ response).tolist()
    slide, approach = before = (J @ v).tolist()
    impulse = [0.0, 0.0]
    slides = True
    for _ in range(3):  # slide, then stick or slide back
        if approach >= 0.0:
            break
        sticks = slide == 0.0 and abs(a_tn) <= friction * a_tt
        direction = math.copysign(1.0, slide if slide != 0.0 else a_tn)
        ratio = -a_tn / a_tt if sticks else -friction * direction
        slide_rate, approach_rate = a_tn + a_tt * ratio, a_nn + a_tn * ratio
        to_end = -approach / approach_rate if approach_rate > 0.0 else math.inf
        to_stop = -slide / slide_rate if not sticks and slide * slide_rate < 0.0 else math.inf
        normal = min(to_end, to_stop)
        impulse = [impulse[0] + ratio * normal, impulse[1] + normal]
        slide = 0.0 if sticks or to_stop <= to_end else slide + slide_rate * normal
        approach = 0.0 if to_end <= to_stop else approach + approach_rate * normal
        slides = not sticks
    Lambda = np.array(impulse)
    after = v + response @ Lambda
    loss = -0.5 * float(Lambda @ (np.array(before) + J @ after))
    return Impact(after, Lambda, loss, slides and slide != 0.0)
