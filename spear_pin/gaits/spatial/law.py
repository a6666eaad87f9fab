"""The bounding controller in space: the plane's numbers for each leg, and the control of the adduction joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.gaits.bounding_law import INPUTS as SAGITTAL
from spear_pin.gaits.bounding_law import LEGS, PAIR, BoundingLaw, Shape
from spear_pin.gaits.spatial.legs import FLIGHTS, Group, Leg
from spear_pin.gaits.spatial.torques import ADJUSTED, adjusted
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space

ANTISYMMETRIC = ("hip_difference", "knee_difference", "leg_difference", "adduction", "adduction_torque")
SYMMETRIC = ("spread", "squeeze")
ACROSS = tuple(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ANTISYMMETRIC)
"""Parameters that are zero in symmetric motion, and change sign in the mirror: what turns and what balances."""
INPUTS = (*ACROSS, *SAGITTAL)
"""Parameters that event feedback adjusts once a stride: these, and the plane's."""
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
        heading: yaw to which feedback steers, in rad.
        nominal: section state (q, v) of the gait, x = y = yaw = 0, with which feedback compares.
        feedback: event feedback, one row for each of `INPUTS`, one column for each of `nominal`.
        feedback_limits: largest adjustment of each of `INPUTS`, in N·m and rad.

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
    heading: float = 0.0
    nominal: tuple[float, ...] = ()
    feedback: Shape = ()
    feedback_limits: tuple[float, ...] = (*2 * (100.0, 100.0, 0.2, 0.3, 30.0), *4 * (100.0,), *2 * (0.2,))

    def __post_init__(self) -> None:
        """Checks the fields."""
        valid: dict[str, tuple[Callable[[float], bool], str]] = {
            "adduction_stiffness": (lambda k: k >= 0, "a number >= 0, in N·m/rad"),
            "adduction_damping": (lambda b: b >= 0, "a number >= 0, in N·m·s/rad"),
            "adduction_epsilon": (lambda e: e > 0, "a number > 0, in s"),
        }
        for field in fields(self)[1:]:
            if isinstance(getattr(self, field.name), tuple):
                continue
            test, expected = valid.get(field.name, (math.isfinite, "a finite number"))
            require(f"SpatialLaw.{field.name}", getattr(self, field.name), test, expected)
        if self.plane.feedback:
            raise BadValue("SpatialLaw.plane.feedback", "event feedback", "(): in space give SpatialLaw.feedback")
        if self.feedback and np.shape(self.feedback) != (len(INPUTS), len(self.nominal)):
            expected = f"{len(INPUTS)} x {len(self.nominal)} numbers, as many columns as `nominal` has, or ()"
            raise BadValue("SpatialLaw.feedback", self.feedback, expected)
        if len(self.feedback_limits) != len(INPUTS) or min(self.feedback_limits) < 0:
            raise BadValue("SpatialLaw.feedback_limits", self.feedback_limits, f"{len(INPUTS)} numbers >= 0")

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
            feedback_limits=limits_for(robot, INPUTS, one.feedback_limits),
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

    def torques(self, leg: Leg, held: Mapping[str, Any], ahead: float) -> tuple[float, float, float]:
        """Returns torques of a landing leg for adduction (to the left), hip and knee (extending), in N·m.

        Args:
            leg: the leg.
            held: latched values.
            ahead: speed of the torso along its heading, in m/s.
        """
        i = LEGS.index(leg.end)
        faster = self.plane.speed_gain[i] * (ahead - self.plane.speed_nominal[i])
        hip, knee = (self._of_pair(leg, f"{name}_torque", held) for name in ("hip", "knee"))
        squeeze = getattr(self, f"{leg.end}_squeeze")
        return (
            self._of(leg, "adduction_torque", held) - leg.lateral * squeeze,
            (hip + faster) / PAIR + self._of(leg, "hip_difference", held),
            knee / PAIR + self._of(leg, "knee_difference", held),
        )

    def swing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that swings while the other pair stands."""
        shape: Shape = getattr(self.plane, f"{_other(leg.end)}_stance_swing")
        return shape

    def trailing(self, leg: Leg) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that trails after its lift-off."""
        shape: Shape = getattr(self.plane, f"{_FLIGHTS[leg.end]}_trailing")
        return shape

    def landing(self, leg: Leg, held: Mapping[str, Any]) -> Shape:
        """Returns coefficients of γ and knee, from the third on, for a leg that moves to its touchdown angles."""
        angle, knee = getattr(self.plane, f"{_FLIGHTS[_other(leg.end)]}_landing")
        target = self._of_pair(leg, "leg_touchdown", held) + self._of(leg, "leg_difference", held)
        return (angle, *3 * (target,)), (knee, *3 * (leg.bends * self.plane.knee_touchdown,))

    def span_of_stance(self, group: Group) -> float:
        """Returns Δ of (5.10), for the mean leg angle of a pair on the ground, in rad."""
        span: float = getattr(self.plane, f"{group.name}_stance_span")
        return span

    def span_of_flight(self, group: Group) -> float:
        """Returns Δ of (5.19), in the flight after the stance of a pair, or of all legs, in m."""
        span: float = getattr(self.plane, f"{group.flight}_span")
        return span

    def adduction_touchdown(self, leg: Leg, held: Mapping[str, Any]) -> float:
        """Returns the angle of a leg's adduction at touchdown, to the left, in rad."""
        spread: float = getattr(self, f"{leg.end}_spread")
        return self._of(leg, "adduction", held) + leg.lateral * spread

    def _of(self, leg: Leg, name: str, held: Mapping[str, Any]) -> float:
        """Returns one of `ANTISYMMETRIC` for a leg, as adjusted; a difference has the leg's sign."""
        value = self._adjusted(self, f"{leg.end}_{name}", held)
        return leg.lateral * value if name.endswith("difference") else value

    def _of_pair(self, leg: Leg, name: str, held: Mapping[str, Any]) -> float:
        """Returns a number of the plane's law for a leg's pair, as adjusted."""
        return self._adjusted(self.plane, f"{leg.end}_{name}", held)

    def _adjusted(self, owner: Any, name: str, held: Mapping[str, Any]) -> float:
        value: float = getattr(owner, name)
        return value + held[ADJUSTED][INPUTS.index(name)] if self.feedback and ADJUSTED in held else value

    def adjustment(self, q: Sequence[float], v: Sequence[float]) -> tuple[float, ...]:
        """Returns the adjustment of `INPUTS` for a stride by event feedback, within limits, from a section state."""
        return adjusted(self.feedback, self.nominal, self.feedback_limits, q, v, self.heading)


def is_angle(name: str) -> bool:
    """Tells whether one of `INPUTS`, or of a trot's inputs, is an angle; the others are torques."""
    return name.endswith(("leg_difference", "adduction", "spread", "touchdown"))


def limits_for(robot: Robot, inputs: Sequence[str], limits: Sequence[float]) -> tuple[float, ...]:
    """Scales Q-SPEAR's limits of event feedback to a robot: angles stay, torques scale with m g l."""
    torque = scale_in_space(robot).torque
    return tuple(limit * (1.0 if is_angle(name) else torque) for name, limit in zip(inputs, limits, strict=True))


def _other(end: str) -> str:
    return LEGS[1 - LEGS.index(end)]
