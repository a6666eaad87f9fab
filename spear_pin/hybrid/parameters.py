"""A system's numbers by their names: fields of its law, springs and ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import HybridSystem

PARTS = ("law", "spring", "contact")


def with_parameters(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """The same system with other parameters, named as fields of its law, spring or contact.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: a value is not valid for its field.
    """
    if not values:
        return system  # as it is, with what may have been replaced in it
    parts = {part: getattr(system, part) for part in PARTS}
    for name, value in values.items():
        owner = _owner(system, name)
        parts[owner] = replace(parts[owner], **{name: value})
    return rebuilt(system, **parts)


def rebuilt(system: HybridSystem, **parts: Any) -> HybridSystem:
    """The same system with another law, spring or contact, and the limits that were set in it."""
    built = system.build(system.robot, **{part: getattr(system, part) for part in PARTS} | parts)
    return replace(built, phase_limit=system.phase_limit, shortest_flight=system.shortest_flight)


def parameter(system: HybridSystem, name: str) -> float:
    """Value of a parameter named as a field of the law, spring or contact.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: the field has no number in it to begin from.
    """
    value = getattr(getattr(system, _owner(system, name)), name)
    if value is None:
        raise BadValue(name, value, "a number to begin from: set it first")
    return float(value)


def _owner(system: HybridSystem, name: str) -> str:
    owners = {
        field.name: part
        for part in PARTS
        for field in fields(getattr(system, part))
        if not isinstance(getattr(getattr(system, part), field.name), (bool, str, tuple))
    }
    if name not in owners:
        raise UnknownName("parameter", name, owners)
    return owners[name]
