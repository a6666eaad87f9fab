"""Applies impacts to many lanes at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.lanes.groups import Group, stack_matrices
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.per_lane import apply_matrices, null_spaces
from spear_pin.hybrid.rules.footing import along
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import joint_impact, rises, routh
from spear_pin.model.feet import find_leading
from spear_pin.model.robot_posture import row_along


def strike(numbers: Numbers, toes: list[str], reset: Reset, group: Group) -> tuple[Group, Group]:
    """Applies an impact on some toes, and of brakes, to lanes; returns them with the lanes that it leaves unchanged.

    A lane is left unchanged where a toe that lands rises before the impact, unless a brake grips in it.

    Args:
        numbers: numbers of the lanes.
        toes: toes that take part in the impact.
        reset: reset of the event.
        group: the lanes.
    """
    q, v = group.y[: numbers.nv], group.y[numbers.nv :]
    n, terms = len(group), numbers.mechanism.terms(list(q), list(v), np)
    ground = numbers.ground(group.lanes)
    D, jacobians = stack_matrices(terms.mass_matrix, n), ground.seen(terms, np).jacobians
    J = np.concatenate([np.empty((n, 0, len(v))), *(stack_matrices(jacobians[toe], n) for toe in toes)], axis=1)
    lands = () if reset.grips else reset.impact
    rising = np.any([np.zeros(n, bool), *(rises(along(jacobians[toe][1], v)) for toe in lands)], axis=0)
    if rising.any():
        landing, risen = group.take(~rising), group.take(rising)
        return strike(numbers, toes, reset, landing)[0] if len(landing) else landing, risen
    friction, held, v = ground.friction, group.held, v.T
    rows = [*terms.loop_rows, *(row_along(path, numbers.system.robot).tolist() for path in reset.grips)]
    basis = null_spaces(stack_matrices(rows, n)) if rows else None
    if basis is not None:  # as `strikes.make_yielding`
        along_it = np.swapaxes(basis, 1, 2)
        own = along_it @ D @ basis
        v = _solved(own, apply_matrices(along_it @ D, v)) if reset.grips else apply_matrices(along_it, v)
        D, J = own, J @ basis
    if reset.grips and toes:
        v = _landed(D, J[:, 1::2], v)
    if not toes:
        after = v
    elif len(toes) > 1:
        each = zip(D, J, v, np.broadcast_to(friction, n), strict=True)
        leads = find_leading(numbers.system.robot.feet, toes)
        impacts = [joint_impact(*values[:3], float(values[3]), leads) for values in each]
        speeds = np.array([(J[i] @ impact.v)[1::2] * impact.leaves for i, impact in enumerate(impacts)])
        held = {**held, **{rise(toe): speeds[:, i] for i, toe in enumerate(toes)}}
        after = np.array([impact.v for impact in impacts])
    else:
        response = np.linalg.solve(D, J.transpose(0, 2, 1))
        before = (J @ v[:, :, None])[:, :, 0].T
        impulse, _ = routh((J @ response).transpose(1, 2, 0), before, friction)
        after = v + (response @ np.transpose(impulse)[:, :, None])[:, :, 0]
    after = after if basis is None else apply_matrices(basis, after)
    return replace(group, y=np.concatenate([q, after.T]), held=held), group.take(rising)


def _landed(D: Array, normal: Array, v: Array) -> Array:
    """Returns velocities, (n, nv), with toes stopped that rise, as `rules.impact.land_toes` does."""
    rising = np.maximum(apply_matrices(normal, v), 0.0)
    response = np.linalg.solve(D, normal.transpose(0, 2, 1))
    landed = v - apply_matrices(response, _solved(normal @ response, rising))
    return np.where(rises(rising).any(axis=1)[:, None], landed, v)


def _solved(matrices: Array, vectors: Array) -> Array:
    """Solves a system of linear equations in each lane, (n, m)."""
    return np.asarray(np.linalg.solve(matrices, vectors[:, :, None])[:, :, 0])
