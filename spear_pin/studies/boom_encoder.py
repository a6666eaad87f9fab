"""Height of the hip from an encoder at the pivot of a rotary boom.

The source gives a radius of about 2 m. The encoder's resolution, offset and noise are assumptions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.model.boom import RotaryBoom


@dataclass(frozen=True)
class Encoder:
    """The encoder at the pivot.

    Attributes:
        resolution: resolution of the angle, in rad; 0: exact.
        offset: offset of its zero, in rad.
        noise: noise from one reading to the next, root mean square, in rad.
        seed: seed of the noise.
    """

    resolution: float = 0.0
    offset: float = 0.0
    noise: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Encoder.resolution", self.resolution, lambda step: step >= 0, "a number >= 0, in rad")
        require("Encoder.offset", self.offset, lambda angle: abs(angle) < np.pi, "within ±π rad")
        require("Encoder.noise", self.noise, lambda angle: angle >= 0, "a number >= 0, in rad")


def read_angle(boom: RotaryBoom, encoder: Encoder, heights: ArrayLike) -> Array:
    """Returns the encoder's readings of the arm's elevation at heights of the hip, in rad, to the nearest step."""
    angles = boom.elevation(heights) + encoder.offset
    if encoder.noise:
        angles = angles + encoder.noise * np.random.default_rng(encoder.seed).normal(size=angles.shape)
    if encoder.resolution:
        angles = encoder.resolution * np.round(angles / encoder.resolution)
    return np.asarray(angles)


def height_by_sine(boom: RotaryBoom, angles: ArrayLike) -> Array:
    """Returns the height of the hip for elevations of the arm, z_pivot + R sin φ, in m."""
    return np.asarray(boom.pivot + boom.radius * np.sin(angles))


def height_by_arc(boom: RotaryBoom, angles: ArrayLike) -> Array:
    """Returns the height of the hip by the small angle, z_pivot + R φ, in m, with an error of R (φ - sin φ)."""
    return np.asarray(boom.pivot + boom.radius * np.asarray(angles, dtype=float))


def tilt(boom: RotaryBoom, heights: ArrayLike, leg: float) -> tuple[Array, Array]:
    """Returns loss of reach and outward swing of a leg of this length that tilts with the arm, without a linkage.

    Args:
        boom: the arm.
        heights: heights of the hip, in m.
        leg: length from hip to toe, in m.

    Returns:
        how much less it reaches down, l (1 - cos φ), and how far its toe swings outward, l sin φ, in m.
    """
    angles = boom.elevation(heights)
    return np.asarray(leg * (1.0 - np.cos(angles))), np.asarray(leg * np.sin(angles))
