"""Legs of a quadruped in space, and the groups in which they stand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.legs import Leg
from spear_pin.model.chain import CHAIN
from spear_pin.model.legs import Leg as RobotLeg
from spear_pin.model.legs import check_side, simple
from spear_pin.model.robot import Robot
from spear_pin.model.sagittal import leg_pairs
from spear_pin.model.tree import Tree

X, Z, YAW, PITCH = (CHAIN.index(name) for name in ("torso_x", "torso_z", "yaw", "pitch"))
SIDES = {"left": 1.0, "right": -1.0}
FLIGHTS = ("flight_1", "flight_2")  # after the stance of the first group, and of the second


@dataclass(frozen=True)
class Group:
    """Legs that are on the ground together.

    Attributes:
        name: name such as "posterior".
        legs: any legs of the four.
        flight: name of the flight after its stance.
    """

    name: str
    legs: tuple[Leg, ...]
    flight: str

    def __iter__(self) -> Iterator[Leg]:
        """Iterates over the legs."""
        return iter(self.legs)


Groups = tuple[Group, ...]
"""One group, or two that bear in turn: all four legs in either case."""


def pairs_of(robot: Robot) -> Groups:
    """Returns the posterior and the anterior pair, the left leg first.

    Raises:
        BadValue: the base of the robot is not a chain, it does not have four legs that `spear_pin.sagittal` would pair,
            its toes are not those of the legs, or a leg has no adduction, no motor on one of its joints, or a knee that
            may flex to either side.
    """
    if robot.coordinates[: len(CHAIN)] != CHAIN:
        raise BadValue("robot", robot, 'a quadruped on a chain, load(..., base="chain")')
    found = leg_pairs(robot)
    if {leg.toe for pair in found for leg in pair} != {*robot.toes}:
        toes = ", ".join(leg.toe for pair in found for leg in pair)
        raise BadValue("robot.toes", robot.toes, f"those of its four legs, load(..., toes=...): {toes}")
    posterior, anterior = (
        Group(end, (_leg(robot, left, end, "left"), _leg(robot, right, end, "right")), flight)
        for end, flight, (left, right) in zip(LEGS, FLIGHTS, found, strict=True)
    )
    return posterior, anterior


def sides_of(robot: Robot, *, across: bool) -> Groups:
    """Returns the posterior right and the posterior left leg, each with the anterior leg of its side, or of the other.

    Raises:
        BadValue: the robot is not such a quadruped; see `pairs_of`.
    """
    (left, right), fore = pairs_of(robot)
    with_left, with_right = reversed(fore.legs) if across else fore.legs
    name = "diagonal" if across else "lateral"
    return Group(f"{name}_right", (right, with_right), FLIGHTS[0]), Group(f"{name}_left", (left, with_left), FLIGHTS[1])


def together(robot: Robot) -> Groups:
    """Returns all four legs as one group.

    Raises:
        BadValue: the robot is not such a quadruped; see `pairs_of`.
    """
    return (Group("all", tuple(leg for pair in pairs_of(robot) for leg in pair), FLIGHTS[0]),)


def _leg(robot: Robot, leg: RobotLeg, end: str, side: str) -> Leg:
    joints = (leg.abduction, leg.hip, leg.knee)
    if leg.abduction is None or not {*joints} <= {*robot.actuated}:
        raise BadValue("robot", robot, f"one whose leg {leg.name} has motors at adduction, hip and knee")
    check_side(simple(leg))
    adduction, hip, knee = (robot.index(str(joint)) for joint in joints)
    columns = tuple(robot.actuated.index(joint) for joint in joints)
    tree = Tree(robot.model)
    swings = float(np.sign(tree.axis(robot.model.getJointId(leg.abduction))[0]))
    return Leg(
        end=end,
        hip=hip,
        knee=knee,
        side=float(leg.side),
        lengths=(leg.thigh, leg.shank),
        motors=columns,
        joint=leg.knee,
        above=leg.hip,
        toe=leg.toe,
        pitch=PITCH,
        lateral=SIDES[side],
        adduction=adduction,
        signs=(swings, float(leg.hip_sign), float(leg.knee_sign)),
        zeros=(0.0, leg.hip_zero, leg.knee_zero),
    )


def place_in_space(robot: Robot, pairs: Groups, planar: Array) -> Array:
    """Returns the configuration in space, (nv,), of a planar one: x, z, pitch, then hip and knee of either pair."""
    q = move_in_space(robot, pairs, planar)
    for pair in pairs:
        for leg in pair:
            q[list(leg.rows)] += leg.zeros
    return q


def move_in_space(robot: Robot, pairs: Groups, planar: Array) -> Array:
    """Returns the velocity in space, (nv,), of a planar one; see `place_in_space` for the order of its coordinates."""
    whole = np.zeros(robot.nv)
    whole[[X, Z, PITCH]] = planar[:3]
    for i, pair in enumerate(pairs):
        for leg in pair:
            whole[[leg.hip, leg.knee]] = planar[3 + 2 * i : 5 + 2 * i] * leg.signs[1:]
    return whole
