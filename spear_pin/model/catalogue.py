"""Motors and gearboxes by name, each number with its source and with how far it has been verified."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from math import pi
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

G_CM2 = 1e-7  # kg·m²
RPM = pi / 30.0  # rad/s


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
def scaled(motor: Motor, power: float) -> Motor:
    """Scales a motor to another power, as an assumption where its numbers are not known: `sized`, r times the power.

    Args:
        motor: a motor with a known `rated_power`.
        power: the new rated power, in W.
    """
    require("power", power, lambda p: p > 0, "a number > 0, in W")
    name = f"{motor.name} scaled to {power:g} W (assumption)"
    return replace(sized(motor, power / motor.known("rated_power")), name=name)


@typed
def sized(motor: Motor, size: float) -> Motor:
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


def _given(verification: Verification, source: str, **values: float) -> Entry:
    return {field: Quantity(value, UNITS[field], source, verification) for field, value in values.items()}


_stated = partial(_given, "source document")
_second = partial(_given, "secondary source")
_recalled = partial(_given, "recollection")
_assumption = partial(_given, "assumption")


def _assumed(base: str, power: float) -> Entry:
    """Returns an entry for a scaled motor."""
    larger = scaled(motor(base), power)
    source = f"{base} scaled to {power:g} W"
    return _assumption(source, **{field: getattr(larger, field) for field in MOTORS[base]})


_MAXON = "maxon catalogue, from memory"
_FAULHABER = "Faulhaber data sheet of 2012"
_MAXON_2006 = "maxon catalogue of April 2006, p. 197, as transcribed in a public repository"
_OF_TWO = "agrees with 66.2 A at the start on that page; 0.343 Ω in another repository"
_NOTES = "set-up notes in a public repository"
_DESIGN = "controller design in a public repository"
_HOPPY = "simulator of HOPPY, arXiv 2010.14580"
_MUPS = "repository of SurGE, arXiv 2606.21866, at the joint"
_ODRI = "actuator of a public project for open legged robots"
_SAME_HEAT = "that of the 24 V winding: equal heat in equal copper"

MOTORS: dict[str, Entry] = {
    "spear_ii_knee": {
        **_stated("K_v of (4.8); fits the 48 V winding, not named there", torque_constant=0.115),
        **_stated("Section 2.4: EC-60 Flat 100W", rated_power=100.0),
        **_given("computed", "Table 2.4: 0.027 kg·m² at the joint / 15²", rotor_inertia=0.027 / 15**2),
        **_assumption("that of ec_60_flat_100w_48v", resistance=1.1, inductance=0.86e-3, nominal_torque=0.227),
        **_assumption("that of ec_60_flat_100w_48v, a recollection", mass=0.470),
    },
    "ec_60_flat_100w_24v": {
        **_second(_NOTES, torque_constant=0.0534, nominal_voltage=24.0, rated_power=100.0),
        **_recalled(_MAXON, resistance=0.307, inductance=0.188e-3, rotor_inertia=1210 * G_CM2),
        **_recalled(_MAXON, nominal_torque=0.227, no_load_current=0.49, mass=0.470),
    },
    "ec_60_flat_100w_48v": {
        **_recalled(_MAXON, torque_constant=0.114, resistance=1.1, inductance=0.86e-3),
        **_recalled(_MAXON, rotor_inertia=1210 * G_CM2, mass=0.470, nominal_voltage=48.0, rated_power=100.0),
        **_assumption(_SAME_HEAT, nominal_torque=0.227),
    },
    "ec_60_flat_150w": {
        **_second("a thesis quoted in a public repository", nominal_torque=0.401, mass=0.350),
        **_second("a thesis quoted in a public repository", nominal_voltage=24.0, rated_power=150.0),
        **_second("a public repository", nominal_current=7.25),
    },
    "ec_60_flat_200w": {
        **_second("a public repository, as EC 60 flat ventilated 48 V", rotor_inertia=832 * G_CM2),
        **_second("a public repository", rated_power=200.0),
    },
    "ec_90_flat_90w_24v": {
        **_second(_MAXON_2006, torque_constant=0.0705, inductance=0.264e-3),
        **_second(f"{_MAXON_2006}; {_OF_TWO}", resistance=0.363),
        **_second(_MAXON_2006, rotor_inertia=3060 * G_CM2, nominal_torque=0.387, nominal_current=5.39),
        **_second(_MAXON_2006, no_load_current=0.539, nominal_voltage=24.0, rated_power=90.0),
        **_second("the same page, in another public repository", mass=0.648),
    },
    "ec_90_flat_90w_48v": {
        **_second(_MAXON_2006, torque_constant=0.217, resistance=2.3, inductance=2.5e-3),
        **_second(_MAXON_2006, rotor_inertia=3060 * G_CM2, nominal_torque=0.494, nominal_current=2.12),
        **_second(_MAXON_2006, no_load_current=0.13, nominal_voltage=48.0, rated_power=90.0),
        **_second("the same page, in another public repository", mass=0.648),
    },
    "ec_90_flat_260w": {
        **_second(_DESIGN, torque_constant=0.231, resistance=0.844, inductance=1.07e-3),
        **_second(_DESIGN, rotor_inertia=5060 * G_CM2, rated_power=260.0),
        **_second("amplifier set-up of an EC 90 flat in a public repository", nominal_current=4.06),
        **_recalled(_MAXON, mass=1.0),
        **_assumption("not stated with the other numbers", nominal_voltage=48.0),
    },
    "ec_i_52_ht": _second("a public repository", rotor_inertia=264 * G_CM2, nominal_torque=0.627, nominal_voltage=48.0),
    "faulhaber_3863h024cr": {
        **_given("datasheet seen", _FAULHABER, torque_constant=0.0398, resistance=0.64, inductance=180e-6),
        **_given("datasheet seen", _FAULHABER, rotor_inertia=120 * G_CM2, nominal_torque=0.157, no_load_current=0.168),
        **_given("datasheet seen", _FAULHABER, max_speed=8000 * RPM, mass=0.390, nominal_voltage=24.0),
    },
    "hoppy_gearmotor": {
        **_given("published", f"{_HOPPY}: of its voltage", torque_constant=0.0186),
        **_given("published", _HOPPY, resistance=1.3, rotor_inertia=7e-6),
    },
    "mups_v2_joint": _given("published", _MUPS, torque_constant=0.945, resistance=0.17),
    "antigravity_4004_300kv": {
        **_second(_ODRI, torque_constant=0.025, mass=0.053),
        **_second(f"{_ODRI}: 3/2 of 0.2326 Ω and 0.14 mH a phase", resistance=0.349, inductance=0.21e-3),
        **_second("robot descriptions of the same project", rotor_inertia=4.5e-6),
        **_assumption("heat of 9 W; 12 A are for moments", nominal_current=5.0),
        **_assumption("5 A at 24 V", nominal_voltage=24.0, rated_power=120.0),
    },
}
MOTORS["assumed_600w"] = _assumed("ec_90_flat_260w", 600.0)

_GEARS = "maxon catalogue of GP 52 C, from memory"
_ONE_STAGE = _recalled(_GEARS, efficiency=0.91, max_torque=4.0, mass=0.46)
_TWO_STAGES = _recalled(_GEARS, efficiency=0.83, max_torque=15.0, mass=0.62)
_THREE_STAGES = _recalled(_GEARS, efficiency=0.75, max_torque=30.0, mass=0.77)

GEARBOXES: dict[str, Entry] = {
    "spear_ii_knee_gear": {**_stated("Table 2.4", ratio=15.0), **_TWO_STAGES},
    "gp_52_c_4": {**_second("a public repository", ratio=4.3), **_ONE_STAGE},
    "gp_52_c_12": {
        **_second("a public repository, as 223083", ratio=12.0, inertia=17.6 * G_CM2),
        **_TWO_STAGES,
    },
    "gp_52_c_15": {**_recalled(_GEARS, ratio=91 / 6), **_TWO_STAGES},
    "gp_52_c_19": {**_second("a public repository", ratio=18.8), **_TWO_STAGES},
    "gp_52_c_66": {**_recalled(_GEARS, ratio=1183 / 18), **_THREE_STAGES},
    "gp_52_c_81": {**_second("a public repository", ratio=81.4), **_THREE_STAGES},
}
