"""A spring that a linkage compresses as the knee flexes: its torque at the knee, and that as a spring's table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import scipy
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed

FINE = 1000  # angles at which a range is looked through for where the spring begins


@typed
@dataclass(frozen=True)
class SliderLinkage:
    """A compression spring along the thigh, pushed by a slider that a rod joins to a crank on the shank.

    In the thigh, seen from the knee: the crank's pin is c sin φ toward the hip and c cos φ across, the slider's rail e
    across, and the slider by the rod's reach further on, s(φ) = c sin φ + √(r² - (e - c cos φ)²) toward the hip. The
    spring is between it and a stop, a toward the hip: it is a - s(φ) long, x = l₀ - a + s(φ) less than when it is free.
    Where that is negative the spring lies loose: it only pushes. The torque toward extension is k x ds/dφ, the
    derivative of the energy k x²/2.

    Attributes:
        stiffness: k, in N/m.
        free_length: l₀, in m.
        crank: c, from the knee to the pin, in m.
        rod: r, from the pin to the slider, in m.
        stop: a, from the knee to the spring's end, along the thigh, in m.
        offset: e, of the slider's rail from the knee, across, in m.
    """

    stiffness: float
    free_length: float
    crank: float
    rod: float
    stop: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        for field in fields(self)[:-1]:
            unit = "N/m" if field.name == "stiffness" else "m"
            require(
                f"SliderLinkage.{field.name}", getattr(self, field.name), lambda x: x > 0, f"a number > 0, in {unit}"
            )
        reach = self.rod - self.crank
        require("SliderLinkage.offset", self.offset, lambda e: abs(e) < reach, "a number, in m, within rod less crank")

    def compression(self, angle: ArrayLike) -> Array:
        """x, in m; negative where the spring lies loose.

        Args:
            angle: φ, in rad: how far the knee is flexed beyond the crank square to the thigh.
        """
        phi = np.asarray(angle, dtype=float)
        return np.asarray(self.free_length - self.stop + self.crank * np.sin(phi) + self._along(phi))

    def lever(self, angle: ArrayLike) -> Array:
        """ds/dφ, in m, at an angle as of `compression`."""
        phi = np.asarray(angle, dtype=float)
        across = self.offset - self.crank * np.cos(phi)
        return np.asarray(self.crank * (np.cos(phi) - np.sin(phi) * across / self._along(phi)))

    def torque(self, angle: ArrayLike) -> Array:
        """Torque toward extension, in N·m, at an angle as of `compression`."""
        return np.asarray(self.stiffness * np.maximum(self.compression(angle), 0.0) * self.lever(angle))

    def energy(self, angle: ArrayLike) -> Array:
        """Energy that the spring stores, in J, at an angle as of `compression`."""
        return 0.5 * self.stiffness * np.maximum(self.compression(angle), 0.0) ** 2

    def begin(self, low: float, high: float) -> float:
        """The least angle between two at which the spring begins to be compressed, in rad.

        Raises:
            BadValue: it does not begin between them.
        """
        angles = np.linspace(low, high, FINE)
        x = self.compression(angles)
        found = np.flatnonzero((x[:-1] <= 0.0) & (x[1:] > 0.0))
        if not len(found):
            raise BadValue("angles", (low, high), "two between which the spring begins to be compressed")
        i = int(found[0])
        return float(scipy.optimize.brentq(self.compression, angles[i], angles[i + 1], xtol=1e-14))

    def table(self, begin: float, deflections: Sequence[float]) -> tuple[tuple[float, float], ...]:
        """Points of `Spring.table`.

        Args:
            begin: as of `begin`, where the table has its (0, 0), in rad.
            deflections: beyond it, rising, in rad.
        """
        torques = self.torque(begin + np.asarray(deflections, dtype=float))
        return (0.0, 0.0), *zip(map(float, deflections), torques.tolist(), strict=True)

    def _along(self, phi: Array) -> Array:
        """How far the slider is beyond the pin, in m."""
        return np.sqrt(self.rod**2 - (self.offset - self.crank * np.cos(phi)) ** 2)
