"""A leg on a boom that hops round its post: HOPPY's published law, and its automaton.

The contact is that of the makers' simulator. The toe is pinned where it strikes, vertically and along the circle about
the post, whatever force that takes. Towards the post it yields, as the boom sways. It lifts off where its normal force
has fallen to a small value. Coulomb friction along the circle is available instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.gaits.inputs import Input
from spear_pin.gaits.virtual_constraints import bezier
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, PINNED, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, rate, touchdown
from spear_pin.hybrid.result import Run
from spear_pin.kinds import typed
from spear_pin.model.motor import Gearbox, gear_constant
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring, refuse_unusual

COORDINATES = YAW, TILT, HIP, KNEE = "boom_yaw", "boom_tilt", "hip", "knee"
Forces = tuple[float, ...]


@typed
@dataclass(frozen=True)
class RoundHoppingLaw:
    """Parameters of the controller of a leg on a boom; defaults are HOPPY's, from its authors' simulator.

    The law commands torques. `driven` applies each torque as the voltage that gives it to a motor at rest; where the
    motor turns, its back-EMF takes a part.

    In flight a spring and a damper draw the toe to a point below the hip, or ahead of it as the hip moves on. In stance
    the toe pushes with a force along the circle and upward that is a Bézier polynomial over the time since touchdown,
    and both joints are drawn softly to a posture. Places and forces are in the plane that boom and thigh span.

    Attributes:
        hip_height: commanded height of the hip above the toe in flight, in m.
        placement: K of the term K ẋ that is added to the commanded place of the toe along the circle, in s; ẋ is the
            hip's speed along the circle.
        toe_stiffness: stiffness of the toe's spring in flight, in N/m.
        toe_damping: damping of the toe in flight, in N·s/m.
        push_ahead: coefficients of the ground's force on the toe along the circle, in N.
        push_up: coefficients of the vertical force, in N.
        push_time: time over which they act, in s.
        hip_posture: commanded angle of the hip in stance, in rad.
        knee_posture: commanded angle of the knee in stance, in rad.
        posture_gain: gain of both joints in stance, in N·m/rad.
        posture_damping: damping of both joints in stance, in N·m·s/rad.
        lift_off_force: normal force at which the toe lifts off as the force falls, in N; 0 with a limit of friction.
        hip_back_emf: torque that the hip's motor loses per rate, in N·m·s/rad; 0: the torque is as commanded.
        knee_back_emf: the same for the knee's motor.
        unlimited_friction: whether the toe sticks whatever friction that takes; else it sticks and slips along the
            circle by the ground's coefficient.
        units: units of these numbers, by name.
        inputs: numbers that event feedback may adjust, for HOPPY.

    Example:
        >>> from spear_pin.gaits.round_hopping import RoundHoppingLaw
        >>> max(RoundHoppingLaw().push_up)  # N
        100.0
    """

    hip_height: float = 0.15
    placement: float = 0.1
    toe_stiffness: float = 150.0
    toe_damping: float = 5.0
    push_ahead: Forces = (0.0, 0.0, -25.0, 0.0, 0.0)
    push_up: Forces = (0.0, 20.0, 100.0, 0.0, 0.0)
    push_time: float = 0.35
    hip_posture: float = math.pi / 3
    knee_posture: float = math.pi / 2
    posture_gain: float = 0.03
    posture_damping: float = 0.08
    lift_off_force: float = 1.5
    hip_back_emf: float = 0.0
    knee_back_emf: float = 0.0
    unlimited_friction: bool = True
    units: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("placement", "push_time"), "s"),
        **dict.fromkeys(("hip_posture", "knee_posture"), "rad"),
        **dict.fromkeys(("posture_damping", "hip_back_emf", "knee_back_emf"), "N·m·s/rad"),
        "hip_height": "m",
        "toe_stiffness": "N/m",
        "toe_damping": "N·s/m",
        "posture_gain": "N·m/rad",
        "lift_off_force": "N",
    }
    inputs: ClassVar[Mapping[str, Input]] = {"hip_height": Input(0.01, 0.03), "placement": Input(0.02, 0.05)}

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in ("hip_height", "push_time"):
            require(f"RoundHoppingLaw.{name}", getattr(self, name), lambda number: number > 0, "a number > 0")
        gains = ("toe_stiffness", "toe_damping", "posture_gain", "posture_damping")
        for name in (*gains, "lift_off_force", "hip_back_emf", "knee_back_emf"):
            require(f"RoundHoppingLaw.{name}", getattr(self, name), lambda number: number >= 0, "a number >= 0")
        require("RoundHoppingLaw.placement", self.placement, lambda gain: abs(gain) >= 0, "a finite number, in s")
        for name in ("hip_posture", "knee_posture"):
            require(f"RoundHoppingLaw.{name}", getattr(self, name), lambda a: abs(a) < math.pi, "within ±π rad")
        for name in ("push_ahead", "push_up"):
            for i, force in enumerate(forces := getattr(self, name)):
                require(f"RoundHoppingLaw.{name}[{i}]", force, lambda force: abs(force) >= 0, "a finite number, in N")
            if not forces:
                raise BadValue(f"RoundHoppingLaw.{name}", forces, "one coefficient or more, in N")

    @classmethod
    @typed
    def driven(cls, robot: Robot) -> RoundHoppingLaw:
        """Returns HOPPY's law with motors driven by voltage: back-EMF N² η K_t²/R each; 0 if not known.

        Args:
            robot: a robot whose settings give its motors, as `load("hoppy")`.
        """
        return cls(hip_back_emf=_back_emf(robot, HIP), knee_back_emf=_back_emf(robot, KNEE))


def _back_emf(robot: Robot, joint: str) -> float:
    """Returns the torque that a motor at a given voltage loses per rate of its joint, in N·m·s/rad."""
    known = robot.settings
    if joint not in known.motors:
        return 0.0
    motor, gears = known.motors[joint], Gearbox(robot.gear_ratio(joint), known.efficiencies[joint])
    return gears.efficiency * gear_constant(motor, gears) ** 2 / motor.known("resistance")


@dataclass(frozen=True)
class Limb:
    """The leg in the plane that it moves in, and the boom.

    Attributes:
        thigh: length of the thigh, in m.
        shank: length of the shank, in m.
        reach: distance from the post to the plane of the leg, in m.
    """

    thigh: float
    shank: float
    reach: float

    def toe(self, hip: Any, knee: Any, ops: Operations) -> tuple[tuple[Any, Any], tuple[tuple[Any, Any], ...]]:
        """Returns the toe's place ahead of and above the hip, in m, and its Jacobian, rows of hip and knee."""
        lower = hip - knee
        x, z = self.thigh * ops.sin(hip), -self.thigh * ops.cos(hip)
        dx, dz = self.shank * ops.sin(lower), -self.shank * ops.cos(lower)
        return (x + dx, z + dz), ((-z - dz, dz), (x + dx, -dx))

    def torques(self, q: Any, force: tuple[Any, Any], ops: Operations) -> tuple[Any, Any]:
        """Returns torques of hip and knee that move the toe by a force ahead and up, in N·m."""
        _, (ahead, up) = self.toe(q[2], q[3], ops)
        return ahead[0] * force[0] + up[0] * force[1], ahead[1] * force[0] + up[1] * force[1]


