"""Q-SPEAR bounding: the laws (5.4)-(5.6), (5.15) and (5.20), and the automaton of Fig. 5.4, completed.

Beside posterior and anterior stance and the flights between them there are double stances, entered
when the next foot comes down before the other has lifted, and slip in each; so a disturbed run goes
on where four phases would have no answer.

A leg of the sagittal model is a pair; torques are those of the pair, a motor's are half.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, require
from spear_pin.gaits.virtual_constraints import Evolution, Outputs, Row, dot, progress, resume, zeroing
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, Guard, Held, HybridSystem, Law, Mount, Reset
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.phases import contact_domains, fall, spring_switches, touchdown
from spear_pin.hybrid.record import Run
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

Shape = tuple[tuple[float, ...], ...]
SHORTEST_SPAN = 0.2  # of a stance's span: what is left of it when a stance is resumed late
INPUTS = (
    "posterior_hip_torque",
    "posterior_knee_torque",
    "anterior_hip_torque",
    "anterior_knee_torque",
    "posterior_leg_touchdown",
    "anterior_leg_touchdown",
)
"""Parameters that event feedback adjusts once a stride."""
NEARLY = 1e-3  # rad: this near θ̄, whether a leg will come back to it depends on whether it flexes
NO_ADJUSTMENT = (0.0,) * len(INPUTS)


@dataclass(frozen=True)
class BoundingLaw:
    """Parameters of the bounding controller.

    The source gives k's equivalent (Fig. 5.6), θ̄ and the form of the law; every other number is a
    result of a search, see `spear_pin.gaits.optimize`. Leg angles γ are those of the line from hip
    to toe from straight down, > 0 with the toe ahead.

    Attributes:
        posterior_hip_torque: β_sp of (5.4), in N·m.
        anterior_hip_torque: β_sa of (5.4), in N·m.
        posterior_knee_torque: |ū_p| of (5.5), extending, in N·m.
        anterior_knee_torque: |ū_a| of (5.6), extending, in N·m.
        posterior_leg_touchdown: γ the posterior leg lands with, in rad.
        anterior_leg_touchdown: γ the anterior leg lands with, in rad.
        posterior_stance_span: Δ_sp of (5.10), in rad, negative.
        anterior_stance_span: Δ_sa of (5.10), in rad, negative.
        flight_1_span: Δ of (5.19) in the flight after posterior stance, in m.
        flight_2_span: Δ of (5.19) in the flight after anterior stance, in m.
        posterior_stance_swing: Bézier coefficients from the third on of the anterior leg's angle and
            knee in posterior stance (the first two follow from the state, (5.22)).
        anterior_stance_swing: those of the posterior leg in anterior stance.
        flight_1_trailing: those of the posterior leg, just lifted.
        flight_2_trailing: those of the anterior leg, just lifted.
        flight_1_landing: the third coefficient of the anterior leg's angle and knee; the last three
            are the touchdown values, so that the leg comes to rest.
        flight_2_landing: the same for the posterior leg.
        virtual_stiffness: k_p = k_a of (5.5)-(5.6), in N·m/rad (200 per motor: implied by Fig. 5.6).
        knee_rest: θ̄ of (5.5)-(5.6), by magnitude, in rad (source: 40°).
        knee_touchdown: knee angle of a landing leg, by magnitude, in rad (source: 40°).
        epsilon: ε of (5.16), in s (not in the source).
        lift_off: "knee": a leg is lifted when its knee is back at θ̄ (what the source implies), or
            earlier if its foot bears nothing; a leg that came down flexed less than that has nothing
            to come back from, and stays until its foot bears nothing. "force": always the latter.
        nominal: section state (q, v) of the gait, without torso_x; what feedback compares with.
        feedback: event feedback, one row for each of `INPUTS`, one column for each of `nominal`.
        feedback_limits: largest adjustment of each of `INPUTS`, in N·m and rad.
        speed_gain: gain of β += K (ẋ_td - ẋ*) at each touchdown, posterior and anterior, in N·s.
        speed_nominal: ẋ* just after posterior and anterior touchdown, in m/s.
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
    feedback: Shape = ()
    feedback_limits: tuple[float, ...] = (100.0, 100.0, 100.0, 100.0, 0.2, 0.2)
    speed_gain: tuple[float, ...] = (0.0, 0.0)
    speed_nominal: tuple[float, ...] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Check the fields."""
        valid: dict[str, tuple[Callable[[float], bool], str]] = {
            "virtual_stiffness": (lambda k: k >= 0, "a number >= 0, in N·m/rad"),
            "epsilon": (lambda e: e > 0, "a number > 0, in s"),
            "knee_rest": (lambda a: 0 < a < math.pi, "between 0 and π rad"),
            "knee_touchdown": (lambda a: 0 < a < math.pi, "between 0 and π rad"),
            "posterior_stance_span": (lambda span: span < 0, "a number < 0, in rad"),
            "anterior_stance_span": (lambda span: span < 0, "a number < 0, in rad"),
            "flight_1_span": (lambda span: span > 0, "a number > 0, in m"),
            "flight_2_span": (lambda span: span > 0, "a number > 0, in m"),
        }
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, (tuple, str)):
                continue
            test, expected = valid.get(field.name, (math.isfinite, "a finite number"))
            require(f"BoundingLaw.{field.name}", value, test, expected)
        if self.lift_off not in ("knee", "force"):
            raise BadValue("BoundingLaw.lift_off", self.lift_off, "'knee' or 'force'")
        if len(self.feedback_limits) != len(INPUTS) or not all(limit >= 0 for limit in self.feedback_limits):
            raise BadValue("BoundingLaw.feedback_limits", self.feedback_limits, f"{len(INPUTS)} numbers >= 0")
        if self.feedback and [len(row) for row in self.feedback] != [len(self.nominal)] * len(INPUTS):
            expected = f"{len(INPUTS)} rows of {len(self.nominal)}, as many as `nominal` has numbers"
            raise BadValue("BoundingLaw.feedback", self.feedback, expected)


@dataclass(frozen=True)
class Leg:
    """A leg of the sagittal model.

    Attributes:
        name: "posterior" or "anterior".
        hip: index of its hip.
        knee: index of its knee.
        side: +1 if the knee flexes to positive angles, -1 if to negative.
        angle: row of its leg angle γ = pitch + hip - knee / 2 (exact: thigh and shank are as long).
        motors: columns of its motors.
    """

    name: str
    hip: int
    knee: int
    side: float
    angle: Row
    motors: tuple[int, int]

    @property
    def toe(self) -> str:
        """Name of its toe."""
        return f"{self.name}_toe"

    @property
    def joint(self) -> str:
        """Name of its knee."""
        return f"{self.name}_knee"

    @property
    def rows(self) -> tuple[Row, ...]:
        """What is controlled of it: γ and the knee."""
        return self.angle, ((self.knee, 1.0),)


@dataclass(frozen=True)
class Phase:
    """A phase in which some leg swings.

    Attributes:
        name: its name.
        legs: those that swing, in the order of the outputs.
        outputs: what is controlled.
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


