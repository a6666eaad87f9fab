"""The hop of least cost of a point: descents by exact derivatives from many starts.

A descent keeps the flight time and the limits of joints and motors. It also keeps the toe on the ground until the
torque switches to extension, knee and hip off the ground, and the spring taut until it releases: beyond these limits
hops are of another kind, and their cost jumps. One descent ends in one valley; starts elsewhere lead to others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from spear_pin.errors import MissingExtra, NoGait
from spear_pin.gaits.codesign import design as codesign
from spear_pin.gaits.codesign.optimize_design import optimize_design
from spear_pin.gaits.codesign.problem import Problem
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.leading import Way, lead_along
from spear_pin.gaits.measures.catalogue import describe_measure, unit_in
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, rebuilt
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.motor import NO_MOTORS
from spear_pin.model.robot import Robot
from spear_pin.studies.hop_of_another import hop_of
from spear_pin.studies.payoff.grid import Point
from spear_pin.studies.payoff.knee import levers, release_springs, tie_springs, with_knee, with_values
from spear_pin.studies.payoff.motors import PARTS, Motors, make_geared

TORQUE = "stance_torque"  # what is solved for the flight time
FOOTING = 0.05  # of the weight: what the law lets rest on the toe at least while the knee flexes
TREAD, TAUT = 0.02, 0.005  # of the weight, rad: how far a descent keeps from a toe that leaves, a spring that is slack
CLEAR = 0.005  # m: how far it keeps knee and hip from the ground
LOADED = "margin_lift_off_before_torque_switch"
FREQUENCIES = (1.0, 1.3)  # of the law's, that a first hop is looked for with, in turn
FIRST, SHORTEST = 0.5, 0.03  # of the way to another point: the first step, and the least
LEAST = 1e-3  # of a range of stiffness: without any a spring has no derivative
MISSED = 1e-3  # of limits, together: a hop that misses more keeps them not
NO_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType({})
SAME = 1e-6  # SI: by which the state of a hop may change where its spring is let go
ALIKE, APART = 0.01, 0.1  # of a cost; of a range: starts nearer than that are one


@dataclass(frozen=True)
class Task:
    """What to minimise.

    Attributes:
        flight_time: wanted flight time, in s.
        measure: measure of `optimize_design`.
        motors: motors whose limits are kept; None: those of the file alone.
        ranges: least and most of the stance torque, and of each chosen number of law or spring.
        tolerance: relative gain that ends a descent.
        starts: number of starts beside the first.
        seed: seed of these.
    """

    flight_time: float
    measure: str
    motors: Motors | None
    ranges: Mapping[str, tuple[float, float]]
    tolerance: float
    starts: int
    seed: int

    @property
    def chosen(self) -> list[str]:
        """Names of the chosen numbers."""
        return [name for name in self.ranges if name != TORQUE]


class Best(NamedTuple):
    """The best of some descents.

    Attributes:
        gait: its hop.
        design: what it chose, and what held it.
        starts: number of descents that ended alike, at this cost within `ALIKE`, from starts that are `APART`.
    """

    gait: Gait
    design: codesign.Design
    starts: int


def best_hop(task: Task, begun: Sequence[Gait]) -> Best:
    """Finds the hop of least cost among the ends of descents from some hops and from starts around them.

    Raises:
        MissingExtra: heyoka is not installed.
        NoGait: no descent ends in a hop within its limits.
    """
    found: list[tuple[Gait, codesign.Design, bool]] = []
    failures: list[str] = []
    low, high = task.ranges[TORQUE]
    for start in starts(task, begun):
        try:
            end = descend(task, start)
        except MissingExtra:
            raise
        except REFUSALS as error:
            failures.append(error.reason if isinstance(error, NoGait) else str(error))
            continue
        if low <= number(end[0].system, TORQUE) <= high:
            found.append((*end, start is begun[0] or _apart(task, begun[0], start)))
        else:
            failures.append(f"it ends with a stance torque beyond {low:.3g} to {high:.3g} N·m")
    if not found:
        raise NoGait(f"no descent to a hop succeeds; of the first: {failures[0]}", np.inf)
    within = [each for each in found if each[1].missed <= MISSED]
    if not within:
        nearest, design, _ = min(found, key=lambda each: each[1].missed)
        cause = f"in the nearest one {_missed(design, nearest.system)}"
        remedy = "a stronger motor, another spring, or another flight time"
        raise NoGait("every hop exceeds a limit", nearest.residual, cause, remedy)
    gait, design, _ = min(within, key=lambda each: each[1].objective)
    most = (1.0 + ALIKE) * design.objective
    return Best(gait, design, max(sum(far and each.objective <= most for _, each, far in within), 1))


def _apart(task: Task, one: Gait, other: Gait) -> bool:
    """Tells whether two hops differ in a chosen number by a good part of its range."""
    shares = (
        abs(number(one.system, name) - number(other.system, name)) / (task.ranges[name][1] - task.ranges[name][0])
        for name in task.chosen
    )
    return max(shares) >= APART


def _missed(design: codesign.Design, system: HybridSystem) -> str:
    """Names the bound that a design misses most, relative to the bound, with value and bound."""

    def miss(label: str) -> float:
        value, bound = design.bounds[label]
        return (value - bound if label.endswith("at most") else bound - value) / (abs(bound) or 1.0)

    worst = max(design.bounds, key=miss)
    value, bound = design.bounds[worst]
    measure = worst.rsplit(" ", 2)[0]
    unit = "N" if measure == LOADED else unit_in(system, describe_measure(measure), measure)
    return f"{measure.replace('_', ' ')} is {value:.3g} instead of {worst[len(measure) + 1 :]} {bound:.3g} {unit}"


def starts(task: Task, begun: Sequence[Gait]) -> Iterator[Gait]:
    """Yields some hops, then hops on ways from them, in turn, to random numbers in the ranges, where a way leads."""
    yield from begun
    rng = np.random.default_rng(task.seed)
    for i in range(task.starts):
        near, share = begun[i % len(begun)], rng.uniform()
        now = {name: number(near.system, name) for name in task.chosen}
        aim = {name: value + share * (rng.uniform(*task.ranges[name]) - value) for name, value in now.items()}

        def solve(reach: float, last: Gait, now: Mapping[str, float] = now, aim: Mapping[str, float] = aim) -> Gait:
            values = {name: value + reach * (aim[name] - value) for name, value in now.items()}
            return _hop(with_values(last.system, values), last, task.flight_time)

        way = _led(solve, near)
        if way.done:
            yield way.end


def _led(solve: Callable[[float, Gait], Gait], begun: Gait) -> Way[Gait]:
    """Leads a hop along a way, which ends as well where numbers are not valid."""

    def safely(reach: float, last: Gait) -> Gait:
        try:
            return solve(reach, last)
        except NoGait:
            raise
        except REFUSALS as error:
            raise NoGait(str(error), np.inf) from None

    return lead_along(safely, begun, first=FIRST, shortest=SHORTEST)


def _hop(system: HybridSystem, near: Gait, flight_time: float) -> Gait:
    """Finds the hop of a system near another one, with a flight time."""
    begun = with_values(system, {TORQUE: number(near.system, TORQUE)})
    return gait_beside(begun, near.state, [TORQUE], {"flight_time": flight_time})


def descend(task: Task, start: Gait) -> tuple[Gait, codesign.Design]:
    """Leads a hop down to the minimum near it, with the task's flight time; within limits its spring then releases.

    Raises:
        MissingExtra: heyoka is not installed.
        NoGait, NotDifferentiable: there is no way down, or no hop at its end.
    """
    wanted = problem(task, start.system)
    design = optimize_design(
        replace(start, system=tie_springs(start.system)),
        wanted.minimize,
        wanted.over,
        wanted.keep,
        vary=wanted.vary,
        at_most=wanted.at_most,
        at_least=wanted.at_least,
        motors=wanted.motors,
        assuming=(),
        tolerance=task.tolerance,
    )
    values = {name: number(design.gait.system, name) for name in wanted.names}
    system = release_springs(start.system) if design.missed <= MISSED else start.system
    gait = gait_beside(with_values(system, values), design.gait.state, wanted.vary, wanted.keep)
    if max(float(np.abs(ours - its).max()) for ours, its in zip(gait.state, design.gait.state, strict=True)) > SAME:
        raise NoGait("the spring is slack in stance", gait.residual)
    return gait, design


def problem(task: Task, system: HybridSystem) -> Problem:
    """Returns what a descent minimises, and within which bounds.

    Args:
        task: what to minimise.
        system: the hop at the beginning, whose numbers are within their ranges or widen these.
    """
    at_most, at_least = limits(system.robot, task.motors, task.ranges)
    at_least[LOADED] = TREAD * system.robot.weight
    at_least |= {f"margin_fall:{part}": CLEAR for part in PARTS}
    if system.spring.rest is None:
        at_least |= {f"deflection_{name}": TAUT for name in system.springs}
        at_least[f"deflection_{next(iter(system.springs))}"] *= float(np.linalg.norm(levers(system)))
    drives = NO_MOTORS if task.motors is None else make_geared(task.motors, system.robot)
    over = dict[str, tuple[float, float]]()
    for name in task.chosen:
        (least, most), value = task.ranges[name], number(system, name)
        if name == "stiffness":
            least = max(least, min(LEAST * most, value))
        over[name] = min(least, value), max(most, value)
    keep = {"flight_time": task.flight_time}
    return Problem(task.measure, over, (TORQUE,), keep, at_most, at_least, None, drives)


def limits(
    robot: Robot, motors: Motors | None, ranges: Mapping[str, tuple[float, float]] = NO_RANGES
) -> tuple[dict[str, float], dict[str, float]]:
    """Returns upper and lower bounds of measures, by the robot's file and the motors.

    A motor keeps its greatest speed behind the greatest ratio among `ranges`, if its gears are among them.
    """
    at_most, at_least = dict[str, float](), dict[str, float]()
    for part in PARTS:
        own, fastest = robot.limits[part], np.inf
        if motors is not None:
            drive, at_least[f"reserve_{part}"] = getattr(motors, part), 0.0
            _, ratio = ranges.get(f"{part}_ratio", (0.0, drive.gearbox.ratio))
            fastest = (drive.motor.max_speed or np.inf) / ratio
        low, high = own.position
        upper = {
            "peak_torque": own.effort or np.inf,
            "peak_speed": min(own.velocity or np.inf, fastest),
            "greatest": high,
        }
        at_most |= {f"{name}_{part}": limit for name, limit in upper.items() if limit < UNKNOWN}
        at_least |= {f"least_{part}": low} if low > -UNKNOWN else {}
    return at_most, at_least


def lead_hop(point: Point, kind: str, gait: Gait) -> Gait:
    """Leads a hop to another point by small steps of stiffness and flight time; the kind changes without a spring.

    Springs act both ways on the way, where no cycle would close with springs that release.

    Args:
        point: the point.
        kind: kind of the hop's knee.
        gait: the hop.

    Raises:
        NoGait: the way ends before.
    """
    spring, law, here = gait.system.spring, gait.system.law, gait.durations["flight"]
    own = point.stiffness
    if own is None:
        own = spring.stiffness or law.virtual_stiffness / float(np.sum(levers(gait.system) ** 2))
    if kind != point.kind:
        gait = _towards(gait, kind, 0.0, here)
    return _towards(gait, point.kind, own, point.speed)


def _towards(begun: Gait, kind: str, stiffness: float, flight_time: float) -> Gait:
    """Leads a hop to a stiffness of a kind of knee and to a flight time.

    Raises:
        NoGait: the way ends before.
    """
    softest, shortest = begun.system.spring.stiffness, begun.durations["flight"]

    def solve(reach: float, near: Gait) -> Gait:
        own = softest + reach * (stiffness - softest)
        system = with_knee(near.system, kind, own)
        return _hop(system, near, shortest * (flight_time / shortest) ** reach)

    way = _led(solve, begun)
    if way.failure is not None:
        raise way.failure
    return way.end


def first_hops(system: HybridSystem, flight_times: Sequence[float]) -> Iterator[Gait]:
    """Yields hops by a law like SPEAR-II's, for some frequencies of its square wave and flight times.

    Raises:
        NoGait: there is none.
    """
    failures = []
    for wanted in flight_times:
        for share in FREQUENCIES:
            law = replace(
                system.law,
                frequency=share * system.law.frequency,
                hold_extension=True,
                minimum_force=FOOTING * system.robot.weight,
            )
            try:
                hop = hop_of(rebuilt(system, law=law), wanted)
            except NoGait as error:
                failures.append(error)
                continue
            yield hop
    if len(failures) == len(flight_times) * len(FREQUENCIES):
        raise failures[0]
