"""A one-legged robot's size against SPEAR-II's, for whose hop the numbers of law and spring are."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue
from spear_pin.model.legs import Leg, simple
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]


class Scale(NamedTuple):
    """Factors of SPEAR-II's torques and times that do the same for another robot.

    Attributes:
        torque: of torques and stiffnesses: the ratio of m g l, of the robot's mass and its leg's length.
        time: the ratio of √(l/g).
    """

    torque: float
    time: float


def scale_of(robot: Robot) -> Scale:
    """A robot's size against SPEAR-II's.

    Args:
        robot: with one leg, as `spear_pin.monopod` cuts it.

    Raises:
        BadValue: it has not one leg of hip and knee, in the plane.
    """
    (torque, time), (of_torque, of_time) = _size(robot), _size(spear_ii())
    return Scale(torque / of_torque, time / of_time)


def touchdown_inertia(robot: Robot, knee: float) -> Array:
    """Diagonal entries of D of hip and knee, (2,), in kg·m², the toe below the hip.

    Args:
        robot: as of `scale_of`.
        knee: its angle, in rad.
    """
    leg = only_leg(robot)
    rows = [robot.index(leg.hip), robot.index(leg.knee)]
    q = np.zeros(robot.nq)
    q[rows] = leg.lean(knee), knee
    return np.diag(robot.mass_matrix(q))[rows]


def only_leg(robot: Robot) -> Leg:
    """The leg of a robot that has one, with SPEAR-II's signs.

    Raises:
        BadValue: it has another, or more.
    """
    if not robot.planar or len(robot.legs) != 1:
        raise BadValue("robot", robot, "one with one leg, in the plane, as of monopod(...)")
    leg = simple(robot.legs[0])
    if (leg.hip_sign, leg.knee_sign, leg.side, leg.hip_zero, leg.knee_zero) != (1, 1, 1, 0.0, 0.0):
        raise BadValue("robot", robot, "one with SPEAR-II's signs and zeros of hip and knee, as of monopod(...)")
    return leg


@cache
def spear_ii() -> Robot:
    """SPEAR-II, loaded once."""
    return load("spear_ii")


def _size(robot: Robot) -> tuple[float, float]:
    """The torque m g l, in N·m, and the time √(l/g), in s."""
    leg = only_leg(robot)
    length, gravity = leg.thigh + leg.shank, float(np.linalg.norm(robot.model.gravity.linear))
    return robot.mass * gravity * length, math.sqrt(length / gravity)
