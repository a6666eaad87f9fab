"""A brake as data, and the numbers of brakes, which may be scalars of any kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from spear_pin.errors import require
from spear_pin.hybrid.domain import GuardValue
from spear_pin.hybrid.fields import with_fields
from spear_pin.kinds import typed
from spear_pin.model.clutch import LONGEST
from spear_pin.model.path import Joints

NUMBERS = {"force": "brake_force", "delay": "brake_delay"}  # what the fields are called behind the brake's name


class Place(NamedTuple):
    """Where a number of brakes is.

    Attributes:
        brake: name of the brake.
        field: its own name there.
    """

    brake: str
    field: str


@typed
@dataclass(frozen=True)
class Brake:
    """A brake that closes in some phases.

    Attributes:
        force: the most that it holds, in N or N·m; beyond it slips, with this force. No impact makes it slip.
        phases: names of the phases in which it closes; an event that leads into another phase opens it first.
        path: the path that it holds; None for the joint of its name.
        when: a function as of a `Guard`, such as a rate, or a toe's force less a threshold. The brake closes within the
            phase where its value falls through zero, or is below; None: it closes as the phase begins.
        delay: time from then until it closes, in s.
        until: a function as of a `Guard`; the closed brake opens where its value falls through zero, or is below. If
            that is so as a phase begins, the brake does not close; else it closes just after toes have struck. While
            `when` asks to close it too, it opens and closes without end (`zeno`).
    """

    force: float
    phases: tuple[str, ...]
    path: Joints | None = None
    when: GuardValue | None = None
    delay: float = 0.0
    until: GuardValue | None = None

    def __post_init__(self) -> None:
        """Checks the numbers."""
        require("Brake.force", self.force, lambda force: force > 0, "a number > 0, in N or N·m")
        within = f"a number from 0 to {LONGEST:g}, in s"
        require("Brake.delay", self.delay, lambda delay: (delay >= 0) & (delay <= LONGEST), within)

    @property
    def at_once(self) -> bool:
        """Tells whether it closes in the instant in which its phases begin, whatever the state."""
        return self.begins and self.until is None

    @property
    def begins(self) -> bool:
        """Tells whether it closes in that instant unless `until` holds already."""
        return self.when is None and self.delay == 0.0


Brakes = Mapping[str, Brake]


@dataclass(frozen=True)
class Braked:
    """A change of a system that adds brakes.

    Attributes:
        brakes: the brakes by name.
    """

    brakes: Brakes


def brakes_of(changes: Iterable[object]) -> dict[str, Brake]:
    """Returns the brakes that changes of a system add, by name."""
    return {name: each for change in changes if isinstance(change, Braked) for name, each in change.brakes.items()}


def places_of_brakes(brakes: Brakes) -> dict[str, Place]:
    """Returns where each number of brakes is, by its name, such as `knee.brake_force`."""
    return {f"{brake}.{own}": Place(brake, field) for brake in brakes for field, own in NUMBERS.items()}


def numbers_of_brakes(brakes: Brakes) -> dict[str, Any]:
    """Returns the numbers of brakes by name, in their order."""
    return {name: getattr(brakes[brake], field) for name, (brake, field) in places_of_brakes(brakes).items()}


def brakes_with(brakes: Brakes, values: Mapping[str, Any]) -> dict[str, Brake]:
    """Returns brakes with other numbers of any kind, by the names of `numbers_of_brakes`; those not named stay."""
    changed: dict[str, dict[str, Any]] = {name: {} for name in brakes}
    for name, (brake, field) in places_of_brakes(brakes).items():
        if name in values:
            changed[brake][field] = values[name]
    return {name: with_fields(each, changed[name]) for name, each in brakes.items()}


def unit_of_brakes(units: Mapping[str, str], brakes: Brakes, name: str) -> str:
    """Returns the unit of a number of brakes; "" if none has it.

    Args:
        units: units of the robot's coordinates by name.
        brakes: the brakes.
        name: name of the number.
    """
    place = places_of_brakes(brakes).get(name)
    if place is None:
        return ""
    if place.field == "delay":
        return "s"
    path = brakes[place.brake].path
    turns = units[place.brake] == "rad" if path is None else path.turns
    return "N·m" if turns else "N"
