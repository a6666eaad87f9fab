"""Makes systems from others: with other numbers, named as fields of law, springs and ground, or changed as a whole."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import partial
from typing import Any, NamedTuple

from spear_pin.errors import BadValue, SpearError, UnknownName
from spear_pin.hybrid.automaton import REPLACED, HybridSystem
from spear_pin.hybrid.brake import Braked, Brakes, places_of_brakes, unit_of_brakes
from spear_pin.hybrid.ground import PLACE
from spear_pin.hybrid.hardware import Hardware
from spear_pin.kinds import typed
from spear_pin.model.clutch import OF_CLUTCHES
from spear_pin.model.numbers import body_numbers
from spear_pin.model.path import Path
from spear_pin.model.robot import Robot
from spear_pin.model.spring import UNITS as OF_SPRINGS
from spear_pin.model.spring import Spring
from spear_pin.model.springs import places_of, unit_of
from spear_pin.model.variants import PARAMETERS, parameters_of, value_of, vary

OF_SPRING, OF_BRAKE = "spring ", "brake "  # begins the part that is one of the springs, or of the brakes
Change = Callable[[HybridSystem], HybridSystem]
LIMITS = ("phase_limit", "shortest_flight", "overlap")
OF_GROUND = {"friction": "1", "slope": "rad", "height": "m"}


def left_out_at_zero(name: str) -> bool:
    """Tells whether the equations leave a number out where it is zero: of springs, switches and the ground's place."""
    return name in OF_SPRINGS or name in OF_CLUTCHES or name in PLACE or "." in name


