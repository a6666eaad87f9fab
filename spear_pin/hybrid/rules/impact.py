"""Plastic impacts with Coulomb friction of one toe and of several, and the toes that take part in an impact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Reset
from spear_pin.hybrid.rules.footing import LIFTS
from spear_pin.hybrid.rules.scalars import nowhere, quotient, where

RESTING = 1e-9  # m/s: a toe that approaches more slowly does not strike, whatever its friction
AGREES, ROUNDING = 1e-9, 1e-12  # relative to the toes' speed, and in m/s: largest violation of a joint impact's law


@dataclass(frozen=True)
class Impact:
    """A plastic impact.

    Attributes:
        v: velocity after the impact, (nv,).
        impulse: Λ = (Λ_x, Λ_z) on the toe, in N·s; x is along the ground and z normal to it in this module. If toes
            are `caught`, it has the impulses on all of them, in the order of their rows.
        loss: kinetic energy lost, in J: -½ Λᵀ (J v⁺ + J v⁻).
        slides: whether the toe still slides after the impact.
    """

    v: Array
    impulse: Array
    loss: float
    slides: bool


@dataclass(frozen=True)
class JointImpact:
    """A plastic impact in which several toes take part.

    Attributes:
        v: velocity after the impact, (nv,).
        impulse: Λ on each toe, along the ground and normal to it, in N·s, (m, 2), in space (m, 3).
        loss: kinetic energy lost, in J: -½ Σ Λᵀ (J v⁺ + J v⁻).
        slides: for each toe, whether it stays on the ground and slides; not told of a toe whose bounces end.
        leaves: for each toe, whether the impact lifts it off.
    """

    v: Array
    impulse: Array
    loss: float
    slides: tuple[bool, ...]
    leaves: tuple[bool, ...]


def find_struck_toes(system: HybridSystem, domain: Domain, reset: Reset) -> list[str]:
    """Returns the toes that take part in an impact: those that strike, and those on the ground before and after it.

    An alternating toe counts as on the ground. A brake that closes is an impact as well.
    """
    if not (reset.impact or reset.grips):
        return []
    entered = system.of_phase(reset.phase or domain.phase)[0]
    stay = {
        toe
        for toe, before, after in zip(system.robot.toes, domain.contacts, entered.contacts, strict=True)
        if (before != OPEN and after != OPEN) or toe in domain.alternating
    }
    return [toe for toe in system.robot.toes if toe in stay or toe in reset.impact]


def plastic_impact(D: Array, J: Array, v: Array, friction: float) -> Impact:
    """Computes the impact of one toe on the ground with zero normal restitution, by Routh's method.

    The normal impulse grows until the toe no longer approaches. Meanwhile the toe slides with Coulomb friction. Once
    its sliding stops, it sticks if the cone allows, |a_tn| ≤ μ a_tt with a = J D⁻¹ Jᵀ, or else slides back. If sliding
    stops before the impact ends and the toe then sticks, this is D (v⁺ - v⁻) = Jᵀ Λ with J v⁺ = 0, and Λ lies inside
    the cone. A Λ inside the cone does not suffice: if |a_tn| > μ a_tt, the toe slides back all the same.

    Args:
        D: mass matrix, (nv, nv).
        J: toe Jacobian, rows x and z, (2, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
    """
    response = np.linalg.solve(D, J.T)
    A, before = J @ response, J @ v
    impulse, slides = routh(A.tolist(), before.tolist(), friction)
    Lambda = np.array(impulse)
    after = v + response @ Lambda
    loss = -0.5 * float(Lambda @ (before + J @ after))
    return Impact(after, Lambda, loss, slides)


def caught(D: Array, J: Array, v: Array) -> Impact:
    """Computes the impact of toes that come to rest without a limit of friction, D (v⁺ - v⁻) = Jᵀ Λ with J v⁺ = 0.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes, with all rows of each toe, (m, nv).
        v: velocity before, (nv,).
    """
    response = np.linalg.solve(D, J.T)
    before = J @ v
    impulse = np.asarray(-np.linalg.lstsq(J @ response, before, rcond=None)[0], np.float64)
    return Impact(v + response @ impulse, impulse, -0.5 * float(impulse @ before), False)


def routh(A: Any, before: Any, friction: Any) -> tuple[tuple[Any, Any], Any]:
    """Returns the impulse of a plastic impact of one toe, by Routh's method as in `plastic_impact`.

    Args:
        A: J D⁻¹ Jᵀ, rows of numbers, or (2, 2, n).
        before: J v before the impact, numbers, or (2, n).
        friction: coefficient of friction.

    Returns:
        the impulse, tangential and normal, and whether the toe still slides afterwards.
    """
    (a_tt, a_tn), (_, a_nn) = A
    slide, approach = before
    strikes = approach < -RESTING
    if nowhere(strikes):
        return (0.0 * slide, 0.0 * slide), slide != 0.0
    # the toe slides until it stops, or the impact ends
    grip = where(slide > 0.0, -friction, friction)
    slide_rate, approach_rate = a_tn + a_tt * grip, a_nn + a_tn * grip
    to_end = quotient(approach_rate > 0.0, -approach, approach_rate, math.inf)
    to_stop = quotient(slide * slide_rate < 0.0, -slide, slide_rate, where(slide == 0.0, 0.0, math.inf))
    stops = to_stop <= to_end
    first = where(stops, to_stop, to_end)
    # then the toe sticks, or slides back
    sticks = abs(a_tn) <= friction * a_tt
    turn = where(a_tn > 0.0, -friction, friction)
    back = quotient(sticks & (a_tt > 0.0), -a_tn, a_tt, where(sticks, 0.0, turn))
    left, rate = approach + approach_rate * first, a_nn + a_tn * back
    second = quotient(stops & (left < -RESTING) & (rate > 0.0), -left, rate, 0.0)
    slides = where(stops, (second > 0.0) & (abs(a_tn) > friction * a_tt), True)
    tangential, normal = grip * first + back * second, first + second
    return (where(strikes, tangential, 0.0), where(strikes, normal, 0.0)), where(strikes, slides, slide != 0.0)


def joint_impact(D: Array, J: Array, v: Array, friction: float, leads: Sequence[int] | None = None) -> JointImpact:
    """Computes a plastic impact on several toes at once, by Moreau's law with zero restitution.

    Let u = J v⁺ be the toes' velocities after the impact. Each toe has 0 ≤ Λ_z ⊥ u_z ≥ 0, and sticks with |Λ_x| ≤ μ Λ_z
    or slides with Λ_x = -μ sgn(u_x) Λ_z. So Λᵀ u ≤ 0, and with A = J D⁻¹ Jᵀ the loss is ½ Λᵀ A Λ - Λᵀ u ≥ 0. Such an
    impulse always exists, but need not be unique. Every combination of open, sticking and sliding toes is tried. The
    one with the most sticking toes is taken, of these the one with the most toes on the ground, then the first in
    order. If rounding leaves none that satisfies the law to `AGREES`, the one that violates it least is taken. If the
    rows of sticking toes depend on each other, their impulse is the smallest.

    Toes of one body stick or slide together. Two of them share the impulse along the ground as the normal one.

    A toe that would rise by no more than `LIFTS` bounces no more. A second impact takes its speed: it stays, and so do
    the toes that stay anyway, without friction against those that slide. It loses energy, too.

    The law compares only the velocities before and after. If a single toe sticks in the end, the result is that of
    `plastic_impact`; if its sliding reverses during the impact, the two may differ.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes, with rows x and z of each toe, (2 m, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.
        leads: of each toe, the first toe on its body; without, each toe is on a body of its own.
    """
    response = np.linalg.solve(D, J.T)
    A, before = J @ response, J @ v
    leads = range(len(J) // 2) if leads is None else leads
    impulse, modes = moreau(A, before, friction, leads)
    after = v + response @ impulse
    work = 0.5 * float(impulse @ (before + J @ after))
    slides, leaves = (tuple(mode == kind for mode in modes) for kind in ("slip", "open"))
    return JointImpact(after, impulse.reshape(-1, 2), -work, slides, leaves)


def moreau(A: Array, before: Array, friction: float, leads: Sequence[int]) -> tuple[Array, list[str]]:
    """Returns the impulses of a joint impact, (2 m,), and the modes of the toes: "stick", "slip", "open", or "rest".

    A toe that rests would have risen by no more than `LIFTS`.

    Args:
        A: J D⁻¹ Jᵀ, (2 m, 2 m).
        before: J v before the impact, (2 m,).
        friction: coefficient of friction.
        leads: of each toe, the first toe on its body.
    """
    weight = np.trace(A) / len(A)  # impulses are measured by the velocities that they cause
    allowed = max(AGREES * float(np.abs(before).max()), ROUNDING)
    least, modes, impulse = math.inf, (_OPEN,) * len(leads), np.zeros(len(A))
    for candidate in _combinations(tuple(leads)):
        trial = _impulse(A, before, candidate, friction, leads)
        violation = _violation(before + A @ trial, trial, candidate, friction, weight)
        if violation < least:
            least, modes, impulse = violation, candidate, trial
        if violation <= allowed:
            break
    after = before + A @ impulse
    kinds = [_KINDS[mode] for mode in modes]
    kinds = ["rest" if kind == "open" and up <= LIFTS else kind for kind, up in zip(kinds, after[1::2], strict=True)]
    if "rest" in kinds:
        rows = find_held_rows(kinds, leads)
        impulse[rows] -= np.linalg.lstsq(A[np.ix_(rows, rows)], after[rows], rcond=None)[0]
    return impulse, kinds


def find_held_rows(kinds: Sequence[str], leads: Sequence[int]) -> list[int]:
    """Returns the rows in which toes have no velocity after a joint impact.

    Args:
        kinds: modes of the toes, by `moreau`.
        leads: of each toe, the first toe on its body; if that sticks, both have no velocity along the ground.
    """
    rows = list[int]()
    for i, kind in enumerate(kinds):
        along = kind == "stick" and (leads[i] == i or kinds[leads[i]] != "stick")
        rows += [] if kind == "open" else [2 * i, 2 * i + 1] if along else [2 * i + 1]
    return rows


def rises(speed: Any) -> Any:
    """Tells whether a toe that should strike moves away from the ground, by its normal speed in m/s."""
    return speed > RESTING


def land_toes(D: Array, J: Array, v: Array, lands: Sequence[bool]) -> tuple[Array, Array]:
    """Stops toes that rise but return to the ground within an instant, before the impact, so that they rise no more.

    This ends the ever shorter bounces of toes that lift each other off.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobians of the toes on the ground, rows x and z of each, (2 m, nv), or x, y and z, (3 m, nv).
        v: velocity before, (nv,).
        lands: which of the toes touch down.

    Returns:
        the velocity, (nv,), and the normal impulses that took the toes' speed, (m,).
    """
    each = len(J) // len(lands)
    normal = J[each - 1 :: each]
    rising = np.where(lands, normal @ v, 0.0)
    if not rises(rising).any():
        return v, np.zeros(len(normal))
    response = np.linalg.solve(D, normal.T)
    impulse = np.linalg.solve(normal @ response, -np.maximum(rising, 0.0))
    return v + response @ impulse, impulse


_STICK, _OPEN = 0, 2
_SIDES = (1, -1)  # a toe that slides forward, or backward
_KINDS = {_STICK: "stick", **dict.fromkeys(_SIDES, "slip"), _OPEN: "open"}


@cache
def _combinations(leads: tuple[int, ...]) -> tuple[tuple[int, ...], ...]:
    """Returns the combinations of the modes that toes may have, in order of preference."""
    modes = product((_STICK, *_SIDES, _OPEN), repeat=len(leads))
    alike = [each for each in modes if all(len({each[i], each[lead], _OPEN}) < 3 for i, lead in enumerate(leads))]
    return tuple(sorted(alike, key=lambda each: (-each.count(_STICK), each.count(_OPEN))))


def _impulse(A: Array, before: Array, modes: tuple[int, ...], friction: float, leads: Sequence[int]) -> Array:
    """Returns the impulse for which the toes keep to these modes, whether or not the law allows it."""
    rows: list[int] = []
    directions: list[Array] = []
    unit = np.eye(len(A))
    beside = [(lead, i) for i, lead in enumerate(leads) if lead < i and modes[lead] == modes[i] == _STICK]
    led = [i for _, i in beside]
    for i, mode in enumerate(modes):
        if mode == _STICK:
            own = [2 * i + 1] if i in led else [2 * i, 2 * i + 1]
            rows += own
            directions += [*unit[own]]
        elif mode in _SIDES:
            rows.append(2 * i + 1)
            directions.append(unit[2 * i + 1] - mode * friction * unit[2 * i])
    if not rows:
        return np.zeros(len(A))
    G = np.array(directions).T
    found = np.asarray(G @ np.linalg.lstsq(A[rows] @ G, -before[rows], rcond=None)[0], np.float64)
    pairs = found.reshape(-1, 2)
    for foot in map(list, beside):
        along, normal = pairs[foot].sum(axis=0)
        pairs[foot, 0] = along * (pairs[foot, 1] / normal if normal else 0.5)
    return found


def _violation(u: Array, impulse: Array, modes: tuple[int, ...], friction: float, weight: float) -> float:
    """Returns how much the velocities u after the impact, or the impulses, violate the law, in m/s."""
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
