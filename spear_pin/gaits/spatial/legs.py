"""Legs of a quadruped in space, their controlled variables, and the groups in which they stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import LEGS, convert_angle, leg_angle
from spear_pin.gaits.virtual_constraints import Evolution, Outputs, Sum, Variable
from spear_pin.model.chain import CHAIN
from spear_pin.model.legs import Leg as RobotLeg
from spear_pin.model.legs import check_side, simple
from spear_pin.model.robot import Robot
from spear_pin.model.sagittal import leg_pairs
from spear_pin.model.tree import Tree

X, Y, Z, YAW, PITCH = (CHAIN.index(name) for name in ("torso_x", "torso_y", "torso_z", "yaw", "pitch"))
SIDES = {"left": 1.0, "right": -1.0}
FLIGHTS = ("flight_1", "flight_2")  # after the stance of the first group, and of the second


@dataclass(frozen=True)
class Leg:
    """A leg in space. Its numbers in a law follow the convention, see `spear_pin.model.legs`; q is the robot's own.

    Attributes:
        end: "posterior" or "anterior".
        lateral: +1 for the left leg, -1 for the right leg.
        adduction: index of its adduction joint; in the convention an angle > 0 swings the leg to the left.
        hip: index of its hip.
        knee: index of its knee.
        side: +1 if the knee flexes to positive angles of its own, -1 if to negative.
        lengths: lengths of thigh and shank, in m.
        motors: columns of the motors of adduction, hip and knee.
        joint: name of its knee.
        above: name of its hip.
        toe: name of its toe.
        signs: signs of adduction, hip and knee: their angles of the convention are sign (q - zero).
        zeros: zeros of adduction, hip and knee, in rad.
    """

    end: str
    lateral: float
    adduction: int
    hip: int
    knee: int
    side: float
    lengths: tuple[float, float]
    motors: tuple[int, int, int]
    joint: str
    above: str
    toe: str
    signs: tuple[float, float, float] = (1.0, 1.0, 1.0)
    zeros: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def name(self) -> str:
        """Name such as "posterior_left", whatever the robot calls the leg."""
        return f"{self.end}_{'left' if self.lateral > 0 else 'right'}"

    @property
    def rows(self) -> tuple[int, int, int]:
        """Indices of adduction, hip and knee."""
        return self.adduction, self.hip, self.knee

    @property
    def bends(self) -> float:
        """+1 if the knee flexes to positive angles of the convention, -1 if to negative."""
        return self.side * self.signs[2]

    @cached_property
    def angle(self) -> Variable:
        """Leg angle γ in the torso's sagittal plane, the same as that of a planar leg."""
        return leg_angle(PITCH, self.hip, self.knee, self.lengths, self.signs[1:], self.zeros[1:])

    @cached_property
    def controlled(self) -> tuple[Variable, Variable]:
        """Variables that the motors of hip and knee control in the air: γ and the knee, of the convention."""
        return self.angle, convert_angle(self.knee, self.signs[2], self.zeros[2])

    def flexion(self, q: Any) -> Any:
        """Returns how far the knee is flexed, in rad."""
        return self.side * (q[self.knee] - self.zeros[2])

    def outputs(self, others: Sequence[Leg], weights: tuple[Any, Any, Any]) -> Outputs:
        """Returns the controlled outputs in the air, over a phase variable.

        Args:
            others: the legs of the other group, if there is one.
            weights: weights of x, of y and of each of their γ in the phase variable.
        """
        ahead, aside, angles = weights
        travel = ((X, ahead), (Y, aside))
        phase = Sum(((1.0, travel), *((angles, leg.angle) for leg in others)))
        return Outputs(self.controlled, phase, self.motors[1:])

    def evolution(self, held: Mapping[str, Any]) -> Evolution:
        """Returns the latched desired evolution of the leg."""
        return Evolution(*(held[f"{self.name}_{part}"] for part in ("alpha", "origin", "span", "past")))


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


def diagonals_of(robot: Robot) -> Groups:
    """Returns the pairs of the posterior right and of the posterior left leg, each with the opposite anterior leg.

    Raises:
        BadValue: the robot is not such a quadruped; see `pairs_of`.
    """
    (left, right), (across, other) = pairs_of(robot)
    return Group("diagonal_right", (right, across), FLIGHTS[0]), Group("diagonal_left", (left, other), FLIGHTS[1])


def laterals_of(robot: Robot) -> Groups:
    """Returns the pair of the right legs and the pair of the left legs.

    Raises:
        BadValue: the robot is not such a quadruped; see `pairs_of`.
    """
    (left, right), (fore_left, fore_right) = pairs_of(robot)
    return Group("lateral_right", (right, fore_right), FLIGHTS[0]), Group("lateral_left", (left, fore_left), FLIGHTS[1])


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
        lateral=SIDES[side],
        adduction=adduction,
        hip=hip,
        knee=knee,
        side=float(leg.side),
        lengths=(leg.thigh, leg.shank),
        motors=(columns[0], columns[1], columns[2]),
        joint=leg.knee,
        above=leg.hip,
        toe=leg.toe,
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