def support(leg: Leg, q: Any, held: Mapping[str, Any], p: BoundingLaw, dyn: Any) -> list[tuple[int, Any]]:
    """Motor torques of a supporting leg, (5.4)-(5.6) with corrected signs, as (column, torque).

    The virtual spring is shared: the motor gives what the physical one does not.
    """
    hip, knee = leg.motors
    flexed = leg.side * q[leg.knee] - p.knee_rest
    total = -leg.side * (held[f"{leg.name}_knee_torque"] + p.virtual_stiffness * flexed)
    return [(hip, held[f"{leg.name}_hip_torque"]), (knee, total - dyn.spring_torque(leg.joint))]


def bounding(
    robot: Robot, law: BoundingLaw, spring: Spring | None = None, contact: Contact | None = None
) -> HybridSystem:
    """The bounding automaton of Fig. 5.4 with double stances and slip.

    Touchdown latches the leg's spring and its angle, lift-off releases it; every event that changes
    the phase resets the virtual constraints so that the outputs stay at zero, (5.22).

    Args:
        robot: Q-SPEAR in the sagittal plane.
        law: parameters of the controller, for instance those of a shipped gait.
        spring: the knee springs, of a pair of legs; by default 2 · 56 N·m/rad (source: Table 5.1),
            without damping (the source gives none for the quadruped).
        contact: the ground; by default with friction 0.8 (assumption).

    Raises:
        BadValue: the robot has not the coordinates, toes and motors of `q_spear`.
    """
    spring, contact = spring or Spring(stiffness=112.0, damping=0.0), contact or Contact()
    posterior, anterior = legs = legs_of(robot)
    mounts = {leg: _mount(leg, spring) for leg in legs}
    fallen = fall([f"{leg.name}_{part}" for leg in legs for part in ("hip", "knee")])
    phases = phases_of(robot)
    stances = {phase.bearing: phase for phase in phases if phase.bearing}
    flights = {phase.lifted: phase for phase in phases if phase.lifted}

    def lands(leg: Leg, phase: Phase | str, name: str = "touchdown", *, resumed: bool = False) -> Guard:
        """The leg touches down; `resumed` keeps its leg angle, as its stance goes on."""

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
            bears = _bear(leg, q, v, held, p, resumed)
            if isinstance(phase, str):
                return bears
            return {**bears, **_swing(leg, phase, q, v, {**held, **bears}, p)}

        into = phase if isinstance(phase, str) else phase.name
        reset = Reset(impact=(leg.toe,), latch=latch, phase=into)
        return Guard(f"{leg.name}_{name}", touchdown(leg.toe, reset).value, reset, tolerance=1e-8)

    def lifts(leg: Leg, phase: Phase, remaining: Leg | None) -> Reset:
        """The leg lifts off, into flight or into the stance of the one that remains."""

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
            return _fly(phase, q, v, held, p) if remaining is None else _swing(remaining, phase, q, v, held, p)

        return Reset(release=(leg.joint,), latch=latch, phase=phase.name)

    def grounded(name: str, bearing: tuple[Leg, ...], law: Law, resets: Mapping[str, Reset], guards: Any) -> Any:
        domain = Domain(
            name,
            name,
            tuple(STICK if leg in bearing else OPEN for leg in legs),
            law,
            mounts=tuple(mounts[leg] for leg in bearing),
            guards=(
                *(guard for leg in bearing for guard in spring_switches(mounts[leg], leg.knee)),
                *guards,
                *fallen,
            ),
        )
        first = tuple(_knee_back(leg, resets[leg.toe]) for leg in bearing if p.lift_off == "knee")
        return contact_domains(domain, robot.toes, contact, resets, first)

    p = law
    domains: list[Domain] = []
    for leg, other in (legs, legs[::-1]):
        double = f"double_{1 if leg is posterior else 2}"  # from this leg's stance to the other's
        stance, flight = stances[leg], flights[leg]
        landing = (_passing(stance), lands(other, double))
        domains += grounded(stance.name, (leg,), _stance_law(leg, stance), {leg.toe: lifts(leg, flight, None)}, landing)
        resets = {leg.toe: lifts(leg, stances[other], other), other.toe: lifts(other, stance, leg)}
        domains += grounded(double, legs, _double_law(legs), resets, ())
        returns = lands(leg, stance, "return", resumed=True)
        guards = (lands(other, stances[other]), returns, _passing(flight), *fallen)
        domains.append(Domain(flight.name, flight.name, (OPEN, OPEN), _flight_law(flight), guards=guards))
    return HybridSystem(
        kind="bounding",
        robot=robot,
        law=law,
        spring=spring,
        contact=contact,
        domains=tuple(domains),
        section="posterior_touchdown",
        cyclic=("torso_x",),
        build=bounding,
        guess=lambda: _guess(law),
        measures=_MEASURES,
        phase_limit=2.0,
    )


