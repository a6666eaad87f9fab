"""Continuation of a hop from one that exists to numbers with which a search finds none; tells where and why it ends."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spear_pin.errors import NoGait
from spear_pin.gaits.continuation import continue_gait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.gaits.proportions import usual_flight
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.targets import FLIGHT
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.parameters import parameter, rebuilt, with_parameters
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.kinds import typed
from spear_pin.model.spring import Spring
from spear_pin.studies.hop_of_another import hop_of

TORQUE = "stance_torque"  # what is solved for the flight time
SECONDS = 15.0  # of a processor, on the way
STEP = 0.3  # of the way, the longest
RTOL = 1e-7  # of the integrator on the way
STAGES = 3  # in which the angles of touchdown change by turns
BACK = 0.005  # of the way: a number that turns back by more is beyond a fold
BESIDE = 1e-3  # of the way, before its beginning: so much more is its range
INSIDE = 0.02  # of the way, that the hop which is told keeps from the end
ANGLES = "knee_touchdown", "hip_touchdown"
TURNS, LATE = "there the branch of hops turns back", "there the time for it was over"


@dataclass(frozen=True)
class Way:
    """How far hops exist on the way to given numbers.

    Attributes:
        gait: the hop with all numbers; None where the way ends before.
        number: name of the number at which the way ends; empty where it does not end.
        begun: value of the number at which the way begins.
        reached: value of the number that the way reaches.
        flight_time: flight time on the way, in s.
        why: why the way ends, in words.
    """

    gait: Gait | None
    number: str = ""
    begun: float = math.nan
    reached: float = math.nan
    flight_time: float = math.nan
    why: str = ""

    @property
    def inside(self) -> float:
        """A value of the number that surely has a hop: a little before the end."""
        return self.reached + INSIDE * (self.begun - self.reached)


class _Ended(Exception):
    """Raised when the way is not followed farther; the text says why."""


@typed
def lead_hop(system: HybridSystem, target: Mapping[str, float], seconds: float = SECONDS) -> Way:
    """Continues a hop from one with SPEAR-II's numbers, scaled, to the numbers of a system, one number after another.

    Args:
        system: the hop of a leg with boom_x locked, made by `hopping`.
        target: flight time, in s, by the name "flight_time", or a torque by "stance_torque"; by default the flight time
            of the hop at which the way begins.
        seconds: CPU time in s, after which the way ends.

    Raises:
        NoGait: there is no hop with SPEAR-II's numbers either.
    """
    deadline = time.process_time() + seconds
    usual = usual_hop(system)
    flight = usual_flight(system.robot)
    try:
        gait = hop_of(usual, target.get(FLIGHT, flight))
    except NoGait:
        if FLIGHT not in target:
            raise
        gait = hop_of(usual, flight)
    for number, value in [*_stops(usual, system), *target.items()]:
        own = gait.durations["flight"] if number == FLIGHT else parameter(gait.system, number)
        if value == own or abs(value - own) <= 1e-9 * max(1.0, abs(own)):
            continue
        way = _follow(gait, number, own, value, deadline)
        if way.gait is None:
            return way
        gait = way.gait
    return Way(gait)


def usual_hop(system: HybridSystem) -> HybridSystem:
    """Returns the system with SPEAR-II's numbers, scaled, for the law, a spring that pulls, and friction."""
    robot, law, spring = system.robot, HoppingLaw.scaled(system.robot), Spring.scaled(system.robot)
    numbers = {name: getattr(law, name) for name in (TORQUE, "frequency", *ANGLES)}
    stiffness = 0.0 if system.spring.table else spring.stiffness
    like = system.spring
    if like.path is None:
        like = replace(like, stiffness=stiffness, damping=spring.damping, hardening=0.0, preload=0.0)
    friction = max(system.contact.friction, Contact().friction)
    if law.hip_touchdown is None:
        numbers["hip_touchdown"] = robot.legs[0].lean(law.knee_touchdown)
    return with_parameters(rebuilt(system, law=replace(system.law, **numbers), spring=like), {"friction": friction})


def _stops(usual: HybridSystem, system: HybridSystem) -> list[tuple[str, float]]:
    """Lists numbers with the values that they take on the way, in turn."""
    names = ("stiffness", "damping", "hardening", "preload", "frequency", "friction")
    stops = [(name, parameter(system, name)) for name in names]
    begins = [parameter(usual, name) for name in ANGLES]
    ways = [*zip(ANGLES, begins, (system.law.knee_touchdown, system.law.hip_commanded), strict=True)]
    for share in np.linspace(0.0, 1.0, STAGES + 1)[1:].tolist():
        stops += [(name, (1.0 - share) * a + share * b) for name, a, b in ways]
    return stops


def _follow(gait: Gait, number: str, own: float, value: float, deadline: float) -> Way:
    """Follows hops over one number; the flight is kept, unless the flight or the torque is that number."""
    flight = gait.durations["flight"]
    solved = [] if number == TORQUE else [TORQUE]
    kept = {} if number in (TORQUE, FLIGHT) else {FLIGHT: flight}
    farthest, span = own, value - own

    def tell(now: float) -> None:
        nonlocal farthest
        if farthest == value:  # the other way along the branch, which leads nowhere
            return
        if (now - farthest) / span < -BACK:
            raise _Ended(TURNS)
        farthest = max(now, farthest) if span > 0.0 else min(now, farthest)
        if time.process_time() > deadline:
            raise _Ended(LATE)

    begin = own - BESIDE * span
    within = (min(begin, value), max(begin, value))
    try:
        branch = continue_gait(gait, number, within, solved, kept, step=STEP, rtol=RTOL, on_point=tell)
    except _Ended as ended:
        return Way(None, number, own, farthest, flight, str(ended))
    except REFUSALS as failure:
        return Way(None, number, own, farthest, flight, str(failure))
    last = -1 if span > 0.0 else 0
    end = branch.ends[last]
    if end.reason != "range":
        return Way(None, number, own, farthest, flight, str(end).partition("; beyond")[0])
    near = branch.gaits[last]
    wanted = {FLIGHT: value} if number == FLIGHT else kept
    return Way(gait_beside(near.system, near.state, solved, wanted))
