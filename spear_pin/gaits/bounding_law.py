"""The bounding controller: its parameters, its legs and phases, and the torques of (5.4)-(5.6), (5.15), (5.20).

A leg of the sagittal model is a pair of legs. Torques are those of the pair; each motor gives half.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, ClassVar

from spear_pin.errors import BadValue, list_names, require
from spear_pin.gaits.inputs import ANGLE, Input
from spear_pin.gaits.legs import AHEAD, Leg
from spear_pin.gaits.virtual_constraints import Evolution, Outputs, demand_accelerations
from spear_pin.hybrid.domain import Law
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.kinds import typed
from spear_pin.model.legs import Leg as RobotLeg
from spear_pin.model.legs import check_side, in_convention, simple
from spear_pin.model.robot import Robot

Shape = tuple[tuple[float, ...], ...]
Valid = Mapping[str, tuple[Callable[[float], bool], str]]
PITCH = 2  # index of the torso's pitch
SIDES = (1.0, -1.0)  # to which Q-SPEAR's knees flex
LEGS = ("posterior", "anterior")
PAIR = 2  # a leg of the sagittal model stands for so many legs, so a joint has so many motors
INPUTS = (
    "posterior_hip_torque",
    "posterior_knee_torque",
    "anterior_hip_torque",
    "anterior_knee_torque",
    "posterior_leg_touchdown",
    "anterior_leg_touchdown",
)
"""Parameters that event feedback may adjust once a stride."""
STATES = 13  # numbers of a section state, torso_x left out
SHAPES = {
    "posterior_stance_swing": (2, 4),
    "anterior_stance_swing": (2, 4),
    "flight_1_trailing": (2, 4),
    "flight_2_trailing": (2, 4),
    "flight_1_landing": (2,),
    "flight_2_landing": (2,),
    "speed_gain": (2,),
    "speed_nominal": (2,),
}


@typed
@dataclass(frozen=True)
class BoundingLaw:
    """Parameters of the bounding controller.

    The source gives k's equivalent (Fig. 5.6), θ̄ and the form of the law. Every other number is a result of a search,
    see `spear_pin.gaits.optimize`. A leg angle γ is the angle of the line from hip to toe from straight down, > 0 with
    the toe ahead.

    Attributes:
        posterior_hip_torque: β_sp of (5.4), in N·m.
        anterior_hip_torque: β_sa of (5.4), in N·m.
        posterior_knee_torque: |ū_p| of (5.5), extending, in N·m.
        anterior_knee_torque: |ū_a| of (5.6), extending, in N·m.
        posterior_leg_touchdown: γ at which the posterior leg lands, in rad.
        anterior_leg_touchdown: γ at which the anterior leg lands, in rad.
        posterior_stance_span: Δ_sp of (5.10), in rad, negative.
        anterior_stance_span: Δ_sa of (5.10), in rad, negative.
        flight_1_span: Δ of (5.19) in the flight after posterior stance, in m.
        flight_2_span: Δ of (5.19) in the flight after anterior stance, in m.
        posterior_stance_swing: Bézier coefficients from the third on of the anterior leg's angle and
            knee in posterior stance (the first two follow from the state, (5.22)).
        anterior_stance_swing: the same for the posterior leg in anterior stance.
        flight_1_trailing: the same for the posterior leg, which has just lifted.
        flight_2_trailing: the same for the anterior leg, which has just lifted.
        flight_1_landing: the third coefficient of the anterior leg's angle and knee; the last three
            are the touchdown values, so that the leg comes to rest.
        flight_2_landing: the same for the posterior leg.
        virtual_stiffness: k_p = k_a of (5.5)-(5.6), in N·m/rad (200 per motor: implied by Fig. 5.6).
        knee_rest: θ̄ of (5.5)-(5.6), by magnitude, in rad (source: 40°).
        knee_touchdown: knee angle of a landing leg, by magnitude, in rad (source: 40°).
        epsilon: ε of (5.16), in s (not in the source).
        lift_off: "knee": a leg lifts when its knee is back at θ̄ (implied by the source), or earlier if its foot
            carries no force; a knee that never flexes beyond θ̄ cannot come back. "force": a leg lifts when the foot
            carries no force.
        nominal: section state (q, v) of the gait, without torso_x, from which a search begins.
        speed_gain: gain of β += K (ẋ_td - ẋ*) at each touchdown, posterior and anterior, in N·s.
        speed_nominal: ẋ* just after posterior and anterior touchdown, in m/s.
        units: units of the scalar numbers, by name.
        inputs: numbers that event feedback may adjust, for Q-SPEAR.

    Example:
        >>> from dataclasses import replace
        >>> from spear_pin import Gait
        >>> law = Gait.load("long_stride").system.law
        >>> replace(law, posterior_hip_torque=-120.0).posterior_hip_torque  # N·m
        -120.0
    """

    posterior_hip_torque: float
    anterior_hip_torque: float
    posterior_knee_torque: float
    anterior_knee_torque: float
    posterior_leg_touchdown: float
    anterior_leg_touchdown: float
    posterior_stance_span: float
    anterior_stance_span: float
    flight_1_span: float
    flight_2_span: float
    posterior_stance_swing: Shape
    anterior_stance_swing: Shape
    flight_1_trailing: Shape
    flight_2_trailing: Shape
    flight_1_landing: tuple[float, ...]
    flight_2_landing: tuple[float, ...]
    virtual_stiffness: float = 400.0
    knee_rest: float = math.radians(40.0)
    knee_touchdown: float = math.radians(40.0)
    epsilon: float = 0.015
    lift_off: str = "knee"
    nominal: tuple[float, ...] = ()
    speed_gain: tuple[float, ...] = (0.0, 0.0)
    speed_nominal: tuple[float, ...] = (0.0, 0.0)
    units: ClassVar[Mapping[str, str]] = {
        **{f"{leg}_{part}_torque": "N·m" for leg in LEGS for part in ("hip", "knee")},
        **{f"{leg}_{what}": "rad" for leg in LEGS for what in ("leg_touchdown", "stance_span")},
        **dict.fromkeys(("flight_1_span", "flight_2_span"), "m"),
        **dict.fromkeys(("knee_rest", "knee_touchdown"), "rad"),
        "virtual_stiffness": "N·m/rad",
        "epsilon": "s",
    }
    inputs: ClassVar[Mapping[str, Input]] = {
        name: Input(50.0, 100.0, True) if name.endswith("torque") else ANGLE for name in INPUTS
    }

    def __post_init__(self) -> None:
        """Checks the fields."""
        valid: Valid = {
            "virtual_stiffness": (lambda k: k >= 0, "a number >= 0, in N·m/rad"),
            "epsilon": (lambda e: e > 0, "a number > 0, in s"),
            **dict.fromkeys(("knee_rest", "knee_touchdown"), (lambda a: 0 < a < math.pi, "between 0 and π rad")),
            **dict.fromkeys((f"{leg}_stance_span" for leg in LEGS), (lambda span: span < 0, "a number < 0, in rad")),
            **dict.fromkeys(("flight_1_span", "flight_2_span"), (lambda span: span > 0, "a number > 0, in m")),
        }
        check_numbers(self, valid, SHAPES)
        if self.nominal != () and not has_shape(self.nominal, (STATES,)):
            raise BadValue("BoundingLaw.nominal", self.nominal, f"{STATES} finite numbers, or ()")

    @property
    def leg_stiffness(self) -> float:
        """The virtual stiffness of a knee of the model, in N·m/rad."""
        return self.virtual_stiffness


def check_numbers(law: Any, valid: Valid, shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Checks the numbers of a law, by tests and what they expect in words, and nested tuples by their shapes.

    Raises:
        BadValue: one is not finite or not valid, or the rule for lift-off is unknown.
    """
    for name, value in vars(law).items():
        place = f"{type(law).__name__}.{name}"
        if name in shapes and not has_shape(value, shapes[name]):
            raise BadValue(place, value, f"{' x '.join(map(str, shapes[name]))} finite numbers, as tuples")
        if name == "lift_off" and value not in ("knee", "force"):
            raise BadValue(place, value, "'knee' or 'force'")
        if name not in (*shapes, "lift_off", "nominal", "plane"):
            require(place, value, *valid.get(name, (lambda number: abs(number) >= 0, "a finite number")))


