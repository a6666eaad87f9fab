"""SPEAR-II hopping in place: the control law (4.9)-(4.10) with corrected signs, and its automaton."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, list_names, require
from spear_pin.gaits.hop_law import HopLaw
from spear_pin.gaits.proportions import proportions
from spear_pin.gaits.reaching import angles, drive_motors, pose_leg, set_down, show_leg_angles
from spear_pin.gaits.springing import springing
from spear_pin.hybrid.automaton import SHORTEST_FLIGHT, HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset, Switch
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, rate, toggle, touchdown
from spear_pin.hybrid.result import Run
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, load_shipped, scale_of, touchdown_inertia
from spear_pin.model.spring import Spring
from spear_pin.model.springs import springs_by_name

ROBOTS = "a planar robot with the toe 'toe' whose last joints are 'hip' and 'knee'"
LONGEST, FALLING = 5.0, 0.8  # s, m/s: a phase of SPEAR-II, and how fast it lands in a guess
FLAT = 1e-9  # 1/m: a smaller change of the normal force with the torque counts as zero


@typed
@dataclass(frozen=True)
class HoppingLaw(HopLaw):
    """Parameters of the hopping controller.

    In flight each joint is driven to its touchdown angle, τ = K (θ_des - θ) - K_D θ̇: (4.9)-(4.10)
    with the sign of the proportional term corrected and the printed K_D taken by its magnitude.
    In stance the knee motor flexes with τ̄ through the first half period of the square wave, so
    that it helps to compress the spring, and extends through the second.

    Attributes:
        knee_touchdown: commanded knee angle in flight, in rad (assumption; the latched one differs).
        hip_touchdown: commanded hip angle in flight, in rad; None means half of the knee's.
        stance_torque: τ̄_knee, in N·m (not in the source; solved for).
        frequency: f of the square wave, in Hz (source).
        hip_gain: K_hip, in N·m/rad (source).
        hip_damping: |K_D,hip|, in N·m·s/rad (source).
        knee_gain: K_knee, in N·m/rad (source).
        knee_damping: |K_D,knee|, in N·m·s/rad (source).
        hip_stance_torque: τ̄_hip, in N·m (source: negligible).
        virtual_stiffness: stiffness of a spring that the motor imitates in stance, in N·m/rad, latched and slack like
            the real spring.
        hold_extension: whether to keep extending after the first period, where the printed square wave would flex
            again.
        minimum_force: if not None, flexion in the first half period is limited so that the normal
            force stays at or above this, in N, as far as less flexion can keep it there.
        foot_placement: K of the term K (ẋ_lo - ẋ*) added to the commanded hip angle, in rad·s/m,
            ẋ_lo being the hip's forward speed latched at lift-off; needs a free boom_x.
        speed: ẋ*, in m/s.
        units: units of these numbers, by name.

    Example:
        >>> from spear_pin import HoppingLaw
        >>> HoppingLaw(stance_torque=8.5).frequency  # Hz
        2.56
    """

    hip_stance_torque: float = 0.0
    virtual_stiffness: float = 0.0
    hold_extension: bool = False
    minimum_force: float | None = None
    foot_placement: float = 0.0
    speed: float = 0.0
    units: ClassVar[Mapping[str, str]] = {
        **HopLaw.units,
        "hip_stance_torque": "N·m",
        "virtual_stiffness": "N·m/rad",
        "minimum_force": "N",
        "foot_placement": "rad·s/m",
        "speed": "m/s",
    }

    def __post_init__(self) -> None:
        """Checks the fields."""
        super().__post_init__()
        of = type(self).__name__
        require(f"{of}.virtual_stiffness", self.virtual_stiffness, lambda gain: gain >= 0, "a number >= 0")
        for name in ("hip_stance_torque", "foot_placement", "speed"):
            require(f"{of}.{name}", getattr(self, name), lambda number: abs(number) >= 0, "a finite number")
        if self.minimum_force is not None:
            require(f"{of}.minimum_force", self.minimum_force, lambda force: force >= 0, "a number >= 0, in N")

    @classmethod
    @typed
    def scaled(cls, robot: Robot, damping_ratio: float | None = None) -> HoppingLaw:
        """Scales SPEAR-II's law to another robot: torques by m g l, times by √(l/g), the hip's angle by geometry.

        In flight hip and knee oscillate as often in √(l/g) as SPEAR-II's and with the same damping, each with its own
        inertia, the diagonal entry of D at touchdown. The toe lands below the hip. A flight that corresponds to
        SPEAR-II's 0.2 s is longer by the ratio of √(l/g). For a leg with `[reach]` see `gaits.proportions`.

        Args:
            robot: a robot with one leg, as `spear_pin.monopod` cuts it, or with `[reach]`.
            damping_ratio: damping ratio of hip and knee in flight, by their own inertias; None: SPEAR-II's, 0.24 and
                0.16.

        Raises:
            BadValue: the robot does not have one leg with hip and knee, or the damping ratio is not a number >= 0.
        """
        if robot.reach is not None:
            _check(robot)
        law = cls()
        hip, knee, scale, torque, inertia = proportions(robot, law.knee_touchdown)
        heavier = inertia / touchdown_inertia(load_shipped("spear_ii"), law.knee_touchdown)
        gains = np.array([law.hip_gain, law.knee_gain]) * heavier / scale.time**2
        dampings = np.array([law.hip_damping, law.knee_damping]) * heavier / scale.time
        if damping_ratio is not None:
            require("damping_ratio", damping_ratio, lambda ratio: ratio >= 0, "a number >= 0, or None")
            dampings = 2.0 * damping_ratio * np.sqrt(gains * inertia)
        return replace(
            law,
            knee_touchdown=knee,
            hip_touchdown=hip,
            stance_torque=law.stance_torque * torque,
            frequency=law.frequency / scale.time,
            hip_gain=float(gains[0]),
            hip_damping=float(dampings[0]),
            knee_gain=float(gains[1]),
            knee_damping=float(dampings[1]),
        )


def flight_law(t: Any, q: Any, v: Any, held: Any, p: HoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
    """Returns hip and knee torque in flight, (4.9)-(4.10) with corrected signs, in N·m."""
    hip, knee = -2, -1
    hip_desired = p.hip_commanded + p.foot_placement * (held["speed"] - p.speed)
    return (
        p.hip_gain * (hip_desired - q[hip]) - p.hip_damping * v[hip],
        p.knee_gain * (p.knee_touchdown - q[knee]) - p.knee_damping * v[knee],
    )


def sprung_flight_law(
    t: Any, q: Any, v: Any, held: Any, p: HoppingLaw, dyn: Dynamics, ops: Operations
) -> Sequence[Any]:
    """Returns the torques of the flight law when springs stay engaged: the motors also balance them."""
    hip, knee = flight_law(t, q, v, held, p, dyn, ops)
    return hip - dyn.spring_torque("hip"), knee - dyn.spring_torque("knee")


def stance_law(t: Any, q: Any, v: Any, held: Any, p: HoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
    """Returns hip and knee torque in stance: the square wave of (4.10), flexion positive, in N·m.

    `held["flexing"]` is the sign of the square wave. Where `held["limited"]` is 1, the torque gives the normal force
    `minimum_force`, or is zero if that would take extension.
    """
    knee = p.stance_torque * held["flexing"]
    if p.minimum_force is not None:
        knee = knee + held["limited"] * (limit_torque(q, held, p, dyn, ops) - knee)
    return (p.hip_stance_torque, knee + virtual_torque(q, held, p))


def virtual_torque(q: Any, held: Any, p: HoppingLaw) -> Any:
    """Returns the torque of the spring that the knee motor imitates, in N·m."""
    return -p.virtual_stiffness * held["taut"] * (q[-1] - held["knee_touchdown"])


def limit_torque(q: Any, held: Any, p: HoppingLaw, dyn: Dynamics, ops: Operations) -> Any:
    """Returns the flexing torque, up to τ̄, at which the normal force is `minimum_force`, in N·m.

    The torque is zero where the force would be less even without flexion. Flexion is limited only where it unloads the
    toe. It may load a sliding toe; then no single torque gives the force.
    """
    unloaded, per_torque = _normal_force(q, held, p, dyn)
    limit = (unloaded - p.minimum_force) / ops.maximum(-per_torque, FLAT)
    return ops.maximum(-ops.maximum(-limit, -p.stance_torque), 0.0)


def _normal_force(q: Any, held: Any, p: HoppingLaw, dyn: Dynamics) -> tuple[Any, Any]:
    """Returns the normal force without flexion, in N, and its change with the knee torque, in 1/m."""
    hip, virtual = p.hip_stance_torque, virtual_torque(q, held, p)
    unloaded = dyn.normal_force("toe", (hip, virtual))
    return unloaded, dyn.normal_force("toe", (hip, virtual + 1.0)) - unloaded


@typed
def hopping(
    robot: Robot,
    law: HoppingLaw | None = None,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the hopping automaton: stance (sticking or slipping) and flight.

    Touchdown latches the spring at the knee's angle and starts the square wave. Lift-off, where the normal force falls
    to zero, releases the spring and latches the forward speed.

    Args:
        robot: SPEAR-II, with boom_x locked or free, another leg as `spear_pin.monopod` cuts it, or a leg on a slider
            whose file has `[reach]`, the angles that the law calls hip and knee: with closed loops, or with an ankle.
        law: parameters of the controller; for another leg those of `HoppingLaw.scaled`. With
            `[reach]` the hip lands at 0 unless the law gives its angle.
        spring: the knee spring, or several by name, each on the joint of its name or on its own path; for another leg
            that of `Spring.scaled`; with `[reach]` by default the springs of its file. If one of them is fixed, the
            motors balance in flight all that are engaged, but not with `[reach]`.
        contact: friction of level ground.
        ground: the ground, instead of `contact`.

    Raises:
        BadValue: law, spring or contact is missing, both contact and ground are given, the motor is to imitate a knee
            spring beside springs without one, or the robot is not a planar one with a toe "toe" and motors on "hip" and
            "knee" last.
        UnknownName: a spring is on no joint or frame of the robot.

    Example:
        >>> from spear_pin import HoppingLaw, hopping, load
        >>> system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(stance_torque=8.5))
        >>> system.phases
        ('stance', 'flight')
    """
    law, contact = law or HoppingLaw(), choose_ground(contact, ground)
    springs = springing(robot, springs_by_name(_usual(robot) if spring is None else spring, "knee"))
    _check(robot)
    if robot.reach is not None and law.hip_touchdown is None:
        law = replace(law, hip_touchdown=0.0)
    lands = pose_leg(robot, law.hip_commanded, law.knee_touchdown)
    rise, scale = robot.index("boom_z"), _scale(robot, lands)
    forward = robot.index("boom_x") if "boom_x" in robot.coordinates else None
    if forward is None and law.foot_placement != 0.0:
        raise BadValue("HoppingLaw.foot_placement", law.foot_placement, "0 while boom_x is locked")

    imitated = "taut" in {mount.taut for mount in springs.mounts}
    if law.virtual_stiffness and not imitated:
        expected = "0 unless the first spring is at the knee, and its switch is ideal"
        raise BadValue("HoppingLaw.virtual_stiffness", law.virtual_stiffness, expected)

    def latch_touchdown(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
        own = {} if imitated else {"knee_touchdown": angles(robot, q)[1], "taut": 1.0}
        return {**own, **springs.engage(q, held), "flexing": 1.0, "compressing": 1.0, "limited": 0.0}

    def latch_lift_off(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
        return {"speed": 0.0 if forward is None else v[forward], **springs.keep(q, held)}

    aloft = springs.aloft
    lift_off = Reset(release=springs.released, latch=latch_lift_off, phase="flight", edges=springs.leaving)
    landed = Reset(impact=("toe",), latch=latch_touchdown, phase="stance", edges=springs.touching)
    balancing = any(spring.rest is not None for spring in springs.springs.values())
    flip = Reset(latch=lambda q, v, held, p: {"flexing": -held["flexing"], "compressing": 0.0, "limited": 0.0})
    fallen = fall(["hip", "knee"])
    if robot.reach is not None:
        turning = [joint for joint, unit in zip(robot.coordinates, robot.units, strict=True) if unit == "rad"]
        fallen = (*fall(turning), *toggle(robot, lands))
    stance = Domain(
        "stance",
        "stance",
        (STICK,),
        drive_motors(robot, stance_law),
        mounts=springs.standing,
        guards=(*springs.switches(springs.standing), *springs.conditions("toe"), *fallen),
        switch=Switch("torque_switch", _half_periods, flip),
    )
    flight = Domain(
        "flight",
        "flight",
        (OPEN,),
        drive_motors(robot, sprung_flight_law if balancing and robot.reach is None else flight_law),
        mounts=aloft,
        guards=(
            *springs.switches(aloft),
            touchdown("toe", landed),
            *fallen,
            Guard("apex", rate(rise)),
        ),
    )
    return HybridSystem(
        kind="hopping",
        robot=robot,
        law=law,
        springs=springs.springs,
        contact=contact,
        domains=(*contact_domains(stance, robot.toes, lift_off, first=_limit_guards(robot, law)), flight),
        section="touchdown",
        cyclic=() if forward is None else ("boom_x",),
        build=hopping,
        guess=lambda: set_down(robot, lands, FALLING * scale.speed, as_ground(contact)),
        measures=_measures(robot),
        phase_limit=LONGEST * scale.time,
        shortest_flight=SHORTEST_FLIGHT * scale.time,
        sprung=True,
    )


def _half_periods(n: int, p: HoppingLaw) -> float:
    return math.inf if p.hold_extension and n > 1 else 0.5 * n / p.frequency


def _limit_guards(robot: Robot, law: HoppingLaw) -> tuple[Guard, ...]:
    """Returns guards that enter and leave the limit on flexion, if there is one."""
    if law.minimum_force is None:
        return ()

    def margin(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        # negative where τ̄ leaves too little force and less would leave more; only in the first half period
        unloaded, per_torque = _normal_force(q, held, p, dyn)
        excess = unloaded + per_torque * p.stance_torque - p.minimum_force
        spare = (1.0 - 2.0 * held["limited"]) * ops.maximum(excess, per_torque)
        return held["compressing"] * spare + (1.0 - held["compressing"])

    turn = Reset(latch=lambda q, v, held, p: {"limited": 1.0 - held["limited"]})
    return (Guard("force_limit", show_leg_angles(robot, margin), turn, tolerance=1e-6),)


def _check(robot: Robot) -> None:
    """Refuses a robot that the law cannot drive."""
    if robot.reach is not None:
        if not robot.planar or robot.toes != ("toe",) or "boom_z" not in robot.independent:
            raise BadValue("robot", robot, "a planar robot with the toe 'toe' on a slider 'boom_z'")
        robot.reach.check(robot.actuated)
        if tied := [motor for motor in robot.actuated if motor not in robot.independent]:
            expected = f"motors on joints that determine the others: {list_names(robot.independent)}"
            raise BadValue("motors", tied, expected)
        return
    if not robot.planar or robot.toes != ("toe",) or "boom_z" not in robot.coordinates:
        raise BadValue("robot", robot, ROBOTS)
    if robot.loops or robot.coordinates[-2:] != ("hip", "knee"):
        raise BadValue("robot", robot, "one with [reach] in its file" if robot.loops else ROBOTS)
    if robot.actuated != ("hip", "knee"):
        raise BadValue("robot.actuated", robot.actuated, "motors on 'hip' and 'knee'")


def _usual(robot: Robot) -> Spring | Mapping[str, Spring]:
    """Returns SPEAR-II's knee spring; for a leg with loops the springs of its file."""
    if robot.reach is None:
        return Spring()
    springs: Mapping[str, Spring] = robot.settings.springs
    if not springs:
        raise BadValue("spring", None, "springs on paths by name, as a leg with loops has no knee")
    return springs


def _scale(robot: Robot, q: Array) -> Scale:
    """Returns a robot's size; with `[reach]` its leg is as long as its toe is deep at touchdown, at q."""
    return scale_of(robot) if robot.reach is None else scale_of(robot, -float(robot.toe_position(q, "toe")[1]))


def _measures(robot: Robot) -> Mapping[str, Callable[[Run], float]]:
    """Returns the measures of a hop."""
    rise, forward = robot.index("boom_z"), "boom_x" in robot.coordinates

    def mean_speed(run: Run) -> float:
        """Returns the forward speed over the cycle, in m/s; boom_x comes first where it is free."""
        return (run.state[0][0] - run.start[0][0]) / sum(run.durations.values()) if forward else 0.0

    return {
        "flight_time": lambda run: run.durations["flight"],
        "stance_time": lambda run: run.durations["stance"],
        "period": lambda run: run.durations["flight"] + run.durations["stance"],
        "apex_height": lambda run: run.event("apex").q[rise],
        "knee_at_touchdown": lambda run: angles(robot, run.event("touchdown").q)[1],
        "knee_rate_at_touchdown": lambda run: angles(robot, run.event("touchdown").v_before)[1],
        "hip_at_touchdown": lambda run: angles(robot, run.event("touchdown").q)[0],
        "hip_rate_at_touchdown": lambda run: angles(robot, run.event("touchdown").v_before)[0],
        "mean_speed": mean_speed,
    }
