"""Legs of a quadruped in space by their names, and the angles with which they reach a point."""

from __future__ import annotations

import math

import numpy as np

from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.legs import pairs_of
from spear_pin.model.legs import lean
from spear_pin.model.robot import Robot

SPARE = 1e-3  # m: least distance of a leg from being straight or folded


def legs_of(robot: Robot) -> dict[str, Leg]:
    """Returns the four legs of a quadruped by their names in `LEGS`, whatever the robot calls them.

    Raises:
        UnknownName, BadValue: the robot is not such a quadruped; see `pairs_of`.
    """
    return {leg.name: leg for pair in pairs_of(robot) for leg in pair}


def hip_heights(robot: Robot) -> dict[str, float]:
    """Returns the height of each hip above the torso's frame with every joint at zero, in m."""
    upright = np.zeros(robot.nq)
    return {name: float(robot.frame_position(upright, leg.above)[2]) for name, leg in legs_of(robot).items()}


def length(lengths: tuple[float, float], flexion: float) -> float:
    """Returns the distance from hip to toe in the plane, in m, with the knee flexed by an angle in rad."""
    thigh, shank = lengths
    return math.hypot(shank * math.sin(flexion), thigh + shank * math.cos(flexion))


def find_limb_angles(leg: Leg, ahead: float, down: float) -> tuple[float, float]:
    """Returns the own angles of hip and knee, in rad, that put the toe at a place ahead of and below the hip."""
    thigh, shank = leg.lengths
    distance = min(max(math.hypot(ahead, down), abs(thigh - shank) + SPARE), thigh + shank - SPARE)
    knee = leg.bends * math.acos((distance**2 - thigh**2 - shank**2) / (2.0 * thigh * shank))
    hip = math.atan2(ahead, down) + float(lean(thigh, shank, knee, math)[0])
    (_, of_hip, of_knee), (_, zero_of_hip, zero_of_knee) = leg.signs, leg.zeros
    return zero_of_hip + of_hip * hip, zero_of_knee + of_knee * knee
