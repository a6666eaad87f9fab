"""A robot's size against that of the one whose hop or bound the numbers of a law, a spring or a search are of."""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.legs import Leg, in_convention, simple
from spear_pin.model.robot import Robot


class Scale(NamedTuple):
    """Factors that make of SPEAR-II's or Q-SPEAR's numbers what does the same for another robot, at its gravity.

    Attributes:
        mass: of masses.
        length: of lengths; those of the legs are compared.
        time: of times: the ratio of √(l/g).
    """

    mass: float
    length: float
    time: float

    @property
    def speed(self) -> float:
        """Of speeds."""
        return self.length / self.time

    @property
    def force(self) -> float:
        """Of forces: the ratio of m g."""
        return self.mass * self.length / self.time**2

    @property
    def torque(self) -> float:
        """Of torques, stiffnesses and energies: the ratio of m g l."""
        return self.force * self.length

    @property
    def power(self) -> float:
        """Of powers."""
        return self.torque / self.time


def scale_of(robot: Robot) -> Scale:
    """A robot's size against SPEAR-II's if it has one leg, against Q-SPEAR's if it has two or two pairs.

    Args:
        robot: in the plane, as `spear_pin.monopod` or `spear_pin.sagittal` cuts it.

    Raises:
        BadValue: it has no legs of hip and knee in the plane.
    """
    reference = spear_ii() if len(robot.legs) == 1 else q_spear()
    return Scale(*(own / of for own, of in zip(_size(robot), _size(reference), strict=True)))


def scale_in_space(robot: Robot) -> Scale:
    """A quadruped's size in space against Q-SPEAR's.

    Args:
        robot: as `load` has it, not in the plane.

    Raises:
        BadValue: it has no legs of hip and knee.
    """
    if not robot.legs:
        raise BadValue("robot", robot, "one with legs of hip and knee")
    return Scale(*(own / of for own, of in zip(_measured(robot), _measured(q_spear_full()), strict=True)))


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
    leg = in_convention(simple(robot.legs[0]))
    if leg.side != 1:
        raise BadValue("robot", robot, "one whose knee flexes to positive angles, as SPEAR-II's")
    return leg


@cache
def spear_ii() -> Robot:
    """SPEAR-II, loaded once."""
    from spear_pin.model.loading import load

    return load("spear_ii")


@cache
def q_spear() -> Robot:
    """Q-SPEAR in the sagittal plane, loaded once."""
    from spear_pin.model.loading import load

    return load("q_spear")


@cache
def q_spear_full() -> Robot:
    """Q-SPEAR in space, loaded once."""
    from spear_pin.model.loading import load

    return load("q_spear_full", base="chain")


def _size(robot: Robot) -> tuple[float, float, float]:
    """Mass, in kg, the mean length of the legs, in m, and the time √(l/g), in s."""
    if not robot.planar or not robot.legs:
        raise BadValue("robot", robot, "one with legs, in the plane, as of monopod(...) or sagittal(...)")
    return _measured(robot)


def _measured(robot: Robot) -> tuple[float, float, float]:
    length = sum(leg.thigh + leg.shank for leg in robot.legs) / len(robot.legs)
    return robot.mass, length, math.sqrt(length / float(np.linalg.norm(robot.model.gravity.linear)))
