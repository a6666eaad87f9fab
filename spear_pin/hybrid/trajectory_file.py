"""Trajectories on disk: an npz file of arrays and one JSON string, nothing pickled; every read is checked."""

from __future__ import annotations

import json
import math
import struct
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from spear_pin.errors import BadFile, BadValue, UnknownName, list_names
from spear_pin.files import atomic, check_keys, parse_json, regular
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.path_springs import MEASURED, PathSprings
from spear_pin.hybrid.reasons import REASONS
from spear_pin.hybrid.trajectory import PLAIN, SAMPLED, Event, Ledger, Trajectory
from spear_pin.model.origin import check_origin
from spear_pin.model.path_data import path_data, path_of
from spear_pin.printable import is_printable, printable

FORMAT = "spear_pin trajectory 1"
UNITS = "SI, radians"
KINDS = {"f": "numbers", "i": "whole numbers", "b": "truth values", "U": "names"}
ARRAYS = {  # kind of each array, and the names of its axes
    "t": ("f", "samples"),
    "q": ("f", "samples", "coordinates"),
    "v": ("f", "samples", "coordinates"),
    "a": ("f", "samples", "coordinates"),
    "domain": ("U", "samples"),
    "phase": ("U", "samples"),
    "cycle": ("i", "samples"),
    "u": ("f", "samples", "actuated"),
    "tau": ("f", "samples", "actuated"),
    "friction": ("f", "samples", "coordinates"),
    "force": ("f", "samples", "toes", "directions"),
    "spring": ("f", "samples", "spring_joints"),
    "engaged": ("b", "samples", "spring_joints"),
    "current": ("f", "samples", "driven"),
    "reference": ("f", "samples", "driven"),
    "event_time": ("f", "events"),
    "event_q": ("f", "events", "coordinates"),
    "event_v_before": ("f", "events", "coordinates"),
    "event_v": ("f", "events", "coordinates"),
    "event_impulse": ("f", "events", "toes", "directions"),
    "ledger_work": ("f", "cycles", "flows"),
    "ledger_change": ("f", "cycles"),
}
SPRINGS = {
    **{f"springs_{each}": ("f", "samples", "springs") for each in MEASURED},
    "springs_acts": ("b", "samples", "springs"),
}
ELECTRICAL = {"electrical_work": ("f", "cycles", "drives"), "electrical_change": ("f", "cycles")}
CURRENTS = ("current", "reference")  # missing in files that are older than hardware
ORDERED = ("t", "cycle", "event_time")
STATES = ("t", "q", "v")  # finite for any end of a run
EVENT_ARRAYS = ("time", "q", "v_before", "v", "impulse")
NAMES = ("coordinates", "actuated", "toes", "spring_joints")
COUNTS = ("cycles", "evaluations")
TEXTS = ("robot", "reason", "message")
GROUND_FIELDS = tuple(field.name for field in fields(Ground))
DENSEST = 1100  # most bytes that one byte of a compressed file may stand for: more than deflate packs

Arrays = Mapping[str, NDArray[Any]]


def write(trajectory: Trajectory, path: str | Path) -> Path:
    """Writes a trajectory; see `Trajectory.save`."""
    arrays: dict[str, Any] = {name: getattr(trajectory, name) for name in SAMPLED}
    arrays |= {f"event_{name}": np.array([getattr(e, name) for e in trajectory.events]) for name in EVENT_ARRAYS}
    arrays |= {"ledger_work": trajectory.ledger.work, "ledger_change": trajectory.ledger.change}
    electrical, ground, springs = trajectory.electrical, trajectory.ground, trajectory.springs
    if springs is not None:
        arrays |= {name: getattr(springs, name.removeprefix("springs_")) for name in SPRINGS}
    if electrical is not None:
        arrays |= {"electrical_work": electrical.work, "electrical_change": electrical.change}
    meta = {name: getattr(trajectory, name) for name in PLAIN} | {
        "format": FORMAT,
        "units": UNITS,
        "ground": None if ground is None else {name: getattr(ground, name) for name in GROUND_FIELDS},
        "flows": trajectory.ledger.flows,
        "origin": trajectory.origin,
        "drives": () if electrical is None else electrical.flows,
        "events": [{"name": e.name, "domain": e.domain, "work": dict(e.work)} for e in trajectory.events],
    }
    meta |= {} if springs is None else {"springs": _springs_data(springs)}
    with atomic(path) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, meta=np.array(json.dumps(meta)), **arrays)
    return Path(path)


def read(path: str | Path) -> Trajectory:
    """Reads a trajectory; see `Trajectory.load`."""
    try:
        with regular(path).open("rb") as file, ZipFile(file) as archive:
            return _trajectory(archive)
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    except (
        BadValue,
        BadZipFile,
        EOFError,
        MemoryError,
        RuntimeError,
        TypeError,
        UnknownName,
        ValueError,
        struct.error,
        zlib.error,
    ) as error:
        raise BadFile(
            path, f"is not a saved trajectory ({error}); expected a file that Trajectory.save wrote"
        ) from None


