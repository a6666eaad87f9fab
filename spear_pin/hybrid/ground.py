"""The ground: a rigid plane, level or sloped; contact is described along it and normal to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, brief, require
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.dynamics import FLOATS, Operations
from spear_pin.hybrid.own import call_function, is_own, mistake, number
from spear_pin.kinds import typed
from spear_pin.model.mechanism import Feet, Terms
from spear_pin.model.robot import Robot
from spear_pin.model.scalars import plus, times

PLACE = ("slope", "height")  # its numbers besides friction
STEEPEST = 1.2  # rad: steeper slopes are walls
SHAPE = frozenset({"above", "axes", "under"})  # methods that a ground of another shape overrides
HIGHEST = 10.0  # m: far from zero, rounding of coordinates hides changes of guards


@typed
@dataclass(frozen=True)
class Ground(Contact):
    """A plane, z = height + x tan(slope), its axes along it, (cos σ, sin σ), and normal to it, (-sin σ, cos σ).

    Its numbers may be of any kind, including symbols and arrays of lanes. If the slope is the number zero, no vector is
    rotated.

    Attributes:
        friction: coefficient of Coulomb friction, static and kinetic (assumption; not in the source).
        slope: σ, in rad, positive uphill in +x.
        height: height of the plane at x = 0, in m.

    Example:
        >>> from spear_pin import Ground, hopping, load
        >>> hopping(load("spear_ii"), ground=Ground(slope=0.1)).ground.slope
        0.1
    """

    slope: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        super().__post_init__()
        steep = f"an angle within ±{STEEPEST:g} rad"
        require("Ground.slope", self.slope, lambda angle: abs(angle) <= STEEPEST, steep)
        high = f"a number within ±{HIGHEST:g} m"
        require("Ground.height", self.height, lambda height: abs(height) <= HIGHEST, high)

    @property
    def level(self) -> bool:
        """Tells whether its axes are those of the world."""
        return _is_zero(self.slope)

    @property
    def plain(self) -> bool:
        """Tells whether the ground is a level plane at height zero."""
        return self.plane and self.level and _is_zero(self.height)

    @property
    def plane(self) -> bool:
        """Tells whether the ground is a plane."""
        return type(self).above is Ground.above

    def __init_subclass__(cls, **options: Any) -> None:
        """Makes mistakes in a subclass's methods come out as such."""
        super().__init_subclass__(**options)
        if is_own(cls):
            for name in SHAPE & vars(cls).keys():
                setattr(cls, name, _reporting(vars(cls)[name]))

    def axes(self, x: Any, z: Any, ops: Operations = FLOATS) -> tuple[Any, Any]:
        """Returns the tangential and normal component of a vector (x, z), or of a row of vectors if given arrays."""
        if self.level:
            return x, z
        return _turned(x, z, ops.cos(self.slope), ops.sin(self.slope))

    def seen_in(self, vector: Any, ops: Operations = FLOATS) -> tuple[Any, ...]:
        """Returns the components along the ground and normal to it of a vector (x, z) or (x, y, z), or of rows."""
        x, *across, z = vector
        along, normal = self.axes(x, z, ops)
        return along, *across, normal

    def world(self, along: Any, normal: Any) -> tuple[Any, Any]:
        """Returns the vector (x, z) with these components along the ground and normal to it; inverts `axes`."""
        return _turned(along, normal, math.cos(self.slope), -math.sin(self.slope))

    def above(self, x: Any, z: Any, ops: Operations = FLOATS) -> Any:
        """Returns the distance of a point from the ground, along its normal, in m; negative below the ground."""
        _, normal = self.axes(x, z, ops)
        if _is_zero(self.height):
            return normal
        return normal - (self.height if self.level else self.height * ops.cos(self.slope))

    def under(self, x: float) -> float:
        """Returns the height z of the plane at x, in m."""
        return self.height + x * math.tan(self.slope)

    def seen(self, feet: Feet | Terms, ops: Any) -> Feet:
        """Returns the toes in the ground's axes, with positions along and above it; `ops` are for their scalars."""
        if self.plain:
            return Feet(feet.positions, feet.jacobians, feet.drifts)
        places: dict[str, tuple[Any, ...]] = {}
        for toe, (x, *across, z) in feet.positions.items():
            places[toe] = self.axes(x, z, ops)[0], *across, self.above(x, z, ops)
        turned = {
            toe: [list(row) for row in zip(*(self.seen_in(each, ops) for each in zip(*rows, strict=True)), strict=True)]
            for toe, rows in feet.jacobians.items()
        }
        return Feet(places, turned, {toe: self.seen_in(drift, ops) for toe, drift in feet.drifts.items()})

    def foot(self, robot: Robot, q: ArrayLike, toe: str) -> tuple[float, Array]:
        """Returns a toe's distance from the ground, in m, and its Jacobian in the ground's axes, (2 or 3, nv)."""
        (x, *_, z), jacobian = robot.toe_position(q, toe), robot.toe_jacobian(q, toe)
        seen = np.array(self.seen_in(jacobian))
        if toe in robot.guided:
            seen[0] = 0.0  # whatever loops leave of it by rounding
        return float(self.above(x, z, FLOATS)), seen


def _reporting(function: Callable[..., Any]) -> Callable[..., Any]:
    """Wraps a method of a user's ground, so that a mistake in it is reported where it is called with numbers."""

    @wraps(function)
    def reporting(self: Ground, *arguments: Any, **named: Any) -> Any:
        what, plain = f"ground {type(self).__name__}", all(isinstance(each, Real) for each in arguments[:2])
        if not plain:
            return function(self, *arguments, **named)
        answer = call_function(what, function, lambda: function(self, *arguments, **named))
        if function.__name__ != "axes":
            return number(what, function, answer)
        if not isinstance(answer, (tuple, list, np.ndarray)) or len(answer) != 2:
            raise mistake(what, function, f"it gives {brief(answer)}; expected two components, along and normal to it")
        return tuple(number(what, function, each) for each in answer)

    return reporting


def refuse_slopes(robot: Robot, ground: Ground) -> None:
    """Refuses ground that is not level for a robot with round feet, or with toes that move up and down only.

    Raises:
        BadValue: the ground has a slope or a shape.
    """
    if ground.level and ground.plane:
        return
    for what, toes in (("round feet", robot.radii), ("toes on a vertical guide", robot.guided)):
        if toes:
            raise BadValue("ground", ground, f"slope=0 and no shape of its own, as the robot has {what}")


def as_ground(contact: Contact) -> Ground:
    """Returns a ground as it is, and for a contact the level ground at height zero with its friction."""
    return contact if isinstance(contact, Ground) else Ground(contact.friction)


def choose_ground(contact: Contact | None, ground: Ground | None) -> Contact:
    """Returns the ground of a gait from two arguments of which one may be given; else the default.

    Raises:
        BadValue: both are given.
    """
    if contact is not None and ground is not None:
        raise BadValue(
            "ground",
            ground,
            f"one of ground and contact, not both: contact is {contact}, and each describes the whole ground",
        )
    return ground or contact or Contact()


def _turned(x: Any, z: Any, cosine: Any, sine: Any) -> tuple[Any, Any]:
    return plus(times(cosine, x), times(sine, z)), plus(times(cosine, z), times(-sine, x))


def _is_zero(value: Any) -> bool:
    return isinstance(value, Real) and value == 0
