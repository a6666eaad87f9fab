"""The ground: a rigid plane, level or sloped, in whose axes all of contact is said: along it and normal to it."""

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
from spear_pin.hybrid.own import asked, is_own, mistake, number
from spear_pin.kinds import typed
from spear_pin.model.planar import Feet, Terms
from spear_pin.model.robot import Robot
from spear_pin.model.scalars import plus, times

STEEPEST = 1.2  # rad: steeper slopes are walls
SHAPE = frozenset({"above", "axes", "under"})  # methods that a ground of another shape has of its own
HIGHEST = 10.0  # m: far from zero, rounding of coordinates hides how guards change


@typed
@dataclass(frozen=True)
class Ground(Contact):
    """A plane, z = height + x tan(slope), its axes along it, (cos σ, sin σ), and normal to it, (-sin σ, cos σ).

    Numbers may be of any kind, symbols and arrays of lanes among them; of a slope that is the number zero nothing is
    turned.

    Attributes:
        friction: coefficient of Coulomb friction, static and kinetic (assumption; not in the source).
        slope: σ, in rad, positive uphill in +x.
        height: of the plane at x = 0, in m.

    Example:
        >>> from spear_pin import Ground, hopping, load
        >>> hopping(load("spear_ii"), ground=Ground(slope=0.1)).ground.slope
        0.1
    """

    slope: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        super().__post_init__()
        steep = f"an angle within ±{STEEPEST:g} rad"
        require("Ground.slope", self.slope, lambda angle: abs(angle) <= STEEPEST, steep)
        high = f"a number within ±{HIGHEST:g} m"
        require("Ground.height", self.height, lambda height: abs(height) <= HIGHEST, high)

    @property
    def level(self) -> bool:
        """Whether its axes are those of the world."""
        return _is_zero(self.slope)

    @property
    def plain(self) -> bool:
        """Whether it is level, at height zero, and no other shape than a plane."""
        return self.plane and self.level and _is_zero(self.height)

    @property
    def plane(self) -> bool:
        """Whether it is of no other shape than a plane."""
        return type(self).above is Ground.above

    def __init_subclass__(cls, **options: Any) -> None:
        """Have mistakes in what another shape says of itself come out as such."""
        super().__init_subclass__(**options)
        if is_own(cls):
            for name in SHAPE & vars(cls).keys():
                setattr(cls, name, _reporting(vars(cls)[name]))

    def axes(self, x: Any, z: Any, ops: Operations = FLOATS) -> tuple[Any, Any]:
        """Tangential and normal component of a vector (x, z), or of a row of vectors if those are arrays."""
        if self.level:
            return x, z
        return _turned(x, z, ops.cos(self.slope), ops.sin(self.slope))

    def seen_in(self, vector: Any, ops: Operations = FLOATS) -> tuple[Any, ...]:
        """A vector (x, z) or (x, y, z), or rows of them, along the ground and normal to it, in that order."""
        x, *across, z = vector
        along, normal = self.axes(x, z, ops)
        return along, *across, normal

    def world(self, along: Any, normal: Any) -> tuple[Any, Any]:
        """A vector (x, z) of its components along the ground and normal to it, the inverse of `axes`."""
        return _turned(along, normal, math.cos(self.slope), -math.sin(self.slope))

    def above(self, x: Any, z: Any, ops: Operations = FLOATS) -> Any:
        """Distance of a point from the ground, along its normal, in m; negative below it."""
        _, normal = self.axes(x, z, ops)
        if _is_zero(self.height):
            return normal
        return normal - (self.height if self.level else self.height * ops.cos(self.slope))

    def under(self, x: float) -> float:
        """Height z of the plane, in m."""
        return self.height + x * math.tan(self.slope)

    def seen(self, feet: Feet | Terms, ops: Any) -> Feet:
        """Toes in its axes, their positions along and above it; `ops` are for their scalars."""
        if self.plain:
            return Feet(feet.positions, feet.jacobians, feet.drifts)
        places = {toe: (self.axes(*place, ops)[0], self.above(*place, ops)) for toe, place in feet.positions.items()}
        turned = {
            toe: [list(row) for row in zip(*(self.axes(x, z, ops) for x, z in zip(*rows, strict=True)), strict=True)]
            for toe, rows in feet.jacobians.items()
        }
        return Feet(places, turned, {toe: self.axes(*drift, ops) for toe, drift in feet.drifts.items()})

    def foot(self, robot: Robot, q: ArrayLike, toe: str) -> tuple[float, Array]:
        """Distance of a toe from the ground, in m, and its Jacobian along and normal to it, (2, nv) or (3, nv)."""
        (x, *_, z), jacobian = robot.toe_position(q, toe), robot.toe_jacobian(q, toe)
        return float(self.above(x, z, FLOATS)), np.array(self.seen_in(jacobian))


def _reporting(function: Callable[..., Any]) -> Callable[..., Any]:
    """A method of ground of one's own that says what a mistake in it is, where it is asked with numbers."""

    @wraps(function)
    def reporting(self: Ground, *arguments: Any, **named: Any) -> Any:
        what, plain = f"ground {type(self).__name__}", all(isinstance(each, Real) for each in arguments[:2])
        if not plain:
            return function(self, *arguments, **named)
        answer = asked(what, function, lambda: function(self, *arguments, **named))
        if function.__name__ != "axes":
            return number(what, function, answer)
        if not isinstance(answer, (tuple, list, np.ndarray)) or len(answer) != 2:
            raise mistake(what, function, f"it gives {brief(answer)}; expected two components, along and normal to it")
        return tuple(number(what, function, each) for each in answer)

    return reporting


def as_ground(contact: Contact) -> Ground:
    """The ground itself, or the level one at height zero that has a contact's friction."""
    return contact if isinstance(contact, Ground) else Ground(contact.friction)


def given(contact: Contact | None, ground: Ground | None) -> Contact:
    """The ground of a gait, of two arguments one of which may be given; else the default.

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
