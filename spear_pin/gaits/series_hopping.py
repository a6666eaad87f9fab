"""SPEAR-II with its spring in series (SEA), hopping in place: the rotor has its own coordinate; with its automaton.

The URDF's "knee" is the rotor behind its gears, and "knee_spring" is the deflection of the spring from the rotor to the
shank. The angle of the knee is their sum. The law knows the spring's deflection δ, as in series elastic actuators, and
balances its pull: N² J θ̈_m = u + k δ + b δ̇ with u = -k δ + ... So the rest of the law, and the damper, move the
rotor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.hop_law import HopLaw
from spear_pin.gaits.reaching import set_down
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount, Reset, Switch
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, rate, touchdown
from spear_pin.hybrid.result import Run
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring, refuse_unusual

COORDINATES = ("boom_z", "hip", "knee", "knee_spring")
SERIES = Spring(unilateral=False)
FALLING = 0.8  # m/s: how fast it lands in a guess


@typed
@dataclass(frozen=True)
class SeriesHoppingLaw(HopLaw):
    """Parameters of the hopping controller of a leg with a series spring; gains of the hip are `HoppingLaw`'s.

    The rotor holds its angle in flight and stance, u = -k δ + K (θ_des - θ_m) - K_D θ̇_m. In stance ±τ̄ drives it like
    the parallel one: it flexes through the first half period of the square wave, where it gives way to the spring, and
    extends through the second, where it winds the spring up.

    Attributes:
        knee_touchdown: commanded angle of the rotor, in rad (assumption).
        hip_touchdown: commanded hip angle in flight, in rad; None means half of the knee's.
        stance_torque: τ̄, in N·m (solved for).
        frequency: f of the square wave, in Hz (source).
        hip_gain: K_hip, in N·m/rad (source).
        hip_damping: |K_D,hip|, in N·m·s/rad (source).
        knee_gain: K of the rotor, in N·m/rad (source's K_knee).
        knee_damping: K_D of the rotor, in N·m·s/rad (assumption: critical).
        units: units of these numbers, by name.
        inputs: numbers that event feedback may adjust, for SPEAR-II.
    """

    knee_damping: float = 2.6


def flight_law(t: Any, q: Any, v: Any, held: Any, p: SeriesHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
    """Returns hip and knee torque in flight, in N·m: (4.9)-(4.10) with corrected signs, the knee's on the rotor."""
    return p.hip_gain * (p.hip_commanded - q[1]) - p.hip_damping * v[1], _holding(q, v, p, dyn)


def stance_law(t: Any, q: Any, v: Any, held: Any, p: SeriesHoppingLaw, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
    """Returns hip and knee torque in stance, in N·m: the square wave of (4.10) on a rotor that holds its angle."""
    return 0.0, _holding(q, v, p, dyn) + p.stance_torque * held["flexing"]


def _holding(q: Any, v: Any, p: SeriesHoppingLaw, dyn: Dynamics) -> Any:
    return dyn.spring_torque("knee_spring") + p.knee_gain * (p.knee_touchdown - q[2]) - p.knee_damping * v[2]


@typed
def series_hopping(
    robot: Robot,
    law: SeriesHoppingLaw | None = None,
    spring: Spring | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the hopping automaton of a leg whose spring is between rotor and knee: stance and flight.

    Args:
        robot: `load("spear_ii_series", locked=["boom_x"])`.
        law: parameters of the controller.
        spring: the series spring: it pulls and pushes, and rests at no deflection.
        contact: friction of level ground.
        ground: the ground, instead of `contact`.

    Raises:
        BadValue: the robot has other coordinates, the spring pulls only or has a rest of its own, or both
            contact and ground are given.
    """
    law, spring, contact = law or SeriesHoppingLaw(), spring or SERIES, choose_ground(contact, ground)
    if robot.coordinates != COORDINATES or robot.actuated != ("hip", "knee") or robot.toes != ("toe",):
        raise BadValue("robot", robot, "load('spear_ii_series', locked=['boom_x']) or a variant of it")
    if spring.unilateral or spring.rest is not None:
        raise BadValue("spring", spring, "a spring that pulls and pushes, and rests at zero: Spring(unilateral=False)")
    refuse_unusual(spring)
    mount = Mount("knee_spring", spring, rest="rest", taut="taut")
    always: Held = {"rest": 0.0, "taut": 1.0}
    posture = np.array([0.0, law.hip_commanded, law.knee_touchdown, 0.0])

    lift_off = Reset(latch=lambda q, v, held, p: always, phase="flight")
    flip = Reset(latch=lambda q, v, held, p: {"flexing": -held["flexing"]})
    fallen = fall(["hip", "knee"])
    switch = Switch("torque_switch", lambda n, p: 0.5 * n / p.frequency, flip)
    stance = Domain("stance", "stance", (STICK,), stance_law, mounts=(mount,), guards=fallen, switch=switch)
    struck = Reset(impact=("toe",), latch=lambda q, v, held, p: {**always, "flexing": 1.0}, phase="stance")
    guards = (touchdown("toe", struck), *fallen, Guard("apex", rate(0)))
    flight = Domain("flight", "flight", (OPEN,), flight_law, mounts=(mount,), guards=guards)
    return HybridSystem(
        kind="series_hopping",
        robot=robot,
        law=law,
        springs={"knee_spring": spring},
        contact=contact,
        domains=(*contact_domains(stance, robot.toes, lift_off), flight),
        section="touchdown",
        cyclic=(),
        build=series_hopping,
        guess=lambda: set_down(robot, posture, FALLING, as_ground(contact), ("hip", "knee_spring")),
        measures=_MEASURES,
    )


_MEASURES: Mapping[str, Callable[[Run], float]] = {
    "flight_time": lambda run: run.durations["flight"],
    "stance_time": lambda run: run.durations["stance"],
    "period": lambda run: run.durations["flight"] + run.durations["stance"],
    "apex_height": lambda run: run.event("apex").q[0],
    "knee_at_touchdown": lambda run: run.event("touchdown").q[2] + run.event("touchdown").q[3],
}
