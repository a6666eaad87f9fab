"""Requests for gaits with given footfalls."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from spear_pin.errors import BadValue, require
from spear_pin.gaits.footfalls.sequence import FOOTFALLS, LEGS, PAIRS, Footfalls
from spear_pin.gaits.request import Wishes, change_fields
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space
from spear_pin.model.spring import PAIR_STIFFNESS, Spring, refuse_unusual

SPRING = Spring(PAIR_STIFFNESS / 2.0, damping=0.0)
"""Of one knee of Q-SPEAR (source: Table 5.1)."""
SHARPEST = 1.0  # rad a stride


@typed
@dataclass(frozen=True)
class StanceLaw:
    """Law for the torques of a leg on the ground, in the form of `SpatialLaw`; its constants are free.

    The hip's torque is constant. The knee's, including the spring's share, is -side (constant + k flexed). `flexed`
    counts from the rest angle, at which the knee also lands and lifts off. The adduction's torque is a constant plus a
    stiffness and a damping about the angle of touchdown.

    Attributes:
        stiffness: k of a knee, in N·m/rad: half of `BoundingLaw.virtual_stiffness`.
        knee_rest: flexion at touchdown and at lift-off, in rad.
        adduction_stiffness: stiffness of the adduction, in N·m/rad.
        adduction_damping: damping of the adduction, in N·m·s/rad.
        most: largest constant of hip and knee, in N·m.
    """

    stiffness: float = 200.0
    knee_rest: float = math.radians(40.0)
    adduction_stiffness: float = 300.0
    adduction_damping: float = 10.0
    most: float = 200.0

    @classmethod
    @typed
    def scaled(cls, robot: Robot, **values: float) -> StanceLaw:
        """Scales Q-SPEAR's law to another robot: torques and stiffnesses by m g l, damping also by √(l/g).

        Args:
            robot: a quadruped on a chain.
            **values: fields with values of their own, in SI units.

        Raises:
            UnknownName: there is no such field.
            BadValue: the robot is no quadruped, or a value is not valid.

        Example:
            >>> from spear_pin import load
            >>> from spear_pin.gaits.footfalls.request import StanceLaw
            >>> StanceLaw.scaled(load("q_spear_full", base="chain")) == StanceLaw()
            True
        """
        one, scale = cls(), scale_in_space(robot)
        numbers = {
            "stiffness": one.stiffness * scale.torque,
            "adduction_stiffness": one.adduction_stiffness * scale.torque,
            "adduction_damping": one.adduction_damping * scale.torque * scale.time,
            "most": one.most * scale.torque,
        }
        return change_fields(one, numbers, values)

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in ("stiffness", "adduction_stiffness", "adduction_damping"):
            require(f"StanceLaw.{name}", getattr(self, name), lambda number: number >= 0, "a number >= 0")
        require("StanceLaw.knee_rest", self.knee_rest, lambda angle: 0 < angle < math.pi, "between 0 and π rad")
        require("StanceLaw.most", self.most, lambda torque: torque > 0, "a number > 0, in N·m")


@typed
@dataclass(frozen=True)
class SwingLaw:
    """Law for legs in the air, in the form of `SpatialLaw`; its coefficients are free.

    In each phase leg angle and knee follow Bézier polynomials over a phase variable, and begin in the leg's own state,
    (5.22). The phase variable is the mean leg angle of the legs on the ground, or the travel of the torso in a flight.
    The last three coefficients of a leg that is about to land equal its angles at touchdown. Adductions move to the
    angle at which they land.

    Attributes:
        adduction_epsilon: ε of the adduction, in s.
        epsilon: ε of (5.16), in s, for leg angle and knee: the simulation corrects errors with it; a collocated gait
            has no such errors.
    """

    adduction_epsilon: float = 0.04
    epsilon: float = 0.015

    @classmethod
    @typed
    def scaled(cls, robot: Robot, **values: float) -> SwingLaw:
        """Scales Q-SPEAR's law to another robot: times by √(l/g); see `StanceLaw.scaled` for the arguments."""
        one, scale = cls(), scale_in_space(robot)
        return change_fields(one, {name: time * scale.time for name, time in vars(one).items()}, values)

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name, time in vars(self).items():
            require(f"SwingLaw.{name}", time, lambda e: e > 0, "a number > 0, in s")


