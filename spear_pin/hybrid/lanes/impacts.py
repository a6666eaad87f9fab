"""Applies impacts to many lanes at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spear_pin.hybrid.lanes.groups import Group, stack_matrices
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.per_lane import apply_matrices, null_spaces
from spear_pin.hybrid.rules.footing import along
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import joint_impact, rises, routh
from spear_pin.model.feet import find_leading


def strike(numbers: Numbers, toes: list[str], lands: tuple[str, ...], group: Group) -> tuple[Group, Group]:
    """Applies an impact on some toes to lanes, and returns them with the lanes that it leaves unchanged.

    A lane is left unchanged where a toe that lands would rise after the impact.

    Args:
        numbers: numbers of the lanes.
        toes: toes that take part in the impact.
        lands: toes among them that land.
        group: the lanes.
    """
    q, v = group.y[: numbers.nv], group.y[numbers.nv :]
    n, terms = len(group), numbers.mechanism.terms(list(q), list(v), np)
    ground = numbers.ground(group.lanes)
    D, jacobians = stack_matrices(terms.mass_matrix, n), ground.seen(terms, np).jacobians
    J = np.concatenate([stack_matrices(jacobians[toe], n) for toe in toes], axis=1)
    rising = np.any([rises(along(jacobians[toe][1], v)) for toe in lands], axis=0) & np.ones(n, bool)
    if rising.any():
        landing, risen = group.take(~rising), group.take(rising)
        return strike(numbers, toes, lands, landing)[0] if len(landing) else landing, risen
    friction, held, v = ground.friction, group.held, v.T
    basis = null_spaces(stack_matrices(terms.loop_rows, n)) if terms.loop_rows else None
    if basis is not None:  # as `strikes.yielding`
        along_it = np.swapaxes(basis, 1, 2)
        D, J, v = along_it @ D @ basis, J @ basis, apply_matrices(along_it, v)
    if len(toes) > 1:
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
