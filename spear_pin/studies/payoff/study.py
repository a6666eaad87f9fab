"""Payoff study of any kind of gait: the gait of least electrical cost for each knee, stiffness and speed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import spear_pin
from spear_pin.errors import Infeasible, NoGait, SpearError
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot
from spear_pin.studies.design import joints_of
from spear_pin.studies.payoff.gaits import Gaits, Searcher, Tell
from spear_pin.studies.payoff.grid import KINDS, NONE, SWITCHED, Grid, Point
from spear_pin.studies.payoff.motors import PARTS, Motors, assume_motor, fit_motors, known, own_rotors
from spear_pin.studies.payoff.searches import Search, SearchEnd, rebuilt
from spear_pin.studies.payoff.store import Store
from spear_pin.studies.sweep.store import fingerprint

STEPS = (0.25, 0.5, 1.0, 1.5, 2.0)  # of the stiffness that the optimiser chooses
TRIES = 4  # searches of a point that fails, each from another neighbour
GAITS = 2  # gaits of a point, each from another neighbour
FOLLOWED = 6  # rounds in which neighbours, of the same kind, of what became better are searched again
BEGUN = 2  # points that are searched from initial guesses at a time
STARTS = 2  # of the search for the stiffness at the end
BETTER = 0.005  # of a cost: what counts as better


@dataclass(frozen=True)
class Study:
    """Findings of a study.

    Attributes:
        gaits: the kind of gait.
        robot: robot in the plane, with the motors' rotors.
        motors: motors of the robot.
        grid: grid of the study.
        tries: all searches on the usual mesh, by point, in order.
        best: for each kind the cheapest finding at `speed`, with a stiffness of the grid or one that the optimiser
            chose, on the usual mesh or the finer one.
        finer: the same on a finer mesh; a failed search has a reason.
        changes: for each kind, by how much the finer mesh changed its cost; NaN where there is no gait on it.
        speed: speed of the answer: mean forward speed, in m/s; for a hop in place its flight time, in s.
        chosen: stiffness of a leg's switchable spring that the optimiser chose for the grid; None where
            stiffnesses were given, or none was found.
    """

    gaits: Gaits
    robot: Robot
    motors: Motors
    grid: Grid
    tries: Mapping[Point, Sequence[SearchEnd]]
    best: Mapping[str, SearchEnd]
    finer: Mapping[str, SearchEnd]
    changes: Mapping[str, float]
    speed: float
    chosen: float | None = None

    @property
    def searches(self) -> list[SearchEnd]:
        """All searches, each once."""
        everything = [*(each for row in self.tries.values() for each in row), *self.finer.values()]
        return [*{each.key: each for each in everything}.values()]

    @property
    def seconds(self) -> float:
        """CPU time of all searches together, in s."""
        return sum(each.seconds for each in self.searches)

    def ends(self, point: Point) -> list[SearchEnd]:
        """Returns all searches of a point, with those on the finer mesh."""
        return [*self.tries.get(point, ()), *(end for end in self.finer.values() if end.point == point)]

    def at(self, point: Point) -> SearchEnd | None:
        """Returns the cheapest gait of a point, on whatever mesh; None where there is none."""
        return cheapest(self.ends(point))

    def gait(self, finding: SearchEnd) -> Gait:
        """Returns the gait of a finding that has one."""
        assert finding.gait is not None
        return rebuilt(self.gaits.kind, self.robot, finding.gait)

    def along(self, kind: str, speed: float) -> list[SearchEnd]:
        """Returns the cheapest gaits of a kind at a speed, by stiffness."""
        points = [point for point in self.grid if (point.kind, point.speed) == (kind, speed)]
        return [found for point in points if (found := self.at(point)) is not None]


def cheapest(findings: Iterable[SearchEnd]) -> SearchEnd | None:
    """Returns the finding of least cost; None where no search found a gait."""
    found = [each for each in findings if each.figures is not None]
    return min(found, key=lambda each: each.cost, default=None)


def study_knees(
    gaits: Gaits,
    robot: Robot,
    path: Path,
    *,
    speeds: Sequence[float] | None = None,
    stiffnesses: Sequence[float] | None = None,
    drives: Mapping[str, Drive] | None = None,
    bus: float | None = None,
    n_jobs: int | None = 1,
    tell: Tell = lambda text: None,
) -> Study:
    """Finds gaits of least electrical cost without springs, with fixed and with switchable ones.

    Args:
        gaits: the kind of gait.
        robot: a robot in the plane.
        path: path of the store; searches in it are not repeated.
        speeds: rising speeds in m/s, or flight times in s for a hop in place; by default for the robot's size.
        stiffnesses: rising stiffnesses of a leg's spring; by default `STEPS` of the one that the optimiser
            chooses.
        drives: drives of "knee" and "hip"; those left out are the robot's own, or assumed.
        bus: voltage of the supply, in V, for motors that are not given.
        n_jobs: number of processes.
        tell: called with messages about progress, in words.

    Raises:
        NoGait, Infeasible: no gait was found for the motors, or to begin with.
        BadFile: the store belongs to another study, or cannot be written.
        BadValue: an argument is not valid.
        MissingExtra: joblib is not installed, which several processes need.
    """
    speeds = tuple(speeds or gaits.speeds(robot))
    Grid(speeds, tuple(stiffnesses or (1.0,)))
    gaits.check(robot, speeds)
    drives = dict(drives or {})
    asked = {
        "version": spear_pin.__version__,
        "robot": fingerprint(robot),
        "speeds": list(speeds),
        "stiffnesses": None if stiffnesses is None else list(stiffnesses),
        "drives": {part: asdict(drive) for part, drive in drives.items()},
        "bus": bus,
        "settings": str(robot.settings),
        **gaits.asked(robot),
    }
    store = Store(path, asked)
    motors = _motors(gaits, robot, drives, bus, speeds, store, tell)
    searcher = Searcher(gaits, fit_motors(robot, motors), motors, store, n_jobs, tell)
    gaits.suits(searcher.robot)
    work = _Work(searcher)
    first = gaits.first(robot, speeds)
    points = {kind: [Point(kind, speed, 0.0 if kind == NONE else None) for speed in first] for kind in KINDS}
    begun = work.begin(*(points[kind] for kind in gaits.begins))
    chosen = None
    if stiffnesses is None:
        chosen, stiffnesses = work.stiffnesses(begun)
    grid = Grid(speeds, tuple(stiffnesses))
    tell(f"{len(list(grid))} points, each searched about three times")
    work.fill(grid)
    work.alone(grid)
    work.again(grid)
    best, speed = work.best(grid)
    again = searcher.find([Search(each.point, each, gaits.finer) for each in best.values()])
    finer = dict(zip(best, again, strict=True))
    changes = {kind: _change(each, finer[kind]) for kind, each in best.items()}
    best = {kind: min(each, finer[kind], key=lambda end: end.cost) for kind, each in best.items()}
    return Study(gaits, searcher.robot, motors, grid, work.tries, best, finer, changes, speed, chosen)


def _motors(
    gaits: Gaits,
    robot: Robot,
    drives: Mapping[str, Drive],
    bus: float | None,
    speeds: Sequence[float],
    store: Store,
    tell: Tell,
) -> Motors:
    """Returns the given motors, the robot's own, or assumed ones."""
    found, said, own = dict(drives), dict.fromkeys(drives, "given"), []
    for part in PARTS:
        if part in found:
            continue
        own_drive = known(robot, part, bus)
        if own_drive is not None:
            found[part], said[part] = own_drive
            own.append(part)
    if missing := [part for part in PARTS if part not in found]:
        takes = _taken(gaits, robot, speeds, store, tell)
        for part in missing:
            torque, rate = takes["takes"][part]
            found[part] = assume_motor(robot, part, torque, rate, bus)
            said[part] = "assumed"
            own += [part] * (part in own_rotors(robot))
    replaced = tuple(part for part in drives if part in own_rotors(robot))
    return Motors(found["knee"], found["hip"], said, tuple(own), replaced)


