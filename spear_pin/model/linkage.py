"""A slider that a crank pushes: the spring that it compresses, its torque as a table, and its place as a path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.path import Path, Posture, Slope, replace_unchecked

FINE = 1000  # number of angles at which a range is searched for the beginning of the spring


@typed
@dataclass(frozen=True)
class SliderLinkage:
    """A compression spring along the thigh, pushed by a slider that a rod joins to a crank on the shank.

    In the thigh's axes, with the origin at the knee, the crank's pin is at c sin φ toward the hip and c cos φ across.
    The slider's rail is at e across, and the slider at s(φ) = c sin φ + √(r² - (e - c cos φ)²) toward the hip. The
    spring acts between the slider and a stop at a toward the hip. Its length is a - s(φ), and its compression is
    x = l₀ - a + s(φ). Where x is negative the spring is loose, as it only pushes. The torque toward extension is
    k x ds/dφ, the derivative of the energy k x²/2.

    Attributes:
        stiffness: k, in N/m.
        free_length: l₀, in m.
        crank: c, distance from the knee to the pin, in m.
        rod: r, distance from the pin to the slider, in m.
        stop: a, distance from the knee to the spring's end along the thigh, in m.
        offset: e, distance of the slider's rail from the knee across the thigh, in m.
    """

    stiffness: float
    free_length: float
    crank: float
    rod: float
    stop: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        for field in fields(self)[:-1]:
            unit = "N/m" if field.name == "stiffness" else "m"
            require(
                f"SliderLinkage.{field.name}", getattr(self, field.name), lambda x: x > 0, f"a number > 0, in {unit}"
            )
        reach = self.rod - self.crank
        require("SliderLinkage.offset", self.offset, lambda e: abs(e) < reach, "a number within ±(rod - crank), in m")

    def compression(self, angle: ArrayLike) -> Array:
        """Returns the compression x, in m; negative where the spring is loose.

        Args:
            angle: φ, in rad: how far the knee is flexed beyond the angle at which the crank is normal to the thigh.
        """
        place, _ = slider(self.crank, self.rod, self.offset, np.asarray(angle, dtype=float))
        return np.asarray(self.free_length - self.stop + place)

    def lever(self, angle: ArrayLike) -> Array:
        """Returns ds/dφ, in m, at an angle φ, in rad, see `compression`."""
        return np.asarray(slider(self.crank, self.rod, self.offset, np.asarray(angle, dtype=float))[1])

    def torque(self, angle: ArrayLike) -> Array:
        """Returns the torque toward extension, in N·m, at an angle φ, in rad, see `compression`."""
        return np.asarray(self.stiffness * np.maximum(self.compression(angle), 0.0) * self.lever(angle))

    def energy(self, angle: ArrayLike) -> Array:
        """Returns the energy that the spring stores, in J, at an angle φ, in rad, see `compression`."""
        return 0.5 * self.stiffness * np.maximum(self.compression(angle), 0.0) ** 2

    def begin(self, low: float, high: float) -> float:
        """Finds the least angle between `low` and `high` at which compression of the spring begins, in rad.

        Raises:
            BadValue: compression does not begin between them.
        """
        angles = np.linspace(low, high, FINE)
        x = self.compression(angles)
        found = np.flatnonzero((x[:-1] <= 0.0) & (x[1:] > 0.0))
        if not len(found):
            raise BadValue("angles", (low, high), "two angles, in rad, between which compression of the spring begins")
        i = int(found[0])
        return float(scipy.optimize.brentq(self.compression, angles[i], angles[i + 1], xtol=1e-14))

    def table(self, begin: float, deflections: Sequence[float]) -> tuple[tuple[float, float], ...]:
        """Returns the points of `Spring.table`.

        Args:
            begin: angle at which the table has its (0, 0), in rad, see `begin`.
            deflections: deflections beyond it, increasing, in rad.
        """
        torques = self.torque(begin + np.asarray(deflections, dtype=float))
        return (0.0, 0.0), *zip(map(float, deflections), torques.tolist(), strict=True)


def slider(crank: Any, rod: Any, offset: Any, angle: Any, ops: Any = np) -> tuple[Any, Any]:
    """Returns the place s(φ) of a linkage's slider, in m, and ds/dφ, for scalars of any kind; see `SliderLinkage`.

    Args:
        crank: c, in m.
        rod: r, in m.
        offset: e, in m.
        angle: φ, in rad.
        ops: elementary functions.
    """
    cosine, sine = ops.cos(angle), ops.sin(angle)
    across = offset - crank * cosine
    beyond = ops.sqrt(rod * rod - across * across)
    return crank * sine + beyond, crank * (cosine - sine * across / beyond)


@typed
@dataclass(frozen=True)
class Linkage(Path):
    """How far a slider has moved that a rod joins to a crank on a joint, see `SliderLinkage`.

    Attributes:
        joint: the joint.
        crank: c, distance from the joint to the pin, in m.
        rod: r, distance from the pin to the slider, in m.
        offset: e, distance of the slider's rail from the joint, in m.
        zero: angle of the joint at which φ is zero, in rad.
        side: +1 if φ grows with the joint's angle, else -1.
        turned: -1 if the joint's angle is counted the other way, else 1.

    Example:
        >>> from spear_pin import Linkage
        >>> Linkage("knee", 0.03, 0.12, offset=0.01).rod  # m
        0.12
    """

    joint: str
    crank: float
    rod: float
    offset: float = 0.0
    zero: float = 0.0
    side: float = 1.0
    turned: float = 1.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in ("crank", "rod"):
            require(f"Linkage.{name}", getattr(self, name), lambda length: length > 0, "a number > 0, in m")
        reach = self.rod - self.crank
        require("Linkage.offset", self.offset, lambda e: abs(e) < reach, "a number within ±(rod - crank), in m")
        require("Linkage.zero", self.zero, lambda angle: abs(angle) >= 0, "a finite number, in rad")
        require("Linkage.side", self.side, lambda side: abs(side) == 1, "1 or -1")

    def length(self, posture: Posture) -> Any:
        """Returns the slider's place s(φ)."""
        return self._slider(posture)[0]

    def slope(self, posture: Posture) -> Slope:
        """Returns ds/dφ, with the sign of the side."""
        return Slope({posture.index(self.joint): self.turned * self.side * self._slider(posture)[1]})

    def indices(self, posture: Posture) -> list[int]:
        """Returns that of its joint."""
        return [posture.index(self.joint)]

    @property
    def numbers(self) -> Mapping[str, Any]:
        """Crank, rod, offset and the zero."""
        return {name: getattr(self, name) for name in ("crank", "rod", "offset", "zero")}

    @property
    def units(self) -> Mapping[str, str]:
        """All lengths in m, the zero in rad."""
        return {**dict.fromkeys(self.numbers, "m"), "zero": "rad"}

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path of another linkage."""
        return replace_unchecked(self, **numbers)

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path of the same linkage on another joint."""
        return replace_unchecked(self, joint=names.get(self.joint, self.joint), turned=side * self.turned)

    @property
    def turns(self) -> bool:
        """Tells that the length is none of an angle."""
        return False

    def _slider(self, posture: Posture) -> tuple[Any, Any]:
        phi = self.side * (self.turned * posture.angle(self.joint) - self.zero)
        return slider(self.crank, self.rod, self.offset, phi, posture.ops)
