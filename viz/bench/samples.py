"""Samples of a trajectory for a page: columns with their units, thinned to the available room."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.column_names import (
    TIME,
    heading,
    lengths,
    quantity,
    read_heading,
    sort_columns,
    split_column_name,
    unit,
)
from spear_pin.hybrid.trajectory_tables import along_paths, find_engaged, paths_of
from spear_pin.model.robot import Robot
from spear_pin.viz.bench.columns import Column
from spear_pin.viz.bench.space import by_leg, in_space, plotted_in_space
from spear_pin.viz.playback.trajectory import TrajectoryLike, read_times, table_of

MOST_VALUES = 48_000  # that a page holds, four bytes each


@dataclass(frozen=True)
class Samples:
    """Samples of a trajectory.

    Attributes:
        t: (n,) times, in s from the first; an event has two samples.
        columns: all other columns.
        every: one of so many samples of the trajectory is kept.
        words: words by the name of the column, (n,) each: domain, phase if there is one, and whether springs are
            engaged.
        first: names of the columns that a page plots first, if not by `plot_columns`.
    """

    t: Array
    columns: tuple[Column, ...]
    every: float = 1.0
    words: Mapping[str, NDArray[np.str_]] = field(default_factory=dict)
    first: tuple[str, ...] = ()


def samples_of(robot: Robot, trajectory: TrajectoryLike) -> Samples:
    """Returns the samples of a trajectory: all its columns, or else configuration and ground forces."""
    t = read_times(trajectory)
    found = table_of(trajectory)
    # a floating base has more numbers than names there
    names, table = found if found and len(found[0]) == found[1].shape[1] else _plain(robot, trajectory)
    measured = lengths(robot) | along_paths(paths_of(trajectory))
    columns = tuple(
        _column(name, np.asarray(values, dtype=np.float64), measured)
        for name, values in zip(names, table.T, strict=True)
        if read_heading(name)[0] != TIME
    )
    if in_space(robot):
        columns = by_leg(robot, columns)
    first = plotted_in_space(columns) if in_space(robot) else ()
    return Samples(t - t[0], columns, words=_words(trajectory), first=tuple(first))


def thinned(samples: Samples, most: int = MOST_VALUES) -> Samples:
    """Returns as many samples as a page holds, with both sides of every event if they are not too many."""
    n = len(samples.t)
    room = max(2, most // max(1, sum(column.moves for column in samples.columns)))
    if n <= room:
        return samples
    instants = np.flatnonzero(np.diff(samples.t) == 0)
    sides = np.r_[instants, instants + 1] if 4 * len(instants) < room else instants[:0]
    rows = np.unique(np.r_[sides, np.linspace(0, n - 1, room - len(sides)).astype(int)])
    columns = (replace(column, values=column.values[rows]) for column in samples.columns)
    words = {name: values[rows] for name, values in samples.words.items()}
    return replace(samples, t=samples.t[rows], columns=tuple(columns), every=n / len(rows), words=words)


def packed(samples: Samples) -> dict[str, Any]:
    """Returns samples in the form for the page's script; a constant column has a single value."""
    moving = [column.values for column in samples.columns if column.moves]
    tabled = [column for column in samples.columns if not column.derived]
    return {
        "times": _base64(samples.t, "<f8"),
        "values": _base64(np.array(moving), "<f4"),
        "columns": [
            {"name": column.name, "label": column.label, "kind": column.kind, "unit": column.unit}
            | {"heading": heading(column.name, column.unit)}
            | ({"color": column.color} if column.color else {})
            | ({} if column.moves else {"still": float(column.values[0])})
            for column in samples.columns
        ],
        "words": {name: _runs(values) for name, values in samples.words.items()},
        "order": sort_columns([TIME, *samples.words, *(column.name for column in tabled)]),
        "time": heading(TIME, unit(TIME, {})),
        "every": round(samples.every, 2),
        "plotted": list(samples.first) or plotted(samples),
    }


def plotted(samples: Samples) -> list[str]:
    """Returns names of the columns that a page shows first: joints, motors, springs and ground forces."""
    there = [(*split_column_name(column.name), column.name) for column in samples.columns if column.moves]
    driven = {label for symbol, label, _ in there if symbol == "u"}
    angles = [name for symbol, label, name in there if symbol == "q" and (not driven or label in driven)]
    others = [name for first in ("u", "spring", "pull", "force_z") for symbol, _, name in there if symbol == first]
    return [*angles, *others]


def _plain(robot: Robot, trajectory: TrajectoryLike) -> tuple[Sequence[str], Array]:
    force = np.asarray(trajectory.force, dtype=np.float64)
    n, toes, axes = force.shape
    along = [f"force_{axis}_{toe}" for axis in ("xz" if axes == 2 else "xyz") for toe in robot.toes]
    names = [*(f"q_{name}" for name in robot.configuration), *along]
    return names, np.hstack([np.asarray(trajectory.q, dtype=np.float64), force.swapaxes(1, 2).reshape(n, axes * toes)])


def _column(name: str, values: Array, measured: Mapping[str, str]) -> Column:
    plain, said = read_heading(name)
    return Column(plain, split_column_name(plain)[1], quantity(plain), said or unit(plain, measured), values)


def _words(trajectory: TrajectoryLike) -> dict[str, NDArray[np.str_]]:
    domain = np.asarray(trajectory.domain, dtype=str)
    phase = getattr(trajectory, "phase", None)
    latches = {name: on.astype(str) for name, on in find_engaged(trajectory).items()}
    return {"domain": domain} | ({} if phase is None else {"phase": np.asarray(phase, dtype=str)}) | latches


def _runs(values: NDArray[np.str_]) -> list[tuple[int, str]]:
    """Returns where each value begins that differs from the one before."""
    rows = np.r_[0, np.flatnonzero(values[1:] != values[:-1]) + 1]
    return [(int(row), str(values[row])) for row in rows]


def _base64(values: Array, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode()