def _taken(gaits: Gaits, robot: Robot, speeds: Sequence[float], store: Store, tell: Tell) -> dict[str, Any]:
    """Returns torque and speed of each part in a gait of least effort without springs, the fastest that exists.

    Raises:
        NoGait, Infeasible: there is no such gait.
    """
    found = store.get("reference")
    if found is not None:
        return found
    failure: SpearError | None = None
    for speed in sorted(speeds, reverse=True):
        tell(f"searching for what motors have to do {gaits.words.pace.format(speed)}")
        try:
            gait = gaits.reference(robot, speed)
        except (Infeasible, NoGait) as error:
            failure = error
            continue
        cycle = Sampled(robot, simulate(gait.system, gait.state, progress=False))
        loads = [cycle.of(kind) for kind in ("rms_torque", "peak_speed")]
        takes = {part: [max(load[joint] for joint in joints_of(robot, part)) for load in loads] for part in PARTS}
        store.keep({"key": "reference", "speed": speed, "takes": takes})
        return store.get("reference") or {}
    assert failure is not None
    raise failure


def _change(coarse: SearchEnd, fine: SearchEnd) -> float:
    """Returns the relative change of the cost on a finer mesh, by magnitude; NaN where there is no gait on it."""
    return abs(fine.cost / coarse.cost - 1.0) if np.isfinite(fine.cost) else float(np.nan)


