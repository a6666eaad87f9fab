"""Payoff study of a hop of one leg in place: the hop of least electricity for each knee, stiffness and flight time.

The cost of a hop is the electricity of a cycle over m g h with h = g T²/8, the rise of a body with flight time T. So
all hops with one flight time refer to the same work.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid import batch
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter
from spear_pin.hybrid.parameters import rebuilt as with_parts
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_of
from spear_pin.model.spring import Spring
from spear_pin.studies.design import energy_drawn, points_of
from spear_pin.studies.hop_of_another import hop_of, scaled_hopping
from spear_pin.studies.payoff.best_hop import KEPT, TORQUE, best_hop, judged
from spear_pin.studies.payoff.cycles import Task
from spear_pin.studies.payoff.descent import descended
from spear_pin.studies.payoff.figures import Figures, figures
from spear_pin.studies.payoff.gaits import Found, Gaits, Words
from spear_pin.studies.payoff.grid import NONE, SWITCHED, Point
from spear_pin.studies.payoff.leading import FOOTING, Place, led
from spear_pin.studies.payoff.motors import PARTS, Motors
from spear_pin.studies.payoff.searches import Search, rebuilt
from spear_pin.studies.payoff.study import Study, studied

USUAL = 0.2  # s: flight of SPEAR-II
SHARES = (0.7, 0.85, 1.0, 1.15)  # of it, by the leg's size
MESH, FINER = 160, 480  # samples of each phase: where a joint turns back, the losses of its gears jump
TOLERANCES = {MESH: (0.05, 1e-8), FINER: (0.02, 1e-9)}  # of the optimiser, in units, and of the integrator
TREAD, TAUT = 0.02, 0.005  # of the weight, rad: how far from a brink
FREQUENCIES = (1.0, 1.3)  # of SPEAR-II's, scaled, that a first hop is looked for with, in turn
KNEE, HIP = (0.3, 2.2), (-1.5, 1.5)  # rad: of touchdown, within the joints' limits
RATES, TORQUES, STIFFNESS = (0.3, 2.5), (0.0, 6.0), (0.0, 8.0)  # of SPEAR-II's, scaled
WORDS = Words(
    one="hop",
    doing="hopping in place",
    pace="{:.3g} s in the air",
    paces="{:.3g} to {:.3g} s in the air",
    axis="Flight time (s)",
    measure="flight_time",
    slowest="the shortest flight",
    fastest="the longest flight",
    cost="Electricity of a hop over m g h",
    since="Time from touchdown (s)",
    joint="the {part}",
    rests=(
        (
            "what is minimised",
            "the electricity that knee and hip draw in a hop, heat of the windings included, over m g h: m the mass on"
            " the slider, h = g T²/8 the rise of a body that is T in the air",
        ),
        (
            "what a law may do",
            "in stance one period of a square wave of torque at the knee, its flexion as strong as leaves the toe on"
            " the ground, and a virtual spring; no torque at the hip. A damper at the knee in stance, SPEAR-II's,"
            " scaled, which no kind of knee is without. In flight both joints are driven to angles. Torque, frequency,"
            " virtual spring and both angles are chosen for each point, the gains of the flight are SPEAR-II's, scaled;"
            " in flight a fixed spring is borne by the motor. Unless the spring is fixed, the toe leaves the ground"
            " before the knee is back at its angle of touchdown: there springs are let go, the virtual one too, and it"
            " would stay",
        ),
        ("the leg", "on a vertical slider without friction; limits of the file and what the motors can do are kept"),
    ),
)


def work(robot: Robot, flight_time: float) -> float:
    """Returns the work m g h of a hop with a flight time T in s, h = g T²/8, in J."""
    gravity = robot.weight / robot.mass
    return robot.weight * gravity * flight_time**2 / 8.0


def electricity(motors: Motors, system: HybridSystem, trajectory: Trajectory) -> float:
    """Returns the energy that knee and hip draw, in J."""
    return sum(energy_drawn(points_of(system.robot, trajectory, part), getattr(motors, part)) for part in PARTS)


def effort(system: HybridSystem, trajectory: Trajectory) -> float:
    """Returns ∫ Σ u² dt, in N²·m²·s."""
    return float(np.trapezoid((trajectory.u**2).sum(axis=1), trajectory.t))


def within(motors: Motors | None, system: HybridSystem, trajectory: Trajectory) -> Array:
    """Returns what remains of the limits of the joints, and of the motors' envelopes, as shares of them."""
    robot, left = system.robot, []
    for part in PARTS:
        given, limits = points_of(robot, trajectory, part), robot.limits[part]
        for values, limit in ((given.torque, limits.effort), (given.speed, limits.velocity)):
            if 0.0 < limit < UNKNOWN:
                left.append(1.0 - float(np.abs(values).max()) / limit)
        angles, (least, most) = trajectory.q[:, robot.index(part)], limits.position
        left += [gap for gap in (float(angles.min()) - least, most - float(angles.max())) if abs(gap) < UNKNOWN]
        if motors is not None:
            drive = getattr(motors, part)
            left.append(float(np.min(drive.margin(given.torque, given.speed))) / drive.stall_torque)
    return np.array(left)


