"""What a payoff study has to know of a kind of gait, and one search for any of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.model.robot import Robot
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.grid import Point
from spear_pin.studies.payoff.motors import Motors
from spear_pin.studies.payoff.searches import Search, SearchEnd, written


@dataclass(frozen=True)
class Words:
    """How a kind of gait is spoken of.

    Attributes:
        one: such a gait.
        doing: what a robot does.
        pace: how the speed of a `Point` is said, a format with one number.
        paces: how a range of them is said, a format with two.
        axis: name of such speeds, with their unit.
        slowest: the least of them.
        fastest: the largest of them.
        cost: what the cost is.
        since: axis of the time in a cycle, with its unit.
        joint: of what the limits of the file are, a format with "part".
        rests: what a study of such gaits rests on, names and what they say.
    """

    one: str
    doing: str
    pace: str
    paces: str
    axis: str
    slowest: str
    fastest: str
    cost: str
    since: str
    joint: str
    rests: tuple[tuple[str, str], ...]

    def of(self, point: Point) -> str:
        """A point in words."""
        return point.said(self.pace)


Found = tuple[Gait, Figures, Solution | None]


@dataclass(frozen=True)
class Gaits:
    """A kind of gait; its functions are of a module, for they go to other processes.

    Attributes:
        kind: among ``KINDS`` of `spear_pin.gaits.gait`.
        words: how it is spoken of.
        meshes: of a search, as of `Search`.
        finer: of the search that tells how much meshes matter.
        search: the gait of least electrical cost of a robot with its motors, and its figures.
        reference: the gait of least effort of a robot without springs at a speed, and what it took for motors.
        speeds: by default, by the robot's size.
        first: speeds in the order in which a first gait is likeliest to be found from cold.
        stiffness: of a leg's spring, in N·m/rad, by the robot's size.
        check: refuses speeds that no such gait has.
        asked: what beside the rest tells one study from another.
        energy: what the motors of the whole robot draw in a cycle, in J.
    """

    kind: str
    words: Words
    meshes: tuple[int, ...]
    finer: tuple[int, ...]
    search: Callable[[Robot, Motors, Search], Found]
    reference: Callable[[Robot, float], Gait]
    speeds: Callable[[Robot], tuple[float, ...]]
    first: Callable[[Robot, Sequence[float]], Sequence[float]]
    stiffness: Callable[[Robot], float]
    check: Callable[[Robot, Sequence[float]], None]
    asked: Callable[[Robot], Mapping[str, Any]]
    energy: Callable[[Robot, Figures], float]


def attempt(gaits: Gaits, robot: Robot, motors: Motors, asked: Search) -> SearchEnd:
    """Search once."""
    begun = time.process_time()
    origin = "cold" if asked.start is None else gaits.words.of(asked.start.point)
    finding = SearchEnd(asked.key, asked.point, origin, asked.meshes, 0.0)
    try:
        gait, found, solution = gaits.search(robot, motors, asked)
    except (Infeasible, NoGait, BadValue) as error:  # the last where a cycle that was found is none
        return replace(finding, seconds=time.process_time() - begun, reason=str(error))
    return replace(finding, seconds=time.process_time() - begun, figures=found, gait=written(gait), solution=solution)
