"""Design questions of the source's Chapter 5: springs, gears and motors against the torques that bounding takes.

Torques and stiffnesses here are those of one leg and its motor, half of the sagittal model's pair.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, Infeasible, NoGait, UnknownName
from spear_pin.gaits.bounding_law import PAIR, legs_of
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive, drawn_power
from spear_pin.model.robot import Robot
from spear_pin.model.variants import PARAMETERS, vary
from spear_pin.studies.bound import mean_speed, weight

Array = NDArray[np.float64]
STIFFNESSES = (0.0, 56.0, 112.0, 200.0, 300.0, 400.0)  # N·m/rad, of Fig. 5.6; 112 is twice the source's 56


@dataclass(frozen=True)
class Points:
    """Operating points of one kind of joint over a stride, of one motor.

    Attributes:
        t: time, in s, (n,).
        torque: of a motor, by leg (posterior, anterior), in N·m, (n, 2).
        speed: of the joint, in rad/s, (n, 2).
        bears: whether the leg is on the ground, (n, 2).
        since: time since its touchdown, in s, NaN in the air, (n, 2).
        until: time until its lift-off, in s, NaN in the air, (n, 2).
    """

    t: Array
    torque: Array
    speed: Array
    bears: NDArray[np.bool_]
    since: Array
    until: Array

    @property
    def peak(self) -> Array:
        """Largest torque in stance by leg, in N·m, (2,)."""
        return np.asarray(np.where(self.bears, np.abs(self.torque), 0.0).max(axis=0))

    @property
    def rms(self) -> Array:
        """Root mean square of the torque over the stride by leg, in N·m, (2,)."""
        mean = np.trapezoid(self.torque**2, self.t, axis=0) / (self.t[-1] - self.t[0])
        return np.asarray(np.sqrt(mean))


@dataclass(frozen=True)
class EnvelopeUse:
    """Operating points against a drive.

    Attributes:
        drive: the drive.
        margin: available less required torque at each point, in N·m, (n, 2); negative outside.
        outside: share of the stride's time outside, by leg, (2,).
        worst: least margin by leg, in N·m, (2,).
        near_events: of the points outside, the share within 20 ms after touchdown or before lift-off; NaN
            where none is outside.
        heating: rms torque over the drive's continuous torque, by leg, (2,).
    """

    drive: Drive
    margin: Array
    outside: Array
    worst: Array
    near_events: float
    heating: Array

    @property
    def fits(self) -> bool:
        """Whether no point is outside."""
        return bool((self.worst >= 0.0).all())


@dataclass(frozen=True)
class Member:
    """One gait of a family.

    Attributes:
        value: of what was varied.
        gait: the gait; None where none was found.
        solution: the optimiser's, to start from; None where none was found.
        reason: why there is none.
    """

    value: float
    gait: Gait | None
    solution: Solution | None
    reason: str = ""


@typed
def points(gait: Gait, part: str = "knee", stiffness: float | None = None) -> Points:
    """Operating points of the knees or hips over one stride.

    The law gives the total torque at the knee and the motor what the spring does not, so another
    spring changes the motor's torque and nothing else.

    Args:
        gait: a bounding gait.
        part: "knee" or "hip".
        stiffness: of a leg's knee spring, in N·m/rad; None means the gait's own.

    Raises:
        UnknownName: the part is neither.
        BadValue: the stiffness is negative.
    """
    if part not in ("knee", "hip"):
        raise UnknownName("part of a leg", part, ("knee", "hip"))
    system = gait.system if stiffness is None else sprung(gait.system, stiffness)
    return points_of(system.robot, simulate(system, gait.state, progress=False), part)


def sprung(system: HybridSystem, stiffness: float) -> HybridSystem:
    """A bounding system with knee springs of another stiffness a leg, in N·m/rad."""
    return rebuilt(system, spring=replace(system.spring, stiffness=PAIR * stiffness))


def points_of(robot: Robot, trajectory: Trajectory, part: str) -> Points:
    """Operating points of the knees ("knee") or hips ("hip") over a stride of a robot."""
    legs = legs_of(robot)
    columns = [leg.motors[("hip", "knee").index(part)] for leg in legs]
    rows = [leg.knee if part == "knee" else leg.hip for leg in legs]
    bears = np.stack([trajectory.force[:, i].any(axis=1) for i in range(len(legs))], axis=1)
    since, until = np.full(bears.shape, np.nan), np.full(bears.shape, np.nan)
    for i in range(len(legs)):
        times = trajectory.t[bears[:, i]]
        if len(times):
            since[bears[:, i], i], until[bears[:, i], i] = times - times[0], times[-1] - times
    return Points(trajectory.t, trajectory.u[:, columns] / PAIR, trajectory.v[:, rows], bears, since, until)


@typed
def spring_sweep(gait: Gait, stiffnesses: Sequence[float] = STIFFNESSES) -> dict[float, Points]:
    """Knee motor torque for springs of other stiffness on the same gait, Figs. 5.5 and 5.6.

    Args:
        gait: a bounding gait.
        stiffnesses: of a leg's spring, in N·m/rad; 0 is "no compliance".
    """
    return {stiffness: points(gait, "knee", stiffness) for stiffness in stiffnesses}


@typed
def against(given: Points, drive: Drive) -> EnvelopeUse:
    """Operating points against a drive's torque-speed envelope, Fig. 5.8."""
    margin = np.asarray(drive.margin(given.torque, given.speed))
    out = margin < 0.0
    share = np.trapezoid(out.astype(float), given.t, axis=0) / (given.t[-1] - given.t[0])
    near = (given.since < 0.02) | (given.until < 0.02)
    return EnvelopeUse(
        drive=drive,
        margin=margin,
        outside=np.asarray(share),
        worst=margin.min(axis=0),
        near_events=float(near[out].mean()) if out.any() else float("nan"),
        heating=given.rms / drive.continuous_torque,
    )


