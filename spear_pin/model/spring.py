"""The switchable parallel spring (Sw-PEA): latched at touchdown, released at lift-off."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from spear_pin.errors import require
from spear_pin.kinds import typed

STIFFEST = 1e6  # N·m/rad: at a knee as good as rigid
UNITS = {"stiffness": "N·m/rad", "damping": "N·m·s/rad", "hardening": "N·m/rad³", "preload": "N·m"}


@typed
@dataclass(frozen=True)
class Spring:
    """A rotational spring and damper in parallel with a joint, in action while its switch is engaged.

    The torque on the joint is -(τ₀ + k δ + k₃ δ³) - b θ̇, where δ = θ - θ_td is counted from the angle latched at
    touchdown and positive in flexion: with τ₀ = k₃ = 0 the corrected (3.24)-(3.25). The physical spring is a chain in
    tension: it pulls only beyond θ_td.

    Attributes:
        stiffness: k_rot, in N·m/rad (source: Table 4.2, with motor).
        damping: b, in N·m·s/rad, acting in stance only (source: Table 4.2, with motor).
        unilateral: whether it pulls only beyond the latched angle; False is the linear idealisation.
        rest: the angle of a spring that is never switched (a fixed parallel spring), in rad; None: switched,
            latched at touchdown and let go at lift-off. Its damper acts in stance only, as the other's. Hops take
            it, bounds do not.
        hardening: k₃, in N·m/rad³.
        preload: τ₀ with which it pulls as soon as it does, in N·m. A stop holds the spring as far as that stretched,
            so that the torque jumps at the latched angle, and what it stored before it was latched is not counted.
            Only a spring that is unilateral has one: another rests where it does not pull.
    """

    stiffness: float = 48.84
    damping: float = 1.3
    unilateral: bool = True
    rest: float | None = None
    hardening: float = 0.0
    preload: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        for name, unit in UNITS.items():
            within = f"a number from 0 to {STIFFEST:g}, in {unit}"
            require(f"Spring.{name}", getattr(self, name), lambda number: (number >= 0) & (number <= STIFFEST), within)
        if not self.unilateral:
            require("Spring.preload", self.preload, lambda torque: torque == 0, "0 of a spring that is not unilateral")
        if self.rest is not None:
            require("Spring.rest", self.rest, lambda angle: abs(angle) < math.pi, "within ±π rad, or None")

    # its law, of whatever scalars the fields and the arguments are

    def torque(self, deflection: Any) -> Any:
        """Torque toward flexion while it pulls, without the damper's, in N·m, (3.24).

        Args:
            deflection: how far the joint is flexed beyond the angle at which it rests, in rad.
        """
        return -(self.preload + deflection * (self.stiffness + self.hardening * deflection * deflection))

    def drag(self, rate: Any) -> Any:
        """Torque of the damper on a joint that turns at a rate in rad/s, in N·m, (3.25)."""
        return -self.damping * rate

    def energy(self, deflection: Any) -> Any:
        """Energy that it stores while it pulls, in J: the integral of minus its torque.

        Args:
            deflection: how far the joint is flexed beyond the angle at which it rests, in rad.
        """
        square = deflection * deflection
        return self.preload * deflection + square * (0.5 * self.stiffness + 0.25 * self.hardening * square)


@typed
def rotational_stiffness(spring: float, spacer_radius: float, belt: float = 0.0, pulley_radius: float = 0.0) -> float:
    """k_rot = 2 k_belt r_pulley² + k_S1 r_spacer², (3.5)-(3.6), in N·m/rad.

    Args:
        spring: k_S1, in N/m.
        spacer_radius: r_spacer, in m.
        belt: k_belt, in N/m.
        pulley_radius: r_pulley, in m.
    """
    return 2.0 * belt * pulley_radius**2 + spring * spacer_radius**2


@typed
def belt_stiffness(modulus: float, area: float, length: float, radius: float) -> float:
    """k_rotBelt = 2 E A r² / L₀, (4.5)-(4.7), in N·m/rad: both strands of a timing belt about its pulley.

    Args:
        modulus: E, in Pa. That of the rubber alone ignores the belt's cords, which are far stiffer.
        area: A of one strand, in m².
        length: L₀ of one strand, in m.
        radius: r of the pulley, in m.

    Raises:
        BadValue: a number that is not positive.
    """
    for name, value in (("modulus", modulus), ("area", area), ("length", length), ("radius", radius)):
        require(name, value, lambda number: number > 0, "a number > 0")
    return 2.0 * modulus * area * radius**2 / length
