"""A leg on a boom hopping round its post: HOPPY's published law, and its automaton.

Contact is what its makers simulate: the toe is pinned to where it strikes along the circle about the post, and
vertically, whatever that takes; towards the post it yields, as the boom sways. It lifts off where its normal force has
fallen to a little more than nothing. Coulomb's friction along the circle may be had instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, PINNED, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, given
from spear_pin.hybrid.phases import contact_domains, fall, rate, touchdown
from spear_pin.hybrid.result import Run
from spear_pin.kinds import typed
from spear_pin.model.motor import Gearbox, geared_constant
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

COORDINATES = YAW, TILT, HIP, KNEE = "boom_yaw", "boom_tilt", "hip", "knee"
Forces = tuple[float, ...]


@typed
@dataclass(frozen=True)
class RoundHoppingLaw:
    """Parameters of the controller of a leg on a boom; numbers by default are HOPPY's, of its authors' simulator.

    What it commands is torque; `driven` has it as the voltage that gives this torque to a motor at rest, of which the
    back-EMF takes its share where the motor turns.

    In flight a spring and a damper draw the toe to a point below the hip, or before it as the hip moves on; in stance
    the toe pushes with a force along the circle and upward that is a Bézier polynomial over the time since touchdown,
    and both joints are drawn to a posture, softly. Places and forces are in the plane that boom and thigh span.

    Attributes:
        height: of the hip above the toe that is commanded in flight, in m.
        placement: K of the term K ẋ that is added to where the toe is commanded along the circle, ẋ being the hip's
            speed along it, in s.
        stiffness: of the toe in flight, in N/m.
        damping: of the toe in flight, in N·s/m.
        push_ahead: coefficients of the ground's force on the toe along the circle, in N.
        push_up: of the vertical one, in N.
        push_time: over which they act, in s.
        hip_posture: the hip's angle that is commanded in stance, in rad.
        knee_posture: the knee's, in rad.
        posture_gain: of both in stance, in N·m/rad.
        posture_damping: of both in stance, in N·m·s/rad.
        lift_off_force: normal force at which the toe lifts off as it falls, in N; with a limit of friction it is 0.
        hip_back_emf: torque of the hip's motor that its rate takes from it, in N·m·s/rad; 0: torque is as commanded.
        knee_back_emf: the same of the knee's.
        unlimited_friction: whether the toe is held whatever friction that takes; else it sticks and slips along the
            circle by the ground's coefficient.
        units: of these numbers, by name.

    Example:
        >>> from spear_pin.gaits.round_hopping import RoundHoppingLaw
        >>> max(RoundHoppingLaw().push_up)  # N
        100.0
    """

    height: float = 0.15
    placement: float = 0.1
    stiffness: float = 150.0
    damping: float = 5.0
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
        "height": "m",
        "stiffness": "N/m",
        "damping": "N·s/m",
        "posture_gain": "N·m/rad",
        "lift_off_force": "N",
    }

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("height", "push_time"):
            require(f"RoundHoppingLaw.{name}", getattr(self, name), lambda number: number > 0, "a number > 0")
        gains = ("stiffness", "damping", "posture_gain", "posture_damping")
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
        """HOPPY's law with motors that are driven by voltage: N² η K_t²/R of back-EMF each; 0 of one that is not known.

        Args:
            robot: whose settings say its motors, as `load("hoppy")`.
        """
        return cls(hip_back_emf=_back_emf(robot, HIP), knee_back_emf=_back_emf(robot, KNEE))


def _back_emf(robot: Robot, joint: str) -> float:
    """Torque that a joint's rate takes from its motor at a given voltage, in N·m·s/rad."""
    known = robot.settings
    if known is None or joint not in known.motors:
        return 0.0
    motor, gears = known.motors[joint], Gearbox(robot.gear_ratio(joint), known.efficiencies[joint])
    return gears.efficiency * geared_constant(motor, gears) ** 2 / motor.known("resistance")


@dataclass(frozen=True)
class Limb:
    """The leg in the plane that it moves in, and the boom.

    Attributes:
        thigh: length, in m.
        shank: length, in m.
        reach: from the post to the plane of the leg, in m.
    """

    thigh: float
    shank: float
    reach: float

    def toe(self, hip: Any, knee: Any, ops: Operations) -> tuple[tuple[Any, Any], tuple[tuple[Any, Any], ...]]:
        """The toe's place before and above the hip, in m, and its Jacobian, rows of hip and knee."""
        lower = hip - knee
        x, z = self.thigh * ops.sin(hip), -self.thigh * ops.cos(hip)
        dx, dz = self.shank * ops.sin(lower), -self.shank * ops.cos(lower)
        return (x + dx, z + dz), ((-z - dz, dz), (x + dx, -dx))

    def torques(self, q: Any, force: tuple[Any, Any], ops: Operations) -> tuple[Any, Any]:
        """Torques of hip and knee that move the toe by a force ahead and up, in N·m."""
        _, (ahead, up) = self.toe(q[2], q[3], ops)
        return ahead[0] * force[0] + up[0] * force[1], ahead[1] * force[0] + up[1] * force[1]


