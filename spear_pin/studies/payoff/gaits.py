"""What a payoff study has to know of a kind of gait, and one search for any of them."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
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
        measure: name of the measure that they are.
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
    measure: str
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


class Gaits(ABC):
    """A kind of gait; it goes to other processes.

    Attributes:
        kind: among ``KINDS`` of `spear_pin.gaits.gait`.
        words: how it is spoken of.
        meshes: of a search, as of `Search`.
        finer: of the search that tells how much meshes matter.
    """

    kind: str
    words: Words
    meshes: tuple[int, ...]
    finer: tuple[int, ...]

    @abstractmethod
    def search(self, robot: Robot, motors: Motors, asked: Search) -> Found:
        """The gait of least electrical cost of a robot with its motors, and its figures."""

    @abstractmethod
    def reference(self, robot: Robot, speed: float) -> Gait:
        """The gait of least effort of a robot without springs at a speed, and what it took for motors."""

    @abstractmethod
    def speeds(self, robot: Robot) -> tuple[float, ...]:
        """By default, by the robot's size."""

    @abstractmethod
    def first(self, robot: Robot, speeds: Sequence[float]) -> Sequence[float]:
        """Speeds in the order in which a first gait is likeliest to be found from cold."""

    @abstractmethod
    def stiffness(self, robot: Robot) -> float:
        """Of a leg's spring, in N·m/rad, by the robot's size."""

    @abstractmethod
    def check(self, robot: Robot, speeds: Sequence[float]) -> None:
        """Refuse speeds that no such gait has."""

    @abstractmethod
    def asked(self, robot: Robot) -> Mapping[str, Any]:
        """What beside the rest tells one study from another."""

    @abstractmethod
    def energy(self, robot: Robot, figures: Figures) -> float:
        """What the motors of the whole robot draw in a cycle, in J."""


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