def has_shape(value: Any, shape: tuple[int, ...]) -> bool:
    """Tells whether a value consists of nested tuples of a given shape that hold finite numbers."""
    if not shape:
        return isinstance(value, Real) and math.isfinite(value)
    fits = isinstance(value, tuple) and len(value) == shape[0]
    return fits and all(has_shape(item, shape[1:]) for item in value)


@dataclass(frozen=True)
class Phase:
    """A phase in which some leg swings.

    Attributes:
        name: name of the phase.
        legs: legs that swing, in the order of the outputs.
        outputs: the controlled outputs.
        bearing: the leg on the ground, in a stance.
        lifted: the leg that lifted last, in a flight.
        landing: the leg that lands next, in a flight.
    """

    name: str
    legs: tuple[Leg, ...]
    outputs: Outputs
    bearing: Leg | None = None
    lifted: Leg | None = None
    landing: Leg | None = None


def support(leg: Leg, q: Any, held: Mapping[str, Any], p: Any, dyn: Dynamics) -> list[tuple[int, Any]]:
    """Returns torques of hip and knee of a supporting leg, (5.4)-(5.6) with corrected signs, as (column, torque).

    The virtual spring is shared: the motor gives the part that the physical spring does not.
    """
    *_, hip, knee = leg.motors
    flexed = leg.flexion(q) - p.knee_rest
    total = -leg.side * (held[f"{leg.name}_knee_torque"] + p.leg_stiffness * flexed)
    return [(hip, held[f"{leg.name}_hip_torque"]), (knee, total - dyn.spring_torque(leg.joint))]


