"""The leg as a log drives it: measured torques in place of the law, dry friction of joints and springs, springs fixed.

A law of its own does all this, with the numbers that a fit may vary. Friction of a joint is Coulomb's, and so is the
hysteresis of a spring, half the distance of its two branches: c tanh(v / w), with a rate w that is slow for a hop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass, replace
from functools import lru_cache
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Held, Law
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.model.robot import Robot
from spear_pin.studies.logs.phases import FLIGHT, STANCE

SLOW = {"rad": 0.05, "m": 0.01}  # rad/s, m/s: the rate w, far below those of a hop
SCALE, FRICTION, HYSTERESIS, SHIFT, TORQUE = "torque_scale", "_friction", "_hysteresis", "_shift", "_torque"


@lru_cache
def numbers_type(joints: Sequence[str], springs: Sequence[str], motors: Sequence[str], units: Sequence[str]) -> type:
    """Returns the dataclass of the numbers of a played leg.

    They are `torque_scale`, by which measured torques are multiplied; Coulomb's friction of each joint, such as
    "crank_friction"; the hysteresis and the shift of the rest of each spring; and the torque of each motor.

    Args:
        joints: names of all joints.
        springs: names of the springs.
        motors: names of the joints with a motor.
        units: units of the joints.
    """
    named = {f"{joint}{FRICTION}": "N·m" if unit == "rad" else "N" for joint, unit in zip(joints, units, strict=True)}
    named |= {f"{spring}{HYSTERESIS}": "" for spring in springs} | {f"{spring}{SHIFT}": "" for spring in springs}
    torques = {f"{motor}{TORQUE}": "N·m" for motor in motors}
    fields = [(SCALE, float, 1.0), *((name, float, 0.0) for name in {**named, **torques})]
    kind = make_dataclass("Played", fields, frozen=True, namespace={"units": {SCALE: "1", **named, **torques}})
    kind.__doc__ = "Numbers of a leg that a log drives."
    return kind


@dataclass(frozen=True)
class Playing:
    """The law of a played leg: forces on all of its joints.

    Attributes:
        joints: names of all joints.
        units: their units.
        motors: names of the joints with a motor.
        springs: names of the springs that act.
        one_way: those of them that only pull.
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    motors: tuple[str, ...]
    springs: tuple[str, ...]
    one_way: tuple[str, ...]

    def __call__(
        self, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Operations
    ) -> Sequence[Any]:
        """Returns the force on each joint besides those of the equations of motion, in N·m or N."""
        rates = zip(self.joints, v, self.units, strict=True)
        forces = [-getattr(p, f"{name}{FRICTION}") * ops.tanh(rate / SLOW[unit]) for name, rate, unit in rates]
        for motor in self.motors:
            i = self.joints.index(motor)
            forces[i] = forces[i] + getattr(p, SCALE) * getattr(p, f"{motor}{TORQUE}")
        for name in self.springs:
            pull = dyn.pull(name)
            stretch = pull.stretch - getattr(p, f"{name}{SHIFT}")
            stretch = ops.maximum(stretch, 0.0) if name in self.one_way else stretch
            drag = getattr(p, f"{name}{HYSTERESIS}") * ops.tanh(pull.rate / SLOW["rad" if pull.spring.turns else "m"])
            # the spring of the equations acts both ways, and from where it rests in the file: it is replaced
            change = pull.spring.torque(stretch, ops) - pull.spring.torque(pull.stretch, ops) - drag
            for i, lever in pull.slope.items():
                forces[i] = forces[i] + change * lever
        return forces


def played(system: HybridSystem) -> HybridSystem:
    """Returns a system of two domains, stance and flight, that measured torques drive.

    Its robot has a motor on every joint, for friction. Its numbers are those of the system's robot, springs and ground,
    and those of `numbers_type`.

    Args:
        system: a system of a planar robot with one toe, whose switches are ideal.

    Raises:
        BadValue: the system has several toes, a switch that is not ideal, or hardware.
    """
    robot = system.robot
    if not robot.planar or len(robot.toes) != 1 or system.hardware is not None:
        raise BadValue("system", system.kind, "a planar robot with one toe and without hardware")
    if unusual := [name for name, spring in system.springs.items() if spring.clutch is not None]:
        raise BadValue(f"clutch of the spring {unusual[0]}", system.springs[unusual[0]].clutch, "None: an ideal switch")
    motors, names = robot.actuated, tuple(_names(system))
    kind = numbers_type(robot.coordinates, names, motors, robot.units)
    return _built(system, robot, motors, kind(), system.springs)


def _built(system: HybridSystem, robot: Robot, motors: tuple[str, ...], law: Any, springs: Any) -> HybridSystem:
    own = robot.with_model(robot.model, actuated=motors, base=robot.base, varied=robot.varied)
    given = system.build(own, law=system.law, spring=springs if system.sprung else next(iter(springs.values()), None), contact=system.contact)
    full = own.with_model(own.model, actuated=own.coordinates, base=own.base, varied=own.varied)

    def build(robot: Robot, law: Any, spring: Any, contact: Any) -> HybridSystem:
        return _built(system, robot, motors, law, spring)

    domains = tuple(_domain(given, name, motors) for name in (STANCE, FLIGHT))
    return HybridSystem("played", full, law, given.springs, given.contact, domains, "", (), build, given.guess, sprung=True)


def _domain(system: HybridSystem, name: str, motors: tuple[str, ...]) -> Domain:
    """Returns the domain of stance or flight with the law of a played leg; its events are left out."""
    robot = system.robot
    own = next(each for each in system.domains if (each.contacts[0] == OPEN) == (name == FLIGHT))
    one_way = tuple(mount.name for mount in own.mounts if system.springs[mount.of or next(iter(system.springs))].unilateral)
    mounts = tuple(replace(mount, taut=None) for mount in own.mounts)
    law: Law = Playing(robot.coordinates, robot.units, motors, tuple(m.name for m in mounts), one_way)
    return replace(own, name=name, phase=name, law=law, mounts=mounts, guards=(), switch=None)


def _names(system: HybridSystem) -> list[str]:
    """Returns the names of all springs that act in stance or flight."""
    return [*dict.fromkeys(mount.name for domain in system.domains for mount in domain.mounts)]

