"""The legs of a quadruped on a chain, by where they are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue
from spear_pin.gaits.footfalls.sequence import LEGS
from spear_pin.model.chain import CHAIN
from spear_pin.model.legs import Leg, sided, simple
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Limb:
    """A leg of a quadruped in space.

    Attributes:
        name: one of `LEGS`.
        leg: the robot's.
        adduction: index of its adduction joint; > 0 swings it to the left.
        hip: index of its hip.
        knee: index of its knee.
        place: of the hip with every joint at zero, (3,), in m.
    """

    name: str
    leg: Leg
    adduction: int
    hip: int
    knee: int
    place: Array

    @property
    def lateral(self) -> float:
        """+1 of a left one, -1 of a right one."""
        return 1.0 if self.name.endswith("left") else -1.0

    @property
    def rows(self) -> list[int]:
        """Indices of adduction, hip and knee."""
        return [self.adduction, self.hip, self.knee]

    def flexion(self, q: Any) -> Any:
        """How far the knee is flexed, in rad, zero where the leg is straight."""
        return self.leg.side * (q[self.knee] - self.leg.knee_zero)

    def reaching(self, ahead: float, down: float) -> tuple[float, float]:
        """Angles of hip and knee with the toe so far ahead of the hip and below it in the torso's plane, in rad."""
        leg, distance = self.leg, math.hypot(ahead, down)
        least, most = abs(leg.thigh - leg.shank) + 1e-3, leg.thigh + leg.shank - 1e-3
        distance = min(max(distance, least), most)
        cosine = (distance**2 - leg.thigh**2 - leg.shank**2) / (2.0 * leg.thigh * leg.shank)
        knee = leg.bends * math.acos(cosine)
        hip = math.atan2(ahead, down) + leg.lean(knee)
        return leg.hip_zero + leg.hip_sign * hip, leg.knee_zero + leg.knee_sign * knee


def limbs_of(robot: Robot) -> dict[str, Limb]:
    """The four legs of a quadruped by their names in `LEGS`, whatever the robot calls them.

    Raises:
        BadValue: the base is no chain, there are not four legs with adduction, hip and knee, motors at all of them,
            at the corners of a torso, or it is not known to which side a knee flexes.
    """
    joints = {each for leg in robot.legs for each in (leg.abduction, leg.hip, leg.knee)}
    if robot.coordinates[: len(CHAIN)] != CHAIN or len(robot.legs) != len(LEGS) or joints != {*robot.actuated}:
        expected = 'a quadruped on a chain, load(..., base="chain"), with motors at adductions, hips and knees'
        raise BadValue("robot", robot, expected)
    upright, found = np.zeros(robot.nq), {}
    places = {leg.name: robot.frame_position(upright, leg.hip) for leg in robot.legs}
    middle = np.mean(list(places.values()), axis=0)
    for leg in robot.legs:
        place = places[leg.name]
        name = f"{'anterior' if place[0] > middle[0] else 'posterior'}_{'left' if place[1] > middle[1] else 'right'}"
        sided(simple(leg))
        assert leg.abduction is not None
        adduction, hip, knee = (robot.index(joint) for joint in (leg.abduction, leg.hip, leg.knee))
        found[name] = Limb(name, leg, adduction, hip, knee, place)
    if set(found) != set(LEGS):
        raise BadValue("robot", robot, f"a quadruped with a leg at each corner: {', '.join(LEGS)}")
    return {name: found[name] for name in LEGS}
