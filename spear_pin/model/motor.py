"""Motor, gearbox and supply: the torque that a joint can have at a speed, and the electrical power it takes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed

UNITS = {
    "torque_constant": "N·m/A",
    "resistance": "Ω",
    "inductance": "H",
    "rotor_inertia": "kg·m²",
    "nominal_torque": "N·m",
    "nominal_current": "A",
    "no_load_current": "A",
    "max_speed": "rad/s",
    "rated_power": "W",
    "mass": "kg",
    "nominal_voltage": "V",
    "ratio": "1",
    "efficiency": "1",
    "inertia": "kg·m²",
    "max_torque": "N·m",
}


@typed
@dataclass(frozen=True)
class Motor:
    """A motor as its equivalent DC motor: torque kt i, back-EMF kt ω; a brushless motor is taken line to line.

    Unknown numbers are None; functions that need them raise an error. `spear_pin.model.catalogue` has some motors.

    Attributes:
        name: name of the motor in messages.
        torque_constant: kt, in N·m/A; the same number is K_v of (4.8), in V·s/rad.
        resistance: R of the terminals, in Ω.
        inductance: L of the terminals, in H; steady states do without.
        rotor_inertia: J of the rotor itself, in kg·m²; `Drive.reflected_inertia` multiplies it by N².
        nominal_torque: largest continuous torque at the shaft, in N·m.
        nominal_current: largest continuous current, in A.
        no_load_current: current without load, in A; its torque kt I₀ is neglected here.
        max_speed: largest speed of its bearings and rotor, in rad/s.
        rated_power: rated power, in W.
        mass: mass, in kg.
        nominal_voltage: voltage for which its numbers are given, in V.
    """

    name: str
    torque_constant: float | None = None
    resistance: float | None = None
    inductance: float | None = None
    rotor_inertia: float | None = None
    nominal_torque: float | None = None
    nominal_current: float | None = None
    no_load_current: float | None = None
    max_speed: float | None = None
    rated_power: float | None = None
    mass: float | None = None
    nominal_voltage: float | None = None

    def __post_init__(self) -> None:
        """Checks the fields."""
        for field in fields(self)[1:]:
            value, unit = getattr(self, field.name), UNITS[field.name]
            if value is not None:
                require(f"Motor.{field.name}", value, lambda x: x > 0, f"a number > 0, in {unit}, or None")

    def known(self, quantity: str) -> float:
        """Returns a number of the motor, by the name of its field.

        Raises:
            BadValue: the number is not known.
        """
        value: float | None = getattr(self, quantity)
        if value is None:
            expected = f"a number, in {UNITS[quantity]}: unknown for this motor, give it by dataclasses.replace"
            raise BadValue(f"{quantity} of {self.name}", value, expected)
        return value

    @property
    def continuous_torque(self) -> float:
        """Torque without overheating, in N·m: its nominal torque, else kt times its nominal current."""
        if self.nominal_torque is None and self.nominal_current is not None:
            return self.known("torque_constant") * self.nominal_current
        return self.known("nominal_torque")

    def check_known(self) -> None:
        """Checks that what a study of drives takes is known; `known` says what is not."""
        for quantity in ("torque_constant", "resistance", "rotor_inertia"):
            self.known(quantity)
        _ = self.continuous_torque


NO_MOTORS: Mapping[str, Motor] = MappingProxyType({})
"""Where no joint has one, by joint."""


@typed
@dataclass(frozen=True)
class Gearbox:
    """A reduction that loses the same share of power in either direction.

    Attributes:
        ratio: N, turns of the rotor per turn of the joint.
        efficiency: η, power out over power in.
        inertia: inertia of the gears at the motor's shaft, in kg·m²; 0 neglects it.
        max_torque: largest continuous torque at the joint, in N·m; None if not known.
        mass: mass, in kg; None if not known.
    """

    ratio: float
    efficiency: float = 1.0
    inertia: float = 0.0
    max_torque: float | None = None
    mass: float | None = None

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Gearbox.ratio", self.ratio, lambda n: n > 0, "a number > 0")
        require("Gearbox.efficiency", self.efficiency, lambda eta: 0 < eta <= 1, "a number in (0, 1]")
        require("Gearbox.inertia", self.inertia, lambda j: j >= 0, "a number >= 0, in kg·m²")
        for name in ("max_torque", "mass"):
            if (value := getattr(self, name)) is not None:
                require(f"Gearbox.{name}", value, lambda x: x > 0, f"a number > 0, in {UNITS[name]}, or None")


def gear_constant(motor: Motor, gearbox: Gearbox) -> float:
    """Returns N kt of a motor behind gears, in N·m/A or V·s/rad at the joint."""
    return gearbox.ratio * motor.known("torque_constant")


def find_passed_on(efficiency: float, effort: ArrayLike, speed: ArrayLike) -> Array:
    """Returns the share of a motor's torque that reaches the joint: η when driving, 1/η when braking.

    At rest gears stick and pass on any share between these. A joint at rest counts as driven, η, as this torque remains
    to set it in motion; `find_passed_on_creeping` is smooth at rest.

    Args:
        efficiency: η.
        effort: torque or current of the motor; its sign counts.
        speed: speed of the joint, in rad/s, broadcast against the effort.
    """
    return efficiency ** np.where(np.copysign(1.0, effort) * speed < 0.0, -1.0, 1.0)


def find_passed_on_creeping(efficiency: float, effort: float, speed: float, creep: float) -> float:
    """Returns the share at an instant, smooth at rest: η^tanh(along / creep), which is 1 at rest.

    Any other value at rest would make gears give power on one side. Above 20 times the creep, the width of the
    transition in rad/s, the share is that of `find_passed_on`, which has the same arguments.
    """
    share: float = efficiency ** math.tanh(math.copysign(1.0, effort) * speed / creep)
    return share


@dataclass(frozen=True)
class Worst:
    """The point of a motion at which a drive has the least margin.

    Attributes:
        index: index of the point.
        torque: torque at the point, in N·m.
        speed: speed at the point, in rad/s.
        margin: margin at the point, in N·m; negative if the drive cannot give the torque.
    """

    index: int
    torque: float
    speed: float
    margin: float


@typed
@dataclass(frozen=True)
class Drive:
    """A motor behind a gearbox on a supply, seen from the joint.

    Torques are those of u in (3.16): N kt i less the losses of the gears. The rotor's inertia stands in D(q),
    as N² J, so the torque that accelerates the rotor is part of u already. Driving (torque along speed, or at
    rest), u = N η kt i; braking, the gears help and u = N kt i / η: `find_passed_on`. Voltages are steady,
    R i + kt N ω.

    Attributes:
        motor: the motor; most methods need its `torque_constant` and `resistance`.
        gearbox: gearbox between motor and joint.
        bus: V of the supply, in V.
        current_limit: limit of the amplifier, in A; None leaves the resistance as the only limit.
    """

    motor: Motor
    gearbox: Gearbox
    bus: float
    current_limit: float | None = None

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Drive.bus", self.bus, lambda v: v > 0, "a number > 0, in V")
        if self.current_limit is not None:
            require("Drive.current_limit", self.current_limit, lambda i: i > 0, "a number > 0, in A, or None")

    @property
    def constant(self) -> float:
        """N kt, in N·m/A or V·s/rad at the joint."""
        return gear_constant(self.motor, self.gearbox)

    @property
    def reflected_inertia(self) -> float:
        """N² J, of rotor and gears, in kg·m²."""
        return self.gearbox.ratio**2 * (self.motor.known("rotor_inertia") + self.gearbox.inertia)

    @property
    def no_load_speed(self) -> float:
        """Joint speed at which the back-EMF equals the supply, V / (N kt), in rad/s."""
        return self.bus / self.constant

    @property
    def stall_torque(self) -> float:
        """Peak torque at rest, N η kt V / R or that of the current limit, in N·m; gears may not stand it."""
        return float(self.envelope(0.0))

    @property
    def continuous_torque(self) -> float:
        """Continuous torque at the joint, in N·m, within the limits of gearbox and amplifier."""
        gear = self.gearbox
        torque = gear.ratio * gear.efficiency * self.motor.continuous_torque
        if self.current_limit is not None:
            torque = min(torque, gear.efficiency * self.constant * self.current_limit)
        return torque if gear.max_torque is None else min(torque, gear.max_torque)

    @property
    def continuous_speed(self) -> float:
        """Joint speed up to which the supply still gives the continuous torque, in rad/s; 0 if it never does."""
        drop = self.motor.known("resistance") * float(self.current(self.continuous_torque, 0.0))
        return max(0.0, self.bus - drop) / self.constant

    def torque(self, current: ArrayLike, speed: ArrayLike) -> Array:
        """Returns the joint torque for a motor current, in N·m; inverts `current`."""
        amperes, rate = _arrays(current=current, speed=speed)
        return np.asarray(self.constant * amperes * find_passed_on(self.gearbox.efficiency, amperes, rate))[()]

    def current(self, torque: ArrayLike, speed: ArrayLike) -> Array:
        """Returns the motor current, in A: u / (N η kt) when driving, u η / (N kt) when braking.

        Args:
            torque: u at the joint, in N·m.
            speed: speed of the joint, in rad/s, broadcast against the torque.

        Raises:
            BadValue: shapes do not fit or a number is not finite (as in every method).
        """
        effort, rate = _arrays(torque=torque, speed=speed)
        return np.asarray(effort / (self.constant * find_passed_on(self.gearbox.efficiency, effort, rate)))[()]

    def voltage(self, torque: ArrayLike, speed: ArrayLike) -> Array:
        """Returns the voltage at the terminals, R i + kt N ω, in V."""
        return self.motor.known("resistance") * self.current(torque, speed) + self.constant * np.asarray(speed)

    def envelope(self, speed: ArrayLike) -> Array:
        """Returns the greatest positive torque at a signed joint speed, in N·m; the least is -envelope(-speed).

        The current is (V - kt N ω) / R or the current limit, whichever is less. At negative speed the motor
        brakes, and the back-EMF adds to the supply. Above the no-load speed the envelope is negative: the
        back-EMF drives current into the supply, through the bridge's diodes at least, and the motor brakes.
        """
        (rate,) = _arrays(speed=speed)
        current = (self.bus - self.constant * rate) / self.motor.known("resistance")
        limit = np.inf if self.current_limit is None else self.current_limit
        return self.torque(np.minimum(current, limit), rate)

    def margin(self, torque: ArrayLike, speed: ArrayLike) -> Array:
        """Returns available minus required torque, in N·m, in the torque's direction; negative if not available.

        Above the no-load speed a torque can also brake too little; the margin then is minus the missing torque.
        Above the motor's `max_speed` it is -inf.
        """
        effort, rate = _arrays(torque=torque, speed=speed)
        along = np.where(effort == 0, np.abs(rate), np.sign(effort) * rate)  # speed, seen along the torque
        least, required = -self.envelope(-along), np.abs(effort)
        margin = self.envelope(along) - required
        margin = np.where(least > 0, np.minimum(margin, required - least), margin)
        fastest = np.inf if self.motor.max_speed is None else self.motor.max_speed / self.gearbox.ratio
        return np.where(np.abs(rate) > fastest, -np.inf, margin)[()]

    def worst(self, torque: ArrayLike, speed: ArrayLike) -> Worst:
        """Finds the point with the least margin, for torques and speeds of one dimension."""
        effort, rate = _arrays(torque=torque, speed=speed)
        if effort.ndim != 1 or not effort.size:
            raise BadValue("torque", effort, "an array of one dimension, not empty")
        margins = self.margin(effort, rate)
        index = int(np.argmin(margins))
        return Worst(index, float(effort[index]), float(rate[index]), float(margins[index]))

    def joule_power(self, torque: ArrayLike, speed: ArrayLike) -> Array:
        """Returns the heat of the winding, i² R, in W."""
        return self.motor.known("resistance") * np.square(self.current(torque, speed))

    def bus_power(self, torque: ArrayLike, speed: ArrayLike) -> Array:
        """Returns the electrical power at the terminals, V i, in W, which an ideal amplifier takes from the supply."""
        return self.voltage(torque, speed) * self.current(torque, speed)


def drawn_power(power: ArrayLike, regeneration: float) -> Array:
    """Returns the power that the supply loses, max(P, 0) + η_r min(P, 0), in W; its integral is the energy drawn.

    Args:
        power: electrical power P at the terminals, in W, see `Drive.bus_power`.
        regeneration: η_r, the share of negative power that the supply gets back: 0 none, 1 all.
    """
    require("regeneration", regeneration, lambda eta: 0 <= eta <= 1, "a number in [0, 1]")
    watts = np.asarray(power, dtype=float)
    return np.asarray(np.maximum(watts, 0.0) + regeneration * np.minimum(watts, 0.0))[()]


def _arrays(**values: ArrayLike) -> list[Array]:
    """Returns values as arrays of floats of one shape."""
    try:
        arrays = [np.asarray(value, dtype=float) for value in values.values()]
        shaped = np.broadcast_arrays(*arrays)
    except (TypeError, ValueError):
        raise BadValue(" and ".join(values), tuple(values.values()), "numbers whose shapes broadcast") from None
    for name, array in zip(values, arrays, strict=True):
        if not np.isfinite(array).all():
            raise BadValue(name, array, "finite numbers")
    return list(shaped)
