"""Place on the ground in the middle of the picture and, where the robot turns, its heading."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.chain import CHAIN, FREE

# a motion that stays within this, in m, is played in place; one that turns by less, in rad, is seen from one side
IN_PLACE, STRAIGHT = 0.5, 0.2
WINDOW = 0.5  # s, over which is smoothed


@dataclass(frozen=True)
class Following:
    """Place and heading that the picture follows over the frames.

    Attributes:
        place: places, (m, 2), x and y, in m.
        heading: headings, (m,), in rad.
    """

    place: Array
    heading: Array

    @property
    def moves(self) -> bool:
        """Whether the place changes."""
        return bool(np.ptp(self.place, axis=0).max() > 0)

    @property
    def turns(self) -> bool:
        """Whether the heading changes."""
        return bool(np.ptp(self.heading) > 0)

    @property
    def poses(self) -> Array:
        """Poses of the world as it is seen, (m, 4, 4): the place at its origin, the heading along x."""
        poses = np.tile(np.eye(4), (len(self.heading), 1, 1))
        c, s = np.cos(self.heading), np.sin(self.heading)
        poses[:, 0, 0], poses[:, 0, 1], poses[:, 1, 0], poses[:, 1, 1] = c, s, -s, c
        poses[:, :2, 3] = -np.einsum("mij,mj->mi", poses[:, :2, :2], self.place)
        return poses


def base_joint(model: pin.Model) -> int | None:
    """Returns the joint that moves the base in space, below which is the torso; None if a robot has none."""
    if model.njoints > 1 and model.joints[1].shortname() == FREE:
        return 1
    return model.getJointId(CHAIN[-1]) if all(model.existJointName(name) for name in CHAIN) else None


def follow(model: pin.Model, t: Array, world: Array, center: Array) -> Following:
    """Returns the place of a robot's centre of mass and the heading of its torso, smoothed so that strides show.

    Args:
        model: model of the robot.
        t: times of the frames, (m,), in s.
        world: poses of the joints, (m, joints, 4, 4).
        center: centres of mass, (m, 3), in m.
    """
    place, base = center[:, :2], base_joint(model)
    stays = np.ptp(place, axis=0).max() < IN_PLACE
    place = np.column_stack([_middle(along) if stays else _smooth(t, along) for along in place.T])
    heading = np.zeros(len(t))
    if base is not None:
        # of the axis to the left, on which neither pitch nor, but for its shortening, roll tells
        left = world[:, base, :2, 1]
        heading = np.unwrap(np.arctan2(-left[:, 0], left[:, 1]))
        heading = _middle(heading) if np.ptp(heading) < STRAIGHT else _smooth(t, heading)
    return Following(place, heading)


def _middle(values: Array) -> Array:
    return np.full(len(values), (values.min() + values.max()) / 2)


def _smooth(t: Array, values: Array) -> Array:
    count = max(3, int(np.ceil(60 * t[-1])) + 1)
    steady = np.linspace(0.0, t[-1], count)
    half = min(int(30 * WINDOW), count - 1)
    padded = np.pad(np.interp(steady, t, values), half, mode="reflect", reflect_type="odd")
    smooth = np.convolve(padded, np.full(2 * half + 1, 1 / (2 * half + 1)), mode="valid")
    return np.interp(t, steady, smooth)
