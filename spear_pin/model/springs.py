"""The springs of a system by name, and the names of their numbers.

A number of the first spring has the name of its field, `stiffness`. One of another spring has the spring's name before
it, `biceps.stiffness`, and so has every number of a path, `biceps.hip`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.model.clutch import DELAYS, OF_CLUTCHES
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
        before = f"{name}." if i else ""
        found |= {before + field: getattr(spring, field) for field in UNITS}
        if spring.clutch is not None:
            found |= {before + field: getattr(spring.clutch, field) for field in OF_CLUTCHES}
        if spring.path is not None:
            found |= {f"{name}.{number}": value for number, value in spring.path.numbers.items()}
    return found


def said(name: str, spring: Spring) -> str:
    """Returns a spring in words, with its switch where that is not ideal."""
    law = "by a table" if spring.table else f"{spring.stiffness:.4g} {spring.units['stiffness']}"
    words = [f"{law} in the {name}" if spring.path is None else f"{law}, {name}"]
    if (clutch := spring.clutch) is not None:
        words += [f"engaged {1e3 * clutch.on_delay:.4g} ms late, released {1e3 * clutch.off_delay:.4g} ms late"]
        unit = "rad" if spring.turns else "m"
        words += [f"play {clutch.play:.4g} {unit}"] if clutch.play else []
        words += [f"teeth of {clutch.pitch:.4g} {unit}"] if clutch.pitch else []
    return "; ".join(words)


def unit_of(springs: Springs, name: str) -> str:
    """Returns the unit of a number of springs; "" if none has it."""
    owner, _, field = name.rpartition(".")
    spring = springs.get(owner) if owner else next(iter(springs.values()), None)
    if spring is None:
        return ""
    if field in UNITS:
        return spring.units[field]
    if field in OF_CLUTCHES and spring.clutch is not None:
        units = dict.fromkeys(DELAYS, "s") | {"second": spring.units["stiffness"]}
        return units.get(field, "rad" if spring.turns else "m")
    return spring.path.units.get(field, "") if spring.path is not None else ""
