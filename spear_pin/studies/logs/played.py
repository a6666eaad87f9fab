"""The leg as a log drives it: measured torques in place of the law, dry friction of joints and springs, springs fixed.

A law of its own does all this, with the numbers that a fit may vary. Coulomb's friction of a joint and the hysteresis
of a spring are smooth here, c tanh(v / w), with a rate w that is slow for a hop.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, make_dataclass, replace
from functools import lru_cache, partial
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Held, Law, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.phases import touchdown
from spear_pin.hybrid.pull import Pull
from spear_pin.hybrid.springs import spring_of, values_along
from spear_pin.model.robot import Robot
from spear_pin.model.springs import places_of
from spear_pin.studies.logs.measured import FLIGHT, STANCE

SLOW = {"rad": 0.02, "m": 0.004}  # rad/s, m/s: the rate w, far below those of a hop
SLACK = {"rad": 1e-3, "m": 1e-4}  # rad, m: beyond which a spring is taut
SCALE, FRICTION, HYSTERESIS, SHIFT, TORQUE = "torque_scale", "_friction", "_hysteresis", "_shift", "_torque"


@lru_cache
def numbers_type(joints: Sequence[str], springs: Sequence[str], motors: Sequence[str], units: Sequence[str]) -> type:
    """Returns the dataclass of the numbers of a played leg.

    These are `torque_scale`, by which measured torques are multiplied; Coulomb's friction of each joint, such as
    "crank_friction"; of each spring the hysteresis, and by how much longer it rests than its file says,
    "leg_shift"; and the motors' torques.

    Args:
        joints: names of all joints.
        springs: names of the springs.
        motors: names of the joints with a motor.
        units: units of the joints.
    """
    named = {f"{joint}{FRICTION}": "N·m" if unit == "rad" else "N" for joint, unit in zip(joints, units, strict=True)}
    named |= {f"{spring}{what}": "" for spring in springs for what in (HYSTERESIS, SHIFT)}
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
        springs: name of each mount that acts, and of its spring.
        one_way: names of those mounts whose springs only pull.
    """

    joints: tuple[str, ...]
    units: tuple[str, ...]
    motors: tuple[str, ...]
    springs: tuple[tuple[str, str], ...]
    one_way: tuple[str, ...]

    def __call__(self, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        """Returns the force on each joint besides those of the equations of motion, in N·m or N."""
        rates = zip(self.joints, v, self.units, strict=True)
        forces = [-getattr(p, f"{name}{FRICTION}") * ops.tanh(rate / SLOW[unit]) for name, rate, unit in rates]
        for motor in self.motors:
            i = self.joints.index(motor)
            forces[i] = forces[i] + getattr(p, SCALE) * getattr(p, f"{motor}{TORQUE}")
        for mount, spring in self.springs:
            pull = dyn.pull(mount)
            change = self._whole(
                pull, getattr(p, f"{spring}{SHIFT}"), getattr(p, f"{spring}{HYSTERESIS}"), ops
            ) - pull.spring.torque(pull.stretch, ops)
            for i, lever in pull.slope.items():
                forces[i] = forces[i] + change * lever
        return forces

    def _whole(self, pull: Pull, shift: Any, width: Any, ops: Operations) -> Any:
        """Returns the force along a spring's path; the one in the equations acts both ways and has no hysteresis."""
        stretch, pulls = pull.stretch - shift, pull.name in self.one_way
        force = pull.spring.torque(ops.maximum(stretch, 0.0) if pulls else stretch, ops)
        against = width * ops.tanh(pull.rate / SLOW["rad" if pull.spring.turns else "m"])
        if pulls:  # a slack spring has none, and one that is let go does not push
            taut = ops.tanh(ops.maximum(stretch, 0.0) / SLACK["rad" if pull.spring.turns else "m"])
            against = taut * ops.maximum(against, force)
        return force - against


def make_played(system: HybridSystem) -> HybridSystem:
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
    if rubs := {each for domain in system.domains for rub in domain.rubs for each in rub.along.numbers}:
        raise BadValue(
            "dry friction or brake",
            sorted(rubs),
            "a system without: a fit has friction of its own, such as knee_friction",
        )
    if unusual := [name for name, spring in system.springs.items() if spring.clutch is not None]:
        raise BadValue(f"clutch of the spring {unusual[0]}", system.springs[unusual[0]].clutch, "None: an ideal switch")
    kind = numbers_type(robot.coordinates, tuple(system.springs), robot.actuated, robot.units)
    widths = {f"{name}{HYSTERESIS}": spring.hysteresis for name, spring in system.springs.items()}
    plain = {name: replace(spring, hysteresis=0.0) for name, spring in system.springs.items()}
    return _built(system, robot, robot.actuated, kind(**widths), plain)


def find_number(system: HybridSystem, name: str) -> tuple[str, float]:
    """Returns the name that a number has in a played leg, and what is taken off its value there.

    The law has the hysteresis of springs. Where a fixed spring rests is built into the equations: the law has a number
    for how far that is shifted.
    """
    place = places_of(system.springs).get(name)
    if place is not None and place.field == "hysteresis":
        return f"{place.spring}{HYSTERESIS}", 0.0
    if place is not None and place.field == "rest" and system.springs[place.spring].rest is not None:
        return f"{place.spring}{SHIFT}", float(place.value(system.springs[place.spring]))
    return name, 0.0


def _built(system: HybridSystem, robot: Robot, motors: tuple[str, ...], law: Any, springs: Any) -> HybridSystem:
    own = robot.with_model(robot.model, actuated=motors, base=robot.base, varied=robot.varied)
    given = system.build(
        own,
        law=system.law,
        spring=springs if system.sprung else next(iter(springs.values()), None),
        contact=system.contact,
    )
    full = own.with_model(own.model, actuated=own.coordinates, base=own.base, varied=own.varied)

    def build(robot: Robot, law: Any, spring: Any, contact: Any) -> HybridSystem:
        return _built(system, robot, motors, law, spring)

    stance, flight = (_domain(given, name, motors) for name in (STANCE, FLIGHT))
    lands = Reset(impact=robot.toes, latch=partial(latch_rests, robot, stance.mounts), phase=STANCE)
    domains = stance, replace(flight, guards=(touchdown(robot.toes[0], lands),))
    return HybridSystem(
        "played", full, law, given.springs, given.contact, domains, "", (), build, given.guess, sprung=True
    )


def _domain(system: HybridSystem, name: str, motors: tuple[str, ...]) -> Domain:
    """Returns the domain of stance or flight with the law of a played leg; its events are left out."""
    robot = system.robot
    own = next(each for each in system.domains if (each.contacts[0] == OPEN) == (name == FLIGHT))
    springs = tuple((mount.name, spring_of(mount, system)) for mount in own.mounts if mount.spring.pulls)
    one_way = tuple(mount for mount, spring in springs if system.springs[spring].unilateral)
    mounts = tuple(replace(mount, taut=None, way=None) for mount in own.mounts)
    law: Law = Playing(robot.coordinates, robot.units, motors, springs, one_way)
    return replace(own, name=name, phase=name, law=law, mounts=mounts, guards=(), switch=None)


def latch_rests(robot: Robot, mounts: Sequence[Mount], q: Sequence[float], *_: Any) -> Held:
    """Returns where springs rest that touchdown latches."""
    return {mount.rest: values_along(mount.along, robot, q) for mount in mounts if isinstance(mount.rest, str)}


def played_with(leg: HybridSystem, system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns a played leg with other numbers, by the names of `identify_motion`."""
    named = {name: find_number(system, name) for name in values}
    return with_numbers(leg, {named[name][0]: value - named[name][1] for name, value in values.items()})


def with_own(system: HybridSystem, leg: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns the user's system with those fitted values that it has itself."""
    of_law = {*type(leg.law).__dataclass_fields__}
    return with_numbers(system, {name: value for name, value in values.items() if name not in of_law})
