"""Trajectories as tables: columns with their units, files of them, pandas and xarray."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, MissingExtra, RobotWarning, SpearError, UnknownName
from spear_pin.files import atomic

if TYPE_CHECKING:
    from spear_pin.hybrid.trajectory import Trajectory

Array = NDArray[np.float64]
TIME = "t [s]"
UNSAID = "m or rad"  # of a coordinate whose robot is not found
RATES = {"q": "", "v": "/s", "a": "/s²"}
EFFORTS = {"m": "N", "rad": "N·m", UNSAID: "N or N·m"}
OTHERS = {"current": "A", "reference": "A", "force_x": "N", "force_z": "N"}
EFFORT = EFFORTS[UNSAID]
VARIABLES = {  # arrays over samples: their axes besides time, and the unit
    "q": (("coordinate",), "m or rad"),
    "v": (("coordinate",), "m/s or rad/s"),
    "a": (("coordinate",), "m/s² or rad/s²"),
    "u": (("motor",), EFFORT),
    "tau": (("motor",), EFFORT),
    "friction": (("coordinate",), EFFORT),
    "force": (("toe", "axis"), "N"),
    "spring": (("spring_joint",), EFFORT),
    "engaged": (("spring_joint",), ""),
    "domain": ((), ""),
    "phase": ((), ""),
    "cycle": ((), ""),
}


def columns(trajectory: Trajectory) -> tuple[list[str], Array]:
    """Names, and values, of everything numeric, one row a sample."""
    one = trajectory
    names, parts = [TIME, "cycle"], [one.t[:, None], one.cycle[:, None].astype(float)]
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
        ("force_x", one.force[:, :, 0], one.toes),
        ("force_z", one.force[:, :, 1], one.toes),
    ):
        names += [f"{symbol}_{label}" for label in labels]
        parts.append(values)
    return names, np.hstack(parts)


def chosen(names: list[str], asked: tuple[str, ...]) -> list[str]:
    """Names of columns among those that were asked for: of each, or of all that begin with it, as "q" or "force_z".

    Raises:
        UnknownName: there is none.
    """
    groups = [*RATES, "u", "tau", "friction", "spring", *OTHERS]
    found = []
    for name in asked:
        those = [name] if name in names else [each for each in names if name in groups and each.startswith(f"{name}_")]
        if not those:
            there = [group for group in groups if any(each.startswith(f"{group}_") for each in names)]
            raise UnknownName("column", name, [*there, *(each for each in names if each not in (TIME, "cycle"))])
        found += those
    return list(dict.fromkeys(found))


def units(trajectory: Trajectory) -> dict[str, str]:
    """Unit of each column by its name; "m or rad" and the like where the robot, which tells, is not found."""
    lengths, found = _lengths(trajectory), {TIME: "s", "cycle": "1"}
    for name in columns(trajectory)[0][2:]:
        others = [unit for symbol, unit in OTHERS.items() if name.startswith(f"{symbol}_")]
        symbol, _, coordinate = name.partition("_")
        found[name] = others[0] if others else _unit(symbol, lengths[coordinate])
    return found


def frame(trajectory: Trajectory) -> Any:
    """The samples as a `pandas.DataFrame`, see `Trajectory.to_pandas`."""
    import pandas

    names, table = columns(trajectory)
    made = pandas.DataFrame(table[:, 1:], columns=names[1:], index=pandas.Index(trajectory.t, name="t"))
    made["cycle"] = trajectory.cycle
    made.insert(0, "domain", trajectory.domain)
    made.insert(1, "phase", trajectory.phase)
    for column, joint in enumerate(trajectory.spring_joints):
        made[f"engaged_{joint}"] = trajectory.engaged[:, column]
    said = units(trajectory)
    made.attrs = {"units": {"t": said.pop(TIME), **said}, "robot": trajectory.robot}
    return made


def dataset(trajectory: Trajectory) -> Any:
    """The samples as an `xarray.Dataset`, see `Trajectory.to_xarray`."""
    try:
        import xarray
    except ImportError:
        raise MissingExtra("xarray", "sweep", "a trajectory as a Dataset") from None
    lengths = [_lengths(trajectory)[name] for name in trajectory.coordinates]
    shown = dict(VARIABLES)
    if trajectory.current.size:
        shown |= dict.fromkeys(("current", "reference"), (("motor",), "A"))
    variables = {
        name: (("t", *axes), getattr(trajectory, name), {"units": unit} if unit else {})
        for name, (axes, unit) in shown.items()
    }
    coordinates = {
        "t": ("t", trajectory.t, {"units": "s"}),
        "coordinate": list(trajectory.coordinates),
        "unit": ("coordinate", lengths, {"long_name": "unit of each coordinate"}),
        "motor": list(trajectory.actuated),
        "toe": list(trajectory.toes),
        "axis": ["x", "z"],
        "spring_joint": list(trajectory.spring_joints),
    }
    attributes = {"robot": trajectory.robot, "reason": trajectory.reason, "cycles": trajectory.cycles}
    return xarray.Dataset(variables, coordinates, attributes)


def export(trajectory: Trajectory, path: str | Path, sampled: tuple[str, ...]) -> Path:
    """Write the samples, see `Trajectory.export`.

    Args:
        trajectory: whose they are.
        path: the file.
        sampled: names of the arrays over samples.
    """
    suffix = Path(path).suffix
    if suffix == ".csv":
        names, table = columns(trajectory)
        with atomic(path) as temporary, temporary.open("w", encoding="utf-8") as file:
            file.write(",".join(["domain", *names]) + "\n")
            for name, row in zip(trajectory.domain, table, strict=True):
                file.write(name + "," + ",".join(map(repr, row.tolist())) + "\n")
    elif suffix == ".mat":
        from scipy.io import savemat

        arrays = {name: getattr(trajectory, name) for name in sampled}
        arrays |= {name: arrays[name].astype(object) for name in ("domain", "phase")}
        ledger = {flow: trajectory.ledger[flow] for flow in trajectory.ledger.flows}
        events = {"name": [e.name for e in trajectory.events], "time": [e.time for e in trajectory.events]}
        extra: dict[str, Any] = {"coordinates": list(trajectory.coordinates), "ledger": ledger, "events": events}
        if trajectory.electrical is not None:
            extra["electrical"] = {flow: trajectory.electrical[flow] for flow in trajectory.electrical.flows}
        with atomic(path) as temporary, temporary.open("wb") as file:
            savemat(file, arrays | extra, oned_as="column")
    else:
        raise BadValue("path", str(path), "a name ending in .csv or .mat")
    return Path(path)


def _unit(symbol: str, length: str) -> str:
    if symbol not in RATES:
        return EFFORTS[length]
    return " or ".join(f"{part}{RATES[symbol]}" for part in length.split(" or "))


def _lengths(trajectory: Trajectory) -> dict[str, str]:
    """Unit of each coordinate, "m" or "rad"."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RobotWarning)
            robot = trajectory.load_robot()
    except (SpearError, ValueError):
        return dict.fromkeys(trajectory.coordinates, UNSAID)
    known = dict(zip(robot.coordinates, robot.units, strict=True))
    return {name: known.get(name, UNSAID) for name in trajectory.coordinates}
