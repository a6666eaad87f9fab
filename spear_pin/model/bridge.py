"""The bridge between a battery and a motor (Figs. 4.8, 4.9), and the current that flows in each of its states.

A brushless motor is taken line to line, two of its three phases in series at a time, as `Motor` is; six-step
commutation keeps the back-EMF across them at kt N ω. Voltages and currents are those of the motor's terminals.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName, require

State = Literal["open", "coast", "short"]
STATES: tuple[State, ...] = get_args(State)


@dataclass(frozen=True)
class Battery:
    """A voltage behind a resistance.

    Attributes:
        voltage: voltage without load, in V (source: Section 2.4.5, 24 V).
        resistance: internal resistance, in Ω (assumption: none).
    """

    voltage: float = 24.0
    resistance: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Battery.voltage", self.voltage, lambda v: v > 0, "a number > 0, in V")
        require("Battery.resistance", self.resistance, lambda r: r >= 0, "a number >= 0, in Ω")


@dataclass(frozen=True)
class Bridge:
    """Switches and diodes.

    Attributes:
        diode: forward voltage of a diode, in V (assumption); the path has two diodes.
    """

    diode: float = 0.7

    def __post_init__(self) -> None:
        """Checks the field."""
        require("Bridge.diode", self.diode, lambda v: v >= 0, "a number >= 0, in V")


def back_emf(torque_constant: float, ratio: float, speed: ArrayLike) -> Array:
    """Returns the voltage of a motor turned from outside, K_v N ω, (4.8) without its sign, in V.

    Args:
        torque_constant: kt in N·m/A, which is K_v in V·s/rad.
        ratio: gear ratio N.
        speed: speed of the joint, in rad/s. The source's 34.5 V at 20 rad/s refer to the joint, not to the rotor.
    """
    return np.asarray(torque_constant * ratio * np.asarray(speed, dtype=float))[()]


def conduction_threshold(battery: Battery, bridge: Bridge) -> float:
    """Returns the back-EMF above which the diodes conduct although all switches are open, V + 2 V_d, in V."""
    return battery.voltage + 2.0 * bridge.diode


def idle_current(
    state: State, emf: ArrayLike, resistance: float, battery: Battery | None = None, bridge: Bridge | None = None
) -> Array:
    """Returns the steady current of a motor that is turned from outside without a command, in A.

    Args:
        state: "open": no circuit, the power supply disconnected; "coast": all switches open, the bridge's
            diodes towards the battery, through which the motor charges it above the threshold; "short": the
            phases shorted, brake.
        emf: back-EMF, in V.
        resistance: resistance at the motor's terminals, in Ω.
        battery: battery behind the bridge (default: 24 V).
        bridge: diodes of the bridge (default: 0.7 V each).

    Returns:
        The current, positive if it brakes, against the back-EMF.

    Raises:
        UnknownName: an unknown state.
    """
    require("resistance", resistance, lambda r: r > 0, "a number > 0, in Ω")
    volts = np.asarray(emf, dtype=float)
    if state == "open":
        return np.zeros_like(volts)[()]
    if state == "short":
        return np.asarray(-volts / resistance)[()]
    if state != "coast":
        raise UnknownName("state of the bridge", state, STATES)
    battery, bridge = battery or Battery(), bridge or Bridge()
    excess = np.maximum(np.abs(volts) - conduction_threshold(battery, bridge), 0.0)
    return np.asarray(-np.sign(volts) * excess / (resistance + battery.resistance))[()]


def shorted_damping(torque_constant: float, ratio: float, resistance: float) -> float:
    """Returns the damping of the joint by a shorted motor, N² kt² / R, in N·m·s/rad."""
    require("resistance", resistance, lambda r: r > 0, "a number > 0, in Ω")
    return (ratio * torque_constant) ** 2 / resistance