def phases_of(robot: Robot) -> tuple[Phase, ...]:
    """Returns the four phases of the gait in order.

    Raises:
        BadValue: the robot lacks the legs of `q_spear`; see `legs_of`.
    """
    posterior, anterior = legs_of(robot)
    return (
        _stance(posterior, anterior),
        _flight("flight_1", posterior, anterior),
        _stance(anterior, posterior),
        _flight("flight_2", anterior, posterior),
    )


def legs_of(robot: Robot) -> tuple[Leg, Leg]:
    """Returns the posterior and the anterior leg.

    Raises:
        BadValue: the robot lacks coordinates, signs, toes or motors of `q_spear`, or the side to which a knee flexes is
            unknown.
    """
    joints = tuple(f"{name}_{part}" for name in LEGS for part in ("hip", "knee"))
    expected = ("torso_x", "torso_z", "pitch", *joints)
    if robot.coordinates != expected or robot.actuated != joints or robot.toes != ("posterior_toe", "anterior_toe"):
        names = list_names(expected, 8)
        alike = f"a robot as sagittal(...) makes it: coordinates {names}, motors on the last four, two toes"
        raise BadValue("robot", robot, alike)
    posterior, anterior = (
        Leg(
            end=name,
            hip=hip,
            knee=hip + 1,
            side=_side(robot, found, usual),
            lengths=(found.thigh, found.shank),
            motors=(hip - 3, hip - 2),
            joint=f"{name}_knee",
            above=f"{name}_hip",
            toe=f"{name}_toe",
            pitch=PITCH,
        )
        for name, hip, found, usual in zip(LEGS, (3, 5), robot.legs, SIDES, strict=True)
    )
    return posterior, anterior


def _side(robot: Robot, leg: RobotLeg, usual: float) -> float:
    """Returns the side to which a knee flexes by its limits; a robot that was not cut from another has Q-SPEAR's."""
    in_convention(simple(leg))
    return float(leg.side or usual) if robot.cut is None else float(check_side(leg).side)


def _stance(leg: Leg, other: Leg) -> Phase:
    """Returns a single stance: the other leg swings, and s depends on the supporting leg's angle."""
    return Phase(f"{leg.name}_stance", (other,), Outputs(other.controlled, leg.angle, other.motors), bearing=leg)


def _flight(name: str, lifted: Leg, landing: Leg) -> Phase:
    """Returns a flight: both legs swing, and s depends on the torso's travel."""
    first, second = legs = sorted((lifted, landing), key=lambda leg: leg.hip)
    outputs = Outputs((*first.controlled, *second.controlled), ((AHEAD, 1.0),), (*first.motors, *second.motors))
    return Phase(name, tuple(legs), outputs, lifted=lifted, landing=landing)


def evolution(held: Mapping[str, Any]) -> Evolution:
    """Returns the latched desired evolution."""
    return Evolution(held["alpha"], held["origin"], held["span"], held["past"])


def law_of(bearing: Sequence[Leg], outputs: Outputs | None) -> Law:
    """Returns the law for torques: (5.4)-(5.6) of legs on the ground, and (5.15) or (5.20) of outputs of the others."""

    def law(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        torques = [torque for leg in bearing for torque in support(leg, q, held, p, dyn)]
        if outputs is not None:
            demand = demand_accelerations(outputs, evolution(held), q, v, p.epsilon, ops)
            torques += zip(outputs.motors, dyn.imposing(*demand, outputs.motors, torques), strict=True)
        return [torque for _, torque in sorted(torques, key=lambda pair: pair[0])]

    return law
