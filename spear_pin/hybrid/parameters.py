"""Systems made of others: with other numbers, by the names of law, springs and ground, or changed as a whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import REPLACED, HybridSystem
from spear_pin.hybrid.hardware import Hardware
from spear_pin.kinds import typed

PARTS = ("law", "spring", "contact")
Change = Callable[[HybridSystem], HybridSystem]
LIMITS = ("phase_limit", "shortest_flight", "overlap")


def with_parameters(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """System with other parameters, named as fields of its law, spring or contact; the given one is left alone.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: a value is not valid for its field.
    """
    if not values:
        return system  # as it is, with what may have been replaced in it
    whole, parts = _parts(system), dict[str, Any]()
    for name, value in values.items():
        owner = _owner(system, name)
        parts[owner] = replace(parts.get(owner, whole[owner]), **{name: value})
    return rebuilt(system, **parts)


def rebuilt(system: HybridSystem, **parts: Any) -> HybridSystem:
    """System with another law, spring or contact; what was changed or replaced in the given one stays so.

    Raises:
        BadValue: its domains were replaced, and not by `changed`: nobody knows what they were to be with other numbers.
    """
    kept = replaced(system)
    again = system.build(system.robot, **{part: getattr(system, part) for part in PARTS} | parts)
    return replace(again, **kept) if kept else again  # once made it is checked


def changed(system: HybridSystem, change: Change) -> HybridSystem:
    """A system changed by a function, as are all that are rebuilt from it: by `with_parameters`, searches and sweeps.

    For what the numbers of law, springs and ground do not say, such as a guard more or dry friction.

    Args:
        system: the system.
        change: makes another of a system, with `dataclasses.replace`. To go into a sweep it has to be a dataclass that
            is called: by its name and its fields one sweep is told from another.
    """
    build, after = system.build, change(system)
    before = {name: system.made[name] for name in REPLACED if getattr(system, name) != system.made[name]}

    def build_changed(*parts: Any, **named: Any) -> HybridSystem:
        return changed(build(*parts, **named), change)

    made = {name: before.get(name, getattr(after, name)) for name in REPLACED}
    makers = {"build": build_changed, "builder": system.made["builder"]}
    return replace(after, build=build_changed, changes=(*system.changes, change), made=made | makers)


def replaced(system: HybridSystem) -> dict[str, Any]:
    """Fields of a system that were replaced since it was made, other than by `changed`.

    Raises:
        BadValue: its domains are among them.
    """
    others = {name: getattr(system, name) for name in REPLACED if getattr(system, name) != system.made[name]}
    if "domains" in others:
        names = ", ".join(domain.name for domain in system.domains)
        raise BadValue("domains", names, "those that were built, or made by `changed(system, change)`, not replaced")
    return others


def limits(system: HybridSystem) -> dict[str, Any]:
    """The limits that were set in a system, by name, which `dataclasses.replace` sets in another."""
    return {name: getattr(system, name) for name in LIMITS}


def parameter(system: HybridSystem, name: str) -> float:
    """Value of a parameter named as a field of the law, spring or contact.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: the field has no number in it to begin from.
    """
    value = getattr(_parts(system)[_owner(system, name)], name)
    if value is None:
        raise BadValue(name, value, "a number to begin from: set it first")
    return float(value)


def _parts(system: HybridSystem) -> dict[str, Any]:
    """Law, spring and all that the ground may be."""
    return dict(zip(PARTS, (system.law, system.spring, system.ground), strict=True))


def _owner(system: HybridSystem, name: str) -> str:
    owners = {
        field.name: part
        for part, whole in _parts(system).items()
        for field in fields(whole)
        if not isinstance(getattr(whole, field.name), (bool, str, tuple))
    }
    if name not in owners:
        raise UnknownName("parameter", name, owners)
    return owners[name]


@typed
def with_hardware(system: HybridSystem, hardware: Hardware | None) -> HybridSystem:
    """System with hardware, or without; rebuilt systems keep it.

    Where a robot's legs are pairs, an actuator drives both of a joint: twice the inertia, half the resistance.

    Currents, heat and clock start at zero in every run, those of a return map too: a gait found with such
    hardware is periodic in (q, v) alone, and its multipliers leave the others out.

    Raises:
        BadValue: not as many actuators as the robot has actuated joints.
    """
    if hardware is None and system.hardware is None:
        return system
    return changed(system, Fitted(hardware))


@dataclass(frozen=True)
class Fitted:
    """The change that it makes.

    Attributes:
        hardware: between law and joints; None takes it away.
    """

    hardware: Hardware | None

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """The system with it, or without."""
        count = system.robot.nu if self.hardware is None else len(self.hardware.actuators)
        if count != system.robot.nu:
            raise BadValue("actuators", count, f"{system.robot.nu}, one for each of {system.robot.actuated}")
        return replace(system, hardware=self.hardware)
