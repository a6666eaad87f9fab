"""The vertical crank leg of arXiv 2505.22898 as it is driven there, and synthetic logs of its hops and SPEAR-II's.

In stance the motor's torque is a cubic since the stance began, and a weak spring toward an angle; in flight it holds
that angle. An angle switches between the two: touchdown and lift-off come a little before or after.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from spear_pin import load, simulate
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, Contact
from spear_pin.hybrid.domain import Domain, Guard, Mount, Reset
from spear_pin.hybrid.phases import height
from spear_pin.hybrid.rules.guards import contact_guards
from spear_pin.studies.logs import Log
from spear_pin.studies.logs.measured import Measured
from spear_pin.studies.logs.played import SLOW

DEGREE = math.pi / 180.0


@dataclass(frozen=True)
class ConfiguredLaw:
    """Numbers of the law, as published for hops without spring; `drive` is what the motor makes of a command.

    Friction of crank and guide is Coulomb's, smoothed.
    """

    drive: float = 1.0
    stance_gain: float = 6.0
    flight_gain: float = 3.0
    flight_damping: float = 0.125
    wanted: float = -21.0 * DEGREE
    lands: float = -20.0 * DEGREE
    leaves: float = -21.0 * DEGREE
    c0: float = 1.4370216929019946
    c1: float = -1.4789978878441405
    c2: float = -4.777093331965688
    c3: float = -1.1989023901859464
    crank_friction: float = 0.0
    guide_friction: float = 0.0


def configured(robot, law=None, springs=None):
    """The leg with its law, and fixed springs that push and pull."""
    law = ConfiguredLaw() if law is None else law
    rough = law.crank_friction or law.guide_friction
    if rough and robot.nu < robot.nv:  # friction of the guide needs a motor there
        robot = robot.with_model(robot.model, actuated=robot.coordinates, base=robot.base, varied=robot.varied)
    crank, rise = robot.index("crank"), robot.index("boom_z")

    def applied(torque, v, p, ops):
        if robot.nu < robot.nv:
            return (torque,)
        forces = [0.0] * robot.nv
        forces[crank] = torque - p.crank_friction * ops.tanh(v[crank] / SLOW["rad"])
        forces[rise] = -p.guide_friction * ops.tanh(v[rise] / SLOW["m"])
        return forces

    def flight(t, q, v, held, p, dyn, ops):
        torque = p.flight_gain * (p.wanted - q[crank]) - p.flight_damping * v[crank]
        return applied(p.drive * torque, v, p, ops)

    def stance(t, q, v, held, p, dyn, ops):
        s = (t - 0.1) / 0.1
        torque = p.stance_gain * (p.wanted - q[crank]) + ((p.c3 * s + p.c2) * s + p.c1) * s + p.c0
        return applied(p.drive * torque, v, p, ops)

    begins = Guard("stance_mode", lambda t, q, v, held, p, dyn, ops: p.lands - q[crank], Reset(phase="stance"))
    ends = Guard("flight_mode", lambda t, q, v, held, p, dyn, ops: q[crank] - p.leaves, Reset(phase="release"))
    lifts = contact_guards("toe", STICK, "lift_off", Reset(phase="flight"), ())
    lands = Guard("touchdown", height("toe"), Reset(impact=("toe",), phase="touch"))
    given = springs or {}
    mounts = tuple(Mount(name, spring, spring.rest, path=spring.path, of=name) for name, spring in given.items())
    domains = (
        Domain("stance", "stance", (STICK,), stance, mounts=mounts, guards=(ends, *lifts)),
        Domain("touch", "touch", (STICK,), flight, mounts=mounts, guards=(begins, *lifts)),
        Domain("release", "release", (STICK,), flight, mounts=mounts, guards=lifts),
        Domain("flight", "flight", (OPEN,), flight, mounts=mounts, guards=(lands,)),
    )

    def guess():
        at = Measured(robot, ("crank",)).state(
            "stance", np.array([-20.8 * DEGREE]), np.array([7.0]), robot.closed(np.zeros(4))
        )
        return at[: robot.nv], at[robot.nv :]

    def build(robot, law, spring, contact):
        return configured(robot, law, spring)

    return HybridSystem("configured", robot, law, given, Contact(), domains, "touchdown", (), build, guess, sprung=True)


def spring(stiffness=400.0, rest=0.1459):
    """The leg's spring, which here pushes and pulls."""
    leg = load("crank_hopper").settings.springs["leg"]
    return replace(leg, stiffness=stiffness, rest=rest, unilateral=False)


def sampled(trajectory, robot, rate=1000.0, begin=0.0):
    """Crank angle and motor's torque at even times, (n,) each, of a trajectory."""
    crank, motor = robot.index("crank"), robot.actuated.index("crank")
    t, first = np.unique(trajectory.t, return_index=True)
    line = CubicHermiteSpline(t, trajectory.q[first, crank], trajectory.v[first, crank])
    times = np.arange(begin, t[-1], 1.0 / rate)
    return times, line(times), np.interp(times, trajectory.t, trajectory.u[:, motor])


def synthetic(system, cycles=3, rate=1000.0, **changed):
    """A log of some hops as the system makes them, and its trajectory."""
    trajectory = simulate(system, system.guess(), cycles, samples=400, progress=False)
    t, angle, torque = sampled(trajectory, system.robot, rate)
    return Log("synthetic", t, {"crank": angle, "crank_torque": torque}, synthetic=True), trajectory


def two_joints(run, rate=1000.0, turned=0.0):
    """A log of SPEAR-II's hip and knee over a run, whose knee's sensor shows too much."""
    t, first = np.unique(run.t, return_index=True)
    times = np.arange(0.0, t[-1], 1.0 / rate)
    named = {"hip": run.q[:, 1], "knee": run.q[:, 2] + turned, "hip_torque": run.u[:, 0], "knee_torque": run.u[:, 1]}
    return Log("two joints", times, {name: np.interp(times, t, each[first]) for name, each in named.items()})
