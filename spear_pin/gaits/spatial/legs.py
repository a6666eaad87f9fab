"""Legs of a quadruped in space, and what of each is controlled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import LEGS, leg_angle
from spear_pin.gaits.virtual_constraints import Evolution, Outputs, Sum, Variable
from spear_pin.model.chain import CHAIN
from spear_pin.model.legs import in_convention
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
X, Y, Z, YAW, PITCH = (CHAIN.index(name) for name in ("torso_x", "torso_y", "torso_z", "yaw", "pitch"))
SIDES = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class Leg:
    """A leg in space.

    Attributes:
        pair: "posterior" or "anterior".
        lateral: +1 of the left one, -1 of the right one.
        adduction: index of its adduction joint; > 0 swings the leg to the left.
        hip: index of its hip.
        knee: index of its knee.
        side: +1 if the knee flexes to positive angles, -1 if to negative.
        lengths: of thigh and shank, in m.
        motors: columns of the motors of adduction, hip and knee.
        joint: name of its knee.
        toe: name of its toe.
    """

    pair: str
    lateral: float
    adduction: int
    hip: int
    knee: int
    side: float
    lengths: tuple[float, float]
    motors: tuple[int, int, int]
    joint: str
    toe: str

    @property
    def name(self) -> str:
        """Such as "posterior_left"."""
        return f"{self.pair}_{'left' if self.lateral > 0 else 'right'}"

    @cached_property
    def angle(self) -> Variable:
        """Its leg angle γ in the torso's sagittal plane, as of the plane's leg."""
        return leg_angle(PITCH, self.hip, self.knee, self.lengths)

    @cached_property
    def rows(self) -> tuple[Variable, Variable]:
        """What the hip's and the knee's motors control in the air: γ and the knee."""
        return self.angle, ((self.knee, 1.0),)

    def outputs(self, bearing: tuple[Leg, Leg], weights: tuple[Any, Any, Any]) -> Outputs:
        """What is controlled in the air, over a phase variable.

        Args:
            bearing: the other pair.
            weights: of x, of y and of each γ of that pair in the phase variable.
        """
        ahead, aside, angles = weights
        travel = ((X, ahead), (Y, aside))
        return Outputs(self.rows, Sum(((1.0, travel), *((angles, leg.angle) for leg in bearing))), self.motors[1:])

    def evolution(self, held: Mapping[str, Any]) -> Evolution:
        """The desired evolution of it that is held."""
        return Evolution(*(held[f"{self.name}_{part}"] for part in ("alpha", "origin", "span", "past")))


Pair = tuple[Leg, Leg]


def pairs_of(robot: Robot) -> tuple[Pair, Pair]:
    """The posterior and the anterior pair, the left leg first.

    Raises:
        BadValue: the robot has no chain as base, not four legs with adduction, a motor on each joint, named as those of
            Q-SPEAR, or other axes than these have.
    """
    names = tuple(f"{pair}_{side}" for pair in LEGS for side in SIDES)
    legs = {leg.name: leg for leg in robot.legs}
    if robot.coordinates[: len(CHAIN)] != CHAIN or not set(names) <= set(legs):
        expected = f'a quadruped on a chain, load(..., base="chain"), with the legs {", ".join(names)}'
        raise BadValue("robot", robot, expected)
    made = []
    for name in names:
        leg = in_convention(legs[name])
        if leg.abduction is None or not {leg.abduction, leg.hip, leg.knee} <= {*robot.actuated} or leg.side == 0:
            raise BadValue("robot", robot, f"one whose {name} has motors at adduction, hip and knee, and a side")
        adduction, hip, knee = (robot.index(joint) for joint in (leg.abduction, leg.hip, leg.knee))
        columns = tuple(robot.actuated.index(joint) for joint in (leg.abduction, leg.hip, leg.knee))
        pair, _, side = name.rpartition("_")
        made.append(
            Leg(
                pair=pair,
                lateral=SIDES[side],
                adduction=adduction,
                hip=hip,
                knee=knee,
                side=float(leg.side),
                lengths=(leg.thigh, leg.shank),
                motors=(columns[0], columns[1], columns[2]),
                joint=leg.knee,
                toe=leg.toe,
            )
        )
    posterior_left, posterior_right, anterior_left, anterior_right = made
    return (posterior_left, posterior_right), (anterior_left, anterior_right)


def placed(robot: Robot, pairs: tuple[Pair, Pair], planar: Array) -> Array:
    """Coordinates, or rates, in space of those in the plane: x, z, pitch, then hip and knee of either pair, (nv,)."""
    whole = np.zeros(robot.nv)
    whole[[X, Z, PITCH]] = planar[:3]
    for i, pair in enumerate(pairs):
        for leg in pair:
            whole[[leg.hip, leg.knee]] = planar[3 + 2 * i : 5 + 2 * i]
    return whole
