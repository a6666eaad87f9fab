"""Impacts of events on a robot's state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import Impact, JointImpact, joint_impact, landed, plastic_impact

Array = NDArray[np.float64]


class Strike(NamedTuple):
    """Effect of an impact.

    Attributes:
        v: velocity afterwards, (nv,).
        impulse: on each toe of the robot, along the ground and normal to it, (ntoes, 2), in N·s.
        work: done on the mechanism, in J, never positive.
        rises: speeds at which toes are lifted off by an impact of several, in m/s, by name in `held`.
    """

    v: Array
    impulse: Array
    work: float
    rises: Mapping[str, float]


def struck_by(system: HybridSystem, struck: Sequence[str], reset: Reset, q: Array, v: Array) -> Strike:
    """Effect of the impact in which some toes take part, by `plastic_impact` or `joint_impact`.

    Args:
        system: the system.
        struck: the toes, as of `rules.impact.struck_toes`.
        reset: of the event.
        q: configuration.
        v: velocity before.
    """
    robot, before = system.robot, v
    mass_matrix = robot.mass_matrix(q)
    jacobian = np.concatenate([system.ground.foot(robot, q, toe)[1] for toe in struck])
    toes = [robot.toes.index(toe) for toe in struck]
    impulse = np.zeros((len(robot.toes), 2))
    v, impulse[toes, 1] = landed(mass_matrix, jacobian, v, [toe in reset.impact for toe in struck])
    strike = plastic_impact if len(struck) == 1 else joint_impact
    impact: Impact | JointImpact = strike(mass_matrix, jacobian, v, system.contact.friction)
    work = 0.5 * float(impulse[toes, 1] @ (jacobian @ (before + v))[1::2]) - impact.loss
    impulse[toes] += impact.impulse
    rises = {}
    if isinstance(impact, JointImpact):
        speeds = np.where(impact.leaves, (jacobian @ impact.v)[1::2], 0.0).tolist()
        rises = dict(zip(map(rise, struck), speeds, strict=True))
    return Strike(impact.v, impulse, work, rises)