@typed
@dataclass(frozen=True)
class FootfallRequest(Wishes):
    """Request for a gait in space, within the limits of its joints. Defaults are for Q-SPEAR; see `scaled` for others.

    Attributes:
        footfalls: which legs are on the ground, and how many intervals of collocation each phase has.
        turn: turn to the left in a stride, in rad, for footfalls that are not mirrored.
        adduction: largest angle of the adduction joints, in rad; no other bound keeps them from their limits in the
            air.
        tilt: largest pitch and roll of the torso, in rad.
        shortest: least durations of a phase on the ground and of a flight, in s.
        longest: longest duration of any phase, in s.
        longest_stride: longest duration of the stride, in s; the least effort is often at the longest stride.
        spring: spring of each knee, engaged from touchdown to lift-off; None: there is no spring.
        law: law for the torques on the ground; None: torques are free.
        swing: law for legs in the air, where there is a law on the ground; None: their motion is free.

    Example:
        >>> from spear_pin.gaits.footfalls.request import FootfallRequest
        >>> FootfallRequest(speed=2.5).footfalls.mirrored
        True
    """

    speed: float = 2.0
    clearance: float = 0.05
    footfalls: Footfalls = FOOTFALLS["trot"]
    turn: float = 0.0
    adduction: float = 0.35
    tilt: float = 0.35
    shortest: tuple[float, float] = (0.03, 0.02)
    longest: float = 0.4
    longest_stride: float = 0.8
    spring: Spring | None = SPRING
    law: StanceLaw | None = None
    swing: SwingLaw | None = None

    @classmethod
    @typed
    def scaled(cls, robot: Robot, **values: Any) -> FootfallRequest:
        """Scales Q-SPEAR's request to another robot: forces by m g, times by √(l/g), speeds by √(g l).

        Args:
            robot: a quadruped on a chain.
            **values: fields with values of their own, in SI units, such as `law=StanceLaw.scaled(robot)`.

        Raises:
            UnknownName: there is no such field.
            BadValue: the robot is no quadruped, or a value is not valid.
        """
        one, scale = cls(), scale_in_space(robot)
        numbers: dict[str, Any] = {
            "speed": one.speed * scale.speed,
            "minimum_force": one.minimum_force * scale.force,
            "clearance": one.clearance * scale.length,
            "shortest": tuple(time * scale.time for time in one.shortest),
            "longest": one.longest * scale.time,
            "longest_stride": one.longest_stride * scale.time,
            "spring": replace(SPRING, stiffness=SPRING.stiffness * scale.torque),
        }
        return change_fields(one, numbers, values)

    def __post_init__(self) -> None:
        """Checks the fields."""
        super().__post_init__()
        if any(leg in PAIRS for phase in self.footfalls.phases for leg in phase):
            raise BadValue("footfalls", self.footfalls.phases, f"phases with legs among {', '.join(LEGS)}")
        require("turn", self.turn, lambda angle: abs(angle) <= SHARPEST, f"within ±{SHARPEST:g} rad a stride")
        if self.turn and self.footfalls.mirrored:
            raise BadValue("turn", self.turn, "0 with mirrored footfalls; to turn give footfalls.unfolded")
        for name in ("adduction", "tilt"):
            require(name, getattr(self, name), lambda angle: 0 < angle < math.pi / 2, "between 0 and π/2 rad")
        if len(self.shortest) != 2 or not 0 < min(self.shortest) <= max(self.shortest) < self.longest:
            raise BadValue("shortest", self.shortest, f"two durations > 0, below the longest, {self.longest:g} s")
        require("longest_stride", self.longest_stride, lambda time: time > 0, "a number > 0, in s")
        if self.swing is not None and self.law is None:
            raise BadValue("swing", self.swing, "None without a law on the ground; give law=StanceLaw(...) too")
        if self.spring is not None:
            refuse_unusual(self.spring)
            if self.spring.rest is not None:
                raise BadValue("spring.rest", self.spring.rest, "None: these springs are latched at touchdown")
