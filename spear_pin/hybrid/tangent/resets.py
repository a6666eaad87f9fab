"""Derivatives of an event's effects: dual numbers pass through the rules of impacts and latches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.hybrid.elimination import solve
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import joint_impact, rises, routh
from spear_pin.hybrid.tangent.dual import Dual, derivatives, duals, value_of
from spear_pin.hybrid.tangent.fields import ToeNumbers
from spear_pin.model.scalars import dot

DEGENERATE = 1e-9  # relative to the largest speed or impulse: an active set this close to another is degenerate
BORDER = "an impact of several toes is on the border between two outcomes"
SINGULAR = 1e12  # condition number of J D⁻¹ Jᵀ above which toes depend on each other


class NotDifferentiable(SpearError):
    """Raised when a cycle has no derivative, or none that can be computed here; the text says why."""


def struck(
    feet: ToeNumbers, slopes: ToeNumbers, toes: Sequence[str], lands: Sequence[str]
) -> tuple[Array, Array, dict[str, Any]]:
    """Returns an impact's change of velocity, (nv,), its derivatives, (nv, c), and the values held for lifted toes.

    Args:
        feet: numbers of the toes that take part.
        slopes: derivatives of these numbers.
        toes: names of these toes.
        lands: names of the toes that land.

    Raises:
        NotDifferentiable: a toe that lands rises again, as at the end of bounces, or the smallest perturbation may
            change the set of sticking, sliding and lifted toes.
    """
    size, lifted = 2 * len(toes), dict[str, Any]()
    if any(rises(float(speed)) for toe, speed in zip(toes, feet.speeds[1::2], strict=True) if toe in lands):
        raise NotDifferentiable("a toe rises as it lands, as at the end of bounces")
    A = [duals(row, d) for row, d in zip(feet.inverse_inertia, slopes.inverse_inertia, strict=True)]
    before, friction = duals(feet.speeds, slopes.speeds), Dual(float(feet.friction), slopes.friction)
    impulses: Sequence[Any]
    if len(toes) == 1:
        impulses, _ = routh(A, before, friction)
    else:
        impulses, speeds = _joint(feet, A, before, friction)
        lifted = {rise(toe): speed for toe, speed in zip(toes, speeds, strict=True)}
    responses, turned = (each.reshape(size, *each.shape[2:]) for each in (feet.responses, slopes.responses))
    given, change = np.array([value_of(each) for each in impulses]), derivatives(impulses, len(slopes.friction))
    of_responses = (given @ turned.reshape(size, -1)).reshape(turned.shape[1:])
    return given @ responses, responses.T @ change + of_responses, lifted


def _joint(feet: ToeNumbers, A: list[list[Any]], before: list[Any], friction: Any) -> tuple[list[Any], list[Any]]:
    """Returns the impulses of a joint impact, and the lift speeds of toes, for the active set that the rule finds."""
    size, values, mu = len(feet.speeds), feet.inverse_inertia, float(feet.friction)
    if not np.linalg.cond(values) < SINGULAR:
        raise NotDifferentiable("toes in an impact cannot move independently, so their impulses are not unique")
    if np.abs(feet.speeds).max() < DEGENERATE:  # in m/s: the toes only touch, and rounding decides the rest
        raise NotDifferentiable(BORDER)
    # in the coordinates of the toes' own velocities the rule needs the inverse of A as the mass matrix
    impact = joint_impact(np.asarray(np.linalg.inv(values), dtype=np.float64), np.eye(size), feet.speeds, mu)
    after, given = impact.v, impact.impulse.ravel()
    _check_set(impact.slides, impact.leaves, after, given, mu)
    rows: list[int] = []
    directions: list[list[Any]] = []
    for i, (slides, leaves) in enumerate(zip(impact.slides, impact.leaves, strict=True)):
        unit = [[1.0 if k == j else 0.0 for k in range(size)] for j in (2 * i, 2 * i + 1)]
        if slides:
            grip = -friction if after[2 * i] > 0.0 else friction
            rows.append(2 * i + 1)
            directions.append([z + grip * x if x else z for x, z in zip(*unit, strict=True)])
        elif not leaves:
            rows += [2 * i, 2 * i + 1]
            directions += unit
    matrix = [[dot(A[row], direction) for direction in directions] for row in rows]
    found = solve(matrix, [-before[row] for row in rows])
    impulses = [dot([direction[k] for direction in directions], found) for k in range(size)]
    speeds = [before[k] + dot(A[k], impulses) if impact.leaves[k // 2] else 0.0 for k in range(1, size, 2)]
    return impulses, speeds


def _check_set(slides: Any, leaves: Any, after: Array, impulse: Array, friction: float) -> None:
    speed, push = np.abs(after).max() + DEGENERATE, np.abs(impulse).max() + 1e-300
    for i, (slide, leave) in enumerate(zip(slides, leaves, strict=True)):
        along, up = impulse[2 * i : 2 * i + 2]
        margin = after[2 * i + 1] / speed if leave else up / push
        if slide:
            margin = min(margin, abs(after[2 * i]) / speed)
        elif not leave:
            margin = min(margin, (friction * up - abs(along)) / push)
        if margin < DEGENERATE:
            raise NotDifferentiable(BORDER)


def flat(held: Mapping[str, Any]) -> list[Any]:
    """Returns the held values as numbers in the order of run-time parameters."""
    return [item for value in held.values() for item in _items(value)]


def _items(value: Any) -> list[Any]:
    return [item for each in value for item in _items(each)] if isinstance(value, tuple) else [value]
