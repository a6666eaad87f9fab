"""Derivatives of an event's effects: dual numbers pass through the rules of impacts and latches."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.hybrid.dual import Dual, derivatives, duals, value_of
from spear_pin.hybrid.elimination import solve
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.guards import struck as told
from spear_pin.hybrid.rules.impact import find_held_rows, moreau, rises, routh
from spear_pin.hybrid.rules.spatial_impact import find_impulses
from spear_pin.hybrid.tangent.fields import ToeNumbers
from spear_pin.model.scalars import dot

T = TypeVar("T")
DEGENERATE = 1e-9  # relative to the largest speed or impulse: an active set this close to another is degenerate
BORDER = "an impact of several toes is on the border between two outcomes"
SINGULAR = 1e12  # condition number of J D⁻¹ Jᵀ above which toes depend on each other
UNMOVED = 1e-7  # m/s per unit of a direction: toes at rest stay so if their speeds change less, as where a path turns


class NotDifferentiable(SpearError):
    """Raised when a cycle has no derivative, or none that can be computed here; the text says why."""


REFUSALS = SpearError, TypeError, ArithmeticError, np.linalg.LinAlgError
"""What stands for no derivative: a cycle that has none, a latch that branches on a value, an overflow."""


def attempt(of: Callable[[], T]) -> T | None:
    """Returns what a function returns; None where it has no derivative, and raises one of `REFUSALS`."""
    try:
        return of()
    except REFUSALS:
        return None


def differentiate_strike(
    feet: ToeNumbers,
    slopes: ToeNumbers,
    toes: Sequence[str],
    lands: Sequence[str],
    leads: Sequence[int],
    *,
    grips: bool = False,
) -> tuple[Array, Array, dict[str, Any]]:
    """Returns an impact's change of velocity, (nv,), its derivatives, (nv, c), and the values held for lifted toes.

    Args:
        feet: numbers of the toes that take part, and of brakes that grip.
        slopes: derivatives of these numbers.
        toes: names of these toes.
        lands: names of the toes that land.
        leads: of each toe, the first of these toes on its body.
        grips: whether brakes grip.

    Raises:
        NotDifferentiable: a toe that lands rises again, as at the end of bounces, or the smallest perturbation may
            change the set of sticking, sliding and lifted toes.
    """
    approach = feet.speeds[1::2] - (feet.rows[:, 1] @ feet.braked if grips else 0.0)  # before brakes grip
    if any(rises(float(speed)) for toe, speed in zip(toes, approach, strict=True) if toe in lands):
        raise NotDifferentiable("a toe rises as it lands, as at the end of bounces")
    A = [duals(row, d) for row, d in zip(feet.inverse_inertia, slopes.inverse_inertia, strict=True)]
    before, friction = duals(feet.speeds, slopes.speeds), Dual(float(feet.friction), slopes.friction)
    speeds: Sequence[Any] = [0.0] * len(toes)
    impulses: Sequence[Any] = [0.0] * len(before)
    still = np.abs(feet.speeds).max(initial=0.0) < DEGENERATE and np.abs(slopes.speeds).max(initial=0.0) < UNMOVED
    if len(toes) == 1 and not grips:
        impulses, _ = routh(A, before, friction)
    elif not still:
        impulses, speeds = _joint(feet, A, before, friction, leads)
    lifted = {rise(toe): speed for toe, speed in zip(toes, speeds, strict=True)}
    given, change = np.array([value_of(each) for each in impulses]), derivatives(impulses, len(slopes.friction))
    moved, turned = _moved(feet, slopes, given, change)
    return feet.braked + moved, slopes.braked + turned, lifted


@dataclass(frozen=True)
class Pushed:
    """Impulses on m toes in space, and what follows from them.

    Attributes:
        v: change of the velocity, (nv,).
        dv: its derivatives, (nv, c).
        impulse: impulses, in N·s, with their derivatives, (m, 3, 1 + c).
        held: values held for the toes.
    """

    v: Array
    dv: Array
    impulse: Array
    held: dict[str, Any]


def differentiate_strike_in_space(
    feet: ToeNumbers,
    slopes: ToeNumbers,
    toes: Sequence[str],
    lands: Collection[str],
    falls: Collection[str],
    before: Array | None,
) -> Pushed:
    """Differentiates an impact in space, for the outcome that the rule finds.

    Let T be all impulses of an impact on a toe, and w its velocity afterwards. A toe that sticks has w = 0, one that
    leaves T = 0, and one that slides along d has w_z = 0 and T_t = -μ T_z d. These equations are differentiated.

    Args:
        feet: numbers of the toes that take part.
        slopes: derivatives of these numbers.
        toes: names of these toes.
        lands: names of the toes that land.
        falls: names of other toes that were in the air and are struck in the same instant.
        before: impulses that the toes have received in impacts that are not over, with their derivatives,
            (m, 3, 1 + c); None if the impact is separate by its law.

    Raises:
        NotDifferentiable: a toe that lands rises again, toes depend on each other, the smallest perturbation may change
            the outcome, or a toe slides in a separate impact.
    """
    m, c, A, u, mu = len(toes), len(slopes.friction), feet.inverse_inertia, feet.speeds, float(feet.friction)
    if any(rises(float(speed)) for toe, speed in zip(toes, u[2::3], strict=True) if toe in lands):
        raise NotDifferentiable("a toe rises as it lands, as at the end of bounces")
    if not np.linalg.cond(A) < SINGULAR:
        raise NotDifferentiable("toes in an impact cannot move independently, so their impulses are not unique")
    total, modes, earlier = find_impulses(A, u, mu, None if before is None else before[..., 0])
    counted = before is not None and (earlier == before[..., 0]).all()  # else the impact obeys the law alone
    dearlier = before[..., 1:] if before is not None and counted else np.zeros((m, 3, c))
    impulse = total - earlier
    after = (u + A @ impulse.ravel()).reshape(-1, 3)
    if before is None and "slip" in modes:
        raise NotDifferentiable("a toe slides in an impact by Keller's law; use the law of Moreau")
    _check_modes(modes, after, total, mu)
    # w = u + A (T - E), so dw = given + A dT
    given = slopes.speeds + np.einsum("ijc,j->ic", slopes.inverse_inertia, impulse.ravel())
    given = (given - A @ dearlier.reshape(3 * m, c)).reshape(m, 3, c)
    matrix, right = np.zeros((m, 3, 3 * m)), np.zeros((m, 3, c))
    for i, mode in enumerate(modes):
        own, rows = np.eye(3 * m)[3 * i : 3 * i + 3], A[3 * i : 3 * i + 3]
        if mode == "open":
            matrix[i] = own
            continue
        matrix[i], right[i] = rows, -given[i]
        if mode == "slip":
            speed = np.hypot(*after[i, :2])
            d = after[i, :2] / speed
            turning = mu * total[i, 2] * (np.eye(2) - np.outer(d, d)) / speed
            matrix[i, :2] = own[:2] + mu * np.outer(d, own[2]) + turning @ rows[:2]
            right[i, :2] = -turning @ given[i, :2] - np.outer(d, slopes.friction) * total[i, 2]
    dtotal = np.linalg.solve(matrix.reshape(3 * m, 3 * m), right.reshape(3 * m, c)).reshape(m, 3, c)
    dimpulse = dtotal - dearlier
    rising = given + (A @ dtotal.reshape(3 * m, c)).reshape(m, 3, c)
    held: dict[str, Any] = {}
    for i, (toe, mode) in enumerate(zip(toes, modes, strict=True)):
        held[rise(toe)] = Dual(float(after[i, 2]), rising[i, 2]) if mode == "open" else 0.0
    held |= {told(toe): float(toe in falls) for toe in toes}
    v, dv = _moved(feet, slopes, impulse.ravel(), dimpulse.reshape(3 * m, c))
    return Pushed(v, dv, np.concatenate([impulse[..., None], dimpulse], axis=2), held)


def differentiate_stop(feet: ToeNumbers, slopes: ToeNumbers, rows: Sequence[int]) -> tuple[Array, Array]:
    """Differentiates the end of sliding: returns the change of velocity, (nv,), and its derivatives, (nv, c).

    Args:
        feet: numbers of the toes on the ground.
        slopes: derivatives of these numbers.
        rows: which of the toes' velocities vanish.

    Raises:
        NotDifferentiable: these velocities depend on each other.
    """
    A = feet.inverse_inertia[np.ix_(rows, rows)]
    if not np.linalg.cond(A) < SINGULAR:
        raise NotDifferentiable("toes that stop cannot move independently, so their impulses are not unique")
    impulse, change = np.zeros(len(feet.speeds)), np.zeros(slopes.speeds.shape)
    impulse[rows] = -np.linalg.solve(A, feet.speeds[rows])
    turned = np.einsum("ijc,j->ic", slopes.inverse_inertia, impulse)
    change[rows] = -np.linalg.solve(A, slopes.speeds[rows] + turned[rows])
    return _moved(feet, slopes, impulse, change)


def _moved(feet: ToeNumbers, slopes: ToeNumbers, impulse: Array, change: Array) -> tuple[Array, Array]:
    """Returns the change of velocity by impulses, (n,), and its derivatives by those of the impulses, (n, c)."""
    responses, turned = (each.reshape(len(impulse), *each.shape[2:]) for each in (feet.responses, slopes.responses))
    return impulse @ responses, responses.T @ change + np.einsum("i,ivc->vc", impulse, turned)


def _check_modes(modes: Sequence[str], after: Array, total: Array, friction: float) -> None:
    """Checks that toes keep their modes, "open", "stick" or "slip", if an impact changes a little.

    Args:
        modes: mode of each toe, "rest" among them where an impact is of `moreau`.
        after: velocities of the toes after the impact, along the ground and normal to it, (m, 2) or (m, 3).
        total: impulses on the toes, of the same shape.
        friction: coefficient of friction.
    """
    speed, push = np.abs(after).max() + DEGENERATE, np.abs(total).max() + 1e-300
    for mode, (*along, up), (*pushed, normal) in zip(modes, after.tolist(), total.tolist(), strict=True):
        if mode == "open":
            margin = up / speed
        elif mode == "rest":  # more or fewer of the last bounces change nothing
            continue
        elif mode == "slip":
            margin = min(normal / push, math.hypot(*along) / speed)
        else:
            margin = min(normal, friction * normal - math.hypot(*pushed)) / push
        if margin < DEGENERATE:
            raise NotDifferentiable(BORDER)


def _joint(
    feet: ToeNumbers, A: list[list[Any]], before: list[Any], friction: Any, leads: Sequence[int]
) -> tuple[list[Any], list[Any]]:
    """Returns the impulses of a joint impact, and the lift speeds of toes, for the active set that the rule finds."""
    size, values, mu = len(before), feet.inverse_inertia, float(feet.friction)
    given = np.array([value_of(speed) for speed in before])
    guided = np.diag(values)[::2] <= np.trace(values) / SINGULAR  # toes that move up and down only
    # toes of one body move along alike
    free = [row for row in range(size) if row % 2 or (leads[row // 2] == row // 2 and not guided[row // 2])]
    if not np.linalg.cond(values[np.ix_(free, free)]) < SINGULAR:
        raise NotDifferentiable("toes in an impact cannot move independently, so their impulses are not unique")
    if np.abs(given).max() < DEGENERATE:  # in m/s: the toes only touch, and rounding decides the rest
        raise NotDifferentiable(BORDER)
    impulse, modes = moreau(values, given, mu, leads)
    after = given + values @ impulse
    _check_modes(modes, after.reshape(-1, 2), impulse.reshape(-1, 2), mu)
    rows: list[int] = []
    directions: list[list[Any]] = []
    for i, mode in enumerate(modes):
        unit = [[1.0 if k == j else 0.0 for k in range(size)] for j in (2 * i, 2 * i + 1)]
        if mode == "slip":
            grip = -friction if after[2 * i] > 0.0 else friction
            rows.append(2 * i + 1)
            directions.append([z + grip * x if x else z for x, z in zip(*unit, strict=True)])
        elif mode == "stick":
            first = 1 if guided[i] or (leads[i] < i and modes[leads[i]] == "stick") else 0
            rows += [2 * i, 2 * i + 1][first:]
            directions += unit[first:]
    matrix = [[dot(A[row], direction) for direction in directions] for row in rows]
    pushes = solve(matrix, [-before[row] for row in rows])
    impulses = [dot([direction[k] for direction in directions], pushes) for k in range(size)]
    if "rest" in modes:
        held = find_held_rows(modes, leads)
        left = [before[k] + dot(A[k], impulses) for k in held]
        stopping = solve([[A[k][j] for j in held] for k in held], [-speed for speed in left])
        for k, push in zip(held, stopping, strict=True):
            impulses[k] = impulses[k] + push
    speeds = [before[k] + dot(A[k], impulses) if modes[k // 2] == "open" else 0.0 for k in range(1, size, 2)]
    return impulses, speeds
