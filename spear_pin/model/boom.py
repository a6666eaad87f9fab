"""A rotary boom in place of the slider: an arm that turns about a pivot, with the leg at its end.

SPEAR-I hung on one of about 2 m. Hopping in place the arm only rises and falls. A parallel linkage keeps the leg's
plane upright, so that the motion in that plane is the slider's, and the whole leg moves sideways besides, on the arc.
Nothing holds the toe sideways. The height stays the coordinate, and what the arc and the arm add is inertia on it:

    sin φ = (z - z_pivot)/R,  μ(z) = m tan²φ + I/(R cos φ)²,  μ z̈ + ½ μ′ ż² on the left of its equation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

HEIGHT = "boom_z"
REACH = 0.9  # of the radius, above and below the pivot; where the arm stands upright the height is no coordinate


@typed
@dataclass(frozen=True)
class RotaryBoom:
    """The arm of a rotary boom.

    Attributes:
        radius: distance from the pivot to the hip, in m (source: about 2 m, of SPEAR-I).
        pivot: height of the pivot, in m (assumption: mean height of the hip in stance and flight).
        inertia: inertia of the arm about the pivot, in kg·m² (assumption; its own weight is balanced).
    """

    radius: float = 2.0
    pivot: float = 0.58
    inertia: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("RotaryBoom.radius", self.radius, lambda radius: radius > 0, "a number > 0, in m")
        require("RotaryBoom.pivot", self.pivot, lambda height: abs(height) >= 0, "a finite number, in m")
        require("RotaryBoom.inertia", self.inertia, lambda inertia: inertia >= 0, "a number >= 0, in kg·m²")

    def elevation(self, height: ArrayLike) -> Array:
        """Returns the arm's angle φ for heights of its end, in rad; NaN beyond its reach."""
        with np.errstate(invalid="ignore"):
            return np.asarray(np.arcsin((np.asarray(height, dtype=float) - self.pivot) / self.radius))

    def sideways(self, height: ArrayLike) -> Array:
        """Returns how far the arm's end moves towards the pivot, R (1 - cos φ), in m."""
        return np.asarray(self.radius * (1.0 - np.cos(self.elevation(height))))


@dataclass(frozen=True)
class Arm:
    """Inertia that a rotary boom adds to a robot at its end, as `Robot.added`.

    Attributes:
        boom: the arm.
        row: index of the height among the coordinates.
        mass: mass at the end of the arm, in kg.
    """

    boom: RotaryBoom
    row: int
    mass: float

    def __call__(self, q: Array) -> tuple[int, float, float]:
        """Returns the index of the height, the inertia μ on it, in kg, and μ′, in kg/m.

        Raises:
            BadValue: the height is not within the arm's reach.
        """
        boom, height = self.boom, float(q[self.row])
        sine = (height - boom.pivot) / boom.radius
        if not abs(sine) <= REACH:
            low, high = (boom.pivot + side * REACH * boom.radius for side in (-1.0, 1.0))
            raise BadValue(f"q[{self.row}]", height, f"within the arm's reach, {low:g} to {high:g} m")
        square, arm = 1.0 - sine * sine, boom.inertia / boom.radius**2
        slope = 2.0 * sine * (self.mass + arm) / (boom.radius * square**2)
        return self.row, (self.mass * sine * sine + arm) / square, slope


@typed
def on_rotary_boom(robot: Robot, boom: RotaryBoom | None = None) -> Robot:
    """Returns a robot on a rotary boom in place of its slider; the given one is left unchanged.

    A saved gait does not keep the boom.

    Args:
        robot: a planar robot with the height as coordinate `boom_z`, and `boom_x` locked.
        boom: the arm.

    Raises:
        BadValue: the robot can move forward, or is no such robot.
    """
    if not robot.planar or HEIGHT not in robot.coordinates or "boom_x" in robot.coordinates:
        raise BadValue("robot", robot, f"a planar robot with the height {HEIGHT}, and boom_x locked")
    if robot.added is not None:
        raise BadValue("robot", robot, "one without a rotary boom")
    moving = float(sum(inertia.mass for inertia in list(robot.model.inertias)[1:]))
    return robot.with_model(robot.model, base=robot.base, added=Arm(boom or RotaryBoom(), robot.index(HEIGHT), moving))
