"""Directions in which the ground acts on a toe: those of the plane, of space, or, of a leg on a boom, round its post.

A boom carries its leg round a post, and sways: towards the post the toe yields. So contact has two directions there, as
in the plane, along the circle about the post on which the toe stands, and vertically. With u the toe's velocity and ψ
its azimuth about the post they are s = (-sin ψ, cos ψ, 0) and z; s turns with the toe, at ψ̇ = s·u/ρ, so that

    d/dt (s·u) = s·u̇ - ψ̇ (r·u),  r = (cos ψ, sin ψ, 0).

A toe that sticks keeps its ψ, wherever it stood when it came down.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot
from typing import Protocol

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array

WORLD_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Directions(Protocol):
    """Components of what is in the world along the directions of contact, the vertical one last.

    `data` has the kinematics at a state, of velocities too where a toe's acceleration is asked for.
    """

    @property
    def dimension(self) -> int:
        """How many there are, 2 or 3."""

    def along(self, model: pin.Model, data: pin.Data, frame: int, vectors: Array) -> Array:
        """Components of vectors in the world, (3, ...), at a frame."""

    def accelerated(self, model: pin.Model, data: pin.Data, frame: int, acceleration: Array) -> Array:
        """Rate of the components of a frame's velocity, by its acceleration in the world, (3,), in m/s²."""

    def world(self, components: Array, places: Callable[[], Array]) -> Array:
        """Vectors in the world, (..., 3), of components at places, (..., 3), which are asked for where they count."""


@dataclass(frozen=True)
class Axes:
    """Axes of the world: x and z, or all three.

    Attributes:
        dimension: 2 or 3.
    """

    dimension: int

    def along(self, model: pin.Model, data: pin.Data, frame: int, vectors: Array) -> Array:
        """Rows of the vectors."""
        return vectors[0 : 3 : 4 - self.dimension]

    def accelerated(self, model: pin.Model, data: pin.Data, frame: int, acceleration: Array) -> Array:
        """Rows of the acceleration."""
        return acceleration[0 : 3 : 4 - self.dimension]

    def world(self, components: Array, places: Callable[[], Array]) -> Array:
        """The components, with none along y where there are two."""
        return components if components.shape[-1] == 3 else np.insert(components, 1, 0.0, axis=-1)


@dataclass(frozen=True)
class Round:
    """Along a circle about a post, to the left about z, and vertically.

    Attributes:
        post: its place, x and y, in m.
    """

    post: tuple[float, float]

    @property
    def dimension(self) -> int:
        """There are two."""
        return 2

    def along(self, model: pin.Model, data: pin.Data, frame: int, vectors: Array) -> Array:
        """Along the circle on which the frame is, and vertically."""
        x, y, radius = self._arm(model, data, frame)
        return np.array([(x * vectors[1] - y * vectors[0]) / radius, vectors[2]])

    def accelerated(self, model: pin.Model, data: pin.Data, frame: int, acceleration: Array) -> Array:
        """The acceleration's components, less what the turn of the circle's direction takes of them."""
        x, y, radius = self._arm(model, data, frame)
        ahead, up = self.along(model, data, frame, acceleration)
        vx, vy, _ = pin.getFrameVelocity(model, data, frame, WORLD_ALIGNED).linear
        return np.array([ahead - (x * vy - y * vx) * (x * vx + y * vy) / radius**3, up])

    def world(self, components: Array, places: Callable[[], Array]) -> Array:
        """Vectors of what is along the circles on which places are, and vertical."""
        arms = places()[..., :2] - self.post
        ahead = components[..., 0] / np.linalg.norm(arms, axis=-1)
        return np.stack([-ahead * arms[..., 1], ahead * arms[..., 0], components[..., 1]], axis=-1)

    def _arm(self, model: pin.Model, data: pin.Data, frame: int) -> tuple[float, float, float]:
        """From the post to a frame, x, y and the distance, in m."""
        place = pin.updateFramePlacement(model, data, frame).translation
        x, y = float(place[0]) - self.post[0], float(place[1]) - self.post[1]
        return x, y, hypot(x, y)
