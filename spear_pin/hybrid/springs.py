"""Springs at a state, for scalars of any kind: how far each is stretched, how it pulls, and along which coordinates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from spear_pin.errors import UnknownName
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Held, Mount
from spear_pin.hybrid.fields import with_fields
from spear_pin.hybrid.pull import Pull
from spear_pin.model.path import Path, Posture
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import find_spanned
from spear_pin.model.scalars import plus
from spear_pin.model.spring import UNITS as OF_SPRINGS
from spear_pin.model.spring import Spring
from spear_pin.model.springs import Springs, places_of

Posed = Callable[[Sequence[Any]], Posture]
"""Returns the posture at a configuration."""


def springs_with(springs: Springs, values: Mapping[str, Any]) -> Springs:
    """Returns springs with other numbers of any kind, by the names of `numbers_of_springs`; those not named stay."""
    changed: dict[str, dict[str, dict[str, Any]]] = {name: {"": {}, "path": {}, "clutch": {}} for name in springs}
    for name, place in places_of(springs).items():
        if name in values:
            changed[place.spring][place.inner][place.field] = values[name]
    found: dict[str, Spring] = {}
    for name, spring in springs.items():
        own, of_path, of_clutch = changed[name].values()
        path = None if spring.path is None else spring.path.with_numbers(of_path)
        clutch = None if spring.clutch is None else with_fields(spring.clutch, of_clutch)
        found[name] = with_fields(spring, {**own, "path": path, "clutch": clutch})
    return found


def number_spring(mount: Mount, system: HybridSystem, springs: Mapping[str, Spring]) -> tuple[Spring, Path]:
    """Returns a mount's spring and path, with the system's numbers where it shares them, else with its own fixed ones.

    Args:
        mount: the mount.
        system: the system.
        springs: the system's springs, with scalars of any kind.
    """
    name, path = spring_of(mount, system), mount.along
    common, numbers = system.springs[name], springs[name]
    own = {each: getattr(numbers, each) for each in find_shared(mount.spring, common)}
    if shares_path(mount, common):
        assert numbers.path is not None
        path = path.with_numbers(dict(zip(path.numbers, numbers.path.numbers.values(), strict=True)))
    return with_fields(mount.spring, {**own, "path": mount.spring.path, "clutch": numbers.clutch}), path


def spring_of(mount: Mount, system: HybridSystem) -> str:
    """Returns the name of the system's spring whose numbers a mount has."""
    return mount.of or next(iter(system.springs))


def shares_path(mount: Mount, common: Spring) -> bool:
    """Tells whether a mount's path has the numbers of the system's spring; else they are fixed."""
    return common.path is not None and [*mount.along.numbers.values()] == [*common.path.numbers.values()]


def find_shared(own: Spring, common: Spring) -> list[str]:
    """Returns the names of the numbers that a mount's spring shares with the system's; its other numbers are fixed."""
    return [name for name in OF_SPRINGS if getattr(own, name) == getattr(common, name)]


def rest_length(mount: Mount, spring: Spring, path: Path, robot: Robot, held: Held, posed: Posed) -> Any:
    """Returns the length at which a spring rests, in rad or m.

    Args:
        mount: where it acts.
        spring: its spring, with scalars of any kind.
        path: its path, with scalars of any kind.
        robot: the robot, which says what the path spans.
        held: held values.
        posed: returns the posture at a configuration.
    """
    if not isinstance(mount.rest, str):
        return mount.rest
    clutch = spring.clutch
    if mount.tooth is not None and clutch is not None:
        return clutch.tooth + clutch.pitch * held[mount.tooth]
    latched, names = held[mount.rest], find_spanned(mount.along, robot)
    values = dict(zip(names, latched if isinstance(latched, tuple) else (latched,), strict=True))
    some = next(iter(values.values()))
    zero = some - some  # of the same kind
    length = path.length(posed([values.get(name, zero) for name in robot.coordinates]))
    if clutch is None:
        return length
    if spring.chained:  # the second spring keeps the stretch that it has as the switch closes
        share = clutch.second / (spring.stiffness + clutch.second)
        return length - share * (length - clutch.slack)
    if mount.slips is not None:  # once it has slipped, it rests as far behind as its clutch slips
        _, slipped = held[mount.slips]
        return length + (1.0 - slipped) * clutch.play - slipped * spring.at_slip
    return plus(length, clutch.play)


def values_along(path: Path, robot: Robot, q: Sequence[Any]) -> Any:
    """Returns what a latch holds for a spring that rests at a configuration, see `Mount.rest`."""
    values = tuple(q[robot.index(name)] for name in find_spanned(path, robot))
    return values if len(values) > 1 else values[0]


def torque_on(pulls: Sequence[Pull], index: int) -> Any:
    """Returns what springs, without dampers, exert on a coordinate, in N·m or N; 0 where none is engaged."""
    return sum((pull.force * pull.slope[index] for pull in pulls if index in pull.slope), 0.0)


def pull_of(pulls: Sequence[Pull], name: str) -> Pull:
    """Returns what the spring of a mount does.

    Raises:
        UnknownName: no spring of that name is engaged.
    """
    for pull in pulls:
        if pull.name == name:
            return pull
    raise UnknownName("engaged spring", name, [pull.name for pull in pulls])
