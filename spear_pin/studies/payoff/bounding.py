"""Payoff study of a bound: the gait of least electrical cost of transport for each knee, stiffness and speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.optimize import MESHES, search
from spear_pin.gaits.request import Request
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_of
from spear_pin.model.settings import refuse_special
from spear_pin.studies.bound import list_active_bounds
from spear_pin.studies.design import motors_of
from spear_pin.studies.payoff.figures import Figures, figures
from spear_pin.studies.payoff.gaits import Found, Gaits, Words
from spear_pin.studies.payoff.grid import FIXED, Point
from spear_pin.studies.payoff.motors import Motors
from spear_pin.studies.payoff.searches import Search
from spear_pin.studies.payoff.study import Study, study_knees

SHARES = (0.6, 0.7, 0.8, 0.9)  # of the speed that `Request.scaled` has
FINER = (20,)  # intervals of each phase
# with a virtual stiffness that is given, a spring that is like it would have the advantage
FREE: dict[str, Any] = {"virtual_stiffness": None, "minimum_knee_torque": 0.0}
WORDS = Words.read("bounding")


def request(robot: Robot, point: Point, motors: Motors) -> Request:
    """Returns the request of a search at a point: least electrical cost of transport, within motors and limits."""
    asked = Request.scaled(
        robot,
        speed=point.speed,
        objective="electrical",
        stiffness=None if point.stiffness is None else motors_of(robot) * point.stiffness,
        **FREE,
        knee_drive=motors.knee,
        hip_drive=motors.hip,
    )
    return replace(asked, rest=asked.knee_touchdown) if point.kind == FIXED else asked


def figures_of(gait: Gait, motors: Motors, request: Request) -> Figures:
    """Returns figures of a bound found by a search.

    Args:
        gait: a bounding gait.
        motors: motors that drive it.
        request: request of the search, for the bounds that are active.
    """
    trajectory = simulate(gait.system, gait.state, progress=False)
    stride = Sampled(gait.system.robot, trajectory)
    held = list_active_bounds(gait, request, stride.largest("friction_used"))
    work, speed = stride.weight * stride.distance, stride.largest("mean_speed")
    return figures(gait, motors, trajectory, work=work, speed=speed, held=held)


class Bounds(Gaits):
    """Bounds of a quadruped, found by collocation."""

    kind = "bounding"
    words = WORDS
    meshes = MESHES
    finer = FINER

    def search(self, robot: Robot, motors: Motors, asked: Search) -> Found:
        """Finds the gait of least electrical cost of a robot with its motors, and its figures."""
        wanted = request(robot, asked.point, motors)
        start = None if asked.start is None else asked.start.solution
        gait, solution = search(robot, wanted, start=start, meshes=asked.meshes)
        return gait, figures_of(gait, motors, wanted), solution

    def reference(self, robot: Robot, speed: float) -> Gait:
        """Finds the gait of least effort of a robot without springs at a speed, and its load on motors."""
        return search(robot, Request.scaled(robot, speed=speed, stiffness=0.0))[0]

    def speeds(self, robot: Robot) -> tuple[float, ...]:
        """Returns default speeds for the robot's size."""
        return tuple(float(f"{share * Request.scaled(robot).speed:.3g}") for share in SHARES)

    def first(self, robot: Robot, speeds: Sequence[float]) -> Sequence[float]:
        """Returns speeds in the order for a first gait: the slowest first."""
        return speeds

    def stiffness(self, robot: Robot) -> float:
        """Returns the stiffness of a leg's spring for the robot's size, in N·m/rad."""
        return (Request.scaled(robot).stiffness or 0.0) / motors_of(robot)

    def check(self, robot: Robot, speeds: Sequence[float]) -> None:
        """Refuses speeds that no such gait has."""
        for speed in speeds:
            Request.scaled(robot, speed=speed).check(scale_of(robot))

    def asked(self, robot: Robot) -> Mapping[str, Any]:
        """Returns further data that tell one study from another."""
        return {"request": str(replace(Request.scaled(robot), **FREE))}

    def energy(self, robot: Robot, figures: Figures) -> float:
        """Returns the energy that the motors of the whole robot draw in a cycle, in J."""
        return figures.cost * robot.weight * figures.speed * sum(figures.durations.values())


BOUNDS = Bounds()


def bounds(robot: Robot, path: Path, **options: Any) -> Study:
    """Finds bounds of least electrical cost without springs, with fixed and with switchable ones.

    Args:
        robot: a robot in its sagittal plane, as `spear_pin.sagittal` cuts it, or Q-SPEAR.
        path: path of the store; searches in it are not repeated.
        **options: see `study_knees`; speeds are by default `SHARES` of that of `Request.scaled`.

    Raises:
        NoGait, Infeasible, BadFile, BadValue: see `study_knees`.
        MissingExtra: CasADi, or for several processes joblib, is not installed.
    """
    refuse_special(robot, "the knees of this study replace")
    return study_knees(BOUNDS, robot, path, **options)