def limb_of(robot: Robot) -> Limb:
    """Returns the leg of a robot that goes round a post.

    Raises:
        BadValue: the robot has other coordinates or motors, or no post.
    """
    joints = robot.coordinates == COORDINATES and robot.actuated == (HIP, KNEE)
    if robot.arm is None or not joints or robot.toes != ("toe",):
        raise BadValue("robot", robot, "load('hoppy'), or one of the same joints on a post")
    (leg,) = robot.legs
    return Limb(leg.thigh, leg.shank, robot.arm)


def find_turning_torques(torques: tuple[Any, Any], v: Any, p: RoundHoppingLaw) -> tuple[Any, Any]:
    """Returns hip and knee torques, in N·m, of turning motors, given the torques commanded as at rest."""
    return torques[0] - p.hip_back_emf * v[2], torques[1] - p.knee_back_emf * v[3]


def laws(limb: Limb) -> tuple[Callable[..., Sequence[Any]], Callable[..., Sequence[Any]]]:
    """Returns the laws of flight and stance for hip and knee torque in N·m."""

    def flight(t: Any, q: Any, v: Any, held: Any, p: RoundHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        (x, z), (ahead, up) = limb.toe(q[2], q[3], ops)
        wanted = p.placement * (limb.reach * v[0]), -p.hip_height
        speeds = ahead[0] * v[2] + ahead[1] * v[3], up[0] * v[2] + up[1] * v[3]
        draw = tuple(
            p.toe_stiffness * (there - here) - p.toe_damping * speed
            for there, here, speed in zip(wanted, (x, z), speeds, strict=True)
        )
        return find_turning_torques(limb.torques(q, (draw[0], draw[1]), ops), v, p)

    def stance(t: Any, q: Any, v: Any, held: Any, p: RoundHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        s = 1.0 - ops.maximum(1.0 - t / p.push_time, 0.0)
        hip, knee = limb.torques(q, (-bezier(p.push_ahead, s)[0], -bezier(p.push_up, s)[0]), ops)
        commanded = (
            hip + p.posture_gain * (p.hip_posture - q[2]) - p.posture_damping * v[2],
            knee + p.posture_gain * (p.knee_posture - q[3]) - p.posture_damping * v[3],
        )
        return find_turning_torques(commanded, v, p)

    return flight, stance


@typed
def round_hopping(
    robot: Robot,
    law: RoundHoppingLaw | None = None,
    spring: Spring | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the automaton of a leg that hops round a post: stance and flight.

    Args:
        robot: `load("hoppy")`.
        law: parameters of the controller; by default `RoundHoppingLaw.driven`.
        spring: spring of the knee, always engaged; by default that of the robot's TOML file.
        contact: friction of level ground, where the law's friction is limited.
        ground: level ground, instead of `contact`; its height counts.

    Raises:
        BadValue: the robot has other joints or no post, the spring has no rest of its own or releases, the ground is
            sloped, or both contact and ground are given.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.round_hopping import round_hopping
        >>> round_hopping(load("hoppy")).cyclic
        ('boom_yaw',)
    """
    limb, contact = limb_of(robot), choose_ground(contact, ground)
    law = law or RoundHoppingLaw.driven(robot)
    own = robot.settings.springs.get(KNEE)
    spring = spring or own or Spring(0.0, damping=0.0, rest=0.0, unilateral=False)
    if spring.rest is None or spring.unilateral:
        raise BadValue(
            "spring", spring, "a spring that pulls and pushes about a rest angle: Spring(rest=0.0, unilateral=False)"
        )
    refuse_unusual(spring)
    flight_law, stance_law = laws(limb)
    mount = Mount(KNEE, spring, rest="knee_rest", taut="taut")
    always: Held = {"knee_rest": spring.rest, "taut": 1.0}

    def unloaded(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return dyn.force("toe")[-1] - p.lift_off_force

    def engaged(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
        return always

    fallen = fall([HIP, KNEE])
    into_flight = Reset(latch=engaged, phase="flight")
    lift_off = Guard("lift_off", unloaded, into_flight, patience=math.inf)  # it begins with less
    lands = touchdown("toe", Reset(impact=("toe",), latch=engaged, phase="stance"))
    apex = Guard("apex", rate(robot.index(TILT), -1.0))
    stance = Domain("stance", "stance", (PINNED,), stance_law, mounts=(mount,), guards=(lift_off, *fallen))
    limited = replace(stance, contacts=(STICK,), guards=fallen)
    return HybridSystem(
        kind="round_hopping",
        robot=robot,
        law=law,
        springs={KNEE: spring},
        contact=contact,
        domains=(
            *((stance,) if law.unlimited_friction else contact_domains(limited, robot.toes, into_flight)),
            Domain("flight", "flight", (OPEN,), flight_law, mounts=(mount,), guards=(lands, *fallen, apex)),
        ),
        section="touchdown",
        cyclic=(YAW,),
        build=round_hopping,
        guess=lambda: _guess(robot, law, as_ground(contact)),
        measures=_measures(robot, limb),
    )


def _guess(robot: Robot, law: RoundHoppingLaw, ground: Ground) -> tuple[Any, Any]:
    """Returns a state just after touchdown in the posture of stance; the boom comes down and goes round."""
    q = np.array([0.0, 0.0, law.hip_posture, law.knee_posture])
    for _ in range(20):  # Newton's method: the tilt that puts the toe on the ground
        height, jacobian = ground.foot(robot, q, "toe")
        q[1] -= height / jacobian[-1, 1]
    v = np.array([0.0, 2.0, 0.0, 0.0])
    jacobian = robot.toe_jacobian(q, "toe")
    v[2:] = np.linalg.solve(jacobian[:, 2:], -jacobian @ v)
    return q, v


def _measures(robot: Robot, limb: Limb) -> Mapping[str, Callable[[Run], float]]:
    """Returns the measures of a hop; speeds are along the circle of the hip, positive to the left about the post."""
    return {
        "flight_time": lambda run: run.durations["flight"],
        "stance_time": lambda run: run.durations["stance"],
        "period": lambda run: run.durations["flight"] + run.durations["stance"],
        "apex_height": lambda run: float(robot.frame_position(run.event("apex").q, HIP)[2]),
        "mean_speed": lambda run: (
            limb.reach * (run.state[0][0] - run.start[0][0]) / (run.durations["flight"] + run.durations["stance"])
        ),
    }
