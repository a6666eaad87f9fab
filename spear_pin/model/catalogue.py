"""Motors and gearboxes by name, each number with its source and with how far it has been verified."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Literal, get_args

import numpy as np

from spear_pin.errors import UnknownName, require
from spear_pin.kinds import typed
from spear_pin.model.motor import UNITS, Gearbox, Motor

Verification = Literal[
    "source document",  # stated by the document that this package follows
    "datasheet seen",
    "published",  # by the makers of another robot, in a paper or a simulator of it
    "secondary source",  # somebody's transcription of a datasheet
    "recollection",  # from memory: verify before relying on it
    "computed",  # from numbers of the source document
    "assumption",
]
VERIFICATIONS: tuple[Verification, ...] = get_args(Verification)


@dataclass(frozen=True)
class Quantity:
    """A number with its provenance.

    Attributes:
        value: value in the unit.
        unit: SI unit.
        source: where the number comes from.
        verification: how far to trust the number.
    """

    value: float
    unit: str
    source: str
    verification: Verification


Entry = Mapping[str, Quantity]


@typed
def scale_motor(motor: Motor, power: float) -> Motor:
    """Scales a motor to another power, an assumption where its numbers are not known: `size_motor`, r times the power.

    Args:
        motor: a motor with a known `rated_power`.
        power: the new rated power, in W.
    """
    require("power", power, lambda p: p > 0, "a number > 0, in W")
    name = f"{motor.name} scaled to {power:g} W (assumption)"
    return replace(size_motor(motor, power / motor.known("rated_power")), name=name)


@typed
def size_motor(motor: Motor, size: float) -> Motor:
    """Returns a motor of another size, an assumption: a manufacturer's larger motor will differ.

    Its electrical numbers and its rotor are those of r equal motors on one shaft and one supply, where the size r need
    not be an integer. Torques, currents, power and rotor inertia are multiplied by r, resistance and inductance are
    divided by r; torque constant, voltage and speeds stay the same. The mass follows `mass_law` from the motor's own:
    it is multiplied by r^k.

    Args:
        motor: the motor of size 1; its numbers that are not known stay so.
        size: r, the continuous torque relative to that of the motor.
    """
    require("size", size, lambda r: r > 0, "a number > 0")
    grow = ("rated_power", "nominal_torque", "nominal_current", "no_load_current", "rotor_inertia")
    factors = dict.fromkeys(grow, size) | dict.fromkeys(("resistance", "inductance"), 1.0 / size)
    if motor.mass is not None:
        factors["mass"] = size ** mass_law().exponent
    numbers = {field: getattr(motor, field) for field in factors}
    changes = {field: number * factors[field] for field, number in numbers.items() if number is not None}
    return replace(motor, name=f"{motor.name} of size {size:g} (assumption)", **changes)


@dataclass(frozen=True)
class MassLaw:
    """The assumed mass of a motor, c T^k of its continuous torque T.

    Attributes:
        exponent: k.
        constant: c, in kg for 1 N·m.
        spread: factor by which motors typically are lighter or heavier.
        motors: names of the motors to which it is fitted.
    """

    exponent: float
    constant: float
    spread: float
    motors: tuple[str, ...]

    def __str__(self) -> str:
        fit = f"fitted to {len(self.motors)} motors of the catalogue within a factor of {self.spread:.2f}"
        return f"mass ∝ torque^{self.exponent:.2f}, {fit} (assumption)"


@cache
def mass_law() -> MassLaw:
    """Fits c T^k to the catalogue's motors, by least squares in logarithms.

    A motor counts if its mass and its continuous torque are known and not assumptions.
    """
    names = tuple(name for name, entry in MOTORS.items() if _weighed(entry))
    torque = np.log([motor(name).continuous_torque for name in names])
    mass = np.log([motor(name).known("mass") for name in names])
    k, c = np.polyfit(torque, mass, 1)
    spread = np.sqrt(np.square(mass - k * torque - c).sum() / (len(names) - 2))
    return MassLaw(float(k), float(np.exp(c)), float(np.exp(spread)), names)


def _weighed(entry: Entry) -> bool:
    torque = ("nominal_torque",) if "nominal_torque" in entry else ("torque_constant", "nominal_current")
    return all(name in entry and entry[name].verification != "assumption" for name in ("mass", *torque))


@typed
def motor(name: str) -> Motor:
    """Returns a motor of the catalogue; numbers that are not known are None, for `dataclasses.replace` to fill in.

    Raises:
        UnknownName: there is no such motor.
    """
    if name not in MOTORS:
        raise UnknownName("motor", name, MOTORS)
    return Motor(name, **{field: quantity.value for field, quantity in MOTORS[name].items()})


@typed
def gearbox(name: str) -> Gearbox:
    """Returns a gearbox of the catalogue; an unknown efficiency means no loss, an unknown inertia none.

    Raises:
        UnknownName: there is no such gearbox.
    """
    if name not in GEARBOXES:
        raise UnknownName("gearbox", name, GEARBOXES)
    return Gearbox(**{field: quantity.value for field, quantity in GEARBOXES[name].items()})


def _entries(kind: str) -> dict[str, Entry]:
    """Returns the motors or gearboxes of the TOML file beside this module, each number with its unit."""
    groups = tomllib.loads(files(__package__).joinpath("catalogue.toml").read_text(encoding="utf-8"))[kind]
    return {
        name: {
            field: Quantity(value, UNITS[field], each["source"], each["verification"])
            for each in sources
            for field, value in each.items()
            if field not in ("source", "verification")
        }
        for name, sources in groups.items()
    }


def _assumed(base: str, power: float) -> Entry:
    """Returns an entry for a scaled motor."""
    larger, source = scale_motor(motor(base), power), f"{base} scaled to {power:g} W"
    return {field: Quantity(getattr(larger, field), UNITS[field], source, "assumption") for field in MOTORS[base]}


MOTORS, GEARBOXES = _entries("motors"), _entries("gearboxes")
MOTORS["assumed_600w"] = _assumed("ec_90_flat_260w", 600.0)
