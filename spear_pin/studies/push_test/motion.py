"""The release of Section 4.1: the pinned leg let go, as a hybrid system, with its sensitivities.

A hand holds the leg; at its release the spring is engaged and the knee swings, whose torque is

    -k (θ - θ₀) - b θ̇ - τ_c sign θ̇

on the robot that the URDF describes, its toe pinned. It is run as any other: springs that go slack, dry friction and
a motor that begins to brake are events.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import PINNED, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount, Reset
from spear_pin.hybrid.dry_friction import DryFriction
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.phases import rate, spring_switches
from spear_pin.hybrid.result import Moment, Options, Run
from spear_pin.hybrid.rules.footing import AT_REST
from spear_pin.hybrid.run import run
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring, refuse_unusual
from spear_pin.studies.push_test.passive_knee import PassiveKnee
from spear_pin.studies.push_test.sensitivity import PARAMETERS, Step, derivatives

RTOL = 1e-10
WORK, WORK_PER_SECOND = 20_000, 2_000  # right-hand sides: twenty times what a release takes
AGAIN = 1e-6  # s: a turn so soon after another is the same, to the integration's error
SHORTEST = 1e-3  # s: of a motion that is wanted at its beginning only
# how a run of a release ends, in its own words
ENDS = {
    "no_event": "complete",
    "stuck": "complete",
    "evaluation_cap": "work",
    "no_cycle": "pieces",
    "zeno": "pieces",
}


@dataclass(frozen=True)
class KneeMotion:
    """The knee's motion after the release, sampled.

    Attributes:
        angle: θ, (n,), in rad.
        rate: θ̇, (n,), in rad/s.
        acceleration: θ̈, (n,), in rad/s².
        sensitivity: ∂θ/∂p, (n, parameters), for the given parameters.
        turns: times at which the knee stands still between two swings, in s.
        extrema: θ at these times, in rad.
        reason: "complete"; or what ended it, the angle being held from there on: "limit" of the joint,
            "step_size", "not_finite", "pieces", too many of them, or "work", more than a release takes: forces are too
            stiff.
    """

    angle: Array
    rate: Array
    acceleration: Array
    sensitivity: Array
    turns: Array
    extrema: Array
    reason: str


@typed
def make_released(leg: PinnedLeg, knee: PassiveKnee, duration: float = 1.5, dry: bool | None = None) -> HybridSystem:
    """Returns the system of the leg: let go as soon as a run begins in the phase "pushed", and swinging.

    The system has no section. A run ends when the duration is over, where dry friction holds the knee, or at the
    joint's limit.

    Args:
        leg: the pinned leg, with its rotor.
        knee: torque law of the knee.
        duration: duration of the motion, in s.
        dry: whether there is dry friction, even if it is zero; None: if the knee has any.
    """
    robot, row, (low, high) = leg.robot, leg.robot.index(leg.joint), leg.span
    still, conducts = (0.0,) * robot.nu, knee.braking > 0.0 and knee.braking_from > 0.0

    def build(robot: Robot, law: PassiveKnee, spring: Spring, contact: Contact) -> HybridSystem:
        if contact != Contact():
            raise BadValue("contact", contact, "Contact(), because the toe is pinned")
        return make_released(replace(leg, robot=robot), _with_spring(law, spring), duration, dry)

    def engage(q: Sequence[float], v: Sequence[float], held: Held, p: PassiveKnee) -> Held:
        taut = not p.unilateral or q[row] > p.zero
        return {"zero": p.zero, "taut": float(taut), "brakes": float(not conducts)}

    def idle(t: Any, q: Any, v: Any, held: Any, p: PassiveKnee, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        if not p.braking:
            return still
        return [p.braking_torque(v[row], ops.maximum) if joint == leg.joint else 0.0 for joint in robot.actuated]

    refuse_unusual(knee.spring)
    mount = Mount(leg.joint, knee.spring, rest="zero", taut="taut")
    hand = Guard("release", lambda *_: -1.0, Reset(latch=engage, phase="swing"))
    guards = (
        Guard("limit", lambda t, q, v, held, p, dyn, ops: q[row] - low, ends="limit"),
        Guard("limit", lambda t, q, v, held, p, dyn, ops: high - q[row], ends="limit"),
        *spring_switches(mount),
        *((_brake_switch(row),) if conducts else ()),
        Guard("turn", rate(row), tolerance=AT_REST),
        Guard("turn", rate(row, -1.0), tolerance=AT_REST),
    )
    system = HybridSystem(
        kind="release",
        robot=robot,
        law=knee,
        springs={leg.joint: knee.spring},
        contact=Contact(),
        domains=(
            Domain("pushed", "pushed", (PINNED,), idle, guards=(hand,)),
            Domain("swing", "swing", (PINNED,), idle, mounts=(mount,), guards=guards),
        ),
        section="",
        cyclic=(),
        build=build,
        guess=lambda: (_placed(leg, high), np.zeros(robot.nv)),
        phase_limit=duration,
    )
    if not (knee.coulomb > 0.0 if dry is None else dry):
        return system
    rubbing = DryFriction({leg.joint: knee.coulomb})(system).domains
    return replace(system, domains=tuple(map(_ending_at_rest, rubbing)), made={})


@typed
def simulate_release(
    leg: PinnedLeg, knee: PassiveKnee, initial_angle: float, duration: float = 1.5, rate: float = 1000.0
) -> Trajectory:
    """Simulates the leg from its release at rest, and samples all of its motion, as for any other system.

    Args:
        leg: the pinned leg, with its rotor.
        knee: torque law of the knee.
        initial_angle: angle at which it is let go, in rad.
        duration: duration of the motion, in s.
        rate: samples a second, about.

    Raises:
        BadValue: the angle is beyond the joint's limits, or the duration is not positive.
    """
    require("duration", duration, lambda d: 0 < d <= 3600, "a number > 0, in s, at most an hour")
    _checked(leg, initial_angle, [0.0], (), RTOL)
    system, samples = make_released(leg, knee, duration), max(1, round(rate * duration))
    start = _pushed(leg, initial_angle)
    motion = simulate(system, start, 1, RTOL, max_evaluations=_work(duration), samples=samples, progress=False)
    over = ENDS.get(motion.reason) == "complete"  # what is no cycle ends by its time, or at rest
    return replace(motion, reason="complete", message="the time is over, or the leg at rest") if over else motion


@typed
def move(
    leg: PinnedLeg,
    knee: PassiveKnee,
    initial_angle: float,
    times: ArrayLike,
    wrt: Sequence[str] = (),
    rtol: float = RTOL,
) -> KneeMotion:
    """Lets the leg go at rest, and returns its motion.

    Args:
        leg: the pinned leg, with its rotor.
        knee: torque law of the knee.
        initial_angle: angle at which it is let go, in rad.
        times: times of the samples, increasing, (n,), in s since the release.
        wrt: parameters, of `PARAMETERS`, for the derivatives of θ.
        rtol: relative tolerance; the absolute one is a hundredth of it, in rad and rad/s.

    Raises:
        BadValue: the angle is beyond the joint's limits, or the times do not increase from 0 on.
        UnknownName: an unknown parameter.
    """
    at = _checked(leg, initial_angle, times, wrt, rtol)
    duration = max(float(at[-1]), SHORTEST)
    system = make_released(leg, knee, duration, knee.coulomb > 0.0 or "coulomb" in wrt)
    start = _pushed(leg, initial_angle)
    result = run(system, start, 1, Options(rtol, max_evaluations=_work(duration), keep=True))
    reason = ENDS.get(result.reason, result.reason)
    row = leg.robot.index(leg.joint)
    steps = list(_steps(result, row, leg.robot.nq))
    bounds = [0, *np.searchsorted(at, [step.end for step in steps], side="right").tolist()]
    last = float(steps[-1].motion(np.array([steps[-1].end]))[0, 0]) if steps else initial_angle
    motion = np.tile([[last], [0.0]], at.size)  # it is held from there on
    for step, (first, end) in zip(steps, pairwise(bounds), strict=True):
        motion[:, first:end] = step.motion(at[first:end])
    (angle, rates), moving = motion, slice(0, bounds[-1])
    pulls, direction = (
        np.repeat([getattr(s, name) for s in steps], np.diff(bounds)) for name in ("pulls", "direction")
    )
    acceleration = np.zeros(at.size)
    torque = knee.torque(angle[moving], rates[moving], pulls, direction)
    acceleration[moving] = leg.acceleration(angle[moving], rates[moving], torque)
    sensitivity = derivatives(leg, knee, steps, wrt, at)
    if reason == "limit":  # it is there whatever the parameters
        sensitivity[bounds[-1] :] = 0.0
    found = [(event.time, event.q[row]) for event in result.events if event.name == "turn" and event.time <= at[-1]]
    turns = np.array(found).reshape(-1, 2)
    turns = turns[np.diff(turns[:, 0], prepend=-np.inf) > AGAIN]
    return KneeMotion(angle, rates, acceleration, sensitivity, turns[:, 0], turns[:, 1], reason)


def _checked(leg: PinnedLeg, initial_angle: float, times: ArrayLike, wrt: Sequence[str], rtol: float) -> Array:
    """Returns the times, if all that `move` takes is valid."""
    try:
        at = np.asarray(times, dtype=float)
    except (TypeError, ValueError):
        raise BadValue("times", times, "increasing numbers from 0 on, in s") from None
    if at.ndim != 1 or at.size == 0 or not np.isfinite(at).all() or at[0] < 0 or (np.diff(at) <= 0).any():
        raise BadValue("times", times, "increasing numbers from 0 on, in s")
    require("rtol", rtol, lambda tolerance: 1e-13 <= tolerance <= 1e-2, "a number from 1e-13 to 1e-2")
    low, high = leg.span
    require("initial_angle", initial_angle, lambda a: low <= a <= high, f"an angle within {low:g} … {high:g} rad")
    for name in wrt:
        if name not in PARAMETERS:
            raise UnknownName("parameter", name, PARAMETERS)
    return at


def _pushed(leg: PinnedLeg, angle: float) -> Moment:
    return Moment(_placed(leg, angle), np.zeros(leg.robot.nv), "pushed", {})


def _work(duration: float) -> int:
    """Returns the number of right-hand sides that a release may take."""
    return WORK + round(WORK_PER_SECOND * duration)


def _placed(leg: PinnedLeg, angle: float) -> Array:
    q = leg.configuration(angle)
    q[leg.robot.index(leg.joint)] = angle  # to the last digit
    return q


def _with_spring(knee: PassiveKnee, spring: Spring) -> PassiveKnee:
    if spring != Spring(spring.stiffness, spring.damping, spring.unilateral):
        raise BadValue("spring", spring, "a spring with stiffness, damping and unilateral only")
    return replace(knee, stiffness=spring.stiffness, damping=spring.damping, unilateral=spring.unilateral)


def _brake_switch(row: int) -> Guard:
    """Returns the event at which the motor begins to brake, or ceases to: the rate passes the threshold."""

    def beyond(t: Any, q: Any, v: Any, held: Any, p: PassiveKnee, dyn: Dynamics, ops: Operations) -> Any:
        return (1.0 - 2.0 * held["brakes"]) * (p.braking_from - ops.maximum(v[row], -v[row]))

    return Guard("brake_switch", beyond, Reset(latch=lambda q, v, held, p: {"brakes": 1.0 - held["brakes"]}))


def _ending_at_rest(domain: Domain) -> Domain:
    """Returns a domain in which a swing ends when dry friction holds the knee, because nothing frees it."""
    if domain.phase == "pushed" or all(rub.sign for rub in domain.rubs):
        return domain
    return replace(domain, guards=(Guard("rest", lambda *_: -1.0, ends="stuck"),))


def _steps(result: Run, row: int, nq: int) -> Iterator[Step]:
    """Returns the steps of the swing, in time."""

    def motion(state: Callable[[Array], Array], times: Array) -> Array:
        return np.asarray(state(times)[[row, nq + row]])

    for segment in result.segments:
        direction, held = sum(rub.sign for rub in segment.domain.rubs), segment.held
        for piece in segment.pieces:
            if piece.end > piece.begin:
                follow = partial(motion, piece.state)
                yield Step(piece.begin, piece.end, follow, held["taut"], held["brakes"], direction)
