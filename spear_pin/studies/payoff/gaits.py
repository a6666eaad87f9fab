"""What a payoff study needs from a kind of gait, and its searches in processes, each kept in a store."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.model.robot import Robot
from spear_pin.studies import workers
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.grid import NONE, SWITCHED, Point
from spear_pin.studies.payoff.motors import Motors
from spear_pin.studies.payoff.searches import Search, SearchEnd, of_json, to_json, write_gait
from spear_pin.studies.payoff.store import Store
from spear_pin.studies.prose import read

SAID = read(__package__, "words.toml")


@dataclass(frozen=True)
class Words:
    """Words for a kind of gait.

    Attributes:
        one: word for such a gait.
        doing: word for what a robot does.
        pace: format for the speed of a `Point`, with one number.
        paces: format for a range of speeds, with two numbers.
        axis: name of such speeds, with their unit.
        measure: name of the measure that they are.
        slowest: word for the least of them.
        fastest: word for the largest of them.
        cost: name of the cost.
        since: label of the axis of time in a cycle, with its unit.
        joint: format with "part" for what the limits of the file belong to.
        rests: assumptions of a study of such gaits, as names and texts.
        place: where the spring is, in words.
        unit: unit of its stiffness.
        units: units of further numbers that are chosen at each point, by name; empty where one has none.
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
    place: str = "in the knee"
    unit: str = "N·m/rad"
    units: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, kind: str) -> Words:
        """Returns the words for a kind of gait, from the file beside this module."""
        said = SAID[kind]
        return cls(**said | {"rests": tuple(said["rests"].items())})

    def of(self, point: Point) -> str:
        """Returns a point in words."""
        return point.said(self.pace, self.unit)

    def of_numbers(self, chosen: Mapping[str, float]) -> str:
        """Returns chosen numbers in words."""
        return ", ".join(f"{name} {value:.3g} {self.units.get(name, '')}".rstrip() for name, value in chosen.items())


PURPOSE = "a payoff study in several processes"
Tell = Callable[[str], object]
Found = tuple[Gait, Figures, Solution | None]


class Gaits(ABC):
    """A kind of gait; it can be sent to other processes.

    Attributes:
        kind: kind among ``KINDS`` of `spear_pin.gaits.gait`.
        words: words for it.
        meshes: meshes of a search; see `Search`.
        finer: meshes of the search that tells how much meshes matter.
        begins: kinds of knee in the order in which a first gait is looked for, from initial guesses.
        cold: kinds of knee whose points are searched from initial guesses where no neighbour leads to a gait; with a
            spring only beside points of the same kind that have one.
        valleys: kinds of knee for which searches end in several valleys; at each speed the softest spring is searched
            from initial guesses as well.
        over: least and greatest values of further numbers of robot or path that are chosen at each point.
    """

    kind: str
    words: Words
    meshes: tuple[int, ...]
    finer: tuple[int, ...]
    begins: tuple[str, ...] = (NONE, SWITCHED)
    cold: tuple[str, ...] = ()
    valleys: tuple[str, ...] = ()
    over: Mapping[str, tuple[float, float]] = MappingProxyType({})

    @abstractmethod
    def search(self, robot: Robot, motors: Motors, asked: Search) -> Found:
        """Finds the gait of least electrical cost of a robot with its motors, and its figures."""

    @abstractmethod
    def reference(self, robot: Robot, speed: float) -> Gait:
        """Finds the gait of least effort of a robot without springs at a speed, and its load on motors."""

    @abstractmethod
    def speeds(self, robot: Robot) -> tuple[float, ...]:
        """Returns default speeds for the robot's size."""

    @abstractmethod
    def first(self, robot: Robot, speeds: Sequence[float]) -> Sequence[float]:
        """Returns speeds in the order in which a first gait is likeliest to be found from initial guesses."""

    @abstractmethod
    def stiffness(self, robot: Robot) -> float:
        """Returns the stiffness of a leg's spring for the robot's size, in the unit of the words."""

    @abstractmethod
    def check(self, robot: Robot, speeds: Sequence[float]) -> None:
        """Refuses speeds that no such gait has."""

    def suits(self, robot: Robot) -> None:  # noqa: B027 - most kinds of gait take any
        """Refuses a robot, with its motors, with which no search can begin."""

    @abstractmethod
    def asked(self, robot: Robot) -> Mapping[str, Any]:
        """Returns further data that tell one study from another."""

    @abstractmethod
    def energy(self, robot: Robot, figures: Figures) -> float:
        """Returns the energy that the motors of the whole robot draw in a cycle, in J."""


def attempt(gaits: Gaits, robot: Robot, motors: Motors, asked: Search) -> SearchEnd:
    """Runs one search."""
    begun = time.process_time()
    origin = "cold" if asked.start is None else gaits.words.of(asked.start.point)
    try:
        gait, figures, solution = gaits.search(robot, motors, asked)
    except (Infeasible, NoGait, BadValue) as error:  # the last where a cycle that was found is none
        found: dict[str, Any] = {"reason": str(error)}
    else:
        found = {"figures": figures, "gait": write_gait(gait), "solution": solution}
    return SearchEnd(asked.key, asked.point, origin, asked.meshes, time.process_time() - begun, **found)


@dataclass(frozen=True)
class Searcher:
    """Searches for a robot with its motors, in processes, each kept in a store.

    Attributes:
        gaits: the kind of gait.
        robot: robot in the plane, with the motors' rotors.
        motors: motors of the robot.
        store: where findings are kept.
        n_jobs: number of processes.
        tell: called with messages about progress, in words.
    """

    gaits: Gaits
    robot: Robot
    motors: Motors
    store: Store
    n_jobs: int | None = 1
    tell: Tell = lambda text: None

    def find(self, searches: Sequence[Search]) -> list[SearchEnd]:
        """Returns the findings of some searches, in their order."""
        missing = {each.key: each for each in searches if self.store.get(each.key) is None}
        if missing:
            words, left = self.gaits.words, len(missing)
            self.tell(f"searching for {words.of(next(iter(missing.values())).point)}")
            arguments = [(self.gaits, self.robot, self.motors, each) for each in missing.values()]
            for finding in workers.each(attempt, arguments, self.n_jobs, PURPOSE):
                self.store.keep(to_json(finding))
                left -= 1
                found = "no gait" if finding.figures is None else f"{finding.figures.cost:.4g}"
                done = f"{len(self.store)} searches done, {left} left in this round"
                self.tell(f"{done}; the last for {words.of(finding.point)}: {found}")
        return [of_json(self.store.get(each.key) or {}) for each in searches]