def phases_of(robot: Robot) -> tuple[Phase, ...]:
    """The four phases of the gait in order.

    Raises:
        BadValue: the robot has not the coordinates, toes and motors of `q_spear`.
    """
    posterior, anterior = legs_of(robot)
    return (
        _stance(posterior, anterior),
        _flight("flight_1", posterior, anterior),
        _stance(anterior, posterior),
        _flight("flight_2", anterior, posterior),
    )


def legs_of(robot: Robot) -> tuple[Leg, Leg]:
    """The posterior and the anterior leg.

    Raises:
        BadValue: the robot has not the coordinates, toes and motors of `q_spear`.
    """
    joints = tuple(f"{name}_{part}" for name in ("posterior", "anterior") for part in ("hip", "knee"))
    expected = ("torso_x", "torso_z", "pitch", *joints)
    if robot.coordinates != expected or robot.actuated != joints or robot.toes != ("posterior_toe", "anterior_toe"):
        raise BadValue("robot", robot, f"the coordinates {', '.join(expected)}, motors on the last four, and two toes")
    legs = []
    for i, (name, side) in enumerate((("posterior", 1.0), ("anterior", -1.0))):
        hip, knee = 3 + 2 * i, 4 + 2 * i
        legs.append(Leg(name, hip, knee, side, ((2, 1.0), (hip, 1.0), (knee, -0.5)), (2 * i, 2 * i + 1)))
    return legs[0], legs[1]


