"""The job of a sweep: unknowns, targets and points, checked, in a form that other processes can receive."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, is_dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError, UnknownName
from spear_pin.gaits.gait_table import REASONS
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.many import find_many
from spear_pin.gaits.singly import find_each
from spear_pin.gaits.targets import check_wanted, measures_of
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import check_equations
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.parameters import Change, change_system, find_replaced, parameter, with_parameters
from spear_pin.hybrid.result import State
from spear_pin.model.robot import Robot
from spear_pin.model.variants import PARAMETERS, parameters_of, vary

Rows = dict[str, Any]
CODES = {reason: code for code, reason in enumerate(REASONS)}
CARRIED = ("section", "cyclic", "phase_limit", "shortest_flight")  # fields that processes can be told


@dataclass(frozen=True)
class Job:
    """A job of solving at some points, in a form that other processes can receive.

    Attributes:
        kind: kind of the system.
        build: makes the system from (robot, law, spring, contact).
        robot: the robot that is varied.
        parts: law, spring and contact.
        changes: other changes of the system, in order.
        replaced: fields that were replaced in the system.
        points: parameters of the system, of the robot, or measures that are targets, (n,) each.
        vary: parameters to solve for, from the system's own values.
        target: wanted values of measures that are the same at all points.
        guess: a state to begin from.
        rtol: relative tolerance; see `find_many`.
    """

    kind: str
    build: Callable[..., HybridSystem]
    robot: Robot
    parts: Mapping[str, Any]
    changes: tuple[Change, ...]
    replaced: Mapping[str, Any]
    points: Mapping[str, Array]
    vary: tuple[str, ...]
    target: Mapping[str, float]
    guess: State
    rtol: float

    def take(self, points: slice | NDArray[np.int64]) -> Job:
        """Returns the job at some of its points."""
        return replace(self, points={name: values[points] for name, values in self.points.items()})

    def system(self, **varied: float) -> HybridSystem:
        """Returns the system with its varied robot."""
        bare = self.build(vary(self.robot, **varied), *self.parts.values())
        return replace(reduce(change_system, self.changes, bare), **self.replaced)

    def rows(self) -> Rows:
        """Solves, and returns a row for each point; lanes of the same robot are solved together."""
        n, base = len(next(iter(self.points.values()))), self.system()
        of_robot = [name for name in self.points if name in PARAMETERS]
        shapes = _shapes(base)
        rows: Rows = {name: np.full((n, *shape), np.nan) for name, shape in shapes.items()}
        rows["multipliers"] = rows["multipliers"] + 0j
        rows["reason"] = np.full(n, CODES["not_valid"], np.int8)
        rows |= {f"solved_{name}": np.full(n, np.nan) for name in self.vary}
        robots = np.column_stack([self.points[name] for name in of_robot] or [np.zeros(n)])
        for values in np.unique(robots, axis=0):
            lanes = np.flatnonzero((robots == values).all(axis=1))
            try:
                system = self.system(**dict(zip(of_robot, values.tolist(), strict=False)))
            except SpearError:
                continue
            own = {name: column[lanes] for name, column in self.points.items() if name not in of_robot}
            target: dict[str, Any] = {
                **self.target,
                **{name: own.pop(name) for name in list(own) if name in measures_of(system)},
            }
            start: dict[str, Any] = {
                name: np.full(len(lanes), parameter(system, name)) for name in (*self.vary, "stiffness")
            }
            in_lanes = system.robot.planar and not system.pins and all(name in MEASURES for name in target)
            find = find_many if in_lanes else find_each
            table = find(system, {**start, **own}, self.vary, target, guess=self.guess, rtol=self.rtol)
            rows["q"][lanes], rows["v"][lanes], rows["residual"][lanes] = table.q, table.v, table.residual
            rows["multipliers"][lanes, : table.multipliers.shape[1]] = table.multipliers
            rows["durations"][lanes] = np.column_stack([table.durations[phase] for phase in system.phases])
            rows["reason"][lanes] = [CODES[str(reason)] for reason in table.reason]
            for name in self.vary:
                rows[f"solved_{name}"][lanes] = table.parameters[name]
        return rows


def check_job(
    system: HybridSystem, points: Mapping[str, ArrayLike], vary: tuple[str, ...], target: Any, rtol: float
) -> Job:
    """Returns the checked job for a request; points of one robot stand together."""
    kept = _check_system(system)
    given = {name: np.array(values, dtype=float) for name, values in points.items()}
    of_robot = [name for name in given if name in parameters_of(system.robot)]
    measured = {name: values for name, values in given.items() if name in measures_of(system)}
    n = _check_points(given, vary)
    for name in given:
        if name not in of_robot and name not in measured:
            _check_name(system, name)
    wanted = {**target, **{name: float(np.median(values)) for name, values in measured.items()}}
    if len(wanted) != len(vary):
        raise BadValue("target", list(wanted), f"as many targets as parameters to vary, {len(vary)}")
    for name in wanted:
        if name not in measures_of(system):
            raise UnknownName("target", name, measures_of(system))
    check_wanted(system, {**target, **measured})
    for name in vary:
        parameter(system, name)
    order = np.lexsort([given[name] for name in of_robot[::-1]]) if of_robot else np.arange(n)
    given = {name: values[order] for name, values in given.items()}
    nowhere = np.zeros(system.robot.nq), np.zeros(system.robot.nv)
    build = system.made["builder"]
    whole = system.kind, build, system.robot, system.parts, system.changes
    return Job(*whole, kept, given, vary, dict(target), nowhere, rtol)


def _check_system(system: HybridSystem) -> dict[str, Any]:
    """Returns fields that were replaced in a system and that other processes can replace; refuses others."""
    check_equations(system)
    named = getattr(system.made["builder"], "__qualname__", "")
    if not named or "<lambda>" in named:
        raise BadValue("system.build", system.build, "a function with a name, which identifies the sweep")
    kept = find_replaced(system)
    for name in kept:
        if name not in CARRIED:
            expected = "the one it was built with: a replacement cannot be sent to other processes"
            raise BadValue(f"{name} of the system", kept[name], expected)
    for name, brake in system.brakes.items():
        if brake.when is not None or brake.until is not None:
            expected = "one without `when` and `until`: no file says which functions they are"
            raise BadValue("a brake of the system", name, expected)
    for change in system.changes:
        if not is_dataclass(change):
            raise BadValue(
                "a change of the system", change, "a callable dataclass, whose name and fields identify the sweep"
            )
    return kept


def _check_points(given: Mapping[str, Array], vary: tuple[str, ...]) -> int:
    """Returns the number of points, for which each name has a number."""
    if not given:
        raise BadValue("points", dict(given), "at least one parameter")
    n = max(values.size for values in given.values())
    for name, values in given.items():
        if values.shape != (n,) or not n or not np.isfinite(values).all():
            raise BadValue(f"points[{name!r}]", values, "finite numbers, equally many for each name")
        if name in vary:
            raise BadValue("vary", name, "a parameter that is not in points")
    return n


def _shapes(system: HybridSystem) -> dict[str, tuple[int, ...]]:
    """Returns the contents of a row, with the count of numbers for each."""
    robot, section = system.robot, system.of_phase(system.section_phase)[0]
    closed = sum(mode != OPEN for mode in section.contacts) if robot.dimension == 2 else 0
    multipliers = robot.nq + robot.nv - 2 * closed - len(system.cyclic)  # with sliding toes; fewer if they stick
    return {
        "q": (robot.nq,),
        "v": (robot.nv,),
        "residual": (),
        "multipliers": (multipliers,),
        "durations": (len(system.phases),),
    }


def _check_name(system: HybridSystem, name: str) -> None:
    """Raises `UnknownName` with every valid name unless one is a parameter of the system."""
    try:
        with_parameters(system, {name: 1.0})
    except UnknownName as error:
        robots = parameters_of(system.robot)
        raise UnknownName("parameter", name, (*error.valid, *robots, *measures_of(system))) from None
    except SpearError:
        pass  # the name is known
