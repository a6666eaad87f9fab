"""Searches of a payoff study, each kept in its store: asked for again it is read, not searched."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.bounding import bounding
from spear_pin.gaits.bounding_law import BoundingLaw
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.optimize import MESHES, search
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.studies import workers
from spear_pin.studies.payoff.figures import Figures, figures
from spear_pin.studies.payoff.grid import Point, request
from spear_pin.studies.payoff.motors import Motors
from spear_pin.studies.payoff.store import Store, digest

PURPOSE = "a payoff study in several processes"


@dataclass(frozen=True)
class Search:
    """One search.

    Attributes:
        point: what is asked.
        start: the finding to start from; None: cold.
        meshes: as of `spear_pin.gaits.optimize.search`.
    """

    point: Point
    start: SearchEnd | None = None
    meshes: tuple[int, ...] = MESHES

    @property
    def key(self) -> str:
        """Its name in the store."""
        return digest([asdict(self.point), None if self.start is None else self.start.key, list(self.meshes)])


@dataclass(frozen=True)
class SearchEnd:
    """What came of a search.

    Attributes:
        key: of the search.
        point: what was asked.
        origin: the point that it began from, in words.
        meshes: intervals of each phase.
        seconds: of a processor.
        reason: why there is no gait; empty where there is one.
        figures: of the gait.
        gait: what `rebuilt` makes it from.
        solution: the optimiser's.
    """

    key: str
    point: Point
    origin: str
    meshes: tuple[int, ...]
    seconds: float
    reason: str = ""
    figures: Figures | None = None
    gait: Mapping[str, Any] | None = None
    solution: Solution | None = None

    @property
    def cost(self) -> float:
        """Electrical cost of transport; infinite where there is no gait."""
        return np.inf if self.figures is None else self.figures.cost


Tell = Callable[[str], object]


@dataclass(frozen=True)
class Searcher:
    """Searches for a robot with its motors, in processes, each kept in a store.

    Attributes:
        robot: in its sagittal plane, the motors' rotors in it.
        motors: its motors.
        store: where findings are kept.
        n_jobs: processes.
        tell: called with what is going on, in words.
    """

    robot: Robot
    motors: Motors
    store: Store
    n_jobs: int | None = 1
    tell: Tell = lambda text: None

    def find(self, searches: Sequence[Search]) -> list[SearchEnd]:
        """What comes of some searches, in their order."""
        missing = {each.key: each for each in searches if self.store.get(each.key) is None}
        arguments = [(self.robot, self.motors, each) for each in missing.values()]
        if missing:
            self.tell(f"searching for {arguments[0][2].point}")
            for finding in workers.each(attempt, arguments, self.n_jobs, PURPOSE):
                self.store.keep(to_json(finding))
                self.tell(f"{len(self.store)} searches done, the last for {finding.point}")
        return [of_json(self.store.get(each.key) or {}) for each in searches]


def attempt(robot: Robot, motors: Motors, asked: Search) -> SearchEnd:
    """Search once."""
    begun = time.process_time()
    wanted = request(robot, asked.point, motors.knee, motors.hip)
    origin = "cold" if asked.start is None else str(asked.start.point)
    finding = SearchEnd(asked.key, asked.point, origin, asked.meshes, 0.0)
    try:
        start = None if asked.start is None else asked.start.solution
        gait, solution = search(robot, wanted, start=start, meshes=asked.meshes)
        found = figures(gait, motors, wanted)
    except (Infeasible, NoGait, BadValue) as error:  # the last where a stride that was found is none
        return replace(finding, seconds=time.process_time() - begun, reason=str(error))
    return replace(finding, seconds=time.process_time() - begun, figures=found, gait=written(gait), solution=solution)


def written(gait: Gait) -> dict[str, Any]:
    """What of a gait the robot does not say, in JSON's terms."""
    return {
        "law": asdict(gait.system.law),
        "spring": asdict(gait.system.spring),
        "state": [part.tolist() for part in gait.state],
        "parameters": dict(gait.parameters),
        "residual": gait.residual,
        "multipliers": [[value.real, value.imag] for value in gait.multipliers],
        "durations": dict(gait.durations),
    }


def rebuilt(robot: Robot, said: Mapping[str, Any]) -> Gait:
    """The gait of a robot that `written` wrote."""
    law = BoundingLaw(**{name: _tuples(value) for name, value in said["law"].items()})
    spring = Spring(**{name: _tuples(value) for name, value in said["spring"].items()})
    q, v = (np.array(part, dtype=float) for part in said["state"])
    multipliers = np.array([complex(*pair) for pair in said["multipliers"]])
    system = bounding(robot, law, spring)
    return Gait(system, (q, v), said["parameters"], said["residual"], multipliers, said["durations"])


def to_json(finding: SearchEnd) -> dict[str, Any]:
    """A finding in JSON's terms."""
    line = {field.name: getattr(finding, field.name) for field in fields(finding)}
    line["point"] = asdict(finding.point)
    line["figures"] = None if finding.figures is None else asdict(finding.figures)
    if finding.solution is not None:
        values = {name: np.asarray(value).tolist() for name, value in finding.solution.values.items()}
        line["solution"] = {**asdict(replace(finding.solution, values={})), "values": values}
    return line


def of_json(line: Mapping[str, Any]) -> SearchEnd:
    """The finding of a line."""
    said = dict(line) | {"point": Point(**line["point"]), "meshes": tuple(line["meshes"])}
    if line["figures"] is not None:
        said["figures"] = Figures(**line["figures"] | {"held": tuple(line["figures"]["held"])})
    if line["solution"] is not None:
        values = {name: np.array(value, dtype=float) for name, value in line["solution"]["values"].items()}
        said["solution"] = Solution(**line["solution"] | {"values": values})
    return SearchEnd(**said)


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value
