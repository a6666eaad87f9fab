"""The springs of a system by name, and the names of their numbers.

A number of the first spring has the name of its field, `stiffness`. One of another spring has the spring's name before
it, `biceps.stiffness`, and so has every number of a path, `biceps.hip`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.model.path import Path
from spear_pin.model.spring import UNITS, Spring

Springs = Mapping[str, Spring]


def springs_by_name(given: Spring | Mapping[str, Spring], first: str) -> Springs:
    """Returns springs by their names; a single one gets the name `first`.

    Raises:
        BadValue: there are none, or a name has a dot in it.
    """
    springs = {first: given} if isinstance(given, Spring) else dict(given)
    if not springs or not all(isinstance(each, Spring) for each in springs.values()):
        raise BadValue("spring", given, "a Spring, or several by their names")
    for name in springs:
        if "." in name or not name:
            raise BadValue("name of a spring", name, "a name without a dot")
    return springs


def numbers_of_springs(springs: Springs) -> dict[str, Any]:
    """Returns the numbers of springs by name, in their order."""
    found: dict[str, Any] = {}
    for i, (name, spring) in enumerate(springs.items()):
        found |= {f"{name}.{field}" if i else field: getattr(spring, field) for field in UNITS}
        found |= {f"{name}.{number}": value for number, value in _of_path(spring).items()}
    return found


def with_spring_numbers(springs: Springs, values: Mapping[str, Any], make: Callable[..., Spring] = replace) -> Springs:
    """Returns springs with other numbers, by the names of `numbers_of_springs`; those not named stay.

    Args:
        springs: the springs.
        values: numbers; names of none of the springs are passed over.
        make: makes a spring from another and fields by name, and checks them or not.
    """
    found: dict[str, Spring] = {}
    for i, (name, spring) in enumerate(springs.items()):
        own = {field: f"{name}.{field}" if i else field for field in UNITS}
        fields: dict[str, Any] = {field: values[full] for field, full in own.items() if full in values}
        moved = {number: values[f"{name}.{number}"] for number in _of_path(spring) if f"{name}.{number}" in values}
        if moved:
            fields["path"] = _path(spring).with_numbers(moved)
        found[name] = make(spring, **fields) if fields else spring
    return found


def unit_of(springs: Springs, name: str) -> str:
    """Returns the unit of a number of springs; "" if none has it."""
    owner, _, field = name.rpartition(".")
    spring = springs.get(owner) if owner else next(iter(springs.values()), None)
    if spring is None:
        return ""
    if field in UNITS:
        return spring.units[field]
    return spring.path.units.get(field, "") if spring.path is not None else ""


def _of_path(spring: Spring) -> Mapping[str, Any]:
    return {} if spring.path is None else spring.path.numbers


def _path(spring: Spring) -> Path:
    assert spring.path is not None
    return spring.path