def _trajectory(archive: ZipFile) -> Trajectory:
    members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
    if len(members) < len(archive.infolist()):
        raise ValueError("an array is there twice")
    if "meta" not in members:
        raise ValueError("there is no meta")
    shape, kind = _header(archive, members["meta"])
    if shape or kind.kind != "U":
        raise ValueError("meta is no text")
    meta = parse_json(str(_array(archive, members.pop("meta"))))
    _check_meta(meta)
    sizes = {name: len(meta[name]) for name in (*NAMES, "flows", "events")} | {"cycles": meta["cycles"]}
    drives = tuple(meta.get("drives", ()))
    sizes |= {"drives": len(drives), "driven": len(meta["actuated"]) if drives else 0}
    springs = meta.get("springs", {})
    sizes["springs"] = len(springs)
    older = () if drives else [name for name in CURRENTS if name not in members]
    rules = ARRAYS | (ELECTRICAL if drives else {}) | (SPRINGS if springs else {})
    wanted = {name: rule for name, rule in rules.items() if name not in older}
    check_keys("array", members, wanted)
    forces, _ = _header(archive, members["force"])
    sizes["directions"] = 3 if forces[-1:] == (3,) else 2  # in space or in the plane
    for name, rule in wanted.items():  # before any array is read
        _check_header(name, rule, *_header(archive, members[name]), sizes)
    arrays = {name: _array(archive, members[name]) for name in wanted}
    for name, array in arrays.items():
        _check_values(name, array, may_fail=meta["reason"] == "not_finite" and name not in STATES)
    arrays |= {name: np.empty((sizes["samples"], 0)) for name in older}
    fields: dict[str, Any] = {name: tuple(meta[name]) for name in NAMES}
    fields |= {name: meta[name] for name in PLAIN if name not in NAMES} | {"message": printable(meta["message"])}
    fields |= {name: arrays[name] for name in SAMPLED}
    return Trajectory(
        **fields,
        events=_events(meta["events"], arrays),
        ledger=Ledger(tuple(meta["flows"]), arrays["ledger_work"], arrays["ledger_change"]),
        electrical=Ledger(drives, arrays["electrical_work"], arrays["electrical_change"]) if drives else None,
        ground=_ground(meta.get("ground")),
        origin=_origin(meta),
        springs=_springs(springs, arrays),
    )


def _ground(numbers: Any) -> Ground | None:
    """Returns the ground, None for older files, which lack it."""
    if numbers is None:
        return None
    if not isinstance(numbers, dict):
        raise BadValue("ground", numbers, "its numbers by name")
    check_keys("field of ground", numbers, GROUND_FIELDS)
    return Ground(**numbers)


def _origin(meta: Mapping[str, Any]) -> dict[str, Any] | None:
    """Returns the robot's origin, None for older files, which lack it."""
    said: dict[str, Any] | None = meta.get("origin")
    if said is not None:
        check_origin(said, "origin")
        if said["source"] != meta["robot"]:
            raise BadValue("robot", meta["robot"], f"{said['source']!r}, the source of its origin")
    return said


def _springs_data(springs: PathSprings) -> dict[str, Any]:
    """Returns the unit of each spring by name, and its path if that is one of the package's."""
    found = {}
    for name, unit, path in zip(springs.names, springs.units, springs.paths, strict=True):
        try:
            along = {} if path is None else path_data(path)
        except BadValue:
            along = {}
        found[name] = {"unit": unit, **along}
    return found


def _springs(tables: Mapping[str, Mapping[str, Any]], arrays: Arrays) -> PathSprings | None:
    """Returns the springs on paths, None if there are none."""
    if not tables:
        return None
    paths = []
    for name, table in tables.items():
        path, others = path_of(table)
        if others.keys() != {"unit"} or others["unit"] not in ("rad", "m"):
            raise BadValue(f"springs[{name!r}]", dict(table), "a unit, rad or m, and a path")
        paths.append(path)
    units = tuple(table["unit"] for table in tables.values())
    return PathSprings(tuple(tables), tuple(paths), units, *(arrays[name] for name in SPRINGS))


def _events(infos: Iterable[Mapping[str, Any]], arrays: Arrays) -> tuple[Event, ...]:
    rows = zip(infos, *(arrays[f"event_{name}"] for name in EVENT_ARRAYS), strict=True)
    return tuple(
        Event(info["name"], float(time), info["domain"], q, v_before, v, impulse, info["work"])
        for info, time, q, v_before, v, impulse in rows
    )


# arrays


