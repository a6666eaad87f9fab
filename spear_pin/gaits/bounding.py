"""Q-SPEAR bounding: the automaton of Fig. 5.4, completed.

Besides posterior and anterior stance and the flights between them there are double stances, which begin when the next
foot lands before the other has lifted, and slip in each of these phases. So a disturbed run goes on where a model with
four phases would stop.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_guards import SHORTEST_SPAN, knee_back, overload
from spear_pin.gaits.bounding_law import (
    LEGS,
    STATES,
    BoundingLaw,
    Phase,
    evolution,
    law_of,
    legs_of,
    phases_of,
)
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.springing import Springing, springing_of
from spear_pin.gaits.virtual_constraints import begin_evolution, progress, value
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Law, Mount, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, touchdown
from spear_pin.hybrid.result import Run
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_of
from spear_pin.model.spring import PAIR_STIFFNESS, Spring
from spear_pin.model.springs import Springs, springs_by_name

Guards = tuple[Guard, ...]
Springings = Mapping[str, Springing]
SPEED_BY = "posterior_hip_torque"  # the parameter to vary for a "mean_speed"
LONGEST = 2.0  # s: a phase of Q-SPEAR


@typed
def bounding(
    robot: Robot,
    law: BoundingLaw,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the bounding automaton of Figure 5.4 with double stances and slip.

    Touchdown latches the leg's spring and its angle; lift-off releases the spring. Every event that changes the phase
    resets the virtual constraints so that the outputs stay at zero, (5.22).

    Args:
        robot: Q-SPEAR in the sagittal plane, or another quadruped as `spear_pin.sagittal` cuts it.
        law: parameters of the controller, for instance those of a shipped gait.
        spring: the knee springs of a pair of legs; by default 2 · 56 N·m/rad (source: Table 5.1), without damping (the
            source gives none for the quadruped), or `Spring.scaled` for another quadruped. A spring with a rest angle,
            in flexion, never releases. Several springs of each pair by name, on the leg's joint of that name or on a
            path by the names of the leg's parts. With a `Clutch` each leg's toe switches that leg's spring. A run
            from a state begins with open switches, except the one of the leg that has just landed.
        contact: friction of level ground; by default 0.8 (assumption).
        ground: the ground, instead of `contact`.

    Raises:
        BadValue: the robot lacks coordinates, toes or motors of `q_spear`, or both contact and ground are given.

    Example:
        >>> from spear_pin import Gait, bounding, load
        >>> bounding(load("q_spear"), Gait.load("long_stride").system.law).phases
        ('posterior_stance', 'double_1', 'flight_1', 'anterior_stance', 'double_2', 'flight_2')
    """
    springs, contact = (
        springs_by_name(_spring(robot) if spring is None else spring, "knee"),
        choose_ground(contact, ground),
    )
    return HybridSystem(
        kind="bounding",
        robot=robot,
        law=law,
        springs=springs,
        contact=contact,
        domains=tuple(_domains(robot, law, springs)),
        section="posterior_touchdown",
        cyclic=("torso_x",),
        build=bounding,
        guess=lambda: _guess(robot, law, as_ground(contact)),
        measures=_MEASURES,
        phase_limit=LONGEST * scale_of(robot).time,
        sprung=True,
    )


def _spring(robot: Robot) -> Spring:
    return Spring(PAIR_STIFFNESS, damping=0.0) if robot.cut is None else Spring.scaled(robot)


# domains


def _domains(robot: Robot, law: BoundingLaw, springs: Springs) -> Iterator[Domain]:
    """Returns the domains from each leg's stance, through flight or a double stance, to the other leg's stance."""
    legs, phases = legs_of(robot), phases_of(robot)
    stances = {phase.bearing: phase for phase in phases if phase.bearing}
    flights = {phase.lifted: phase for phase in phases if phase.lifted}
    overloaded = overload(scale_of(robot).torque, share=False)
    springing = {leg.name: springing_of(robot, springs, leg) for leg in legs}
    fallen = fall([f"{leg.name}_{part}" for leg in legs for part in ("hip", "knee")])

    def sprung(bearing: tuple[Leg, ...]) -> tuple[tuple[Mount, ...], tuple[Guard, ...]]:
        """Returns the springs that act while some legs are on the ground, and where they go slack or switch."""
        mounts, switches = list[Mount](), list[Guard]()
        for leg in legs:
            own = springing[leg.name]
            acting = own.standing if leg in bearing else own.aloft
            mounts += acting
            switches += own.switches(acting)
            switches += own.conditions(leg.toe) if leg in bearing else ()
        return tuple(mounts), tuple(switches)

    def grounded(name: str, bearing: tuple[Leg, ...], control: Law, resets: Mapping[str, Reset], own: Guards) -> Any:
        mounts, switches = sprung(bearing)
        contacts = tuple(STICK if leg in bearing else OPEN for leg in legs)
        domain = Domain(name, name, contacts, control, mounts=mounts, guards=(overloaded, *switches, *own, *fallen))
        backs = [guard for leg in bearing for guard in knee_back(leg, resets[leg.toe])]
        return contact_domains(domain, robot.toes, resets, tuple(backs) if law.lift_off == "knee" else ())

    for leg, other in (legs, legs[::-1]):
        double = f"double_{1 if leg is legs[0] else 2}"  # from this leg's stance to the other's
        stance, next_stance, flight = stances[leg], stances[other], flights[leg]
        lands = _lands(other, double, springing)
        leaves = {leg.toe: _lifts(leg, flight, None, springing)}
        yield from grounded(stance.name, (leg,), law_of((leg,), stance.outputs), leaves, (_passing(stance), lands))
        leaves = {leg.toe: _lifts(leg, next_stance, other, springing), other.toe: _lifts(other, stance, leg, springing)}
        yield from grounded(double, legs, law_of(legs, None), leaves, ())
        returns = _lands(leg, stance, springing, "return", resumed=True)
        mounts, switches = sprung(())
        guards = (_lands(other, next_stance, springing), returns, _passing(flight), overloaded, *switches, *fallen)
        yield Domain(flight.name, flight.name, (OPEN, OPEN), law_of((), flight.outputs), mounts=mounts, guards=guards)


