"""The bound's controller with diagonal pairs: numbers for a hind and a fore leg, the same on both sides."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from spear_pin.gaits.bounding_law import LEGS, Shape, Valid, check_numbers
from spear_pin.gaits.inputs import ANGLE, Input
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import Group
from spear_pin.kinds import typed

INPUTS_OF_A_LEG = {
    "hip_torque": Input(50.0, 50.0, True),
    "knee_torque": Input(50.0, 50.0, True),
    "squeeze": Input(10.0, 30.0, True),
    "leg_touchdown": ANGLE,
    "spread": Input(0.05, 0.3),
}
SHAPES = {
    "posterior_swing": (2, 4),
    "anterior_swing": (2, 4),
    "posterior_trailing": (2, 4),
    "anterior_trailing": (2, 4),
    "posterior_landing": (2,),
    "anterior_landing": (2,),
}


@typed
@dataclass(frozen=True)
class TrotLaw:
    """Parameters of the trotting controller: those of `BoundingLaw` and `SpatialLaw`, for one leg each.

    Attributes:
        posterior_hip_torque: β of (5.4), in N·m.
        anterior_hip_torque: the same for the anterior leg, in N·m.
        posterior_knee_torque: |ū| of (5.5), extending, in N·m.
        anterior_knee_torque: the same for the anterior leg, in N·m.
        posterior_leg_touchdown: γ at which the posterior leg lands, in rad.
        anterior_leg_touchdown: γ at which the anterior leg lands, in rad.
        stance_span: Δ of (5.10), for the mean γ of a pair on the ground, in rad, negative.
        flight_span: Δ of (5.19), in m.
        posterior_swing: Bézier coefficients of γ and knee, from the third on, for a posterior leg while the other pair
            is on the ground.
        anterior_swing: the same for an anterior leg.
        posterior_trailing: the same for a posterior leg that has just lifted.
        anterior_trailing: the same for an anterior leg that has just lifted.
        posterior_landing: the third coefficient of γ and knee for a posterior leg; the last three are the touchdown
            values.
        anterior_landing: the same for an anterior leg.
        posterior_spread: adduction of a posterior leg at touchdown, outward, in rad.
        anterior_spread: the same for an anterior leg, in rad.
        posterior_squeeze: torque of a posterior adduction in stance, inward, in N·m.
        anterior_squeeze: the same for an anterior leg, in N·m.
        leg_stiffness: stiffness of the virtual spring in a knee, in N·m/rad.
        knee_rest: θ̄ of (5.5), by magnitude, in rad.
        knee_touchdown: knee angle of a landing leg, by magnitude, in rad.
        epsilon: ε of (5.16), in s.
        adduction_stiffness: stiffness of the adduction in stance, in N·m/rad.
        adduction_damping: damping of the adduction in stance, in N·m·s/rad.
        adduction_epsilon: ε of the adduction in the air, in s.
        lift_off: "knee" or "force"; see `BoundingLaw`.
        nominal: section state (q, v) of the gait, x = y = yaw = 0, from which a search begins.
        units: units of the scalar numbers, by name.
        inputs: numbers that event feedback may adjust, for Q-SPEAR.

    Example:
        >>> from spear_pin import Gait
        >>> round(Gait.load("trot").system.law.posterior_leg_touchdown, 3)  # rad
        0.267
    """

    posterior_hip_torque: float
    anterior_hip_torque: float
    posterior_knee_torque: float
    anterior_knee_torque: float
    posterior_leg_touchdown: float
    anterior_leg_touchdown: float
    stance_span: float
    flight_span: float
    posterior_swing: Shape
    anterior_swing: Shape
    posterior_trailing: Shape
    anterior_trailing: Shape
    posterior_landing: tuple[float, ...]
    anterior_landing: tuple[float, ...]
    posterior_spread: float = 0.0
    anterior_spread: float = 0.0
    posterior_squeeze: float = 0.0
    anterior_squeeze: float = 0.0
    leg_stiffness: float = 200.0
    knee_rest: float = math.radians(40.0)
    knee_touchdown: float = math.radians(40.0)
    epsilon: float = 0.015
    adduction_stiffness: float = 300.0
    adduction_damping: float = 10.0
    adduction_epsilon: float = 0.04
    lift_off: str = "knee"
    nominal: tuple[float, ...] = ()
    units: ClassVar[Mapping[str, str]] = {
        **SpatialLaw.units,
        **{"stance_span": "rad", "flight_span": "m", "leg_stiffness": "N·m/rad"},
    }
    inputs: ClassVar[Mapping[str, Input]] = {
        f"{end}_{name}": each for end in LEGS for name, each in INPUTS_OF_A_LEG.items()
    }

    def __post_init__(self) -> None:
        """Checks the fields."""
        valid: Valid = {
            **dict.fromkeys(("epsilon", "adduction_epsilon"), (lambda e: e > 0, "a number > 0, in s")),
            **dict.fromkeys(("knee_rest", "knee_touchdown"), (lambda a: 0 < a < math.pi, "between 0 and π rad")),
            **dict.fromkeys(
                ("leg_stiffness", "adduction_stiffness", "adduction_damping"), (lambda k: k >= 0, "a number >= 0")
            ),
            "stance_span": (lambda span: span < 0, "a number < 0, in rad"),
            "flight_span": (lambda span: span > 0, "a number > 0, in m"),
        }
        check_numbers(self, valid, SHAPES)

    def torques(self, leg: Leg, ahead: float) -> tuple[float, float, float]:
        """Returns torques of a landing leg for adduction (to the left), hip and knee (extending), in N·m."""
        hip, knee, squeeze = (getattr(self, f"{leg.end}_{name}") for name in ("hip_torque", "knee_torque", "squeeze"))
        return -leg.lateral * squeeze, hip, knee

    def swing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that swings while the other pair stands."""
        shape: Shape = getattr(self, f"{leg.end}_swing")
        return shape

    def trailing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that trails after its lift-off."""
        shape: Shape = getattr(self, f"{leg.end}_trailing")
        return shape

    def landing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that moves to its touchdown angles."""
        angle, knee = getattr(self, f"{leg.end}_landing")
        target = getattr(self, f"{leg.end}_leg_touchdown")
        return (angle, *3 * (target,)), (knee, *3 * (leg.bends * self.knee_touchdown,))

    def span_of_stance(self, group: Group) -> float:
        """Returns Δ of (5.10), for the mean leg angle of a pair on the ground, in rad."""
        return self.stance_span

    def span_of_flight(self, group: Group) -> float:
        """Returns Δ of (5.19), in the flight after the stance of a pair, in m."""
        return self.flight_span

    def adduction_touchdown(self, leg: Leg) -> float:
        """Returns the angle of a leg's adduction at touchdown, to the left, in rad."""
        spread: float = getattr(self, f"{leg.end}_spread")
        return leg.lateral * spread
