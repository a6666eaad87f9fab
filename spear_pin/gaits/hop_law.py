"""The part of a hop's law that does not depend on where the spring is: angles at touchdown, gains, the square wave."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from spear_pin.errors import require
from spear_pin.gaits.inputs import ANGLE, Input
from spear_pin.kinds import typed


@typed
@dataclass(frozen=True)
class HopLaw:
    """Parameters of the controller of a leg that hops in place, which its subclasses describe.

    Attributes:
        units: units of these numbers, by name.
        inputs: numbers that event feedback may adjust, for SPEAR-II.
    """

    knee_touchdown: float = 1.0
    hip_touchdown: float | None = None
    stance_torque: float = 8.0
    frequency: float = 2.56
    hip_gain: float = 54.77
    hip_damping: float = 1.37
    knee_gain: float = 63.25
    knee_damping: float = 0.52
    units: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("knee_touchdown", "hip_touchdown"), "rad"),
        **dict.fromkeys(("hip_gain", "knee_gain"), "N·m/rad"),
        **dict.fromkeys(("hip_damping", "knee_damping"), "N·m·s/rad"),
        "stance_torque": "N·m",
        "frequency": "Hz",
    }
    inputs: ClassVar[Mapping[str, Input]] = {"stance_torque": Input(2.0, 4.0, True), "hip_touchdown": ANGLE}

    def __post_init__(self) -> None:
        """Checks the fields."""
        of = type(self).__name__
        require(f"{of}.frequency", self.frequency, lambda f: f > 0, "a number > 0, in Hz")
        for name in ("knee_touchdown", "hip_touchdown"):
            if (angle := getattr(self, name)) is not None:
                require(f"{of}.{name}", angle, lambda a: abs(a) < math.pi, "within ±π rad")
        for name in ("stance_torque", "hip_gain", "hip_damping", "knee_gain", "knee_damping"):
            require(f"{of}.{name}", getattr(self, name), lambda gain: gain >= 0, "a number >= 0")

    @property
    def hip_commanded(self) -> float:
        """Commanded hip angle at touchdown, in rad."""
        return 0.5 * self.knee_touchdown if self.hip_touchdown is None else self.hip_touchdown