def _mount(leg: Leg, spring: Spring) -> Mount:
    return Mount(leg.joint, spring, rest=f"{leg.name}_rest", taut=f"{leg.name}_taut", side=leg.side)


def _stance(leg: Leg, other: Leg) -> Phase:
    """Single stance: the other leg swings, s from the supporting leg's angle."""
    return Phase(f"{leg.name}_stance", (other,), Outputs(other.rows, leg.angle, other.motors), bearing=leg)


def _flight(name: str, lifted: Leg, landing: Leg) -> Phase:
    """Flight: both legs swing, s from the torso's travel."""
    first, second = legs = sorted((lifted, landing), key=lambda leg: leg.hip)
    outputs = Outputs((*first.rows, *second.rows), ((0, 1.0),), (*first.motors, *second.motors))
    return Phase(name, tuple(legs), outputs, lifted=lifted, landing=landing)


# control laws


def evolution(held: Mapping[str, Any]) -> Evolution:
    """The desired evolution that is held."""
    return Evolution(held["alpha"], held["origin"], held["span"], held["past"])


def _stance_law(leg: Leg, phase: Phase) -> Law:
    def law(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Sequence[Any]:
        given = support(leg, q, held, p, dyn)
        swing = zeroing(phase.outputs, evolution(held), q, v, p.epsilon, dyn.response(), given, ops)
        return _ordered([*given, *zip(phase.outputs.motors, swing, strict=True)])

    return law


def _flight_law(phase: Phase) -> Law:
    def law(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Sequence[Any]:
        return zeroing(phase.outputs, evolution(held), q, v, p.epsilon, dyn.response(), (), ops)

    return law


def _double_law(legs: tuple[Leg, Leg]) -> Law:
    def law(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Sequence[Any]:
        return _ordered([*support(legs[0], q, held, p, dyn), *support(legs[1], q, held, p, dyn)])

    return law


def _ordered(torques: Sequence[tuple[int, Any]]) -> Sequence[Any]:
    return [torque for _, torque in sorted(torques, key=lambda pair: pair[0])]


# guards


def _passing(phase: Phase) -> Guard:
    """The phase variable passes 1, either way."""

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return (1.0 - 2.0 * held["past"]) * (1.0 - progress(phase.outputs, evolution(held), q))

    return Guard("end_of_constraint", value, Reset(latch=lambda q, v, held, p: {"past": 1.0 - held["past"]}))


def _knee_back(leg: Leg, reset: Reset) -> Guard:
    """The knee is back at θ̄ and extends."""

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        back = ops.maximum(leg.side * q[leg.knee] - p.knee_rest, leg.side * v[leg.knee])
        flexed = held[f"{leg.name}_flexed"]
        return flexed * back + (1.0 - flexed)

    return Guard(f"{leg.name}_lift_off", value, reset)


# what events latch


def _bear(
    leg: Leg, q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw, resumed: bool
) -> dict[str, Any]:
    """A leg begins to bear: its spring is latched, its torques are set, event feedback included."""
    name, first = leg.name, leg.name == "posterior"
    adjust = held.get("adjust", NO_ADJUSTMENT)
    if first and not resumed:
        adjust = _adjustment(p, (*q[1:], *v))
    i = 0 if first else 1
    flexed = leg.side * q[leg.knee]
    faster = p.speed_gain[i] * (v[0] - p.speed_nominal[i])
    return {
        f"{name}_rest": q[leg.knee],
        f"{name}_taut": 1.0,
        f"{name}_flexed": float(
            flexed > p.knee_rest + NEARLY or (flexed > p.knee_rest - NEARLY and leg.side * v[leg.knee] > 0.0)
        ),
        f"{name}_leg": held[f"{name}_leg"] if resumed and f"{name}_leg" in held else dot(leg.angle, q),
        f"{name}_hip_torque": getattr(p, f"{name}_hip_torque") + adjust[2 * i] + faster,
        f"{name}_knee_torque": getattr(p, f"{name}_knee_torque") + adjust[2 * i + 1],
        "adjust": adjust,
    }


def _adjustment(p: BoundingLaw, state: Sequence[float]) -> tuple[float, ...]:
    """What event feedback adds to `INPUTS` for a stride, within its limits."""
    if not p.feedback:
        return NO_ADJUSTMENT
    error = [now - then for now, then in zip(state, p.nominal, strict=True)]
    wanted = [sum(gain * e for gain, e in zip(row, error, strict=True)) for row in p.feedback]
    return tuple(min(max(w, -limit), limit) for w, limit in zip(wanted, p.feedback_limits, strict=True))


def _swing(leg: Leg, phase: Phase, q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
    """The other leg begins to swing while this one supports."""
    whole = getattr(p, f"{phase.name}_span")
    left = 1.0 - (dot(leg.angle, q) - held[f"{leg.name}_leg"]) / whole
    span = whole * max(left, SHORTEST_SPAN)
    return _held(resume(phase.outputs, getattr(p, f"{phase.name}_swing"), q, v, span))


def _fly(phase: Phase, q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
    """Flight begins: one leg trails, the other is brought to its touchdown angles."""
    shapes: list[Sequence[float]] = []
    adjust = held.get("adjust", NO_ADJUSTMENT)
    for i, leg in enumerate(phase.legs):
        if leg == phase.lifted:
            shapes += getattr(p, f"{phase.name}_trailing")
            continue
        angle, knee = getattr(p, f"{phase.name}_landing")
        target = getattr(p, f"{leg.name}_leg_touchdown") + adjust[4 + i]
        shapes += [(angle, *3 * (target,)), (knee, *3 * (leg.side * p.knee_touchdown,))]
    return _held(resume(phase.outputs, shapes, q, v, getattr(p, f"{phase.name}_span")))


def _held(begun: Evolution) -> Held:
    return {"alpha": begun.alpha, "origin": begun.origin, "span": begun.span, "past": begun.past}


def _guess(law: BoundingLaw) -> tuple[Any, Any]:
    if len(law.nominal) != 13:
        raise BadValue("BoundingLaw.nominal", law.nominal, "the 13 numbers of a section state, or give a state")
    return np.array([0.0, *law.nominal[:6]]), np.array(law.nominal[6:])


_MEASURES: Mapping[str, Callable[[Run], float]] = {
    "mean_speed": lambda run: (run.state[0][0] - run.start[0][0]) / sum(run.durations.values()),
    "period": lambda run: sum(run.durations.values()),
    "stride": lambda run: run.state[0][0] - run.start[0][0],
}
