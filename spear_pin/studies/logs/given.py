"""Checks names and values that a fit or a replay is given, before anything is computed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from spear_pin.errors import UnknownName, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import list_numbers, number
from spear_pin.studies.logs.played import FRICTION, SCALE, find_number
from spear_pin.studies.logs.residuals import HEIGHT_SENSOR, HYSTERESIS, LAG

LATEST = 1.0  # s, of a sensor
UNBOUNDED = "values with which the model can be integrated: its motion blows up"


def check_names(leg: HybridSystem, system: HybridSystem, names: Iterable[str], others: Sequence[str]) -> None:
    """Checks that names are numbers of a leg, or others.

    What only the played law has is not for users. A log tells nothing of the ground: toes on it are at rest.

    Args:
        leg: the played leg.
        system: the user's system.
        names: the names.
        others: names that are valid besides the leg's, such as those of the sensors' numbers.

    Raises:
        BadValue: a number has no value to begin from.
        UnknownName: there is no number of a name.
    """
    of_law, of_ground = (each.__dataclass_fields__ for each in (leg.law, leg.ground))
    inner = {each for each in of_law if each != SCALE and not each.endswith(FRICTION)}
    valid = [name for name in list_numbers(leg) if name not in inner and name not in of_ground]
    for name in names:
        if name not in valid and name not in others:
            raise UnknownName("number of the leg", name, [*valid, *others])
        if name not in others:
            number(leg, find_number(system, name)[0])


def check_values(values: Mapping[str, float]) -> None:
    """Checks values by the names of `identify_motion`.

    Raises:
        BadValue: a value is not finite, or is not one that such a number can have.
    """
    for name, value in values.items():
        if name in (LAG, HEIGHT_SENSOR[1]):
            require(name, value, lambda lag: abs(lag) <= LATEST, f"a number from -{LATEST:g} to {LATEST:g}, in s")
        elif name == SCALE:
            require(name, value, lambda scale: scale > 0, "a number > 0")
        elif name.endswith((FRICTION, HYSTERESIS)):
            require(name, value, lambda force: force >= 0, "a number >= 0")
        else:
            require(name, value, lambda _: True, "a finite number")
