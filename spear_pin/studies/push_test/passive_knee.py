"""Torques on the knee of the push test: its spring, friction, and the braking of a motor without command.

The law of the spring is that of `Spring`. The law of a motion with events is that of the hybrid system, see
`motion.released`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.kinds import typed
from spear_pin.model.spring import STIFFEST, Spring

MOST = 1e30  # N·m of dry friction: with more, forces are no numbers


@typed
@dataclass(frozen=True)
class PassiveKnee:
    """Torque on the knee while no motor acts: -k (θ - θ₀) - b θ̇ - τ_c sign θ̇, in N·m.

    In the push test the spring stays engaged, its zero is an angle of its own, and it acts both ways.

    Attributes:
        stiffness: k_rot, in N·m/rad (default: source Table 4.1, with motor, 10 cm).
        damping: b, in N·m·s/rad (default: source Table 4.1, with motor, 10 cm).
        coulomb: τ_c, in N·m; the source has none.
        zero: θ₀, the angle at which the spring is slack, in rad (default: RA of Table 4.1, read so).
        unilateral: whether the spring pulls only beyond its zero, like a chain.
        braking: addition of a motor without command to b beyond a rate, in N·m·s/rad (see `power_off`).
        braking_from: that rate, in rad/s.
    """

    stiffness: float = 48.25
    damping: float = 1.03
    coulomb: float = 0.0
    zero: float = 1.0
    unilateral: bool = False
    braking: float = 0.0
    braking_from: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name, unit, most in (
            ("stiffness", "N·m/rad", STIFFEST),
            ("damping", "N·m·s/rad", STIFFEST),
            ("coulomb", "N·m", MOST),
        ):
            expected = f"a number >= 0, at most {most:g}, in {unit}"
            require(f"PassiveKnee.{name}", getattr(self, name), lambda number: 0 <= number <= most, expected)  # noqa: B023
        require("PassiveKnee.braking", self.braking, lambda b: b >= 0, "a number >= 0, in N·m·s/rad")
        require("PassiveKnee.braking_from", self.braking_from, lambda r: r >= 0, "a number >= 0, in rad/s")
        require("PassiveKnee.zero", self.zero, lambda z: abs(z) < np.inf, "an angle, in rad")

    @property
    def spring(self) -> Spring:
        """The spring and its damper."""
        return Spring(self.stiffness, self.damping, self.unilateral)

    def braking_torque(self, rate: Any, maximum: Callable[[Any, float], Any] = np.maximum) -> Any:
        """Returns the motor's torque against the motion beyond a rate, in N·m, for scalars that `maximum` takes."""
        forward, backward = maximum(rate - self.braking_from, 0.0), maximum(-rate - self.braking_from, 0.0)
        return -self.braking * (forward - backward)

    def torque(self, angle: ArrayLike, rate: ArrayLike, pulls: ArrayLike, direction: ArrayLike) -> Array:
        """Returns the whole torque, in N·m.

        Args:
            angle: θ, in rad.
            rate: θ̇, in rad/s.
            pulls: 1 where the spring acts, 0 where it is slack.
            direction: direction of the motion for dry friction, -1, 0 or 1.
        """
        elastic = np.asarray(pulls) * self.spring.torque(np.asarray(angle) - self.zero)
        viscous = self.spring.drag(np.asarray(rate)) + self.braking_torque(np.asarray(rate))
        return np.asarray(elastic + viscous - self.coulomb * np.asarray(direction))

    def spring_torque(self, angle: ArrayLike) -> Array:
        """Returns -k (θ - θ₀), in N·m."""
        stretch = np.asarray(angle) - self.zero
        return np.asarray(self.spring.torque(np.maximum(stretch, 0.0) if self.unilateral else stretch))


WITH_MOTOR = PassiveKnee(stiffness=48.25, damping=1.03, zero=1.0)  # Table 4.1, 10 cm
WITHOUT_MOTOR = PassiveKnee(stiffness=47.12, damping=0.80, zero=1.0)
