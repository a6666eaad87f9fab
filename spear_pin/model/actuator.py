"""Actuator between a commanded torque and a joint: current loop, bridge, battery, motor and gearbox.

The controller commands the current i* = τ*/(N kt), by the source's τ = k_τ i. The current follows immediately, or with
the bandwidth of its loop, within the limits of battery, amplifier and winding heat; gears then take their share. Power
is accounted for from the battery to the joint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from spear_pin.errors import BadValue, require
from spear_pin.model.bridge import Battery
from spear_pin.model.motor import Gearbox, Motor, find_passed_on_creeping, gear_constant

CREEP = 0.05  # rad/s at the joint
FOLD = 0.1  # share of the continuous current's square over which the limit falls from peak to continuous


@dataclass(frozen=True)
class Thermal:
    """i²t protection as in drives: it limits the mean square of the current, with exponential forgetting.

    Attributes:
        continuous: current that may flow for ever, in A.
        time_constant: time over which the square is averaged, in s.
    """

    continuous: float
    time_constant: float

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Thermal.continuous", self.continuous, lambda i: i > 0, "a number > 0, in A")
        require("Thermal.time_constant", self.time_constant, lambda tau: tau > 0, "a number > 0, in s")


class Power(NamedTuple):
    """Power balance of an actuator at an instant, in W.

    Attributes:
        battery: power from the battery's cell; negative while it is charged.
        joule: heat of winding and battery.
        gearbox: power lost in the gears.
        joint: power at the joint.
        stored: power into the inductance.
        torque: torque at the joint, in N·m.
    """

    battery: float
    joule: float
    gearbox: float
    joint: float
    stored: float
    torque: float


@dataclass(frozen=True)
class Actuator:
    """A current-controlled motor behind a gearbox. D(q) has its rotor's inertia, not this class.

    The bridge is averaged over its switching, without loss. Above the no-load speed the back-EMF forces a current into
    the battery, (V - e)/(R + R_b), whatever the current limit; the drop of the diodes is neglected.

    Attributes:
        motor: the motor; it needs `torque_constant` and `resistance`, and `inductance` if there is a bandwidth.
        gearbox: ratio and efficiency. The efficiency acts on the torque, η when driving and 1/η when braking.
        battery: the actuator's own battery behind the bridge. A sagging battery gives the same power at two duties, of
            which the lesser is taken; the model ignores that beyond the best duty less duty gives more current.
        current_limit: limit of the amplifier, in A; infinite for none.
        bandwidth: bandwidth of the current loop, in Hz; None if the current follows immediately.
        thermal: i²t protection, if there is any.
    """

    motor: Motor
    gearbox: Gearbox
    battery: Battery = Battery()
    current_limit: float = math.inf
    bandwidth: float | None = None
    thermal: Thermal | None = None

    def __post_init__(self) -> None:
        """Checks the fields."""
        self.motor.known("torque_constant")
        self.motor.known("resistance")
        if self.current_limit != math.inf:
            require("Actuator.current_limit", self.current_limit, lambda i: i > 0, "a number > 0, in A")
        if self.thermal is not None and not self.current_limit < math.inf:
            raise BadValue(
                "Actuator.current_limit",
                self.current_limit,
                "a finite number, in A, which thermal (i²t) protection reduces",
            )
        if self.bandwidth is not None:
            require("Actuator.bandwidth", self.bandwidth, lambda f: f > 0, "a number > 0, in Hz, or None")
            self.motor.known("inductance")

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states: current, in A, and the mean square of the current, in A²."""
        return ("current",) * (self.bandwidth is not None) + ("square",) * (self.thermal is not None)

    @cached_property
    def constant(self) -> float:
        """N kt, in N·m/A or V·s/rad at the joint."""
        return gear_constant(self.motor, self.gearbox)

    @cached_property
    def _resistance(self) -> float:
        return self.motor.known("resistance")

    @cached_property
    def _circuit(self) -> float:
        """Resistance of winding and battery, in Ω."""
        return self._resistance + self.battery.resistance

    def reference(self, torque: float) -> float:
        """Returns the commanded current i* = τ*/(N kt), in A."""
        return torque / self.constant

    def current(self, torque: float, speed: float, x: dict[str, float]) -> float:
        """Returns the current that flows when a torque is commanded at a joint speed, in A."""
        return x["current"] if "current" in x else self._held(self._limited(self.reference(torque), x), speed)

    def slopes(self, torque: float, speed: float, x: dict[str, float]) -> dict[str, float]:
        """Returns the rates of change of the states."""
        found: dict[str, float] = {}
        if self.bandwidth is not None:
            wanted = 2.0 * math.pi * self.bandwidth * (self._limited(self.reference(torque), x) - x["current"])
            found["current"] = min(max(wanted, self._fastest(-1.0, speed, x)), self._fastest(1.0, speed, x))
        if self.thermal is not None:
            current = self.current(torque, speed, x)
            found["square"] = (current**2 - x["square"]) / self.thermal.time_constant
        return found

    def torque(self, current: float, speed: float) -> float:
        """Returns the torque at the joint, in N·m: N kt i times η when driving, divided by η when braking.

        It changes from one to the other within about `CREEP`. There gears would stick; in this model the joint creeps.
        """
        return self.constant * current * find_passed_on_creeping(self.gearbox.efficiency, current, speed, CREEP)

    def power(self, current: float, speed: float, current_slope: float = 0.0) -> Power:
        """Returns the power balance: battery = joule + gearbox + joint + stored."""
        stored = (self.motor.inductance or 0.0) * current * current_slope
        shaft = self.constant * current * speed
        heat = self._resistance * current**2
        terminals = heat + shaft + stored
        battery = self._drawn(terminals)
        inside = self.battery.resistance * (battery / self.battery.voltage) ** 2
        torque = self.torque(current, speed)
        joint = torque * speed
        return Power(battery, heat + inside, shaft - joint, joint, stored, torque)

    def stored(self, x: dict[str, float]) -> float:
        """Returns the energy of the inductance, in J."""
        return 0.5 * (self.motor.inductance or 0.0) * x.get("current", 0.0) ** 2

    def _limited(self, current: float, x: dict[str, float]) -> float:
        limit = self.current_limit
        if self.thermal is not None and limit > self.thermal.continuous:
            continuous = self.thermal.continuous
            spare = (continuous**2 - x["square"]) / (FOLD * continuous**2)
            limit = continuous + (limit - continuous) * min(max(spare, 0.0), 1.0)
        return min(max(current, -limit), limit)

    def _held(self, current: float, speed: float) -> float:
        """Limits a wanted current to the current that the battery's voltage allows."""
        emf = self.constant * speed
        voltage, total = self.battery.voltage, self._circuit
        return min(max(current, (-voltage - emf) / total), (voltage - emf) / total)

    def _fastest(self, side: float, speed: float, x: dict[str, float]) -> float:
        """Returns the slope of the current at full voltage to one side, in A/s."""
        drop = self._circuit * x["current"] + self.constant * speed
        return (side * self.battery.voltage - drop) / self.motor.known("inductance")

    def _drawn(self, terminals: float) -> float:
        """Returns the power of the battery's cell, in W, when the bridge takes power from the battery."""
        voltage, resistance = self.battery.voltage, self.battery.resistance
        # the lesser root of V I - R I² = P, written so that a small R costs no digits
        inside = max(voltage**2 - 4.0 * resistance * terminals, 0.0)
        return voltage * 2.0 * terminals / (voltage + math.sqrt(inside))
