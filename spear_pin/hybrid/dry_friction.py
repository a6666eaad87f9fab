"""Dry friction in joints, after Coulomb, event by event.

A constant force opposes a moving joint. Where its rate falls to zero the forces decide whether the joint moves on,
turns or is held. Friction holds it, as a constraint, until more than Coulomb's force is needed. Every domain of a
system thus becomes three, or nine with two joints. After each event, including impacts, the one that fits is chosen.

A law that uses forces, such as one that limits them, ignores dry friction. A torque that jumped where a joint comes to
rest might be consistent with none of the three.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from spear_pin.errors import BadValue, list_names, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import SLIPS
from spear_pin.hybrid.domain import Domain, Rub
from spear_pin.hybrid.parameters import change_system
from spear_pin.hybrid.rules.footing import Bound, closed_toes
from spear_pin.hybrid.rules.guards import rubbing_guards
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import lever_along

SIGNS = (0.0, 1.0, -1.0)  # a joint at rest is held if possible


def with_dry_friction(system: HybridSystem, forces: Mapping[str, float]) -> HybridSystem:
    """Returns the system with additional dry friction in some joints; rebuilt systems keep it.

    A domain in which the joint moves keeps its name; a domain in which it is held names it, as in "flight boom_z held".
    A gait with dry friction cannot be saved.

    Args:
        system: the system.
        forces: Coulomb's force on each joint, in N, or torque in N·m; the same at rest and in motion.

    Raises:
        UnknownName: the robot has no such joint, or it is locked.
        BadValue: a force is not a finite number >= 0, the joint has dry friction already, or more joints would have
            dry friction than can move freely in stance.
    """
    return change_system(system, DryFriction(dict(forces)))


@dataclass(frozen=True)
class DryFriction:
    """The change of a system that adds dry friction.

    Attributes:
        forces: Coulomb's force on each joint, in N, or torque in N·m.
    """

    forces: Mapping[str, float]

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with dry friction added."""
        forces = self.forces
        for joint, force in forces.items():
            system.robot.index(joint)
            if joint not in system.robot.independent:
                raise BadValue(
                    "forces", dict(forces), f"joints that loops do not tie, or {list_names(system.robot.independent)}"
                )
            require(f"dry friction of {joint}", force, lambda value: value >= 0, "a number >= 0, in N or N·m")
            if any(rub.joint == joint for domain in system.domains for rub in domain.rubs):
                raise BadValue("forces", dict(forces), f"joints without dry friction, which {joint} has already")
        rubbing = len(forces) + max((len(domain.rubs) for domain in system.domains), default=0)
        free = min(count_free(domain, system.robot) for domain in system.domains)
        if rubbing > free:
            joints = f"at most {free} joint{'s' * (free != 1)}, as many as move freely with toes on the ground"
            raise BadValue("forces", dict(forces), f"{joints}: with more, friction is not unique")
        rubs = [Rub(joint, float(force), 0.0) for joint, force in forces.items()]
        domains = (mode for domain in system.domains for mode in modes_of(domain, system.robot, rubs))
        return replace(system, domains=tuple(domains))


def has_dry_friction(system: HybridSystem) -> bool:
    """Tells whether joints have dry friction, other than that of brakes."""
    return any(rub.joint not in system.brakes for domain in system.domains for rub in domain.rubs)


def modes_of(domain: Domain, robot: Robot, held: Sequence[Rub]) -> list[Domain]:
    """Returns the domain's variants with each joint or path held, moving forward and moving backward."""
    modes = []
    for signs in product(SIGNS, repeat=len(held)):
        rubs = tuple(replace(rub, sign=sign) for rub, sign in zip(held, signs, strict=True))
        names = [domain.name, *(f"{rub.joint} held" for rub in rubs if rub.sign == 0)]
        ends = (guard for rub in rubs for guard in rubbing_guards(rub, lever_along(rub.along, robot)))
        # other events at the same instant, such as the apex, come first
        guards = (*domain.guards, *ends)
        modes.append(replace(domain, name=" ".join(names), rubs=(*domain.rubs, *rubs), guards=guards))
    return modes


def count_free(domain: Domain, robot: Robot) -> int:
    """Returns how many joints move freely in a domain with its contacts, in the plane or in space."""
    closed = closed_toes(robot.toes, domain)
    first = Bound(robot).first([toe for toe, _ in closed])
    rows = (1 if mode in SLIPS else robot.dimension - row for (_, mode), row in zip(closed, first, strict=True))
    return len(robot.independent) - sum(rows)
