"""Impacts of an automaton's events: which toes take part, and what the impact does to the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import Domain, HybridSystem, Reset
from spear_pin.hybrid.contact import OPEN, Impact, JointImpact, joint_impact, landed, plastic_impact
from spear_pin.hybrid.phases import rise

Array = NDArray[np.float64]


class Strike(NamedTuple):
    """Effect of an impact.

    Attributes:
        v: velocity afterwards, (nv,).
        impulse: on each toe of the robot, (ntoes, 2), in N·s.
        work: done on the mechanism, in J, never positive.
        rises: speeds at which toes are lifted off by an impact of several, in m/s, by name in `held`.
    """

    v: Array
    impulse: Array
    work: float
    rises: Mapping[str, float]


def struck_toes(system: HybridSystem, domain: Domain, reset: Reset) -> list[str]:
    """The toes that take part in an impact: those that strike, and those on the ground before and after it.

    One that alternates is on the ground.
    """
    if not reset.impact:
        return []
    entered = system.of_phase(reset.phase or domain.phase)[0]
    stay = {
        toe
        for toe, before, after in zip(system.robot.toes, domain.contacts, entered.contacts, strict=True)
        if (before != OPEN and after != OPEN) or toe in domain.alternating
    }
    return [toe for toe in system.robot.toes if toe in stay or toe in reset.impact]


def struck_by(system: HybridSystem, struck: Sequence[str], reset: Reset, q: Array, v: Array) -> Strike:
    """Effect of the impact in which some toes take part, by `contact.plastic_impact` or `contact.joint_impact`.

    Args:
        system: the system.
        struck: the toes, as of `struck_toes`.
        reset: of the event.
        q: configuration.
        v: velocity before.
    """
    robot, before = system.robot, v
    mass_matrix = robot.mass_matrix(q)
    jacobian = np.concatenate([robot.toe_jacobian(q, toe) for toe in struck])
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
