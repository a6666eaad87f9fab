"""A trajectory's samples as a page holds them: columns with their units, thinned to what there is room for."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.model.robot import Robot
from spear_pin.viz.playback.trajectory import TrajectoryLike, read_times, table_of

Array = NDArray[np.float64]

MOST_VALUES = 48_000  # that a page holds, four bytes each
LENGTH, ANGLE = ("m", "m/s", "m/s²", "N"), ("rad", "rad/s", "rad/s²", "N·m")
KINDS: dict[
    str, tuple[str, int | str]
] = {  # of columns by their symbol: what they are, and which of the units of their coordinate, or which unit
    "q": ("position", 0),
    "v": ("velocity", 1),
    "a": ("acceleration", 2),
    "u": ("motor torque", 3),
    "tau": ("joint torque", 3),
    "friction": ("friction", 3),
    "spring": ("spring torque", 3),
    "current": ("current", "A"),
    "reference": ("current asked for", "A"),
    "force_x": ("force along the ground", "N"),
    "force_z": ("force normal to the ground", "N"),
}


@dataclass(frozen=True)
class Column:
    """A number over time.

    Attributes:
        name: as `Trajectory.columns` has it, for instance `q_knee`.
        label: what has it, of those of its kind: `knee`.
        kind: what it is, in words; columns of a kind and a unit share a plot.
        unit: of its values.
        values: (n,).
    """

    name: str
    label: str
    kind: str
    unit: str
    values: Array

    @property
    def moves(self) -> bool:
        """Whether its values differ."""
        return bool(np.any(self.values != self.values[0]))


@dataclass(frozen=True)
class Samples:
    """Samples of a trajectory.

    Attributes:
        t: (n,) times, in s from the first; an event has two samples.
        columns: everything else.
        every: of so many samples of the trajectory one is here.
    """

    t: Array
    columns: tuple[Column, ...]
    every: float = 1.0


def samples_of(robot: Robot, trajectory: TrajectoryLike) -> Samples:
    """The samples of a trajectory: all its columns where it has such, else configuration and ground forces."""
    t = read_times(trajectory)
    found = table_of(trajectory)
    # a floating base has more numbers than names there
    names, table = found if found and len(found[0]) == found[1].shape[1] else _plain(robot, trajectory)
    units = _units(robot)
    columns = (
        _column(name, np.asarray(values, dtype=np.float64), units) for name, values in zip(names, table.T, strict=True)
    )
    return Samples(t - t[0], tuple(column for column in columns if column.name != "t"))


def thinned(samples: Samples, most: int = MOST_VALUES) -> Samples:
    """As many samples as a page holds, both sides of every event among them where they are not too many."""
    n = len(samples.t)
    room = max(2, most // max(1, sum(column.moves for column in samples.columns)))
    if n <= room:
        return samples
    instants = np.flatnonzero(np.diff(samples.t) == 0)
    sides = np.r_[instants, instants + 1] if 4 * len(instants) < room else instants[:0]
    rows = np.unique(np.r_[sides, np.linspace(0, n - 1, room - len(sides)).astype(int)])
    columns = (replace(column, values=column.values[rows]) for column in samples.columns)
    return Samples(samples.t[rows], tuple(columns), n / len(rows))


def packed(samples: Samples) -> dict[str, Any]:
    """Samples as the page's script reads them; of a column that stays the same only its value."""
    moving = [column.values for column in samples.columns if column.moves]
    return {
        "times": _base64(samples.t, "<f8"),
        "values": _base64(np.array(moving), "<f4"),
        "columns": [
            {"name": column.name, "label": column.label, "kind": column.kind, "unit": column.unit}
            | ({} if column.moves else {"still": float(column.values[0])})
            for column in samples.columns
        ],
        "every": round(samples.every, 2),
        "plotted": plotted(samples),
    }


def plotted(samples: Samples) -> list[str]:
    """Names of the columns that a page shows first: what motors do, what the ground does, and where the joints are."""
    moving = [column for column in samples.columns if column.moves]
    driven = {c.label for c in moving if c.kind == "motor torque"}
    angles = [c.name for c in moving if c.kind == "position" and (not driven or c.label in driven)]
    torques = [c.name for c in moving if c.kind == "motor torque"]
    forces = [c.name for c in moving if c.name.startswith("force_z_")]
    return [*angles, *torques, *forces]


def _plain(robot: Robot, trajectory: TrajectoryLike) -> tuple[Sequence[str], Array]:
    force = np.asarray(trajectory.force, dtype=np.float64)
    n, toes, axes = force.shape
    along = [f"force_{axis}_{toe}" for axis in ("xz" if axes == 2 else "xyz") for toe in robot.toes]
    names = [*(f"q_{name}" for name in robot.configuration), *along]
    return names, np.hstack([np.asarray(trajectory.q, dtype=np.float64), force.swapaxes(1, 2).reshape(n, axes * toes)])


def _column(name: str, values: Array, units: dict[str, tuple[str, ...]]) -> Column:
    head, _, unit = name.partition(" [")
    symbol = next((each for each in sorted(KINDS, key=len, reverse=True) if head.startswith(f"{each}_")), None)
    if symbol is None:
        return Column(head, head, head, unit.rstrip("]"), values)
    kind, which = KINDS[symbol]
    label = head.removeprefix(f"{symbol}_")
    own = units.get(label, ("",) * 4)
    return Column(head, label, kind, which if isinstance(which, str) else own[which], values)


def _units(robot: Robot) -> dict[str, tuple[str, ...]]:
    """Units of position, velocity, acceleration and force along each coordinate, by its name."""
    return {name: LENGTH if unit == "m" else ANGLE for name, unit in zip(robot.coordinates, robot.units, strict=True)}


def _base64(values: Array, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values).astype(kind).tobytes()).decode()