def with_parameters(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns a system with other parameters, named as fields of its law, spring or contact; the given one is kept.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: a value is not valid for its field.
    """
    if not values:
        return system  # as it is, with what may have been replaced in it
    whole, parts = _parts(system), dict[str, Any]()
    for name, value in values.items():
        place = _owner(system, name)
        parts[place.part] = place.given(parts.get(place.part, whole[place.part]), value)
    brakes = {each: parts.pop(OF_BRAKE + each) for each in system.brakes if OF_BRAKE + each in parts}
    springs = {each: parts.pop(OF_SPRING + each) for each in system.springs if OF_SPRING + each in parts}
    if springs:
        parts["spring"] = {**system.springs, **springs} if system.sprung else springs.popitem()[1]
    return rebuilt(system, brakes=brakes, **parts)


def rebuilt(
    system: HybridSystem, robot: Robot | None = None, brakes: Brakes | None = None, **parts: Any
) -> HybridSystem:
    """Returns a system with another robot, law, spring or contact; its other changed and replaced parts are kept.

    Args:
        system: the system.
        robot: the other robot.
        brakes: other brakes, each in the place of the one of its name.
        parts: other parts by the names of the builder's arguments; a single `spring` takes the first one's place.

    Raises:
        BadValue: its domains were replaced, and not by `change_system`, so that they are not defined for other numbers.
    """
    kept = find_replaced(system)
    if isinstance(own := parts.get("spring"), Spring) and system.sprung:
        first, *others = system.springs.items()
        parts["spring"] = dict([(first[0], own), *others])
    build = partial(_build_braked, system, brakes) if brakes else system.build
    again = build(system.robot if robot is None else robot, **system.parts | parts)
    return replace(again, **kept) if kept else again  # once made it is checked


def _build_braked(system: HybridSystem, brakes: Brakes, robot: Robot, **parts: Any) -> HybridSystem:
    """Builds a system as another was built and changed, with other brakes in the place of those of their names."""
    again: HybridSystem = system.made["builder"](robot, **parts)
    for change in system.changes:
        if isinstance(change, Braked):
            change = replace(change, brakes={name: brakes.get(name, own) for name, own in change.brakes.items()})
        again = change_system(again, change)
    return again


def change_system(system: HybridSystem, change: Change) -> HybridSystem:
    """Changes a system by a function; systems rebuilt from it by `with_parameters`, searches and sweeps change alike.

    Use it for changes beyond the numbers of law, springs and ground, such as another guard or dry friction.

    Args:
        system: the system.
        change: makes another system from a system, with `dataclasses.replace`. For sweeps it has to be a callable
            dataclass, whose name and fields identify the sweep.
    """
    build, after = system.build, change(system)
    before = {name: system.made[name] for name in REPLACED if getattr(system, name) != system.made[name]}

    def build_changed(*parts: Any, **named: Any) -> HybridSystem:
        return change_system(build(*parts, **named), change)

    made = {name: before.get(name, getattr(after, name)) for name in REPLACED}
    makers = {"build": build_changed, "builder": system.made["builder"]}
    return replace(after, build=build_changed, changes=(*system.changes, change), made=made | makers)


def find_replaced(system: HybridSystem) -> dict[str, Any]:
    """Returns the fields of a system that were replaced since it was made, other than by `change_system`.

    Raises:
        BadValue: the domains were replaced.
    """
    others = {name: getattr(system, name) for name in REPLACED if getattr(system, name) != system.made[name]}
    if "domains" in others:
        names = ", ".join(domain.name for domain in system.domains)
        raise BadValue(
            "domains", names, "the domains as built; change them by `change_system(system, change)`, not by `replace`"
        )
    return others


def limits(system: HybridSystem) -> dict[str, Any]:
    """Returns the limits that were set in a system, by name, for `dataclasses.replace` to set in another."""
    return {name: getattr(system, name) for name in LIMITS}


def parameter(system: HybridSystem, name: str) -> float:
    """Returns the value of a parameter named as a field of the law, spring or contact.

    Raises:
        UnknownName: no part has a numeric field of that name.
        BadValue: the field holds no number to begin from.
    """
    place = _owner(system, name)
    value = place.value(_parts(system)[place.part])
    if value is None:
        raise BadValue(name, value, "a number: set it in the law, spring or ground first")
    return float(value)


def number(system: HybridSystem, name: str) -> float:
    """Returns the value of a number of the law, the springs, the ground, or the robot.

    A robot has the numbers of `model.variants`, and its bodies have the numbers of `model.numbers`.

    Raises:
        UnknownName: nothing has a number of that name.
        BadValue: the field holds no number to begin from.
    """
    robot = system.robot
    if name in parameters_of(robot):
        return value_of(robot, name)
    bodies = body_numbers(robot)
    try:
        return parameter(system, name)
    except UnknownName:
        if name not in bodies:
            raise UnknownName("parameter", name, list_numbers(system)) from None
        return bodies[name].value


def list_numbers(system: HybridSystem) -> list[str]:
    """Returns the names of all numbers of a system: of its law, its springs, its ground, its brakes and its robot."""
    own = (name for places in _places(system).values() for name in places)
    return [*dict.fromkeys((*own, *numbers_of_robot(system.robot)))]


def nonzero(system: HybridSystem, names: Iterable[str]) -> tuple[str, ...]:
    """Returns those names for which a system has a number other than zero."""
    found = []
    for name in names:
        with suppress(SpearError):
            if number(system, name) != 0.0:
                found.append(name)
    return tuple(found)


def numbers_of_robot(robot: Robot) -> tuple[str, ...]:
    """Returns the names of a robot's numbers: those that `vary` takes, and those of its bodies."""
    return (*parameters_of(robot), *body_numbers(robot))


def numbers_of_law(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the numbers that a system's law has alone, and that have a value."""
    places = _places(system)
    others = {name for part, own in places.items() if part != "law" for name in own}  # have a name before the law has
    return tuple(
        name for name, place in places["law"].items() if name not in others and place.value(system.law) is not None
    )


def unit(system: HybridSystem, name: str) -> str:
    """Returns the unit of a number of the robot, the law (if it names units), the springs or the ground; else ""."""
    if name in parameters_of(system.robot):
        return PARAMETERS[name].unit
    bodies = body_numbers(system.robot)
    others: Mapping[str, str] = OF_GROUND | dict(getattr(system.law, "units", {}))
    if name in bodies:
        return bodies[name].unit
    if name in others:
        return others[name]
    units = dict(zip(system.robot.coordinates, system.robot.units, strict=True))
    return unit_of_brakes(units, system.brakes, name) or unit_of(system.springs, name)


def with_numbers(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns a system with other numbers, by the names of `number`; the given one is left unchanged.

    Raises:
        UnknownName: nothing has a number of that name.
        BadValue: a value is not valid for its number.
    """
    varied = {name: float(value) for name, value in values.items() if name in numbers_of_robot(system.robot)}
    if varied:
        system = rebuilt(system, vary(system.robot, **varied))
    return with_parameters(system, {name: value for name, value in values.items() if name not in varied})


class _Place(NamedTuple):
    """Where a part of a system has a number: a field of its own, of a dataclass in it, or a number of its path."""

    part: str
    inner: str | None
    field: str

    def value(self, part: Any) -> Any:
        """Returns the number."""
        owner = part if self.inner is None else getattr(part, self.inner)
        return owner.numbers[self.field] if isinstance(owner, Path) else getattr(owner, self.field)

    def given(self, part: Any, value: Any) -> Any:
        """Returns the part with another number."""
        if self.inner is None:
            return replace(part, **{self.field: value})
        owner, given = getattr(part, self.inner), {self.field: value}
        return replace(part, **{self.inner: owner.moved(given) if isinstance(owner, Path) else replace(owner, **given)})


def _parts(system: HybridSystem) -> dict[str, Any]:
    """Returns the parts with numbers: law, each spring, ground or contact, and each brake."""
    springs = {f"{OF_SPRING}{name}": spring for name, spring in system.springs.items()}
    brakes = {f"{OF_BRAKE}{name}": brake for name, brake in system.brakes.items()}
    return {"law": system.law, **springs, "contact": system.ground, **brakes}


def _owner(system: HybridSystem, name: str) -> _Place:
    """Returns where a system has the number of a name.

    Raises:
        UnknownName: no part has such a number.
        BadValue: two parts have one, with different values.
    """
    parts, owners = _parts(system), dict[str, _Place]()
    for part, own in _places(system).items():
        if name in own and name in owners:
            before = owners[name]
            if own[name].value(parts[part]) != before.value(parts[before.part]):
                one, other = (each.split()[0] for each in (before.part, part))
                raise BadValue("name", name, f"a number of one part, not of {one} and {other}: rename the law's")
        owners |= own
    if name not in owners:
        raise UnknownName("parameter", name, owners)
    return owners[name]


def _places(system: HybridSystem) -> dict[str, dict[str, _Place]]:
    """Returns where each part has its numbers, by their names."""
    found: dict[str, dict[str, _Place]] = {part: {} for part in _parts(system)}
    for name, place in places_of(system.springs).items():
        part = OF_SPRING + place.spring
        found[part][name] = _Place(part, place.inner or None, place.field)
    for name, each in places_of_brakes(system.brakes).items():
        found[OF_BRAKE + each.brake][name] = _Place(OF_BRAKE + each.brake, None, each.field)
    for part, whole in (("law", system.law), ("contact", system.ground)):
        for field in fields(whole):
            value = getattr(whole, field.name)
            if is_dataclass(value):
                inner = [each.name for each in fields(value) if _numeric(value, each.name)]
                found[part] |= {name: _Place(part, field.name, name) for name in inner}
            elif _numeric(whole, field.name):
                found[part][field.name] = _Place(part, None, field.name)
    return found


def _numeric(owner: Any, name: str) -> bool:
    nested = isinstance(owner, Spring) and name in ("path", "clutch")
    return not nested and not isinstance(getattr(owner, name), (bool, str, tuple))


@typed
def with_hardware(system: HybridSystem, hardware: Hardware | None) -> HybridSystem:
    """Returns the system with hardware, or without any; rebuilt systems keep it.

    If a robot's legs are pairs, an actuator drives both joints of a pair: twice the inertia, half the resistance.

    Currents, heat and clock start at zero in every run, including those of a return map. A gait found with such
    hardware is periodic only in (q, v), and its multipliers leave out the states of the hardware.

    Raises:
        BadValue: the number of actuators is not that of the robot's actuated joints.
    """
    if hardware is None and system.hardware is None:
        return system
    return change_system(system, Fitted(hardware))


@dataclass(frozen=True)
class Fitted:
    """The change of a system that sets its hardware.

    Attributes:
        hardware: hardware between law and joints; None removes it.
    """

    hardware: Hardware | None

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with the hardware, or without any."""
        count = system.robot.nu if self.hardware is None else len(self.hardware.actuators)
        if count != system.robot.nu:
            raise BadValue("actuators", count, f"{system.robot.nu}, one for each of {system.robot.actuated}")
        return replace(system, hardware=self.hardware)
