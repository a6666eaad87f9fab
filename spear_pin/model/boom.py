"""A rotary boom in place of the slider: an arm that turns about a pivot, with the leg at its end.

SPEAR-I hung on one of about 2 m. Hopping in place the arm only rises and falls. A parallel linkage keeps the leg's
plane upright, so that the motion in that plane is the slider's, and the whole leg moves sideways besides, on the arc.
Nothing holds the toe sideways. The height stays the coordinate, and what the arc and the arm add is inertia on it:

    sin φ = (z - z_pivot)/R,  μ(z) = m tan²φ + I/(R cos φ)²,  μ z̈ + ½ μ′ ż² on the left of its equation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue, require
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
HEIGHT = "boom_z"
REACH = 0.9  # of the radius, above and below the pivot: the height is no coordinate where the arm stands upright


@dataclass(frozen=True)
class RotaryBoom:
    """The arm.

    Attributes:
        radius: from the pivot to the hip, in m (source: about 2 m, of SPEAR-I).
        pivot: its height, in m (assumption: that of the hip in stance and flight, on the average).
        inertia: of the arm about the pivot, in kg·m² (assumption; its own weight is balanced).
    """

    radius: float = 2.0
    pivot: float = 0.58
    inertia: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        require("RotaryBoom.radius", self.radius, lambda radius: radius > 0, "a number > 0, in m")
        require("RotaryBoom.pivot", self.pivot, lambda height: abs(height) >= 0, "a finite number, in m")
        require("RotaryBoom.inertia", self.inertia, lambda inertia: inertia >= 0, "a number >= 0, in kg·m²")

    def elevation(self, height: ArrayLike) -> Array:
        """φ of the arm for heights of its end, in rad; not a number beyond its reach."""
        with np.errstate(invalid="ignore"):
            return np.asarray(np.arcsin((np.asarray(height, dtype=float) - self.pivot) / self.radius))

    def sideways(self, height: ArrayLike) -> Array:
        """How far the end is drawn towards the pivot, R (1 - cos φ), in m."""
        return np.asarray(self.radius * (1.0 - np.cos(self.elevation(height))))

    def added(self, height: float, mass: float) -> tuple[float, float]:
        """Inertia μ on the height, in kg, and its derivative μ′, in kg/m, with a mass at the end.

        Raises:
            ValueError: the height is not within the arm's reach.
        """
        sine = (height - self.pivot) / self.radius
        square = 1.0 - sine * sine
        if not abs(sine) <= REACH:
            raise ValueError("beyond the arm's reach")
        arm = self.inertia / self.radius**2
        return (mass * sine * sine + arm) / square, 2.0 * sine * (mass + arm) / (self.radius * square**2)


class BoomedRobot(Robot):
    """A robot with its height on a rotary boom; queries include what that adds.

    Attributes:
        boom: the arm.
    """

    def __init__(self, robot: Robot, boom: RotaryBoom) -> None:
        super().__init__(
            robot.model.copy(),
            name=robot.name,
            toes=robot.toes,
            actuated=robot.actuated,
            locked=robot.locked,
            source=robot.source,
            varied=robot.varied,
        )
        self.boom = boom
        self._slider = robot
        self._row = self.index(HEIGHT)
        self._rotor = float(robot.model.armature[self._row])
        self._moving = float(sum(inertia.mass for inertia in list(robot.model.inertias)[1:]))
        aloft = np.zeros(self.nq)
        aloft[self._row] = boom.pivot + 0.1 * boom.radius
        self.mount(aloft, np.zeros(self.nv))  # no longer the model that was loaded: it cannot be varied

    def __reduce__(self) -> tuple[object, ...]:
        return BoomedRobot, (self._slider, self.boom)

    def mount(self, q: Array, v: Array) -> float:
        """Put what is added at q into the model, and return ½ μ′ ż², in N, which the model does not have.

        Raises:
            ValueError: the height is not within the arm's reach.
        """
        added, slope = self.boom.added(float(q[self._row]), self._moving)
        self.model.armature[self._row] = self._rotor + added
        return 0.5 * slope * float(v[self._row]) ** 2

    @property
    def row(self) -> int:
        """Row of the height."""
        return self._row

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> Array:
        """C(q, v), (nv, nv), with Ḋ - 2C skew-symmetric."""
        matrix, rates = super().coriolis_matrix(q, v), self._v(v)
        _, slope = self.boom.added(float(self._q(q)[self._row]), self._moving)
        matrix[self._row, self._row] += 0.5 * slope * float(rates[self._row])
        return matrix

    def bias(self, q: ArrayLike, v: ArrayLike) -> Array:
        """C(q, v) v + G(q), (nv,), in N or N·m."""
        vector = super().bias(q, v)
        vector[self._row] += self.mount(self._q(q), self._v(v))
        return vector

    def _q(self, q: ArrayLike) -> Array:
        vector = super()._q(q)
        try:
            self.mount(vector, np.zeros(self.nv))
        except ValueError:
            low, high = (self.boom.pivot + side * REACH * self.boom.radius for side in (-1.0, 1.0))
            expected = f"within the arm's reach, {low:g} to {high:g} m"
            raise BadValue(f"q[{self._row}]", float(vector[self._row]), expected) from None
        return vector


def on_rotary_boom(robot: Robot, boom: RotaryBoom | None = None) -> BoomedRobot:
    """The same robot on a rotary boom in place of its slider, the given one being left alone.

    Vary the robot before. A saved gait does not keep the boom.

    Args:
        robot: planar, its height the coordinate `boom_z`, `boom_x` locked.
        boom: the arm.

    Raises:
        BadValue: the robot can move forward, or is no such robot.
    """
    if not robot.planar or HEIGHT not in robot.coordinates or "boom_x" in robot.coordinates:
        raise BadValue("robot", robot, f"a planar robot with the height {HEIGHT}, and boom_x locked")
    if isinstance(robot, BoomedRobot):
        raise BadValue("robot", robot, "one on its slider")
    return BoomedRobot(robot, boom or RotaryBoom())
