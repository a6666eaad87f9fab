"""Searches of a payoff study and their findings, and both as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.gait import KINDS, Gait, part_of, springs_data, springs_of
from spear_pin.model.robot import Robot
from spear_pin.model.variants import vary
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.grid import Point
from spear_pin.studies.payoff.store import digest


@dataclass(frozen=True)
class Search:
    """One search.

    Attributes:
        point: the point to search at.
        start: the finding to start from; None: the search starts from initial guesses.
        meshes: intervals of each phase, see `spear_pin.gaits.optimize.search`; for a hop the samples of each phase.
    """

    point: Point
    start: SearchEnd | None
    meshes: tuple[int, ...]

    @property
    def key(self) -> str:
        """Name of the search in the store."""
        return digest([asdict(self.point), None if self.start is None else self.start.key, list(self.meshes)])


@dataclass(frozen=True)
class SearchEnd:
    """Finding of a search.

    Attributes:
        key: key of the search.
        point: point of the search.
        origin: point from which it began, in words.
        meshes: intervals of each phase.
        seconds: CPU time, in s.
        reason: why there is no gait; empty where there is one.
        figures: figures of the gait.
        gait: data from which `rebuilt` makes the gait.
        solution: solution of the optimiser, for a bound.
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
        """Electrical cost; infinite where there is no gait."""
        return np.inf if self.figures is None else self.figures.cost


def write_gait(gait: Gait) -> dict[str, Any]:
    """Returns the data of a gait that its robot does not give, as JSON."""
    return {
        "varied": dict(gait.system.robot.varied),
        "law": asdict(gait.system.law),
        **springs_data(gait.system),
        "state": [part.tolist() for part in gait.state],
        "parameters": dict(gait.parameters),
        "residual": gait.residual,
        "multipliers": [[value.real, value.imag] for value in gait.multipliers],
        "durations": dict(gait.durations),
    }


def rebuilt(kind: str, robot: Robot, said: Mapping[str, Any]) -> Gait:
    """Returns the gait of a robot that `write_gait` wrote, of a kind among ``KINDS`` of `spear_pin.gaits.gait`."""
    build, law_of = KINDS[kind]
    q, v = (np.array(part, dtype=float) for part in said["state"])
    multipliers = np.array([complex(*pair) for pair in said["multipliers"]])
    varied = said.get("varied", robot.varied)
    robot = robot if varied == dict(robot.varied) else vary(robot, **varied)
    system = build(robot, part_of(law_of, said["law"]), springs_of(said))
    return Gait(system, (q, v), said["parameters"], said["residual"], multipliers, said["durations"])


def to_json(finding: SearchEnd) -> dict[str, Any]:
    """Returns a finding as JSON."""
    line = {field.name: getattr(finding, field.name) for field in fields(finding)}
    line["point"] = asdict(finding.point)
    line["figures"] = None if finding.figures is None else asdict(finding.figures)
    if finding.solution is not None:
        values = {name: np.asarray(value).tolist() for name, value in finding.solution.values.items()}
        line["solution"] = {**asdict(replace(finding.solution, values={})), "values": values}
    return line


def of_json(line: Mapping[str, Any]) -> SearchEnd:
    """Returns the finding of a line."""
    said = dict(line) | {"point": Point(**line["point"]), "meshes": tuple(line["meshes"])}
    if line["figures"] is not None:
        said["figures"] = Figures(**line["figures"] | {"held": tuple(line["figures"]["held"])})
    if line["solution"] is not None:
        values = {name: np.array(value, dtype=float) for name, value in line["solution"]["values"].items()}
        said["solution"] = Solution(**line["solution"] | {"values": values})
    return SearchEnd(**said)
