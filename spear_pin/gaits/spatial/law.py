"""The bounding controller in space: the plane's numbers for each leg, and the control of the adduction joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

from spear_pin.gaits.bounding_law import LEGS, PAIR, BoundingLaw, Shape, Valid, check_numbers
from spear_pin.gaits.inputs import ANGLE, Input
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.legs import FLIGHTS, Group
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space

ANTISYMMETRIC = ("hip_difference", "knee_difference", "leg_difference", "adduction", "adduction_torque")
SYMMETRIC = ("spread", "squeeze")
ACROSS = tuple(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ANTISYMMETRIC)
"""Parameters that are zero in symmetric motion, and change sign in the mirror: what turns and what balances."""
_ANTISYMMETRIC = (Input(25.0, 100.0, True), Input(25.0, 100.0, True), ANGLE, Input(0.05, 0.3), Input(10.0, 30.0, True))
_UNITS = {
    **{f"{pair}_{name}": "N·m" for pair in LEGS for name in (*ANTISYMMETRIC, *SYMMETRIC)},
    **{f"{pair}_{name}": "rad" for pair in LEGS for name in ("leg_difference", "adduction", "spread")},
    **{"adduction_stiffness": "N·m/rad", "adduction_damping": "N·m·s/rad", "adduction_epsilon": "s"},
}
_FLIGHTS = dict(zip(LEGS, FLIGHTS, strict=True))  # of the plane's law, after the stance of a pair


@typed
@dataclass(frozen=True)
class SpatialLaw:
    """Parameters of the bounding controller in space. Only the plane's parameters come from the source.

    In stance a torque holds an adduction joint about its angle at touchdown; the joint is never locked: with two toes
    on the ground its torque only presses them together. In the air the adduction is an output. Differences are from the
    pair's mean to the left leg; the right leg has the opposite difference.

    Attributes:
        plane: the sagittal controller; its torques are those of a pair, of which each leg has half.
        adduction_stiffness: stiffness of the adduction in stance, in N·m/rad.
        adduction_damping: damping of the adduction in stance, in N·m·s/rad.
        adduction_epsilon: ε of the adduction as an output in the air, in s.
        posterior_hip_difference: difference of the hip torque, in N·m.
        posterior_knee_difference: difference of the knee torque, in N·m, extending.
        posterior_leg_difference: difference of the leg angle γ at touchdown, in rad.
        posterior_adduction: adduction angle at touchdown, both legs to the left, in rad.
        posterior_adduction_torque: adduction torque in stance, on both legs to the left, in N·m.
        posterior_spread: adduction angle at touchdown, both legs outward, in rad.
        posterior_squeeze: adduction torque in stance, on both legs inward, in N·m.
        anterior_hip_difference: the same for the anterior pair, in N·m.
        anterior_knee_difference: the same for the anterior pair, in N·m.
        anterior_leg_difference: the same for the anterior pair, in rad.
        anterior_adduction: the same for the anterior pair, in rad.
        anterior_adduction_torque: the same for the anterior pair, in N·m.
        anterior_spread: the same for the anterior pair, in rad.
        anterior_squeeze: the same for the anterior pair, in N·m.
        nominal: section state (q, v) of the gait, x = y = yaw = 0, from which a search begins.
        units: units of the scalar numbers, by name.
        inputs: numbers that event feedback may adjust, for Q-SPEAR.

    Example:
        >>> from spear_pin import Gait, SpatialLaw
        >>> law = SpatialLaw(Gait.load("long_stride").system.law, posterior_adduction=0.02)
        >>> law.adduction_stiffness  # N·m/rad
        300.0
    """

    plane: BoundingLaw
    adduction_stiffness: float = 300.0
    adduction_damping: float = 10.0
    adduction_epsilon: float = 0.04
    posterior_hip_difference: float = 0.0
    posterior_knee_difference: float = 0.0
    posterior_leg_difference: float = 0.0
    posterior_adduction: float = 0.0
    posterior_adduction_torque: float = 0.0
    posterior_spread: float = 0.0
    posterior_squeeze: float = 0.0
    anterior_hip_difference: float = 0.0
    anterior_knee_difference: float = 0.0
    anterior_leg_difference: float = 0.0
    anterior_adduction: float = 0.0
    anterior_adduction_torque: float = 0.0
    anterior_spread: float = 0.0
    anterior_squeeze: float = 0.0
    nominal: tuple[float, ...] = ()
    units: ClassVar[Mapping[str, str]] = {**BoundingLaw.units, **_UNITS}
    inputs: ClassVar[Mapping[str, Input]] = {**dict(zip(ACROSS, 2 * _ANTISYMMETRIC, strict=True)), **BoundingLaw.inputs}

    def __post_init__(self) -> None:
        """Checks the fields."""
        valid: Valid = {
            "adduction_stiffness": (lambda k: k >= 0, "a number >= 0, in N·m/rad"),
            "adduction_damping": (lambda b: b >= 0, "a number >= 0, in N·m·s/rad"),
            "adduction_epsilon": (lambda e: e > 0, "a number > 0, in s"),
        }
        check_numbers(self, valid, {})

    @classmethod
    @typed
    def scaled(cls, plane: BoundingLaw, robot: Robot) -> SpatialLaw:
        """Returns the law with Q-SPEAR's adduction numbers scaled to another robot.

        Stiffnesses and torques scale with m g l, damping with m g l √(l/g), times with √(l/g).

        Args:
            plane: the sagittal controller.
            robot: a quadruped, not in the plane.

        Raises:
            BadValue: the robot has no legs with hip and knee.

        Example:
            >>> from spear_pin import Gait, SpatialLaw, load
            >>> plane = Gait.load("long_stride").system.law
            >>> SpatialLaw.scaled(plane, load("q_spear_full", base="chain")) == SpatialLaw(plane)
            True
        """
        one, scale = cls(plane), scale_in_space(robot)
        return replace(
            one,
            adduction_stiffness=one.adduction_stiffness * scale.torque,
            adduction_damping=one.adduction_damping * scale.torque * scale.time,
            adduction_epsilon=one.adduction_epsilon * scale.time,
        )

    @property
    def knee_rest(self) -> float:
        """θ̄ of (5.5)-(5.6) in the plane's law, in rad."""
        return self.plane.knee_rest

    @property
    def epsilon(self) -> float:
        """ε of (5.16) in the plane's law, in s."""
        return self.plane.epsilon

    @property
    def leg_stiffness(self) -> float:
        """The virtual stiffness of one knee, in N·m/rad."""
        return self.plane.virtual_stiffness / PAIR

    @property
    def lift_off(self) -> str:
        """Rule for lift-off in the plane's law."""
        return self.plane.lift_off

    def torques(self, leg: Leg, ahead: float) -> tuple[float, float, float]:
        """Returns torques of a landing leg for adduction (to the left), hip and knee (extending), in N·m.

        Args:
            leg: the leg.
            ahead: speed of the torso along its heading, in m/s.
        """
        i = LEGS.index(leg.end)
        faster = self.plane.speed_gain[i] * (ahead - self.plane.speed_nominal[i])
        hip, knee = (getattr(self.plane, f"{leg.end}_{name}_torque") for name in ("hip", "knee"))
        squeeze = getattr(self, f"{leg.end}_squeeze")
        return (
            self._of(leg, "adduction_torque") - leg.lateral * squeeze,
            (hip + faster) / PAIR + self._of(leg, "hip_difference"),
            knee / PAIR + self._of(leg, "knee_difference"),
        )

    def swing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that swings while the other pair stands."""
        shape: Shape = getattr(self.plane, f"{_other(leg.end)}_stance_swing")
        return shape

    def trailing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that trails after its lift-off."""
        shape: Shape = getattr(self.plane, f"{_FLIGHTS[leg.end]}_trailing")
        return shape

    def landing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that moves to its touchdown angles."""
        angle, knee = getattr(self.plane, f"{_FLIGHTS[_other(leg.end)]}_landing")
        target = getattr(self.plane, f"{leg.end}_leg_touchdown") + self._of(leg, "leg_difference")
        return (angle, *3 * (target,)), (knee, *3 * (leg.bends * self.plane.knee_touchdown,))

    def span_of_stance(self, group: Group) -> float:
        """Returns Δ of (5.10), for the mean leg angle of a pair on the ground, in rad."""
        span: float = getattr(self.plane, f"{group.name}_stance_span")
        return span

    def span_of_flight(self, group: Group) -> float:
        """Returns Δ of (5.19), in the flight after the stance of a pair, or of all legs, in m."""
        span: float = getattr(self.plane, f"{group.flight}_span")
        return span

    def adduction_touchdown(self, leg: Leg) -> float:
        """Returns the angle of a leg's adduction at touchdown, to the left, in rad."""
        spread: float = getattr(self, f"{leg.end}_spread")
        return self._of(leg, "adduction") + leg.lateral * spread

    def _of(self, leg: Leg, name: str) -> float:
        """Returns one of `ANTISYMMETRIC` for a leg; a difference has the leg's sign."""
        value: float = getattr(self, f"{leg.end}_{name}")
        return leg.lateral * value if name.endswith("difference") else value


INPUTS = tuple(SpatialLaw.inputs)
"""Numbers that event feedback may adjust once a stride: those that turn and balance, and the plane's."""


def _other(end: str) -> str:
    return LEGS[1 - LEGS.index(end)]
