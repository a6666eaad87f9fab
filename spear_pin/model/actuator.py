"""Actuator between a commanded torque and a joint: current loop, bridge, battery, motor and gearbox.

The controller asks for the current i* = τ*/(N kt), as the source's τ = k_τ i has it. The current follows at once,
or with the bandwidth of its loop, as far as battery, amplifier and the winding's heat let it; gears then take
their share. Power is accounted for from the battery to the joint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from spear_pin.errors import BadValue, require
from spear_pin.model.bridge import Battery
from spear_pin.model.motor import Gearbox, Motor, geared_constant, passed_on_creeping

CREEP = 0.05  # rad/s at the joint
FOLD = 0.1  # of the continuous current's square, over which the limit falls from peak to continuous


@dataclass(frozen=True)
class Thermal:
    """i²t protection as drives do it: the mean square of the current, forgotten exponentially, is limited.

    Attributes:
        continuous: current that may flow for ever, in A.
        time_constant: over which the square is averaged, in s.
    """

    continuous: float
    time_constant: float

    def __post_init__(self) -> None:
        """Check the fields."""
        require("Thermal.continuous", self.continuous, lambda i: i > 0, "a number > 0, in A")
        require("Thermal.time_constant", self.time_constant, lambda tau: tau > 0, "a number > 0, in s")


class Power(NamedTuple):
    """Where the power of an actuator goes at an instant, in W.

    Attributes:
        battery: what the battery's cell gives; negative where it is charged.
        joule: heat of winding and battery.
        gearbox: lost in the gears.
        joint: what the joint gets.
        stored: what the inductance takes up.
        torque: at the joint, in N·m.
    """

    battery: float
    joule: float
    gearbox: float
    joint: float
    stored: float
    torque: float


@dataclass(frozen=True)
class Actuator:
    """A current-controlled motor behind a gearbox. Its rotor's inertia stands in D(q), not here.

    The bridge is an average of its switching, without loss. Beyond the no-load speed the back-EMF forces a
    current into the battery, (V - e)/(R + R_b), whatever the current limit; the drop of the diodes is neglected.

    Attributes:
        motor: needs `torque_constant` and `resistance`; `inductance` where there is a bandwidth.
        gearbox: ratio and efficiency. Its efficiency acts on the torque, η driving and 1/η braking.
        battery: behind the bridge, its own. Of the two duties at which a sagging battery gives the same, the
            lesser is taken; that beyond its best one more current could be had at less duty is not used.
        current_limit: of the amplifier, in A; infinite for none.
        bandwidth: of the current loop, in Hz; None: the current follows at once.
        thermal: i²t protection, if there is any.
    """

    motor: Motor
    gearbox: Gearbox
    battery: Battery = Battery()
    current_limit: float = math.inf
    bandwidth: float | None = None
    thermal: Thermal | None = None

    def __post_init__(self) -> None:
        """Check the fields."""
        self.motor.known("torque_constant")
        self.motor.known("resistance")
        if self.current_limit != math.inf:
            require("Actuator.current_limit", self.current_limit, lambda i: i > 0, "a number > 0, in A")
        if self.thermal is not None and not self.current_limit < math.inf:
            raise BadValue("Actuator.current_limit", self.current_limit, "finite, in A, for i²t protection to reduce")
        if self.bandwidth is not None:
            require("Actuator.bandwidth", self.bandwidth, lambda f: f > 0, "a number > 0, in Hz, or None")
            self.motor.known("inductance")

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of what has a memory: current, in A, and the mean square of the current, in A²."""
        return ("current",) * (self.bandwidth is not None) + ("square",) * (self.thermal is not None)

    @cached_property
    def constant(self) -> float:
        """N kt, in N·m/A or V·s/rad at the joint."""
        return geared_constant(self.motor, self.gearbox)

    @cached_property
    def _resistance(self) -> float:
        return self.motor.known("resistance")

    @cached_property
    def _circuit(self) -> float:
        """Resistance of winding and battery, in Ω."""
        return self._resistance + self.battery.resistance

    def reference(self, torque: float) -> float:
        """i* = τ*/(N kt), in A."""
        return torque / self.constant

    def current(self, torque: float, speed: float, x: dict[str, float]) -> float:
        """The current that flows, in A, when a torque is commanded at a joint speed."""
        return x["current"] if "current" in x else self._held(self._limited(self.reference(torque), x), speed)

    def slopes(self, torque: float, speed: float, x: dict[str, float]) -> dict[str, float]:
        """Rates of change of the states."""
        found: dict[str, float] = {}
        if self.bandwidth is not None:
            wanted = 2.0 * math.pi * self.bandwidth * (self._limited(self.reference(torque), x) - x["current"])
            found["current"] = min(max(wanted, self._fastest(-1.0, speed, x)), self._fastest(1.0, speed, x))
        if self.thermal is not None:
            current = self.current(torque, speed, x)
            found["square"] = (current**2 - x["square"]) / self.thermal.time_constant
        return found

    def torque(self, current: float, speed: float) -> float:
        """Torque at the joint, N kt i times η where it drives, over η where it brakes, in N·m.

        It changes from one to the other within about `CREEP`, where gears would stick: the joint creeps instead.
        """
        return self.constant * current * passed_on_creeping(self.gearbox.efficiency, current, speed, CREEP)

    def power(self, current: float, speed: float, current_slope: float = 0.0) -> Power:
        """Where the power goes; battery = joule + gearbox + joint + stored."""
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
        """Energy of the inductance, in J."""
        return 0.5 * (self.motor.inductance or 0.0) * x.get("current", 0.0) ** 2

    def _limited(self, current: float, x: dict[str, float]) -> float:
        limit = self.current_limit
        if self.thermal is not None and limit > self.thermal.continuous:
            continuous = self.thermal.continuous
            spare = (continuous**2 - x["square"]) / (FOLD * continuous**2)
            limit = continuous + (limit - continuous) * min(max(spare, 0.0), 1.0)
        return min(max(current, -limit), limit)

    def _held(self, current: float, speed: float) -> float:
        """The current that the battery's voltage leaves of one that is wanted."""
        emf = self.constant * speed
        voltage, total = self.battery.voltage, self._circuit
        return min(max(current, (-voltage - emf) / total), (voltage - emf) / total)

    def _fastest(self, side: float, speed: float, x: dict[str, float]) -> float:
        """Slope of the current at full voltage to one side, in A/s."""
        drop = self._circuit * x["current"] + self.constant * speed
        return (side * self.battery.voltage - drop) / self.motor.known("inductance")

    def _drawn(self, terminals: float) -> float:
        """Power of the battery's cell, in W, when the bridge takes some power from it."""
        voltage, resistance = self.battery.voltage, self.battery.resistance
        # V I - R I² = P, the lesser root; written so that a small R costs no digits
        inside = max(voltage**2 - 4.0 * resistance * terminals, 0.0)
        return voltage * 2.0 * terminals / (voltage + math.sqrt(inside))