@dataclass
class _Work:
    """The searches of a study, with their findings so far."""

    searcher: Searcher
    tries: dict[Point, list[SearchEnd]] = field(default_factory=dict)
    begun: SearchEnd | None = None

    def search(self, searches: Sequence[Search]) -> list[SearchEnd]:
        found = self.searcher.find(searches)
        for finding in found:
            known = self.tries.setdefault(finding.point, [])
            if finding.key not in {each.key for each in known}:
                known.append(finding)
        return found

    def of(self, point: Point, start: SearchEnd | None = None) -> Search:
        return Search(point, start, self.searcher.gaits.meshes)

    def at(self, point: Point) -> SearchEnd | None:
        return cheapest(self.tries.get(point, ()))

    def improved(self, finding: SearchEnd) -> bool:
        """Tells whether a point's gait is better than the first that was found for it."""
        first = next(each for each in self.tries[finding.point] if each.figures is not None)
        return finding.cost < (1.0 - BETTER) * first.cost

    def begin(self, *groups: Sequence[Point]) -> SearchEnd:
        """Finds the gait of the first point that has one, from initial guesses; groups of points follow each other."""
        words, reasons = self.searcher.gaits.words, []
        for points in (group[i : i + BEGUN] for group in groups for i in range(0, len(group), BEGUN)):
            for found in self.search([self.of(point) for point in points]):
                if found.figures is not None:
                    self.begun = found
                    return found
                reasons.append(f"{words.of(found.point)}: {found.reason}")
        raise SpearError(f"there is no {words.one} to begin with: {reasons[0]}")

    def stiffnesses(self, begun: SearchEnd) -> tuple[float | None, list[float]]:
        """Returns the stiffness that the optimiser chooses, and those around it, or around one by the robot's size."""
        point, found = Point(SWITCHED, begun.point.speed, None), begun
        if begun.point != point:
            (found,) = self.search([self.of(point, begun)])
        if found.figures is None:
            like = self.searcher.gaits.stiffness(self.searcher.robot)
            return None, [float(f"{step * like:.3g}") for step in STEPS]
        chosen = found.figures.stiffness
        return chosen, [float(f"{step * chosen:.3g}") for step in STEPS]

    def fill(self, grid: Grid, gaits: int = 1) -> None:
        """Searches every point from neighbours with a gait, until it has enough gaits, or enough were tried.

        The first gait of a point is searched for from the nearest neighbour, others from the last.
        """
        while True:
            searches = []
            for point in grid:
                tries = self.tries.get(point, ())
                if sum(each.figures is not None for each in tries) >= gaits or len(tries) >= TRIES + gaits - 1:
                    continue
                near = self._from_neighbours(grid, point)
                searches += near[:1] if gaits == 1 else near[-1:]
            if not searches:
                return
            self.search(searches)

    def alone(self, grid: Grid) -> None:
        """Searches from initial guesses where there are several valleys, and where neighbours led to no gait."""
        gaits = self.searcher.gaits
        softest = [Point(kind, speed, grid.stiffnesses[0]) for kind in gaits.valleys for speed in grid.speeds]
        while points := [*softest, *(point for point in grid if point not in softest and self._is_open(grid, point))]:
            self.search([self.of(point) for point in points])
            self.fill(grid)
            softest = []

    def _is_open(self, grid: Grid, point: Point) -> bool:
        """Tells whether initial guesses may lead to a gait of a point that has none."""
        if point.kind not in self.searcher.gaits.cold or self.at(point) is not None:
            return False
        beside = [near for near in grid.neighbours(point) if near.kind == point.kind]
        likely = point.kind == NONE or any(self.at(near) is not None for near in beside)
        return likely and self.of(point).key not in {each.key for each in self.tries.get(point, ())}

    def again(self, grid: Grid) -> None:
        """Searches every point once more, until it has a gait from another neighbour."""
        self.fill(grid, GAITS)
        for _ in range(FOLLOWED):  # what became better may make its neighbours so
            searches = []
            for point in grid:
                near = self._from_neighbours(grid, point) if self.at(point) is not None else []
                starts = [(each, each.start) for each in near if each.start and each.start.point.kind == point.kind]
                searches += [each for each, start in starts if self.improved(start)]
            if not searches:
                return
            self.search(searches)

    def _from_neighbours(self, grid: Grid, point: Point) -> list[Search]:
        """Lists searches of a point from neighbours' best gaits, except for those that were done."""
        done = {each.key for each in self.tries.get(point, ())}
        starts = [found for near in grid.neighbours(point) if (found := self.at(near)) is not None]
        if self.begun is not None and not any(self.at(each) for each in grid):
            begun = self.begun.point
            beside = [each for each in grid if (each.kind, each.speed) == (begun.kind, begun.speed)]
            left = [each for each in beside if each not in self.tries]
            starts = [self.begun] if point in beside or not left else []
        return [each for start in starts if (each := self.of(point, start)).key not in done]

    def best(self, grid: Grid) -> tuple[dict[str, SearchEnd], float]:
        """Finds the best of each kind at one speed, with free stiffness if the grid has several stiffnesses.

        The speed is the one at which a switchable spring costs least, among those at which most kinds have a gait.
        """
        everything = [each for point in grid if (each := self.at(point)) is not None]
        if not everything:
            words, reasons = self.searcher.gaits.words, [each for tries in self.tries.values() for each in tries]
            failed = next(each for each in reasons if each.reason)
            raise SpearError(f"no point has a {words.one}; {words.of(failed.point)}: {failed.reason}")
        kinds = {
            end.point.speed: {each.point.kind for each in everything if each.point.speed == end.point.speed}
            for end in everything
        }
        speed = min(
            everything, key=lambda end: (-len(kinds[end.point.speed]), end.point.kind != SWITCHED, end.cost)
        ).point.speed
        best, freely = {}, []
        for kind in KINDS:
            own = [each for each in everything if (each.point.kind, each.point.speed) == (kind, speed)]
            own.sort(key=lambda each: each.cost)
            if own:
                best[kind] = own[0]
            if kind != NONE and len(grid.stiffnesses) > 1:
                freely += [self.of(Point(kind, speed, None), each) for each in own[:STARTS]]
        for finding in self.search(freely):
            if finding.cost < best[finding.point.kind].cost:
                best[finding.point.kind] = finding
        return best, speed
