"""A first hop of a user's leg: its flight is as long as SPEAR-II's for its size, or longer where there is none."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from spear_pin.errors import BadValue, NoGait, SpearError
from spear_pin.gaits.diagnosis import Reached, explain_failure
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.search import find_gait, gait_beside
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.kinds import typed
from spear_pin.model.recut import recut
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.variants import vary
from spear_pin.studies.joint_limits import list_exceeded

LONGER = (1.0, 1.15, 1.3)  # in turn: flights that end as the square wave turns back leave a gap before the next
SHORTER = (0.9, 0.8, 0.65, 0.5)  # in turn, of a leg whose joints may not turn as fast
TORQUES = (1.0, 0.9, 1.1, 0.8, 1.25, 1.6)  # of the stance torque, in turn, until with one there is a hop
ACROSS = (0.0, 0.5, 1.0)  # of the way by torque to a flight, in turn: a gap may lie between
ALIKE = 0.02  # of a torque: one so near to another that was tried tells nothing new


@typed
def scaled_hopping(robot: Robot) -> HybridSystem:
    """Returns the hop of a leg by SPEAR-II's scaled law, with the leg's own springs from a TOML file, or SPEAR-II's.

    Args:
        robot: a leg, as `spear_pin.monopod` cuts it, or one with `[reach]`.
    """
    own = robot.settings.springs
    paths = {name: spring for name, spring in own.items() if spring.path is not None}
    lacks = paths or robot.reach is not None
    knee = {"knee": own["knee"]} if "knee" in own else {} if lacks else {"knee": Spring.scaled(robot)}
    return hopping(robot, HoppingLaw.scaled(robot), {**knee, **paths} or None)


@typed
def hop_of(
    system: HybridSystem,
    flight_time: float,
    *,
    within_limits: bool = False,
    on_attempt: Callable[[float, str], object] = lambda flight_time, why: None,
) -> Gait:
    """Finds a hop with a flight time, or one up to 30 % longer; the stance torque is solved for.

    The search begins at hops with given torques, and so ends soon where there is none. Where boom_x is free, the hip's
    angle is solved for as well, so that the leg stays where it is.

    Args:
        system: the hop of a leg, made by `hopping`.
        flight_time: flight time in s.
        within_limits: whether to accept a shorter flight where only that keeps to the limits of the joints.
        on_attempt: called with a flight time, in s, that gives way to a shorter one, and the reason.

    Raises:
        NoGait: there is no such hop; the text says the likely cause, and what to try.
        BadValue: no cycle has a flight so short or so long.
    """
    check_wanted(system, {"flight_time": flight_time})
    first = _anywhere(system, flight_time)
    why = list_exceeded(first) if within_limits else ""
    near = first
    for share in SHORTER if why else ():
        with suppress(SpearError):
            near = _beside(near, share * flight_time)
            if not list_exceeded(near):
                on_attempt(first.durations["flight"], why)
                return near
    return first


def _beside(gait: Gait, flight_time: float) -> Gait:
    """Finds the hop with another flight time near a hop, or beyond a gap."""
    wanted = {"stance_torque": ("flight_time", flight_time), "hip_touchdown": ("mean_speed", 0.0)}
    target = dict(wanted[name] for name in gait.parameters)
    try:
        return gait_beside(gait.system, gait.state, list(gait.parameters), target)
    except NoGait:
        return _anywhere(gait.system, flight_time)


def _anywhere(system: HybridSystem, flight_time: float) -> Gait:
    """Finds the hop of a leg, which stays where it is even if it need not."""
    if "boom_x" not in system.robot.coordinates:
        return _in_place(system, flight_time)
    gait = _in_place(_held(system), flight_time)
    begun = with_parameters(system, {"stance_torque": gait.system.law.stance_torque})
    q, v = (np.concatenate([[0.0], part]) for part in gait.state)
    still = {"flight_time": gait.durations["flight"], "mean_speed": 0.0}
    return gait_beside(begun, (q, v), ["stance_torque", "hip_touchdown"], still)


def _held(system: HybridSystem) -> HybridSystem:
    """Returns the same hop with boom_x locked."""
    cut, robot = system.robot.cut, system.robot
    if cut is None:
        raise BadValue("robot", robot.name, "a robot of monopod(...), or one with boom_x locked")
    leg = vary(recut(cut.kind, cut.robot, cut.legs, cut.body, ["boom_x"]), **robot.varied)
    return hopping(leg, replace(system.law, foot_placement=0.0), system.springs, ground=system.ground)


def _in_place(system: HybridSystem, flight_time: float) -> Gait:
    """Finds the hop of a leg that cannot move forward."""
    tried: list[float] = []
    known: list[Gait] = []

    def at(torque: float) -> None:
        if any(abs(torque - other) < ALIKE * other for other in tried):
            return
        tried.append(torque)
        known.append(find_gait(with_parameters(system, {"stance_torque": torque})))

    failures: list[NoGait] = []
    for share in TORQUES:
        try:
            at(share * system.law.stance_torque)
            break
        except NoGait as error:
            failures.append(error)
    if not known:
        raise failures[0]
    for wanted in (longer * flight_time for longer in LONGER):
        for share in ACROSS:
            near = _nearest(known, wanted)
            try:
                if share:
                    at(near.system.law.stance_torque * (wanted / near.durations["flight"]) ** share)
                    near = known[-1]
                return gait_beside(near.system, near.state, ["stance_torque"], {"flight_time": wanted})
            except NoGait as error:
                failures.append(error)
    near = _nearest(known, flight_time)
    asked, reached = {"flight_time": flight_time}, Reached(0.0, near.system, near.state)
    failure = NoGait(failures[0].reason, min(error.residual for error in failures))
    raise explain_failure(failure, system, ["stance_torque"], asked, reached)


def _nearest(gaits: Sequence[Gait], flight_time: float) -> Gait:
    return min(gaits, key=lambda gait: abs(math.log(gait.durations["flight"] / flight_time)))
