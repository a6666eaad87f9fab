"""The springs of a system by name, and the names of their numbers.

A number of the first spring has the name of its field, `stiffness`. One of another spring has the spring's name before
it, `biceps.stiffness`, and so has every number of a path, `biceps.hip`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, NamedTuple

from spear_pin.errors import BadValue
from spear_pin.model.clutch import FORCES, LIFT_OFF, LOADED, OF_CLUTCHES, TIMES, TOUCHDOWN, UNLOADED
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


class Place(NamedTuple):
    """Where a number of springs is.

    Attributes:
        spring: name of the spring.
        inner: "path" or "clutch" if it is a number of these, else empty.
        field: its own name there.
    """

    spring: str
    inner: str
    field: str

    def value(self, spring: Any) -> Any:
        """Returns the number."""
        owner = getattr(spring, self.inner) if self.inner else spring
        return owner.numbers[self.field] if self.inner == "path" else getattr(owner, self.field)


def places_of(springs: Springs) -> dict[str, Place]:
    """Returns where each number of springs is, by its name."""
    found: dict[str, Place] = {}
    for i, (name, spring) in enumerate(springs.items()):
        before = f"{name}." if i else ""
        own = [each.name for each in fields(spring) if each.name not in ("path", "clutch")]
        plain = [field for field in own if not isinstance(getattr(spring, field), (bool, str, tuple))]
        found |= {before + field: Place(name, "", field) for field in plain}
        if spring.clutch is not None:
            found |= {before + field: Place(name, "clutch", field) for field in OF_CLUTCHES}
        if spring.path is not None:
            found |= {f"{name}.{number}": Place(name, "path", number) for number in spring.path.numbers}
    return found


def numbers_of_springs(springs: Springs) -> dict[str, Any]:
    """Returns the numbers of springs that equations have, by name, in their order."""
    places = {name: place for name, place in places_of(springs).items() if place.inner or place.field in UNITS}
    return {name: place.value(springs[place.spring]) for name, place in places.items()}


def describe_spring(name: str, spring: Spring) -> str:
    """Returns a spring in words, with its switch where that is not ideal."""
    law = "by a table" if spring.table else f"{spring.stiffness:.4g} {spring.units['stiffness']}"
    words = [f"{law} in the {name}" if spring.path is None else f"{law}, {name}"]
    words += [f"hysteresis of {spring.hysteresis:.4g} {spring.units['hysteresis']}"] if spring.hysteresis else []
    if (clutch := spring.clutch) is not None:
        late = ("engaged", clutch.on_delay), ("released", clutch.off_delay)
        words += [f"{what} {1e3 * delay:.4g} ms late" for what, delay in late if delay]
        words += [f"released {1e3 * clutch.hold:.4g} ms after touchdown"] if clutch.hold else []
        at = {LOADED: f" at {clutch.on_force:.4g} N", UNLOADED: f" at {clutch.off_force:.4g} N"}
        when = ("engages", clutch.engage), ("releases", clutch.release)
        words += [f"{does} {on}{at.get(on, '')}" for does, on in when if on not in (TOUCHDOWN, LIFT_OFF)]
        unit = "rad" if spring.turns else "m"
        words += [f"play {clutch.play:.4g} {unit}"] if clutch.play else []
        words += [f"teeth of {clutch.pitch:.4g} {unit}"] if clutch.pitch else []
        words += [f"slips at {clutch.slip:.4g} {spring.units['preload']}"] if clutch.slip else []
        words += [f"a second spring of {clutch.second:.4g} {spring.units['stiffness']}"] if clutch.second else []
    return "; ".join(words)


def unit_of(springs: Springs, name: str) -> str:
    """Returns the unit of a number of springs; "" if none has it."""
    place = places_of(springs).get(name)
    if place is None:
        return ""
    spring, stretch = springs[place.spring], "rad" if springs[place.spring].turns else "m"
    if place.inner == "clutch":
        pulls = {"second": spring.units["stiffness"], "slip": spring.units["preload"]}
        return {**dict.fromkeys(TIMES, "s"), **dict.fromkeys(FORCES, "N"), **pulls}.get(place.field, stretch)
    if spring.path is not None and place.inner:
        return spring.path.units[place.field]
    return spring.units.get(place.field, stretch)
