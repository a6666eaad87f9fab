"""Trajectories as tables: columns with their units, files of them, pandas and xarray."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, RobotWarning, SpearError, UnknownName, import_extra
from spear_pin.files import atomic
from spear_pin.hybrid.column_names import (
    ACTS,
    CYCLE,
    ENGAGED,
    QUANTITIES,
    TIME,
    UNSAID,
    heading,
    lengths,
    sort_columns,
    unit,
    unit_of,
)
from spear_pin.hybrid.path_springs import MEASURED, PathSprings

if TYPE_CHECKING:
    from spear_pin.hybrid.trajectory import Trajectory

AXES = {  # axes of arrays over samples, besides time
    **dict.fromkeys(("q", "v", "a", "friction"), ("coordinate",)),
    **dict.fromkeys(("u", "tau", "current", "reference"), ("motor",)),
    "force": ("toe", "axis"),
    **dict.fromkeys(("spring", ENGAGED), ("spring_joint",)),
    **dict.fromkeys(("domain", "phase", CYCLE), ()),
}
DRIVEN = ("current", "reference")  # only with hardware


def columns(trajectory: Trajectory) -> tuple[list[str], Array]:
    """Returns names and values of all numeric columns, one row a sample."""
    one = trajectory
    names, parts = [TIME, CYCLE], [one.t[:, None], one.cycle[:, None].astype(float)]
    for symbol, values, labels in (
        ("q", one.q, one.coordinates),
        ("v", one.v, one.coordinates),
        ("a", one.a, one.coordinates),
        ("u", one.u, one.actuated),
        ("tau", one.tau, one.actuated),
        ("friction", one.friction, one.coordinates),
        ("spring", one.spring, one.spring_joints),
        ("current", one.current, one.actuated if one.current.size else ()),
        ("reference", one.reference, one.actuated if one.reference.size else ()),
        *((f"force_{axis}", one.force[:, :, i], one.toes) for i, axis in enumerate(directions(one))),
        *((each, getattr(one.springs, each), one.springs.names) for each in MEASURED if one.springs is not None),
    ):
        names += [f"{symbol}_{label}" for label in labels]
        parts.append(values)
    return names, np.hstack(parts)


def directions(trajectory: Trajectory) -> str:
    """Returns the axes of forces: "xz" in the plane, "xyz" in space."""
    return "xyz" if trajectory.force.shape[2] == 3 else "xz"


def choose_columns(names: list[str], asked: tuple[str, ...]) -> list[str]:
    """Returns the names of the requested columns; a beginning such as "q" or "force_z" stands for all of a kind.

    Raises:
        UnknownName: there is no such column.
    """
    found = []
    for name in asked:
        those = (
            [name] if name in names else [each for each in names if name in QUANTITIES and each.startswith(f"{name}_")]
        )
        if not those:
            there = [group for group in QUANTITIES if any(each.startswith(f"{group}_") for each in names)]
            raise UnknownName("column", name, [*there, *(each for each in names if each not in (TIME, CYCLE))])
        found += those
    return list(dict.fromkeys(found))


def units(trajectory: Trajectory) -> dict[str, str]:
    """Returns the unit of each column by its name; "m or rad" and the like if the robot is not found."""
    measured = _measured(trajectory)
    return {name: unit(name, measured) for name in columns(trajectory)[0]}


def frame(trajectory: Trajectory) -> Any:
    """Returns the samples as a `pandas.DataFrame`, see `Trajectory.to_pandas`."""
    said = units(trajectory)
    made = _table(trajectory).set_index(TIME)
    made.attrs = {"units": said, "robot": trajectory.robot}
    return made


def dataset(trajectory: Trajectory) -> Any:
    """Returns the samples as an `xarray.Dataset`, see `Trajectory.to_xarray`."""
    xarray = import_extra("xarray", "sweep", "a trajectory as a Dataset")
    measured = _measured(trajectory)
    lengths = [measured.get(name, UNSAID) for name in trajectory.coordinates]
    there = {name: axes for name, axes in AXES.items() if trajectory.current.size or name not in DRIVEN}
    symbols = {"force": "force_x"} | {name: name for name in QUANTITIES}
    units = {name: {"units": unit_of(symbols[name])} if name in symbols else {} for name in there}
    variables = {name: ((TIME, *axes), getattr(trajectory, name), units[name]) for name, axes in there.items()}
    coordinates = {
        TIME: (TIME, trajectory.t, {"units": unit(TIME, measured)}),
        "coordinate": list(trajectory.coordinates),
        "unit": ("coordinate", lengths, {"long_name": "unit of each coordinate"}),
        "motor": list(trajectory.actuated),
        "toe": list(trajectory.toes),
        "axis": list(directions(trajectory)),
        "spring_joint": list(trajectory.spring_joints),
    }
    if springs := trajectory.springs:
        along = (TIME, "path_spring")
        coordinates |= {"path_spring": list(springs.names), "path_unit": ("path_spring", list(springs.units))}
        variables |= {
            f"path_{each}": (along, getattr(springs, each), {} if each == ACTS else {"units": unit_of(each)})
            for each in (*MEASURED, ACTS)
        }
    attributes = {"robot": trajectory.robot, "reason": trajectory.reason, "cycles": trajectory.cycles}
    return xarray.Dataset(variables, coordinates, attributes)


def export(trajectory: Trajectory, path: str | Path, sampled: tuple[str, ...]) -> Path:
    """Writes the samples to a file, see `Trajectory.export`.

    Args:
        trajectory: the trajectory.
        path: the file.
        sampled: names of the arrays over samples.
    """
    suffix = Path(path).suffix
    if suffix == ".csv":
        table, measured = _table(trajectory), _measured(trajectory)
        head = [heading(name, unit(name, measured)) for name in table.columns]
        with atomic(path) as temporary, temporary.open("wb") as file:
            table.to_csv(file, header=head, index=False, encoding="utf-8")
    elif suffix == ".mat":
        from scipy.io import savemat

        arrays = {name: getattr(trajectory, name) for name in sampled}
        arrays |= {name: arrays[name].astype(object) for name in ("domain", "phase")}
        flows = dict.fromkeys([*trajectory.ledger.kinds, *trajectory.ledger.flows])
        ledger = {flow.replace(":", "_"): trajectory.ledger[flow] for flow in flows}
        events = {"name": [e.name for e in trajectory.events], "time": [e.time for e in trajectory.events]}
        extra: dict[str, Any] = {"coordinates": list(trajectory.coordinates), "ledger": ledger, "events": events}
        if springs := trajectory.springs:
            extra["springs"] = {"names": list(springs.names), "units": list(springs.units)}
            extra["springs"] |= {each: getattr(springs, each) for each in (*MEASURED, ACTS)}
        if trajectory.electrical is not None:
            extra["electrical"] = {flow: trajectory.electrical[flow] for flow in trajectory.electrical.flows}
        with atomic(path) as temporary, temporary.open("wb") as file:
            savemat(file, arrays | extra, oned_as="column")
    else:
        raise BadValue("path", str(path), "a name ending in .csv or .mat")
    return Path(path)


def _table(trajectory: Trajectory) -> Any:
    """Returns all columns as a `pandas.DataFrame`, in the order of a table."""
    import pandas

    names, numbers = columns(trajectory)
    words = pandas.DataFrame({"domain": trajectory.domain, "phase": trajectory.phase} | find_engaged(trajectory))
    made = pandas.concat([pandas.DataFrame(numbers, columns=names), words], axis=1)
    made[CYCLE] = trajectory.cycle
    return made[sort_columns(made.columns)]


def find_engaged(trajectory: Any) -> dict[str, Array]:
    """Returns whether springs are engaged, by the names of the columns, (n,) each; of joints, then of paths."""
    joints, springs = tuple(trajectory.spring_joints), paths_of(trajectory)
    there = np.asarray(trajectory.engaged, dtype=bool).reshape(-1, len(joints)) if joints else np.empty((0, 0), bool)
    found = {f"{ENGAGED}_{joint}": on for joint, on in zip(joints, there.T, strict=True)}
    if springs is not None:
        found |= {f"{ACTS}_{name}": on for name, on in zip(springs.names, springs.acts.T, strict=True)}
    return found


def paths_of(trajectory: Any) -> PathSprings | None:
    """Returns the springs on paths of whatever moves like a trajectory; None if it has none."""
    springs: PathSprings | None = getattr(trajectory, "springs", None)
    return springs


def along_paths(springs: PathSprings | None) -> dict[str, str]:
    """Returns by the names of springs' columns in what their paths are measured, "m" or "rad"."""
    if springs is None:
        return {}
    pairs = [*zip(springs.names, springs.units, strict=True)]
    return {f"{each}_{name}": unit for each in MEASURED for name, unit in pairs}


def _measured(trajectory: Trajectory) -> dict[str, str]:
    """Returns "m" or "rad" for each coordinate, if the robot is found, and for what is measured along a path."""
    return along_paths(trajectory.springs) | _lengths(trajectory)


def _lengths(trajectory: Trajectory) -> dict[str, str]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RobotWarning)
            return lengths(trajectory.load_robot())
    except (SpearError, ValueError):
        return {}