def _header(archive: ZipFile, info: ZipInfo) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Returns shape and type of an array, after checking that it holds as many bytes as its header says."""
    name = info.filename.removesuffix(".npy")
    if info.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise ValueError(f"{name} is compressed in another way")
    with archive.open(info) as member:
        shape, kind = _npy_header(name, member)
        promised = member.tell() + math.prod(shape) * kind.itemsize
    if kind.hasobject:
        raise ValueError(f"{name} is of type object, and nothing is unpickled")
    if promised != info.file_size or info.file_size > DENSEST * (info.compress_size + 1):
        raise ValueError(f"{name} holds less or more than it says")
    return shape, kind


def _npy_header(name: str, member: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    try:
        shape, _, kind = readers[npy.read_magic(member)](member)
    except (ArithmeticError, LookupError, MemoryError, SyntaxError, TokenError, TypeError, ValueError, struct.error):
        raise ValueError(f"{name} is no array") from None
    return tuple(shape), kind


def _array(archive: ZipFile, info: ZipInfo) -> NDArray[Any]:
    with archive.open(info) as member:
        array: NDArray[Any] = npy.read_array(member, allow_pickle=False)
        member.read()  # to its end, where the checksum is checked
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def _check_header(
    name: str, rule: tuple[str, ...], shape: tuple[int, ...], kind: np.dtype[Any], sizes: dict[str, int]
) -> None:
    """Checks an array's type and shape; the first array with samples sets their number."""
    wanted, *axes = rule
    if kind.kind != wanted or wanted in "fi" and kind.itemsize != 8:
        raise ValueError(f"{name} is of type {kind}; expected {KINDS[wanted]}")
    if "samples" not in sizes and shape and shape[0]:
        sizes["samples"] = shape[0]
    expected = tuple(sizes.get(axis, 1) for axis in axes)
    if shape != expected and not (axes[0] == "events" and sizes["events"] == 0 and shape == (0,)):
        raise ValueError(f"{name} has the shape {shape}; expected {expected}: {' x '.join(axes)}")


def _check_values(name: str, array: NDArray[Any], may_fail: bool) -> None:
    if array.dtype.kind == "f" and not may_fail and not np.isfinite(array).all():
        raise ValueError(f"{name} is not finite everywhere")
    if array.dtype.kind == "U" and (array == "").any():
        raise ValueError(f"{name} has an empty name")
    if array.dtype.kind == "U":
        _check_seen(name, np.unique(array).tolist())
    if name in ORDERED and (np.diff(array) < 0).any():
        raise ValueError(f"{name} runs backward")
    if name == "cycle" and array[0] < 0:
        raise ValueError("cycle begins below 0")


# meta


def _check_meta(meta: Any) -> None:
    if not isinstance(meta, dict):
        raise ValueError("meta is no JSON object")
    wanted = {"format", "units", "flows", "events", *PLAIN}
    check_keys("field of meta", meta, wanted, optional=("drives", "ground", "origin", "springs"))
    for name, value in (("format", FORMAT), ("units", UNITS)):
        if meta[name] != value:
            raise BadValue(name, meta[name], repr(value))
    for name in TEXTS:
        if not isinstance(meta[name], str) or not meta[name]:
            raise BadValue(name, meta[name], "text")
    if meta["reason"] not in REASONS:
        raise BadValue("reason", meta["reason"], f"one of {', '.join(REASONS)}")
    for name in COUNTS:
        if type(meta[name]) is not int or meta[name] < 0:
            raise BadValue(name, meta[name], "a whole number >= 0")
    for name in (*NAMES, "flows", "drives"):
        _check_names(name, meta.get(name, []))
    if not meta["coordinates"]:
        raise ValueError("there are no coordinates")
    for name in ("actuated", "spring_joints"):
        if not set(meta[name]) <= set(meta["coordinates"]):
            raise BadValue(name, meta[name], f"some of {list_names(meta['coordinates'], 8)}")
    springs = meta.get("springs", {})
    if not isinstance(springs, dict) or not all(isinstance(table, dict) for table in springs.values()):
        raise BadValue("springs", springs, "a table of each by name")
    _check_names("springs", [*springs])
    if not isinstance(meta["events"], list):
        raise BadValue("events", meta["events"], "a list")
    for event in meta["events"]:
        if not _is_event(event):
            raise BadValue("an event", event, "its name, domain and work")
        _check_seen("an event", (event["name"], event["domain"], *event["work"]))


def _check_names(name: str, value: Any) -> None:
    if not (isinstance(value, list) and all(isinstance(item, str) and item for item in value)):
        raise BadValue(name, value, "a list of names")
    if len(set(value)) < len(value):
        raise BadValue(name, value, "each name once")
    _check_seen(name, value)


def _check_seen(kind: str, names: Iterable[str]) -> None:
    """Refuses names that would act on a terminal, or that look like others; a robot's name may be its path."""
    for name in names:
        if not is_printable(name):
            raise BadValue(kind, name, "names of printable characters")


def _is_event(event: Any) -> bool:
    if not isinstance(event, dict) or set(event) != {"name", "domain", "work"} or not isinstance(event["work"], dict):
        return False
    names = isinstance(event["name"], str) and isinstance(event["domain"], str)
    return names and all(type(energy) in (int, float) for energy in event["work"].values())