@typed
def electrical_cost(gait: Gait, knee: Drive, regeneration: float = 0.0) -> float:
    """Cost of transport of what the knee motors draw and the hips' positive mechanical power.

    Args:
        gait: a bounding gait.
        knee: drive of each knee.
        regeneration: share of the electrical power given back that is stored.
    """
    knees, hips = points(gait, "knee"), points(gait, "hip")
    power = drawn_power(knee.bus_power(knees.torque, knees.speed), regeneration).sum(axis=1)
    power = power + np.maximum(hips.torque * hips.speed, 0.0).sum(axis=1)
    distance = gait.period * mean_speed(gait)
    return float(PAIR * np.trapezoid(power, knees.t) / (weight(gait.system.robot) * distance))


def family(
    robot: Robot,
    request: Request,
    name: str,
    values: Sequence[float],
    start: Solution | None = None,
    on_member: Callable[[Member], object] = lambda member: None,
) -> list[Member]:
    """Locally optimal gaits over a range of one number, each started from the one before.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: what is asked of each.
        name: a numeric field of `Request`, or a parameter of the robot that `vary` knows.
        values: of it, in an order that makes small steps.
        start: a solution near the first one; None searches the first one cold.
        on_member: called with each as it is found.

    Raises:
        UnknownName: there is no such field or parameter.
    """
    asked = [field.name for field in fields(request)]
    if name not in asked and name not in PARAMETERS:
        raise UnknownName("what to vary", name, [*asked, *PARAMETERS])
    members = []
    for value in values:
        if name == "knee_ratio" and request.knee_drive is not None:
            raise BadValue("name", name, "another than the ratio while a knee drive is asked for: see codesign")
        varied = robot if name in asked else vary(robot, **{name: value})
        changes: dict[str, Any] = {name: value}
        wanted = replace(request, **changes) if name in asked else request
        try:
            gait, start = search(varied, wanted, start=start)
            member = Member(value, gait, start)
        except (Infeasible, NoGait) as error:
            member = Member(value, None, None, str(error))
        members.append(member)
        on_member(member)
    return members


