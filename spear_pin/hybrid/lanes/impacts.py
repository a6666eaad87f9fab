"""Applies impacts to many lanes at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

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

    A lane is left unchanged where a toe that lands rises before the impact.

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
    rising = np.any([np.zeros(n, bool), *(rises(along(jacobians[toe][1], v)) for toe in reset.impact)], axis=0)
    if rising.any():
        landing, risen = group.take(~rising), group.take(rising)
        return strike(numbers, toes, reset, landing)[0] if len(landing) else landing, risen
    friction, held, v = ground.friction, group.held, v.T
    rows = [*terms.loop_rows, *(row_along(path, numbers.system.robot).tolist() for path in reset.grips)]
    basis = null_spaces(stack_matrices(rows, n)) if rows else None
    if basis is not None:  # as `strikes.make_yielding`
        along_it = np.swapaxes(basis, 1, 2)
        own = along_it @ D @ basis
        pushed = apply_matrices(along_it @ D, v)[:, :, None]
        v = np.asarray(np.linalg.solve(own, pushed)[:, :, 0]) if reset.grips else apply_matrices(along_it, v)
        D, J = own, J @ basis
    after, speeds = v, np.zeros((n, len(toes)))
    if len(toes) > 1 or (toes and reset.grips):
        each = zip(D, J, v, np.broadcast_to(friction, n), strict=True)
        leads = find_leading(numbers.system.robot.feet, toes)
        impacts = [joint_impact(*values[:3], float(values[3]), leads) for values in each]
        speeds = np.array([(J[i] @ impact.v)[1::2] * impact.leaves for i, impact in enumerate(impacts)])
        after = np.array([impact.v for impact in impacts])
    elif toes:
        response = np.linalg.solve(D, J.transpose(0, 2, 1))
        before = (J @ v[:, :, None])[:, :, 0].T
        impulse, _ = routh((J @ response).transpose(1, 2, 0), before, friction)
        after = v + (response @ np.transpose(impulse)[:, :, None])[:, :, 0]
    if len(toes) > 1 or numbers.system.brakes:
        held = {**held, **{rise(toe): speeds[:, i] for i, toe in enumerate(toes)}}
    after = after if basis is None else apply_matrices(basis, after)
    return replace(group, y=np.concatenate([q, after.T]), held=held), group.take(rising)
