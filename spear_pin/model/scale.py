"""A robot's size relative to SPEAR-II or Q-SPEAR, for which the numbers of laws, springs and searches hold."""

from __future__ import annotations

import math
from functools import cache
from typing import Literal, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.legs import WITHOUT_LOOPS, Leg, in_convention, simple
from spear_pin.model.robot import Robot


class Scale(NamedTuple):
    """Factors that convert SPEAR-II's or Q-SPEAR's numbers to another robot, at its gravity.

    Attributes:
        mass: factor on masses.
        length: factor on lengths, the ratio of leg lengths.
        time: factor on times, the ratio of √(l/g).
    """

    mass: float
    length: float
    time: float

    @property
    def speed(self) -> float:
        """Factor on speeds."""
        return self.length / self.time

    @property
    def force(self) -> float:
        """Factor on forces, the ratio of m g."""
        return self.mass * self.length / self.time**2

    @property
    def torque(self) -> float:
        """Factor on torques, stiffnesses and energies, the ratio of m g l."""
        return self.force * self.length

    @property
    def power(self) -> float:
        """Factor on powers."""
        return self.torque / self.time


def scale_of(robot: Robot, length: float | None = None) -> Scale:
    """Returns a robot's size relative to SPEAR-II's if it has one leg, to Q-SPEAR's if it has two legs or pairs.

    Args:
        robot: a robot in the plane, as `spear_pin.monopod` or `spear_pin.sagittal` cuts it.
        length: length of its leg, in m, if that has closed loops.

    Raises:
        BadValue: the robot has no legs of hip and knee in the plane.
    """
    if length is not None:
        return _relative(_sizes(robot, length), load_shipped("spear_ii"))
    if robot.loops:
        raise BadValue("robot", robot, WITHOUT_LOOPS)
    if not robot.planar or not robot.legs:
        raise BadValue("robot", robot, "a planar robot with legs, as monopod(...) or sagittal(...) makes it")
    return _relative(_size(robot), load_shipped("spear_ii" if len(robot.legs) == 1 else "q_spear"))


def scale_in_space(robot: Robot) -> Scale:
    """Returns a quadruped's size in space relative to Q-SPEAR's.

    Args:
        robot: a robot as `load` returns it, not in the plane.

    Raises:
        BadValue: the robot has no legs of hip and knee.
    """
    if not robot.legs:
        raise BadValue("robot", robot, "one with legs of hip and knee")
    return _relative(_size(robot), load_shipped("q_spear_full", "chain"))


def touchdown_inertia(robot: Robot, knee: float) -> Array:
    """Returns the diagonal entries of D for hip and knee, (2,), in kg·m², with the toe below the hip.

    Args:
        robot: a robot in the plane, as `spear_pin.monopod` or `spear_pin.sagittal` cuts it.
        knee: angle of the knee, in rad.
    """
    leg = only_leg(robot)
    rows = [robot.index(leg.hip), robot.index(leg.knee)]
    q = np.zeros(robot.nq)
    q[rows] = leg.lean(knee), knee
    return np.diag(robot.mass_matrix(q))[rows]


def only_leg(robot: Robot) -> Leg:
    """Returns the leg of a robot that has a single leg, with SPEAR-II's signs.

    Raises:
        BadValue: the leg has other signs, or the robot does not have exactly one leg.
    """
    if not robot.planar or len(robot.legs) != 1:
        raise BadValue("robot", robot, "a planar robot with one leg, as monopod(...) makes it")
    leg = in_convention(simple(robot.legs[0]))
    if leg.side != 1:
        raise BadValue(
            "robot", robot, "one whose knee flexes to positive angles, like SPEAR-II's; monopod(...) makes one"
        )
    return leg


@cache
def load_shipped(name: str, base: Literal["chain"] | None = None) -> Robot:
    """Returns a robot that comes with the package, which is loaded once."""
    from spear_pin.model.loading import load

    return load(name, base=base)


def _relative(size: tuple[float, float, float], reference: Robot) -> Scale:
    return Scale(*(own / of for own, of in zip(size, _size(reference), strict=True)))


def _size(robot: Robot) -> tuple[float, float, float]:
    """Returns the mass, in kg, the mean length of the legs, in m, and the time √(l/g), in s."""
    return _sizes(robot, sum(leg.thigh + leg.shank for leg in robot.legs) / len(robot.legs))


def _sizes(robot: Robot, length: float) -> tuple[float, float, float]:
    """Returns the mass, in kg, a length of the legs, in m, and the time √(l/g), in s."""
    return robot.mass, length, math.sqrt(length / float(np.linalg.norm(robot.model.gravity.linear)))