@dataclass(frozen=True)
class Design:
    """A choice of spring, gear ratio and motor, and what bounding with it costs.

    Attributes:
        motor: name of the motor.
        ratio: of the knee's gears.
        stiffness: of a leg's spring, in N·m/rad.
        knee_touchdown: knee angle at touchdown, by magnitude, in rad.
        cost: electrical cost of transport, see `electrical_cost`.
        heating: largest rms torque over the drive's continuous torque.
        margin: least distance from the envelope, in N·m.
        gait: the gait; None where none was found.
        reason: why there is none.
    """

    motor: str
    ratio: float
    stiffness: float
    knee_touchdown: float
    cost: float
    heating: float
    margin: float
    gait: Gait | None
    reason: str = ""


def codesign(
    robot: Robot,
    request: Request,
    drives: Mapping[str, Drive],
    ratios: Sequence[float],
    start: Solution | None = None,
) -> Iterator[Design]:
    """The spring and the touchdown angle of least cost for each motor and gear ratio, inside the motor's envelope.

    The robot gets the motor's own rotor and its ratio; another motor's mass is not accounted for.
    A design is a local optimum: the better one of those found from `start` and from the design at the ratio before.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: what is asked; its objective, stiffness, touchdown angle and knee drive are replaced.
        drives: by name, their gearboxes' ratios being replaced.
        ratios: of the knee's gears, in an order that makes small steps.
        start: a solution to start from; None searches cold.
    """
    nothing = math.nan
    for name, base in drives.items():
        near = start
        for ratio in ratios:
            drive = replace(base, gearbox=replace(base.gearbox, ratio=ratio))
            fitted = vary(robot, knee_ratio=ratio, knee_rotor=drive.reflected_inertia / ratio**2)
            wanted = replace(request, objective="electrical", stiffness=None, knee_touchdown=None, knee_drive=drive)
            try:
                gait, near = _cheapest(fitted, wanted, drive, [start] if near is start else [start, near])
            except (Infeasible, NoGait) as error:
                yield Design(name, ratio, nothing, nothing, nothing, nothing, nothing, None, str(error))
                continue
            use = against(points(gait), drive)
            yield Design(
                motor=name,
                ratio=ratio,
                stiffness=gait.system.spring.stiffness / PAIR,
                knee_touchdown=gait.system.law.knee_touchdown,
                cost=electrical_cost(gait, drive),
                heating=float(use.heating.max()),
                margin=float(use.worst.min()),
                gait=gait,
            )


def _cheapest(robot: Robot, request: Request, drive: Drive, starts: Sequence[Solution | None]) -> tuple[Gait, Solution]:
    """Of what is found from each start, the gait of least electrical cost; where nothing is, why not from the last."""
    found: list[tuple[Gait, Solution]] = []
    failure: Infeasible | NoGait | None = None
    for start in starts:
        try:
            found.append(search(robot, request, start=start))
        except (Infeasible, NoGait) as error:
            failure = error
    if not found:
        assert failure is not None
        raise failure
    return min(found, key=lambda each: electrical_cost(each[0], drive))


def smallest_violation(
    robot: Robot,
    request: Request,
    drive: Drive,
    starts: int = 20,
    on_start: Callable[[int, float], object] = lambda n, t: None,
) -> tuple[Gait, float]:
    """The gait that exceeds the knee drive's envelope least, over several cold starts.

    Args:
        robot: Q-SPEAR in the sagittal plane, with the drive's rotor in it.
        request: what is asked; its objective and knee drive are replaced.
        drive: of each knee.
        starts: number of seeds.
        on_start: called with the seed and the violation found from it, in N·m (NaN if none).

    Returns:
        the gait, and by how much it exceeds the envelope, in N·m; zero or less: it fits.

    Raises:
        Infeasible, NoGait: no start led to a gait.
    """
    if starts < 1:
        raise BadValue("starts", starts, "at least 1")
    wanted = replace(request, objective="violation", knee_drive=drive)
    best: tuple[Gait, float] | None = None
    failure: Infeasible | NoGait | None = None
    for seed in range(starts):
        try:
            gait, _ = search(robot, wanted, seed=seed)
            excess = -float(against(points(gait), drive).worst.min())
        except (Infeasible, NoGait) as error:
            failure = error
            on_start(seed, float("nan"))
            continue
        on_start(seed, excess)
        if best is None or excess < best[1]:
            best = gait, excess
    if best is None:
        assert failure is not None
        raise failure
    return best
