"""Design maps: fixed points and multipliers over any parameters, in chunks, on any number of processes.

Points are a grid or a sample; chunks of them are solved by `gaits.many.find_many`, here, in processes or on a Dask
cluster, and stored as they come (`sweep_store`). The rows do not depend on where they were solved.
"""

from __future__ import annotations

import signal
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, is_dataclass, replace
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue, MissingExtra, NoGait, SpearError, UnknownName, require
from spear_pin.gaits.gait import KINDS, built_as_named
from spear_pin.gaits.many import MEASURES, REASONS, find_many
from spear_pin.gaits.search import find_gait
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import check_lanes
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.parameters import PARTS, Change, changed, parameter, replaced, with_parameters
from spear_pin.hybrid.record import Options, State
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.variants import PARAMETERS, vary
from spear_pin.studies import sweep_store as store

Array = NDArray[np.float64]
Rows = dict[str, Any]
CODES = {reason: code for code, reason in enumerate(REASONS)}
CHUNK = 512
CARRIED = ("section", "cyclic", "phase_limit", "shortest_flight")  # fields that processes can be told


@typed
def grid(axes: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Every combination of values, the last name running fastest.

    Args:
        axes: values by the names of parameters.
    """
    values = {name: np.atleast_1d(np.asarray(axis, dtype=float)) for name, axis in axes.items()}
    mesh = np.meshgrid(*values.values(), indexing="ij")
    return {name: each.ravel() for name, each in zip(values, mesh, strict=True)}


@typed
def sample(ranges: Mapping[str, tuple[float, float]], n: int, method: str = "sobol", seed: int = 0) -> dict[str, Array]:
    """Points that fill a box evenly.

    Args:
        ranges: least and largest values by the names of parameters.
        n: number of points; of a Sobol sequence best a power of two.
        method: "sobol" or "latin", a Latin hypercube.
        seed: of the scrambling.

    Raises:
        UnknownName: no such method.
        BadValue: a range is none, n is not positive, or the seed is negative.
    """
    methods: dict[str, Callable[..., Any]] = {"sobol": scipy.stats.qmc.Sobol, "latin": scipy.stats.qmc.LatinHypercube}
    if method not in methods:
        raise UnknownName("method", method, methods)
    if n < 1:
        raise BadValue("n", n, "at least 1")
    require("seed", seed, lambda number: number >= 0 and number % 1 == 0, "a whole number >= 0")
    for name, bounds in ranges.items():
        if len(bounds) != 2 or not bounds[0] < bounds[1] or not np.isfinite(bounds).all():
            raise BadValue(name, bounds, "two finite numbers, the first the smaller")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that n is no power of two
        unit = methods[method](len(ranges), rng=seed).random(n)
    return {name: low + (high - low) * unit[:, i] for i, (name, (low, high)) in enumerate(ranges.items())}


@dataclass(frozen=True)
class Job:
    """Job of solving at some points, in a form that goes to another process.

    Attributes:
        kind: of the system.
        robot: the robot that is varied.
        parts: law, spring and contact.
        changes: what else was made of the system, in order.
        replaced: fields replaced in it.
        points: parameters of the system, of the robot, or measures that are targets, (n,) each.
        vary: parameters to solve for, from the system's own values.
        target: wanted values of measures that are the same at all points.
        guess: a state to begin from.
        rtol: as of `find_many`.
    """

    kind: str
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
        """The job at some of its points."""
        return replace(self, points={name: values[points] for name, values in self.points.items()})

    def system(self, **varied: float) -> HybridSystem:
        """The system, its robot varied."""
        bare = KINDS[self.kind][0](vary(self.robot, **varied), *self.parts.values())
        return replace(reduce(changed, self.changes, bare), **self.replaced)

    def rows(self) -> Rows:
        """Solve: a row for each point, lanes of the same robot together."""
        n, base = len(next(iter(self.points.values()))), self.system()
        of_robot = [name for name in self.points if name in PARAMETERS]
        shapes = shape_of(base)
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
                **{name: own.pop(name) for name in list(own) if name in system.measures},
            }
            start: dict[str, Any] = {
                name: np.full(len(lanes), parameter(system, name)) for name in (*self.vary, "stiffness")
            }
            table = find_many(system, {**start, **own}, self.vary, target, guess=self.guess, rtol=self.rtol)
            rows["q"][lanes], rows["v"][lanes], rows["residual"][lanes] = table.q, table.v, table.residual
            rows["multipliers"][lanes, : table.multipliers.shape[1]] = table.multipliers
            rows["durations"][lanes] = np.column_stack([table.durations[phase] for phase in system.phases])
            rows["reason"][lanes] = [CODES[str(reason)] for reason in table.reason]
            for name in self.vary:
                rows[f"solved_{name}"][lanes] = table.parameters[name]
        return rows


def shape_of(system: HybridSystem) -> dict[str, tuple[int, ...]]:
    """Contents of a row, and how many numbers of each."""
    robot, section = system.robot, system.of_phase(system.section_phase)[0]
    closed = sum(mode != OPEN for mode in section.contacts)
    multipliers = robot.nq + robot.nv - 2 * closed - len(system.cyclic)  # with sliding toes; fewer if they stick
    return {
        "q": (robot.nq,),
        "v": (robot.nv,),
        "residual": (),
        "multipliers": (multipliers,),
        "durations": (len(system.phases),),
    }


@typed
def sweep(
    system: HybridSystem,
    points: Mapping[str, ArrayLike],
    out: str | Path,
    vary: Sequence[str] = (),
    target: Mapping[str, float] | None = None,
    *,
    rtol: float = 1e-9,
    chunk: int = CHUNK,
    n_jobs: int | None = None,
    resume: bool = False,
    on_points: Callable[[int, int], object] = lambda done, total: None,
) -> Any:
    """Find the gaits at many points, and store them as an xarray Dataset in zarr.

    What is done is on disk chunk by chunk; after a kill the same call with `resume` loses no chunk and repeats none.

    Args:
        system: robot, law, spring and ground, for what the points leave open.
        points: numbers by name, (n,) each: fields of law, spring or contact, those of `variants.PARAMETERS` that the
            robot has, or measures of the cycle, which are targets then. See `grid` and `sample`.
        out: the folder to write, *.zarr; until it is whole, chunks are beside it in *.zarr.parts.
        vary: parameters to solve for at each point.
        target: wanted values of measures at all points; with those among `points` as many as `vary`.
        rtol: as of `find_many`.
        chunk: points that are solved together, and lost together.
        n_jobs: processes; by default that of `joblib.parallel_config`, in which a Dask cluster can be named, else one.
        resume: go on where this sweep was broken off.
        on_points: called with the number of points done and of all.

    Returns:
        the Dataset, read lazily.

    Raises:
        MissingExtra: heyoka, joblib, xarray or zarr is not installed.
        UnknownName: no parameter or measure of a name.
        BadValue: what was asked makes no sense.
        BadFile: something is there already, or what is to be resumed is another sweep.
    """
    taylor.require()
    store.require()
    parallel = _joblib()
    out, target = Path(out), dict(target or {})
    Options(rtol)
    job = _job(system, points, tuple(vary), target, rtol)
    if chunk < 1 or chunk % 1:
        raise BadValue("chunk", chunk, "a whole number, at least 1")
    n = len(next(iter(job.points.values())))
    described = store.description(job, chunk, n)
    if store.begin(out, described, resume):
        start = store.started(out, lambda: _start(system, job))
        begun, guess = with_parameters(system, start["values"]), (np.array(start["q"]), np.array(start["v"]))
        job = replace(job, parts={part: getattr(begun, part) for part in PARTS}, guess=guess)
        missing = store.missing(out)
        on_points(n - sum(store.size(n, chunk, i) for i in missing), n)
        tasks = (parallel.delayed(_solve)(i, job.take(slice(i * chunk, (i + 1) * chunk))) for i in missing)
        # one chunk a task, so that each is stored as soon as it is solved
        pool = parallel.Parallel(n_jobs=n_jobs, batch_size=1, return_as="generator_unordered", max_nbytes=None)
        done = n - sum(store.size(n, chunk, i) for i in missing)
        with _uninterrupted():
            solved = pool(tasks)
        for i, rows in solved:
            store.keep(out, i, rows)
            done += len(rows["reason"])
            on_points(done, n)
        store.finish(out, job, described, chunk)
    return store.read(out)


def reasons(dataset: Any) -> NDArray[np.str_]:
    """Why each point's search ended, in words of `gaits.many.REASONS`."""
    return np.asarray(np.array(list(REASONS))[dataset["reason"].to_numpy()])


def _solve(index: int, job: Job) -> tuple[int, Rows]:
    return index, job.rows()


def _job(system: HybridSystem, points: Mapping[str, ArrayLike], vary: tuple[str, ...], target: Any, rtol: float) -> Job:
    """Job as it was asked for, checked; points of one robot stand together."""
    if system.kind not in KINDS or not built_as_named(system):
        raise BadValue("system", system.kind, f"one of {', '.join(KINDS)}, made by the builder of that name")
    check_lanes(system)
    kept = replaced(system)
    for name in kept:
        if name not in CARRIED:
            raise BadValue(
                f"{name} of the system", kept[name], "as built: what replaces it cannot go to other processes"
            )
    for change in system.changes:
        if not is_dataclass(change):
            raise BadValue("a change of the system", change, "a dataclass that is called, to tell sweeps apart")
    given = {name: np.array(values, dtype=float) for name, values in points.items()}
    n = max((values.size for values in given.values()), default=0)
    of_robot = [name for name in given if name in PARAMETERS and system.robot.source in PARAMETERS[name].robots]
    measured = [name for name in given if name in system.measures]
    for name, values in given.items():
        if values.shape != (n,) or not n or not np.isfinite(values).all():
            raise BadValue(f"points[{name!r}]", values, "finite numbers, as many for each name")
        if name in vary:
            raise BadValue("vary", name, "what is not among the points")
        if name not in (*of_robot, *measured):
            _check_name(system, name)
    if not given:
        raise BadValue("points", points, "at least one parameter")
    wanted = {**target, **{name: float(np.median(given[name])) for name in measured}}
    if len(wanted) != len(vary):
        raise BadValue("target", list(wanted), f"as many targets as parameters to vary, {len(vary)}")
    for name in wanted:
        if name not in system.measures or name not in MEASURES:
            raise UnknownName("target", name, [each for each in system.measures if each in MEASURES])
    check_wanted(system, {**target, **{name: given[name] for name in measured}})
    for name in vary:
        parameter(system, name)
    order = np.lexsort([given[name] for name in of_robot[::-1]]) if of_robot else np.arange(n)
    parts = {part: getattr(system, part) for part in PARTS}
    given = {name: values[order] for name, values in given.items()}
    nowhere = np.zeros(system.robot.nq), np.zeros(system.robot.nv)
    return Job(system.kind, system.robot, parts, system.changes, kept, given, vary, dict(target), nowhere, rtol)


def _check_name(system: HybridSystem, name: str) -> None:
    """Raise `UnknownName` with every valid name unless one is a parameter of the system."""
    try:
        with_parameters(system, {name: 1.0})
    except UnknownName as error:
        robots = [each for each, known in PARAMETERS.items() if system.robot.source in known.robots]
        measures = [each for each in system.measures if each in MEASURES]
        raise UnknownName("parameter", name, (*error.valid, *robots, *measures)) from None
    except SpearError:
        pass  # the name is known


def _start(system: HybridSystem, job: Job) -> dict[str, Any]:
    """Where every lane begins: at the gait of the system as it is, or its guess if it has none."""
    targets: dict[Any, float] = {
        name: float(np.median(values)) for name, values in job.points.items() if name in system.measures
    }
    targets |= job.target
    try:
        gait = find_gait(system, job.vary, targets)
        (q, v), values = gait.state, dict(gait.parameters)
    except NoGait:
        (q, v), values = system.guess(), {}
    return {"values": values, "q": np.asarray(q).tolist(), "v": np.asarray(v).tolist()}


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Workers that are started meanwhile leave Ctrl-C to this process, which ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _joblib() -> Any:
    try:
        import joblib
    except ImportError:
        raise MissingExtra("joblib", "sweep", "a sweep") from None
    return joblib