def limb_of(robot: Robot) -> Limb:
    """The leg of a robot that goes round a post.

    Raises:
        BadValue: the robot has other coordinates or motors, or no post.
    """
    joints = robot.coordinates == COORDINATES and robot.actuated == (HIP, KNEE)
    if robot.post is None or not joints or robot.toes != ("toe",):
        raise BadValue("robot", robot, "load('hoppy'), or one of the same joints on a post")
    (leg,) = robot.legs
    return Limb(leg.thigh, leg.shank, abs(float(robot.frame_position(np.zeros(4), HIP)[1])))


def bezier(coefficients: Sequence[float], s: Any) -> Any:
    """Value at s, from 0 to 1, of the Bézier polynomial of some coefficients."""
    n = len(coefficients) - 1
    terms = (math.comb(n, k) * c * s**k * (1.0 - s) ** (n - k) for k, c in enumerate(coefficients) if c)
    return sum(terms, 0.0 * s)


def turning(torques: tuple[Any, Any], v: Any, p: RoundHoppingLaw) -> tuple[Any, Any]:
    """Torques of hip and knee, in N·m, of motors that turn, where they are commanded as those of motors at rest."""
    return torques[0] - p.hip_back_emf * v[2], torques[1] - p.knee_back_emf * v[3]


def laws(limb: Limb) -> tuple[Callable[..., Sequence[Any]], Callable[..., Sequence[Any]]]:
    """The laws of flight and stance, of hip and knee torque in N·m."""

    def flight(t: Any, q: Any, v: Any, held: Any, p: RoundHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        (x, z), (ahead, up) = limb.toe(q[2], q[3], ops)
        wanted = p.placement * (limb.reach * v[0]), -p.height
        speeds = ahead[0] * v[2] + ahead[1] * v[3], up[0] * v[2] + up[1] * v[3]
        draw = tuple(
            p.stiffness * (there - here) - p.damping * speed
            for there, here, speed in zip(wanted, (x, z), speeds, strict=True)
        )
        return turning(limb.torques(q, (draw[0], draw[1]), ops), v, p)

    def stance(t: Any, q: Any, v: Any, held: Any, p: RoundHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        s = 1.0 - ops.maximum(1.0 - t / p.push_time, 0.0)
        hip, knee = limb.torques(q, (-bezier(p.push_ahead, s), -bezier(p.push_up, s)), ops)
        commanded = (
            hip + p.posture_gain * (p.hip_posture - q[2]) - p.posture_damping * v[2],
            knee + p.posture_gain * (p.knee_posture - q[3]) - p.posture_damping * v[3],
        )
        return turning(commanded, v, p)

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
    """The automaton of a leg that hops round a post: stance and flight.

    Args:
        robot: `load("hoppy")`.
        law: parameters of the controller; by default `RoundHoppingLaw.driven`.
        spring: of the knee, always engaged; by default that of the robot's TOML file.
        contact: friction of level ground, where the law does not take it for unlimited.
        ground: level ground, in place of `contact`; its height counts.

    Raises:
        BadValue: the robot has other joints or no post, the spring has no rest of its own or lets go, the ground is
            sloped, or both contact and ground are given.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.gaits.round_hopping import round_hopping
        >>> round_hopping(load("hoppy")).cyclic
        ('boom_yaw',)
    """
    limb, contact = limb_of(robot), given(contact, ground)
    law = law or RoundHoppingLaw.driven(robot)
    own = None if robot.settings is None else robot.settings.springs.get(KNEE)
    spring = spring or own or Spring(0.0, damping=0.0, rest=0.0, unilateral=False)
    if spring.rest is None or spring.unilateral:
        raise BadValue("spring", spring, "one with a rest of its own that pulls and pushes, as Spring(rest=0.0, ...)")
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
        spring=spring,
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
    """Just after touchdown in the posture of stance, the boom coming down and going round."""
    q = np.array([0.0, 0.0, law.hip_posture, law.knee_posture])
    for _ in range(20):  # Newton's method: the tilt that puts the toe on the ground
        height, jacobian = ground.foot(robot, q, "toe")
        q[1] -= height / jacobian[-1, 1]
    v = np.array([0.0, 2.0, 0.0, 0.0])
    jacobian = robot.toe_jacobian(q, "toe")
    v[2:] = np.linalg.solve(jacobian[:, 2:], -jacobian @ v)
    return q, v


def _measures(robot: Robot, limb: Limb) -> Mapping[str, Callable[[Run], float]]:
    """What a hop can be asked for; speeds along the circle of the hip, positive to the left about the post."""
    return {
        "flight_time": lambda run: run.durations["flight"],
        "stance_time": lambda run: run.durations["stance"],
        "period": lambda run: run.durations["flight"] + run.durations["stance"],
        "apex_height": lambda run: float(robot.frame_position(run.event("apex").q, HIP)[2]),
        "mean_speed": lambda run: (
            limb.reach * (run.state[0][0] - run.start[0][0]) / (run.durations["flight"] + run.durations["stance"])
        ),
    }
