"""Requests for a bounding gait, and the objectives that may be minimised."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.gaits.bounding_law import PAIR, BoundingLaw, legs_of
from spear_pin.gaits.legs import Leg
from spear_pin.hybrid.contact import Contact
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, scale_of
from spear_pin.model.spring import PAIR_STIFFNESS, Spring

OBJECTIVES: dict[str, tuple[str, str]] = {
    "effort_per_distance": ("N²·m·s", "integral of the squared torques of all motors, per metre"),
    "hip": ("N²·m·s", "the same, the hips' counted ten times"),
    "cost_of_transport": ("1", "integral of |motor power| over weight and distance"),
    "peak": ("N·m", "largest torque of a motor"),
    "electrical": (
        "1",
        "cost of transport of the power that the motors draw, of joints without a drive their positive power",
    ),
    "violation": ("N·m", "most that a knee motor's envelope is exceeded by"),
}
"""Objectives that can be minimised: name -> unit, meaning."""

R = TypeVar("R", bound=Any)
LONGEST_STRIDE = 1.0  # s: limits of the search for Q-SPEAR's size, also in the next lines
FASTEST, FARTHEST = 30.0, 4.0  # m/s, m
HIGHEST = 0.9  # m: of the torso
SHORTEST_FLIGHT, LONGEST_PHASE = 0.02, 0.4  # s
FLEXED = 2.4  # rad: of a knee
STEEPEST = 1.2  # rad: of a leg
SURE = 0.9375  # share of the ground's friction; with all of it a foot slips between nodes
SPARE = 0.1  # rad: least distance of a landing knee from its straightest angle


@typed
@dataclass(frozen=True)
class Wishes:
    """What is asked of any gait that is found by collocation, in the plane or in space.

    In the plane, where a leg stands for a pair, forces and torques are those of a pair; those of `hip_drive` and
    `knee_drive` are always those of one motor.

    Attributes:
        speed: mean speed along the path, in m/s.
        objective: a key of `OBJECTIVES`.
        friction: coefficient of friction that forces and impulses may use.
        minimum_force: least normal force on a foot on the ground, in N.
        clearance: least height of a foot in the air, in m: in the plane while the other leg stands, in space in the
            middle of its way.
        hip_torque: largest hip torque, in N·m; None means no bound.
        knee_drive: motor, gearbox and bus of each knee; None means no bound.
        hip_drive: motor, gearbox and bus of each hip; None: the objective "electrical" counts the hips' positive work.
    """

    legs: ClassVar[int] = 1  # that a leg of the model stands for
    speed: float = 2.5
    objective: str = "effort_per_distance"
    friction: float = 0.6
    minimum_force: float = 20.0
    clearance: float = 0.03
    hip_torque: float | None = None
    knee_drive: Drive | None = None
    hip_drive: Drive | None = None

    def __post_init__(self) -> None:
        """Checks the fields."""
        if self.objective not in OBJECTIVES:
            raise UnknownName("objective", self.objective, OBJECTIVES)
        if self.objective in ("electrical", "violation") and self.knee_drive is None:
            raise BadValue("knee_drive", None, f"a drive, for the objective {self.objective!r}")
        require("speed", self.speed, lambda v: v > 0, "a number > 0, in m/s")
        require("friction", self.friction, lambda mu: mu > 0, "a number > 0")
        for name, unit in (("minimum_force", "N"), ("clearance", "m")):
            require(name, getattr(self, name), lambda number: number >= 0, f"a number >= 0, in {unit}")
        if self.hip_torque is not None:
            require("hip_torque", self.hip_torque, lambda u: u >= 0, "a number >= 0, in N·m, or None")


@typed
@dataclass(frozen=True)
class Request(Wishes):
    """Request for a bounding gait in the plane, where torques and forces are those of a pair of legs.

    Defaults are for Q-SPEAR (source: 2.5 m/s); for another robot see `scaled`. With lift-off by force the normal force
    only may not pull.

    Attributes:
        lift_off: "knee" or "force", see `BoundingLaw`.
        minimum_stride: least duration of a stride, in s.
        minimum_stance: least duration of a stance, in s.
        minimum_knee_torque: least |ū| of (5.5)-(5.6), in N·m.
        stiffness: stiffness of the physical knee springs, in N·m/rad; None leaves it free.
        virtual_stiffness: k of (5.5)-(5.6), in N·m/rad; None leaves it free.
        knee_touchdown: knee angle at touchdown, by magnitude, in rad; None leaves it free.
        knee_rest: θ̄ of (5.5)-(5.6), by magnitude, in rad.
        leg_touchdown: bounds on the leg angle at touchdown, in rad.
        hardening: hardening of the physical knee springs, in N·m/rad³.
        preload: preload of these springs, in N·m.
        table: table of these springs, instead of a stiffness; see `Spring`.
        rest: rest flexion, in rad, of springs that never release and act both ways; None: the springs are switched.
        within_limits: whether angles, rates and torques stay within the limits that the robot's file gives its joints.
    """

    legs: ClassVar[int] = PAIR
    lift_off: str = "knee"
    minimum_stride: float = 0.0
    minimum_stance: float = 0.05
    minimum_knee_torque: float = 10.0
    stiffness: float | None = PAIR_STIFFNESS
    virtual_stiffness: float | None = BoundingLaw.virtual_stiffness
    knee_touchdown: float | None = BoundingLaw.knee_touchdown
    knee_rest: float = BoundingLaw.knee_rest
    leg_touchdown: tuple[float, float] = (-0.3, 0.7)
    hardening: float = 0.0
    preload: float = 0.0
    table: tuple[tuple[float, float], ...] = ()
    rest: float | None = None
    within_limits: bool = False

    @classmethod
    @typed
    def scaled(cls, robot: Robot, **values: Any) -> Request:
        """Scales Q-SPEAR's request to another robot, within the limits of its joints.

        Forces scale with m g, torques and stiffnesses with m g l, times with √(l/g), speeds with √(g l). A knee that
        cannot straighten to 40° lands and rests at `SPARE` above its limit. Most of the available friction may be used,
        because legs whose knees point backward strike the ground at a slant.

        Args:
            robot: a robot with two pairs of legs, as `spear_pin.sagittal` cuts it.
            **values: fields with values of their own, in SI units.

        Raises:
            BadValue: the robot has no legs in the plane, or a value is not valid.
        """
        one, scale = cls(), scale_of(robot)
        bent = max(one.knee_rest, *(_straightest(robot, leg) + SPARE for leg in legs_of(robot)))
        numbers = {
            "speed": one.speed * scale.speed,
            "minimum_force": one.minimum_force * scale.force,
            "clearance": one.clearance * scale.length,
            "minimum_stance": one.minimum_stance * scale.time,
            "minimum_knee_torque": one.minimum_knee_torque * scale.torque,
            "stiffness": PAIR_STIFFNESS * scale.torque,
            "virtual_stiffness": BoundingLaw.virtual_stiffness * scale.torque,
            "knee_touchdown": bent,
            "knee_rest": bent,
            "friction": SURE * Contact().friction,
            "within_limits": True,
        }
        return change_fields(one, numbers, values)

    def __post_init__(self) -> None:
        """Checks the fields."""
        super().__post_init__()
        if self.lift_off not in ("knee", "force"):
            raise UnknownName("rule of lift-off", self.lift_off, ("knee", "force"))
        require("minimum_knee_torque", self.minimum_knee_torque, lambda u: u >= 0, "a number >= 0, in N·m")
        require("minimum_stride", self.minimum_stride, lambda t: t >= 0, "a number >= 0, in s")
        require("minimum_stance", self.minimum_stance, lambda t: t > 0, "a number > 0, in s")
        for name in ("stiffness", "virtual_stiffness"):
            if getattr(self, name) is not None:
                require(name, getattr(self, name), lambda k: k >= 0, "a number >= 0, in N·m/rad, or None")
        self.spring(PAIR_STIFFNESS if self.stiffness is None else self.stiffness)  # it says what is valid
        self._check_angles()

    def spring(self, stiffness: float) -> Spring:
        """Returns the physical knee springs of a pair of legs, with a stiffness in N·m/rad."""
        of_its_law: dict[str, Any] = {"hardening": self.hardening, "preload": self.preload, "table": self.table}
        return Spring(stiffness, damping=0.0, rest=self.rest, unilateral=self.rest is None, **of_its_law)

    def check(self, scale: Scale) -> None:
        """Checks that the request is within the range of the search, which scales with the robot's size.

        Raises:
            BadValue: a speed, a height or a duration is outside that range.
        """
        fastest, highest, farthest = FASTEST * scale.speed, HIGHEST * scale.length, FARTHEST * scale.length
        longest, longest_phase, shortest_flight = (
            time * scale.time for time in (LONGEST_STRIDE, LONGEST_PHASE, SHORTEST_FLIGHT)
        )
        require("speed", self.speed, lambda v: v <= fastest, f"a number > 0, at most {fastest:.4g}, in m/s")
        require("clearance", self.clearance, lambda z: z < highest, f"a number >= 0, below {highest:.4g}, in m")
        within = f"a number >= 0, at most {longest:.4g}, in s"
        require("minimum_stride", self.minimum_stride, lambda t: t <= longest, within)
        within = f"between 0 and {longest_phase:.4g} s"
        require("minimum_stance", self.minimum_stance, lambda t: t < longest_phase, within)
        shortest = max(self.minimum_stride, 2.0 * (self.minimum_stance + shortest_flight))
        if self.speed * shortest > farthest:
            expected = f"at most {farthest / shortest:.3g} m/s, for a stride of at least {shortest:.4g} s has to end"
            raise BadValue("speed", self.speed, f"{expected} within {farthest:.4g} m")

    def _check_angles(self) -> None:
        within = f"a number > 0, at most {FLEXED:g}, in rad"
        require("knee_rest", self.knee_rest, lambda a: 0 < a <= FLEXED, within)
        if self.knee_touchdown is not None:
            require("knee_touchdown", self.knee_touchdown, lambda a: 0 < a <= FLEXED, f"{within}, or None")
        expected = f"two angles in rad, the lower one first, within ±{STEEPEST:g}"
        try:
            least, most = self.leg_touchdown
        except (TypeError, ValueError):
            raise BadValue("leg_touchdown", self.leg_touchdown, expected) from None
        for bound in (least, most):
            require("leg_touchdown", bound, lambda angle: abs(angle) <= STEEPEST, expected)
        if least > most:
            raise BadValue("leg_touchdown", self.leg_touchdown, expected)


def change_fields(one: R, numbers: Mapping[str, Any], values: Mapping[str, Any]) -> R:
    """Returns a request, or a law in it, with changed numbers and the named values.

    Raises:
        UnknownName: a name is not a field's.
    """
    if unknown := values.keys() - vars(one).keys():
        raise UnknownName(f"field of {type(one).__name__}", min(unknown), vars(one))
    return replace(one, **{**numbers, **values})


def _straightest(robot: Robot, leg: Leg) -> float:
    """Returns the least flexion of a knee by its joint's limits, in rad; below zero if it can bend the other way."""
    return min(leg.side * angle for angle in robot.limits[leg.joint].position)
