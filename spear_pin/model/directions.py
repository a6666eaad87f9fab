"""Directions in which the ground acts on a toe: in the plane, in space or, for a leg on a boom, round its post.

A boom carries its leg round a post, and sways: the toe yields towards the post. So contact has two directions, as in
the plane: along the circle about the post on which the toe stands, and vertically. With the toe's velocity u and its
azimuth ψ about the post they are s = (-sin ψ, cos ψ, 0) and z. s turns with the toe, at ψ̇ = s·u/ρ, so that

    d/dt (s·u) = s·u̇ - ψ̇ (r·u),  r = (cos ψ, sin ψ, 0).

A sticking toe keeps the ψ at which it landed.

A round foot of radius r rolls on level ground: what touches is r below the toe, its centre, and with the foot's rate ω
about y it moves along x at v_x - r ω. Where the foot rolls that is zero. Beyond the ends of its arc it stands on a
point, at some (x, z) from the centre, which moves at (v_x + z ω, v_z - x ω).

Arguments `data` have the kinematics at a state, including velocities if a toe's acceleration is needed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.round_feet import RoundFoot
from spear_pin.model.scalars import dot, times

WORLD_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class Axes:
    """Axes of the world: x and z, or all three.

    Attributes:
        dimension: 2 or 3.
        feet: the round feet in the plane, by the numbers of their frames.
    """

    dimension: int
    feet: Mapping[int, RoundFoot] = field(default_factory=dict)

    def standing(self, parts: Mapping[int, Sequence[float]]) -> Axes:
        """Returns the axes where round feet stand on given parts of their arcs, by the numbers of their frames."""
        feet = {frame: replace(self.feet[frame], ends=ends) for frame, ends in parts.items()}
        return replace(self, feet={**self.feet, **feet}) if feet else self

    def place(self, model: pin.Model, data: pin.Data, frame: int) -> Array:
        """Returns where a frame touches, or would touch, in the world, (3,), in m."""
        place: Array = np.array(pin.updateFramePlacement(model, data, frame).translation)
        if frame in self.feet:
            place[::2] += self.feet[frame].lever(model, data, frame)[0]
        return place

    def along(self, model: pin.Model, data: pin.Data, frame: int, motions: Array) -> Array:
        """Returns the components where a frame touches of motions in the world, (6, ...), linear and angular."""
        found = motions[0 : 3 : 4 - self.dimension]
        if frame in self.feet:
            x, z = self.feet[frame].lever(model, data, frame)[0]
            found = np.array([found[0] + z * motions[4], found[1] - x * motions[4]])
        return found

    def accelerated(self, model: pin.Model, data: pin.Data, frame: int, acceleration: Array) -> Array:
        """Returns the rate of velocity components where a frame touches, from its acceleration in the world, (6,)."""
        found = self.along(model, data, frame, acceleration)
        if frame in self.feet:
            lever, beyond = self.feet[frame].lever(model, data, frame)
            if beyond:
                rate = pin.getFrameVelocity(model, data, frame, WORLD_ALIGNED).angular[1]
                found = found - rate**2 * lever
        return found

    def world(self, components: Array, places: Callable[[], Array]) -> Array:
        """Returns vectors in the world, (..., 3), from components; `places`, (..., 3), is called only if needed."""
        return components if components.shape[-1] == 3 else np.insert(components, 1, 0.0, axis=-1)


@dataclass(frozen=True)
class Round:
    """Directions along a circle about a post, to the left about z, and vertically.

    Attributes:
        post: position of the post, x and y, in m.
        feet: none, as in `Axes`.
    """

    post: tuple[float, float]
    feet: ClassVar[Mapping[int, RoundFoot]] = {}

    def standing(self, parts: Mapping[int, Sequence[float]]) -> Round:
        """Returns itself, as its toes are points."""
        return self

    def place(self, model: pin.Model, data: pin.Data, frame: int) -> Array:
        """Returns the position of a frame in the world, (3,), in m."""
        return np.array(pin.updateFramePlacement(model, data, frame).translation)

    @property
    def dimension(self) -> int:
        """Number of directions, 2."""
        return 2

    def along(self, model: pin.Model, data: pin.Data, frame: int, motions: Array) -> Array:
        """Returns the components along the circle on which the frame is, and vertically."""
        x, y, radius = self._arm(model, data, frame)
        return np.array([(x * motions[1] - y * motions[0]) / radius, motions[2]])

    def accelerated(self, model: pin.Model, data: pin.Data, frame: int, acceleration: Array) -> Array:
        """Returns the acceleration's components, minus the effect of the rotation of the circle's direction."""
        x, y, radius = self._arm(model, data, frame)
        ahead, up = self.along(model, data, frame, acceleration)
        vx, vy, _ = pin.getFrameVelocity(model, data, frame, WORLD_ALIGNED).linear
        return np.array([ahead - (x * vy - y * vx) * (x * vx + y * vy) / radius**3, up])

    def world(self, components: Array, places: Callable[[], Array]) -> Array:
        """Returns the vectors of components along the circles through `places`, and vertically."""
        arms = places()[..., :2] - self.post
        ahead = components[..., 0] / np.linalg.norm(arms, axis=-1)
        return np.stack([-ahead * arms[..., 1], ahead * arms[..., 0], components[..., 1]], axis=-1)

    def moving(
        self, place: Sequence[Any], rows: Sequence[Sequence[Any]], drift: Sequence[Any], v: Sequence[Any], ops: Any
    ) -> tuple[list[list[Any]], tuple[Any, Any]]:
        """Returns J, two rows of nv, and J̇ v, in m/s², along the circle and vertically, for scalars of any kind.

        Args:
            place: position of the toe in the world, x, y and z in m.
            rows: its J in the world, three rows of nv.
            drift: its J̇ v in the world, in m/s².
            v: nv scalars.
            ops: has `sqrt` for them.
        """
        x, y = place[0] - self.post[0], place[1] - self.post[1]
        radius = ops.sqrt(x * x + y * y)
        ahead = [times(x, across) - times(y, along) for along, across in zip(rows[0], rows[1], strict=True)]
        outward = times(x, dot(rows[0], v)) + times(y, dot(rows[1], v))
        turning = dot(ahead, v) * outward / (radius * radius)
        along = (x * drift[1] - y * drift[0] - turning) / radius
        return [[each / radius for each in ahead], list(rows[2])], (along, drift[2])

    def _arm(self, model: pin.Model, data: pin.Data, frame: int) -> tuple[float, float, float]:
        """Returns x, y and the distance from the post to a frame, in m."""
        place = pin.updateFramePlacement(model, data, frame).translation
        x, y = float(place[0]) - self.post[0], float(place[1]) - self.post[1]
        return x, y, hypot(x, y)


Directions = Axes | Round
"""Components of vectors in the world along the directions of contact, the vertical one last."""
