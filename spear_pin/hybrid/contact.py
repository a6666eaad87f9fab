"""Point contact with Coulomb friction: stick and slip dynamics, plastic impact with friction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import require
from spear_pin.kinds import typed

Array = NDArray[np.float64]
CONTACTS = OPEN, STICK, SLIP_FORWARD, SLIP_BACKWARD = "open", "stick", "slip+", "slip-"
SIGN = {SLIP_FORWARD: 1.0, SLIP_BACKWARD: -1.0}
RESTING = 1e-9  # m/s: a toe that approaches more slowly does not strike, whatever friction might make of it
AGREES, ROUNDING = 1e-9, 1e-12  # of the toes' speed, and in m/s: by so much a joint impact may violate its law


@typed
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


@dataclass(frozen=True)
class JointImpact:
    """A plastic impact that several toes take part in.

    Attributes:
        v: velocity afterwards, (nv,).
        impulse: Λ_x and Λ_z on each toe, in N·s, (m, 2).
        loss: kinetic energy lost, in J: -½ Σ Λᵀ (J v⁺ + J v⁻).
        slides: for each toe, whether it stays on the ground and slides.
        leaves: for each toe, whether the impact lifts it off.
    """

    v: Array
    impulse: Array
    loss: float
    slides: tuple[bool, ...]
    leaves: tuple[bool, ...]


def constrained(D: Array, force: Array, A: Array, G: Array, drift: Array) -> tuple[Array, Array, Array]:
    """Solve D a = force + G λ under A a + drift = 0.

    For a sticking toe A = J and G = Jᵀ; for one that slips with the sign s, A = J_z and
    G = J_zᵀ - μ s J_xᵀ, (3.17)-(3.18) with the direction of friction in them.

    Args:
        D: mass matrix, (nv, nv).
        force: generalised force less bias, (nv,); further columns (nv, k) are forces that add to it.
        A: constraint rows, (m, nv).
        G: force directions, (nv, m).
        drift: Ȧ v, (m,).

    Returns:
        a (nv,), λ (m,), with as many columns as `force`, and the Schur complement A D⁻¹ G (m, m);
        for a slipping toe this is the pivot, and where it is not positive the equation has no
        solution or two (Painlevé).
    """
    k = 1 if force.ndim == 1 else force.shape[1]
    solved = np.linalg.solve(D, np.column_stack([force, G]))
    free, response = solved[:, :k], solved[:, k:]
    schur = A @ response
    approach = A @ free
    approach[:, 0] += drift
    multiplier = np.linalg.solve(schur, -approach)
    a = free + response @ multiplier
    if force.ndim == 1:
        a, multiplier = a[:, 0], multiplier[:, 0]
    return np.asarray(a, np.float64), np.asarray(multiplier, np.float64), np.asarray(schur, np.float64)


def plastic_impact(D: Array, J: Array, v: Array, friction: float) -> Impact:
    """Impact of one toe on the ground with zero normal restitution, by Routh's method.

    The normal impulse grows until the toe no longer approaches; meanwhile the toe slides with
    Coulomb friction, and once its sliding stops it sticks if the cone allows, |a_tn| ≤ μ a_tt with
    a = J D⁻¹ Jᵀ, or else slides back. Where sliding stops before the impact ends and the toe then
    sticks, this is D (v⁺ - v⁻) = Jᵀ Λ with J v⁺ = 0, and Λ lies inside the cone. A Λ that does so
    does not suffice: where |a_tn| > μ a_tt, the toe slides back all the same.

    Args:
        D: mass matrix, (nv, nv).
        J: toe Jacobian, rows x and z, (2, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
    """
    response = np.linalg.solve(D, J.T)
    A, before = J @ response, J @ v
    impulses, sliding = routh(A[..., None], before[:, None], friction)
    Lambda, slides = impulses[:, 0], bool(sliding[0])
    after = v + response @ Lambda
    loss = -0.5 * float(Lambda @ (before + J @ after))
    return Impact(after, Lambda, loss, slides)


def routh(A: Array, before: Array, friction: float | Array) -> tuple[Array, NDArray[np.bool_]]:
    """Impulses of many plastic impacts of one toe, by Routh's method as in `plastic_impact`.

    Args:
        A: J D⁻¹ Jᵀ, (2, 2, n).
        before: J v before, (2, n).
        friction: coefficient of friction, a number or (n,).

    Returns:
        the impulses, (2, n), and whether each toe still slides afterwards, (n,).
    """
    (a_tt, a_tn), (_, a_nn) = A
    slide, approach = before
    tangential, normal = np.zeros_like(slide), np.zeros_like(slide)
    slides = np.ones(slide.shape, bool)
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(3):  # slide, then stick or slide back
            goes_on = approach < -RESTING
            sticks = (slide == 0.0) & (np.abs(a_tn) <= friction * a_tt)
            direction = np.copysign(1.0, np.where(slide != 0.0, slide, a_tn))
            ratio = np.where(sticks, -a_tn / a_tt, -friction * direction)
            slide_rate, approach_rate = a_tn + a_tt * ratio, a_nn + a_tn * ratio
            to_end = np.where(approach_rate > 0.0, -approach / approach_rate, np.inf)
            to_stop = np.where(~sticks & (slide * slide_rate < 0.0), -slide / slide_rate, np.inf)
            more = np.where(goes_on, np.minimum(to_end, to_stop), 0.0)
            tangential, normal = tangential + np.where(goes_on, ratio * more, 0.0), normal + more
            stopped, ended = sticks | (to_stop <= to_end), to_end <= to_stop
            slides = np.where(goes_on, ~sticks, slides)
            slide = np.where(goes_on, np.where(stopped, 0.0, slide + slide_rate * more), slide)
            approach = np.where(goes_on, np.where(ended, 0.0, approach + approach_rate * more), approach)
    return np.array([tangential, normal]), slides & (slide != 0.0)


def joint_impact(D: Array, J: Array, v: Array, friction: float) -> JointImpact:
    """Plastic impact on several toes at once, by Moreau's law with zero restitution.

    With u = J v⁺ the toes' velocities afterwards, for each toe 0 ≤ Λ_z ⊥ u_z ≥ 0, and it sticks with
    |Λ_x| ≤ μ Λ_z or slides with Λ_x = -μ sgn(u_x) Λ_z. So Λᵀ u ≤ 0, and with A = J D⁻¹ Jᵀ the loss is
    ½ Λᵀ A Λ - Λᵀ u ≥ 0. There always is such an impulse, if not always just one. Every combination of
    open, sticking and sliding toes is tried: the one with the most sticking toes is taken, of those
    the one with the most on the ground, then the first in order; if rounding leaves none that
    satisfies the law to `AGREES`, the one that violates it least. Where the rows of sticking toes
    depend on each other, their impulse is the smallest.

    It compares velocities before and after only. Where a single toe sticks in the end, this is
    `plastic_impact`; where its sliding turns round on the way, the two may differ.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes, rows x and z of each, (2 m, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
    """
    response = np.linalg.solve(D, J.T)
    A, before = J @ response, J @ v
    weight = np.trace(A) / len(A)  # impulses count as the velocities that they cause
    allowed = max(AGREES * float(np.abs(before).max()), ROUNDING)
    m = len(J) // 2
    least, modes, impulse = math.inf, (_OPEN,) * m, np.zeros(len(J))
    for candidate in _combinations(m):
        trial = _impulse(A, before, candidate, friction)
        violation = _violation(before + A @ trial, trial, candidate, friction, weight)
        if violation < least:
            least, modes, impulse = violation, candidate, trial
        if violation <= allowed:
            break
    after = v + response @ impulse
    work = 0.5 * float(impulse @ (before + J @ after))
    return JointImpact(
        after,
        impulse.reshape(-1, 2),
        -work,
        tuple(mode in _SIDES for mode in modes),
        tuple(mode == _OPEN for mode in modes),
    )


def landed(D: Array, J: Array, v: Array, lands: Sequence[bool]) -> tuple[Array, Array]:
    """Stop toes that rise, but are back on the ground within an instant, before the impact: they rise no more.

    So end the bounces, ever shorter, of toes that lift each other off.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes on the ground, rows x and z of each, (2 m, nv).
        v: velocity before, (nv,).
        lands: which of them touch down.

    Returns:
        the velocity, (nv,), and the vertical impulses that took the toes' speed, (m,).
    """
    normal = J[1::2]
    rising = np.where(lands, normal @ v, 0.0)
    if not (rising > RESTING).any():
        return v, np.zeros(len(normal))
    response = np.linalg.solve(D, normal.T)
    impulse = np.linalg.solve(normal @ response, -np.maximum(rising, 0.0))
    return v + response @ impulse, impulse


_STICK, _OPEN = 0, 2
_SIDES = (1, -1)  # a toe that slides forward, or backward


@cache
def _combinations(m: int) -> tuple[tuple[int, ...], ...]:
    """Combinations of the modes that m toes may have, in order of preference."""
    modes = product((_STICK, *_SIDES, _OPEN), repeat=m)
    return tuple(sorted(modes, key=lambda each: (-each.count(_STICK), each.count(_OPEN))))


def _impulse(A: Array, before: Array, modes: tuple[int, ...], friction: float) -> Array:
    """The impulse by which the toes do what they are said to, whether or not the law allows it."""
    rows: list[int] = []
    directions: list[Array] = []
    unit = np.eye(len(A))
    for i, mode in enumerate(modes):
        if mode == _STICK:
            rows += [2 * i, 2 * i + 1]
            directions += [unit[2 * i], unit[2 * i + 1]]
        elif mode in _SIDES:
            rows.append(2 * i + 1)
            directions.append(unit[2 * i + 1] - mode * friction * unit[2 * i])
    if not rows:
        return np.zeros(len(A))
    G = np.array(directions).T
    found = np.linalg.lstsq(A[rows] @ G, -before[rows], rcond=None)[0]
    return np.asarray(G @ found, np.float64)


def _violation(u: Array, impulse: Array, modes: tuple[int, ...], friction: float, weight: float) -> float:
    """By how much the law is violated, in m/s: by velocities u afterwards, or by impulses."""
    worst = 0.0
    for i, mode in enumerate(modes):
        slide, rise = u[2 * i : 2 * i + 2].tolist()
        tangential, normal = impulse[2 * i : 2 * i + 2].tolist()
        if mode == _OPEN:
            worst = max(worst, -rise)
        elif mode == _STICK:
            outside = max(abs(tangential) - friction * normal, -normal)
            worst = max(worst, abs(slide), abs(rise), weight * outside)
        else:
            worst = max(worst, -mode * slide, abs(rise), -weight * normal)
    return worst
