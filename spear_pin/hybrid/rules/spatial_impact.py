"""Plastic impacts in space with Coulomb friction, of any number of toes, by Moreau's law."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.rules.cone import Foothold, foothold
from spear_pin.hybrid.rules.impact import AGREES, ROUNDING, JointImpact

SWEEPS = 500
SETTLED = 1e-15  # largest change of an impulse in the last sweep, relative to the largest impulse
GAINED = 1e-12  # gain of energy due to rounding, relative to the kinetic energy that passes through the toes


class Answer(NamedTuple):
    """Impulses that obey Moreau's law.

    Attributes:
        impulse: the sum of all impulses on each toe that the law is about, (m, 3), in N·s.
        modes: how each toe meets the ground: "stick", "slip" or "open".
        earlier: the part of the sum that toes have received before, (m, 3), in N·s.
    """

    impulse: Array
    modes: tuple[str, ...]
    earlier: Array


def spatial_impact(D: Array, J: Array, v: Array, friction: float, before: Array | None = None) -> JointImpact:
    """Computes a plastic impact on several toes at once, by Moreau's law with zero restitution.

    Let u = J v⁺ be the toes' velocities after the impact. Each toe has 0 ≤ Λ_z ⊥ u_z ≥ 0, and sticks with |Λ_t| ≤ μ Λ_z
    or slides along d with Λ_t = -μ Λ_z d. So Λᵀ u ≤ 0, and with A = J D⁻¹ Jᵀ the loss is ½ Λᵀ A Λ - Λᵀ u ≥ 0. If all
    toes can stick, they do; else Gauss and Seidel's method iterates over exact solutions for one toe each.

    If impacts overlap, `before` has the impulses that toes have received so far. The sum obeys the law, so that a toe
    stays as long as the sum of its normal impulses is positive. If this would gain energy, each impact obeys the law
    alone.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes, with rows x, y and z of each toe, (3 m, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
        before: impulses of impacts that have not ended yet, (m, 3), in N·s.
    """
    response = np.linalg.solve(D, J.T)
    A, u = J @ response, J @ v
    answer = find_impulses(A, u, friction, before)
    impulse = (answer.impulse - answer.earlier).ravel()
    slides, leaves = (tuple(mode == which for mode in answer.modes) for which in ("slip", "open"))
    return JointImpact(v + response @ impulse, impulse.reshape(-1, 3), loss(A, u, impulse), slides, leaves)


def find_impulses(A: Array, u: Array, friction: float, before: Array | None = None) -> Answer:
    """Finds the impulses of `spatial_impact`.

    Args:
        A: J D⁻¹ Jᵀ, (3 m, 3 m).
        u: velocities of the toes before, (3 m,).
        friction: coefficient of friction.
        before: impulses of impacts that have not ended yet, (m, 3), in N·s.
    """
    nothing = np.zeros((len(u) // 3, 3))
    for earlier in (nothing if before is None else before, nothing):
        found = _together(A, u - A @ earlier.ravel(), friction)
        impulse = (found.impulse - earlier).ravel()
        if loss(A, u, impulse) >= -GAINED * float(np.abs(impulse * u).sum()) or np.abs(u).max() <= ROUNDING:
            break
    return found._replace(earlier=earlier)


def loss(A: Array, u: Array, impulse: Array) -> float:
    """Returns the kinetic energy, in J, that impulses, (3 m,), take from toes with the velocities u, (3 m,)."""
    return -0.5 * float(impulse @ (2.0 * u + A @ impulse))


def violation(A: Array, u: Array, impulse: Array, friction: float) -> float:
    """Returns how much impulses violate Moreau's law, in m/s.

    Args:
        A: J D⁻¹ Jᵀ, (3 m, 3 m).
        u: velocities of the toes before, (3 m,).
        impulse: impulses on the toes, (m, 3), in N·s.
        friction: coefficient of friction.
    """
    after = (u + A @ impulse.ravel()).reshape(-1, 3)
    weight = np.trace(A) / len(A)  # impulses are measured by the velocities that they cause
    worst = 0.0
    for (x, y, z), (px, py, pz) in zip(after.tolist(), impulse.tolist(), strict=True):
        pressed, pushed, speed = weight * pz, weight * np.hypot(px, py), np.hypot(x, y)
        moves = speed > 0.0 and pushed > 0.0  # then friction is along the velocity, as near as either is to zero
        aside = weight * abs(px * y - py * x) / max(speed, pushed) if moves else 0.0
        against = max(0.0, px * x + py * y) / speed * weight if speed > 0.0 else 0.0
        slack = min(speed, abs(friction * pressed - pushed), max(pressed, 0.0)) if speed > 0.0 else 0.0
        worst = max(worst, -z, -pressed, min(abs(z), abs(pressed)), pushed - friction * pressed, slack)
        worst = max(worst, aside, min(against, speed))
    return float(worst)


def _together(A: Array, u: Array, friction: float) -> Answer:
    """Finds impulses for which all toes obey the law together."""
    m = len(u) // 3
    sticking = np.asarray(-np.linalg.lstsq(A, u, rcond=None)[0].reshape(-1, 3), np.float64)
    if all(np.hypot(x, y) <= friction * z for x, y, z in sticking.tolist()):
        if np.abs(u + A @ sticking.ravel()).max() <= max(AGREES * np.abs(u).max(), ROUNDING):
            return Answer(sticking, m * ("stick",), np.zeros((m, 3)))
    impulse, holds = np.zeros((m, 3)), [Foothold(np.zeros(3), "open")] * m
    blocks = [slice(3 * i, 3 * i + 3) for i in range(m)]
    for _ in range(SWEEPS):
        last = impulse.copy()
        for i, own in enumerate(blocks):
            without = u[own] + A[own] @ impulse.ravel() - A[own, own] @ impulse[i]
            holds[i] = foothold(A[own, own], without, friction)
            impulse[i] = holds[i].force
        if np.abs(impulse - last).max() <= SETTLED * np.abs(impulse).max():
            break
    return Answer(impulse, tuple(hold.mode for hold in holds), np.zeros((m, 3)))