def apart(system: HybridSystem, trajectory: Trajectory) -> Array:
    """Returns how far a hop is from the limits beyond which there is none, >= 0 where it is far enough.

    With too little load a toe leaves the ground again while the knee flexes; that distance is in shares of the weight.
    If the knee is back at its touchdown angle before the toe leaves, the spring releases there, and the toe stays on
    the ground until the knee is straight; that distance is in rad. A toe that only touches the ground in passing has
    no load, and a knee that has not moved.
    """
    stance, knee = trajectory.phase == "stance", system.robot.index("knee")
    if not stance.any():
        return np.array([-TREAD, -TAUT])
    angle, flexing = trajectory.q[stance, knee], trajectory.v[stance, knee] > 0.0
    load = float(trajectory.force[stance, 0, 1][flexing].min(initial=np.inf)) / system.robot.weight
    taut = float(angle[-1] - angle[0]) if system.spring.rest is None else 1.0
    return np.array([min(load, 1.0) - TREAD, taut - TAUT])


def kept(motors: Motors | None, system: HybridSystem, trajectory: Trajectory) -> Array:
    """Returns what a search keeps >= 0."""
    return np.concatenate([within(motors, system, trajectory), apart(system, trajectory)])


def ranges(robot: Robot, free: bool) -> dict[str, tuple[float, float]]:
    """Returns least and most of each chosen number.

    Args:
        robot: a leg.
        free: whether the stiffness of the spring is among them.
    """
    law, stiffness = HoppingLaw.scaled(robot), Spring.scaled(robot).stiffness

    def angles(part: str, least: float, most: float) -> tuple[float, float]:
        low, high = robot.limits[part].position
        return max(low, least), min(high, most)

    def times(shares: tuple[float, float], value: float) -> tuple[float, float]:
        return shares[0] * value, shares[1] * value

    chosen = {
        TORQUE: times(TORQUES, law.stance_torque),
        "knee_touchdown": angles("knee", *KNEE),
        "hip_touchdown": angles("hip", *HIP),
        "frequency": times(RATES, law.frequency),
        "virtual_stiffness": times(STIFFNESS, stiffness),
    }
    return chosen | ({"stiffness": times(STIFFNESS, stiffness)} if free else {})


def figures_of(gait: Gait, motors: Motors, samples: int = MESH) -> Figures:
    """Returns figures of a hop.

    Args:
        gait: a hop in place.
        motors: motors that drive it.
        samples: number of samples of each phase.
    """
    robot, flight = gait.system.robot, gait.durations["flight"]
    trajectory = simulate(gait.system, gait.state, samples=samples, progress=False)
    friction = Sampled(robot, trajectory).largest("friction_used")
    held = _held(gait, trajectory, motors)
    return figures(gait, motors, trajectory, work=work(robot, flight), speed=flight, friction=friction, held=held)


def _held(gait: Gait, trajectory: Trajectory, motors: Motors) -> tuple[str, ...]:
    """Lists ends of ranges at which the law is, and limits that are fully used, in words."""
    found = []
    for name, (least, most) in ranges(gait.system.robot, free=False).items():
        if getattr(gait.system.law, name) is None:  # a hip that follows the knee
            continue
        value, near = parameter(gait.system, name), 1e-3 * (most - least)
        end = "least" if value - least < near else "largest" if most - value < near else ""
        if end and not (name == "virtual_stiffness" and end == "least"):
            found.append(f"{name.replace('_', ' ')} is the {end} allowed")
    if within(motors, gait.system, trajectory).min() < 0.01:
        found.append("a limit of a joint or a motor is reached")
    return tuple(found)


