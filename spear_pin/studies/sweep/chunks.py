"""A sweep solved chunk by chunk, in this process, in several, or on a Dask cluster; each chunk is stored when done.

The rows do not depend on where they were solved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue, NoGait, import_extra
from spear_pin.gaits.gait_table import REASONS, GaitTable
from spear_pin.gaits.search import find_gait
from spear_pin.gaits.targets import measures_of
from spear_pin.hybrid import batch
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options, State
from spear_pin.kinds import typed
from spear_pin.studies import workers
from spear_pin.studies.sweep import store
from spear_pin.studies.sweep.job import Job, Rows, check_job

CHUNK = 512  # points, where they are solved together
PURPOSE = "a sweep"


@typed
def sweep(
    system: HybridSystem,
    points: Mapping[str, ArrayLike],
    out: str | Path,
    vary: Sequence[str] = (),
    target: Mapping[str, float] | None = None,
    *,
    guess: State | None = None,
    rtol: float = 1e-9,
    chunk: int | None = None,
    n_jobs: int | None = None,
    resume: bool = False,
    on_points: Callable[[int, int], object] = lambda done, total: None,
) -> Any:
    """Finds the gaits at many points, and stores them as an xarray Dataset in zarr.

    In the plane the points of a chunk are solved together. In space, and round a post, gaits are found one after the
    other, each in seconds to minutes.

    Each finished chunk is on disk. After a kill, the same call with `resume` loses no chunk and repeats none.

    Args:
        system: robot, law, spring and ground, for everything that the points do not set.
        points: numbers by name, (n,) each: fields of law, spring or contact, those of `variants.PARAMETERS` that the
            robot has, or measures of the cycle, which then are targets. See `grid` and `sample`.
        out: the folder to write, *.zarr; until it is complete, chunks are next to it in *.zarr.parts.
        vary: parameters to solve for at each point.
        target: wanted values of measures at all points; with those among `points` as many as `vary`.
        guess: a state (q, v) on the section from which the system's own gait is searched for; by default the system's
            own. Gaits in 3-D need one.
        rtol: relative tolerance; see `find_many`.
        chunk: number of points that are solved together, and lost together; by default 512, in space 1.
        n_jobs: number of processes; by default that of `joblib.parallel_config`, in which a Dask cluster can be named,
            else one.
        resume: whether to continue an interrupted sweep.
        on_points: called with the number of points done and of all.

    Returns:
        the Dataset, read lazily.

    Raises:
        MissingExtra: heyoka (for robots in the plane), joblib, xarray or zarr is not installed.
        UnknownName: no parameter or measure has such a name.
        BadValue: an argument is not valid.
        BadFile: a file is there already, or the sweep to resume is another one.
    """
    if system.robot.planar and not system.pins:
        batch.require()
    store.require()
    import_extra("joblib", "sweep", PURPOSE)
    out, target = Path(out), dict(target or {})
    Options(rtol)
    job = check_job(system, points, tuple(vary), target, rtol)
    if chunk is None:
        chunk = CHUNK if system.robot.planar else 1
    if chunk < 1 or chunk % 1:
        raise BadValue("chunk", chunk, "a whole number, at least 1")
    n = len(next(iter(job.points.values())))
    described = store.description(job, chunk, n, guess)
    system.robot.bias(*(guess or system.guess()))  # it says what is wrong with them
    if store.begin(out, described, resume):
        start = store.find_starts(out, lambda: _start(system, job, guess))
        begun, guess = with_parameters(system, start["values"]), (np.array(start["q"]), np.array(start["v"]))
        job = replace(job, parts=begun.parts, guess=guess)
        missing = store.list_missing(out)
        tasks = ((i, job.take(slice(i * chunk, (i + 1) * chunk))) for i in missing)
        done = n - sum(store.size(n, chunk, i) for i in missing)
        on_points(done, n)
        for i, rows in workers.each(_solve, tasks, n_jobs, PURPOSE):
            store.keep(out, i, rows)
            done += len(rows["reason"])
            on_points(done, n)
        store.finish(out, job, described, chunk)
    return store.read(out)


def reasons(dataset: Any) -> NDArray[np.str_]:
    """Returns the reason for which each point's search ended, in words of `gaits.gait_table.REASONS`."""
    return np.asarray(np.array(list(REASONS))[dataset["reason"].to_numpy()])


def table(dataset: Any) -> GaitTable:
    """Returns the rows of a sweep as a table of `gaits.many.find_many`, all read; a notebook shows how many ended how.

    Args:
        dataset: the Dataset that `sweep` returned, or one read from its folder.
    """
    attributes, arrays = dataset.attrs, {name: dataset[name].to_numpy() for name in dataset.variables}
    phases = [str(phase) for phase in attributes["phases"]]
    return GaitTable(
        arrays["q"],
        arrays["v"],
        {str(name): arrays[name] for name in (*attributes["names"], *attributes["vary"])},
        arrays["residual"],
        arrays["multiplier_re"] + 1j * arrays["multiplier_im"],
        dict(zip(phases, arrays["duration"].T, strict=True)),
        reasons(dataset),
    )


def _solve(index: int, job: Job) -> tuple[int, Rows]:
    return index, job.rows()


def _start(system: HybridSystem, job: Job, guess: State | None) -> dict[str, Any]:
    """Returns the start of every lane: the gait of the system as it is, or its guess if it has none."""
    targets: dict[Any, float] = {
        name: float(np.median(values)) for name, values in job.points.items() if name in measures_of(system)
    }
    targets |= job.target
    try:
        gait = find_gait(system, job.vary, targets, guess=guess)
        (q, v), values = gait.state, dict(gait.parameters)
    except NoGait:
        (q, v), values = guess or system.guess(), {}
    return {"values": values, "q": np.asarray(q).tolist(), "v": np.asarray(v).tolist()}