# events that change the phase


def _lands(
    leg: Leg, phase: Phase | str, springing: Springings, name: str = "touchdown", *, resumed: bool = False
) -> Guard:
    """Makes the leg touch down; `resumed` keeps its leg angle, as its stance goes on."""

    def latch(q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
        bears = {
            **_kept(springing, q, held),
            **springing[leg.name].engage(q, held),
            **_bear(leg, q, v, held, p, resumed),
        }
        if isinstance(phase, str):
            return bears
        return {**bears, **_swing(leg, phase, q, v, {**held, **bears}, p)}

    into = phase if isinstance(phase, str) else phase.name
    reset = Reset(impact=(leg.toe,), latch=latch, phase=into, edges=springing[leg.name].touching)
    return touchdown(leg.toe, reset, f"{leg.name}_{name}")


def _lifts(leg: Leg, phase: Phase, remaining: Leg | None, springing: Springings) -> Reset:
    """Makes the leg lift off, into flight or into the stance of the remaining leg."""

    def latch(q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
        swings = _fly(phase, q, v, p) if remaining is None else _swing(remaining, phase, q, v, held, p)
        return {**_kept(springing, q, held), **swings}

    own = springing[leg.name]
    staying = (edge for name, other in springing.items() if name != leg.name for edge in other.staying)
    return Reset(release=own.released, latch=latch, phase=phase.name, edges=(*own.leaving, *staying))


def _kept(springing: Springings, q: Sequence[float], held: Held) -> dict[str, Any]:
    """Returns whether the fixed springs of all legs are taut, if that is not known yet."""
    return {name: value for each in springing.values() for name, value in each.keep(q, held).items()}


# guards


def _passing(phase: Phase) -> Guard:
    """Returns guards for the phase variable passing 1, either way."""

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return (1.0 - 2.0 * held["past"]) * (1.0 - progress(phase.outputs, evolution(held), q, ops))

    return Guard("end_of_constraint", value, Reset(latch=lambda q, v, held, p: {"past": 1.0 - held["past"]}))


# what events latch


def _bear(
    leg: Leg, q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw, resumed: bool
) -> dict[str, Any]:
    """Starts a leg's stance: sets its torques, with feedback of the speed."""
    name, i = leg.name, LEGS.index(leg.name)
    faster = p.speed_gain[i] * (v[0] - p.speed_nominal[i])
    return {
        f"{name}_flexed": 0.0,
        f"{name}_leg": held[f"{name}_leg"] if resumed and f"{name}_leg" in held else value(leg.angle, q),
        f"{name}_hip_torque": getattr(p, f"{name}_hip_torque") + faster,
        f"{name}_knee_torque": getattr(p, f"{name}_knee_torque"),
    }


def _swing(leg: Leg, phase: Phase, q: Sequence[float], v: Sequence[float], held: Held, p: BoundingLaw) -> Held:
    """Starts the swing of the other leg while this leg is on the ground."""
    whole = getattr(p, f"{phase.name}_span")
    left = 1.0 - (value(leg.angle, q) - held[f"{leg.name}_leg"]) / whole
    span = whole * np.maximum(left, SHORTEST_SPAN)
    return vars(begin_evolution(phase.outputs, getattr(p, f"{phase.name}_swing"), q, v, span))


def _fly(phase: Phase, q: Sequence[float], v: Sequence[float], p: BoundingLaw) -> Held:
    """Starts a flight: one leg trails, and the other is brought to its touchdown angles."""
    shapes: list[Sequence[float]] = []
    for leg in phase.legs:
        if leg == phase.lifted:
            shapes += getattr(p, f"{phase.name}_trailing")
            continue
        angle, knee = getattr(p, f"{phase.name}_landing")
        target = getattr(p, f"{leg.name}_leg_touchdown")
        shapes += [(angle, *3 * (target,)), (knee, *3 * (leg.side * p.knee_touchdown,))]
    return vars(begin_evolution(phase.outputs, shapes, q, v, getattr(p, f"{phase.name}_span")))


def _guess(robot: Robot, law: BoundingLaw, ground: Ground) -> tuple[Any, Any]:
    if not law.nominal:
        raise BadValue(
            "BoundingLaw.nominal",
            law.nominal,
            f"the {STATES} numbers of a section state; or give a state to start from",
        )
    q, v = np.array([0.0, *law.nominal[:6]]), np.array(law.nominal[6:])
    q[1] += ground.under(robot.toe_position(q, legs_of(robot)[0].toe)[0])
    return q, v


_MEASURES: Mapping[str, Callable[[Run], float]] = {
    "mean_speed": lambda run: (run.state[0][0] - run.start[0][0]) / sum(run.durations.values()),
    "period": lambda run: sum(run.durations.values()),
    "stride": lambda run: run.state[0][0] - run.start[0][0],
}