def _from_cold(robot: Robot, point: Point, task: Task) -> Gait:
    """Finds the best hop near one by SPEAR-II's scaled law, for some frequencies of its square wave.

    The flight time of that hop is SPEAR-II's for the leg's size, or the wanted one.

    Raises:
        NoGait: there is no hop near any of them.
    """
    system = scaled_hopping(robot)
    failures = []
    for wanted in (USUAL * scale_of(robot).time, point.speed):
        for share in FREQUENCIES:
            law = replace(
                system.law,
                frequency=share * system.law.frequency,
                hold_extension=True,
                minimum_force=FOOTING * robot.weight,
            )
            try:
                near = hop_of(with_parts(system, law=law), wanted)
                place = Place(
                    Point(SWITCHED, near.durations["flight"], near.system.spring.stiffness), near.system, near.state
                )
                return best_hop(task, led(task, place, point))
            except NoGait as error:
                failures.append(error)
    raise failures[0]


def _down(task: Task, gait: Gait, measure: str, motors: Motors | None) -> Gait:
    """Returns the hop at the end of the descent, if it costs less and keeps within limits."""
    end, (least, most) = descended(gait, measure, motors, task.ranges, TAUT), task.ranges[TORQUE]
    if not least <= parameter(end.system, TORQUE) <= most:
        return gait
    (before, _), (after, left) = (judged(task, each) for each in (gait, end))
    return end if after < before and left >= KEPT else gait


def _task(robot: Robot, point: Point, cost: Any, spare: Any, mesh: int) -> Task:
    chosen = ranges(robot, free=point.stiffness is None)
    return Task(point.speed, cost, spare, chosen, mesh, *TOLERANCES[mesh])


class Hops(Gaits):
    """Hops of one leg in place, found as fixed points."""

    kind = "hopping"
    words = WORDS
    meshes = (MESH,)
    finer = (FINER,)

    def search(self, robot: Robot, motors: Motors, asked: Search) -> Found:
        """Finds the gait of least electrical cost of a robot with its motors, and its figures."""
        point, (mesh,) = asked.point, asked.meshes
        task = _task(robot, point, partial(electricity, motors), partial(kept, motors), mesh)
        if asked.start is None or asked.start.gait is None:
            gait = _from_cold(robot, point, task)
        else:
            near = rebuilt(self.kind, robot, asked.start.gait)
            gait = best_hop(task, led(task, Place.of(asked.start.point.kind, near), point))
        gait = _down(task, gait, "electricity", motors)
        return gait, figures_of(gait, motors, mesh), None

    def reference(self, robot: Robot, speed: float) -> Gait:
        """Finds the gait of least effort of a robot without springs at a speed, and its load on motors."""
        point = Point(NONE, speed)
        task = _task(robot, point, effort, partial(kept, None), MESH)
        return _down(task, _from_cold(robot, point, task), "effort", None)

    def speeds(self, robot: Robot) -> tuple[float, ...]:
        """Returns default flight times for the robot's size."""
        return tuple(float(f"{share * USUAL * scale_of(robot).time:.3g}") for share in SHARES)

    def first(self, robot: Robot, speeds: Sequence[float]) -> Sequence[float]:
        """Returns flight times in the order for a first hop: those near SPEAR-II's for the leg's size first."""
        usual = USUAL * scale_of(robot).time
        return sorted(speeds, key=lambda flight: abs(math.log(flight / usual)))

    def stiffness(self, robot: Robot) -> float:
        """Returns the stiffness of a leg's spring for the robot's size, in N·m/rad."""
        return Spring.scaled(robot).stiffness

    def check(self, robot: Robot, speeds: Sequence[float]) -> None:
        """Refuses flight times that no such gait has."""
        for flight in speeds:
            check_wanted(scaled_hopping(robot), {"flight_time": flight})

    def asked(self, robot: Robot) -> Mapping[str, Any]:
        """Returns further data that tell one study from another."""
        return {
            "gait": "hop",
            "search": "with descent",
            "ranges": {name: list(ends) for name, ends in ranges(robot, free=True).items()},
        }

    def energy(self, robot: Robot, figures: Figures) -> float:
        """Returns the energy that the motors of the whole robot draw in a cycle, in J."""
        return figures.cost * work(robot, figures.speed)


HOPS = Hops()


def hops(robot: Robot, path: Path, **options: Any) -> Study:
    """Finds hops of least electricity without a spring, with fixed and with switchable ones.

    Args:
        robot: a leg with boom_x locked, as `spear_pin.monopod` cuts it, or SPEAR-II.
        path: path of the store; searches in it are not repeated.
        **options: see `studied`; speeds are flight times, in s, by default `SHARES` of SPEAR-II's for the leg's size.

    Raises:
        NoGait, BadFile, BadValue: see `studied`.
        MissingExtra: heyoka, or for several processes joblib, is not installed.
    """
    batch.require()
    return studied(HOPS, robot, path, **options)
