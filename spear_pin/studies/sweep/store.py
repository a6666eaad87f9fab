"""Files of a sweep: a manifest, a file for each chunk, and in the end one zarr store.

NAME.zarr.parts/manifest.json   what was asked, and where lanes begin
NAME.zarr.parts/000000.npz      the rows of a chunk, renamed to this when they are on disk
NAME.zarr                       everything, renamed to this when it is whole; then the parts are removed
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import zlib
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile

import numpy as np

import spear_pin
from spear_pin.errors import BadFile, import_extra, list_names
from spear_pin.files import atomic, parse_json, read_bytes, write_text
from spear_pin.gaits.gait_table import CONVERGED, REASONS
from spear_pin.hybrid.result import State
from spear_pin.model.origin import origin
from spear_pin.model.path_data import spring_data
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.variants import PARAMETERS
from spear_pin.studies.sweep.job import Job, Rows

FORMAT = "spear_pin sweep 1"
MEANINGS = " ".join(REASONS)


def require() -> Any:
    """Returns the package xarray.

    Raises:
        MissingExtra: xarray or zarr is not installed.
    """
    xarray, _ = (import_extra(name, "sweep", "a sweep") for name in ("xarray", "zarr"))
    return xarray


def parts(out: Path) -> Path:
    """Returns the folder of the chunks."""
    return out.with_name(f"{out.name}.parts")


def size(n: int, chunk: int, index: int) -> int:
    """Returns the number of points of a chunk."""
    return min(chunk, n - index * chunk)


def description(job: Job, chunk: int, n: int, guess: State | None) -> dict[str, Any]:
    """Returns a description of the request as JSON, by which two sweeps can be distinguished."""
    return {
        "format": FORMAT,
        "version": spear_pin.__version__,
        "kind": job.kind,
        "builder": f"{job.build.__module__}.{job.build.__qualname__}",
        "robot": fingerprint(job.robot),
        **{part: _said(value) for part, value in job.parts.items()},
        "changes": [
            [f"{type(change).__module__}.{type(change).__qualname__}", asdict(cast(Any, change))]
            for change in job.changes
        ],
        "replaced": dict(job.replaced),
        "names": list(job.points),
        "points": _digest(b"".join(np.ascontiguousarray(values).tobytes() for values in job.points.values())),
        "number": n,
        "chunk": chunk,
        "vary": list(job.vary),
        "target": dict(job.target),
        "rtol": job.rtol,
        "guess": None if guess is None else [np.asarray(part).tolist() for part in guess],
    }


def _said(part: Any) -> Any:
    """Returns law, ground or springs as data; a single spring at the knee as earlier versions did."""
    if not isinstance(part, Mapping):
        return spring_data(part) if isinstance(part, Spring) else asdict(part)
    springs = {name: spring_data(spring) for name, spring in part.items()}
    return springs["knee"] if [*springs] == ["knee"] else springs


def begin(out: Path, described: Mapping[str, Any], resume: bool) -> bool:
    """Makes the folder, or checks what is in it; returns False if there is nothing left to do.

    Raises:
        BadFile: a file is there that must not be touched, or a sweep that cannot be resumed.
    """
    described = json.loads(json.dumps(described))
    folder = parts(out)
    manifest = folder / "manifest.json"
    if out.exists():
        if not resume:
            raise BadFile(out, "exists already; give another path, remove it, or resume")
        _same(out, _attribute(out), described)
        shutil.rmtree(folder, ignore_errors=True)
        return False
    if manifest.exists():
        if not resume:
            raise BadFile(folder, "has an unfinished sweep; resume it, or remove the folder")
        _same(manifest, _manifest(out)["request"], described)
        return True
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise BadFile(folder, f"cannot be made: {error.strerror}") from None
    write_text(manifest, json.dumps({"request": described}), at_once=True)
    return True


def find_starts(out: Path, start: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """Returns the start of every lane: found once, then read from the manifest, so that it is the same after a kill."""
    found = _manifest(out)
    if "start" not in found:
        found["start"] = start()
        write_text(parts(out) / "manifest.json", json.dumps(found), at_once=True)
    return dict(found["start"])


def list_missing(out: Path) -> list[int]:
    """Returns the numbers of the chunks that are not on disk."""
    request = _manifest(out)["request"]
    count = -(-request["number"] // request["chunk"])
    return [index for index in range(count) if not _chunk(out, index).exists()]


def keep(out: Path, index: int, rows: Rows) -> None:
    """Writes the rows of a chunk, whole or not at all."""
    with atomic(_chunk(out, index), at_once=True) as temporary, open(temporary, "wb") as file:
        np.savez(file, allow_pickle=False, **rows)
        file.flush()
        os.fsync(file.fileno())


def finish(out: Path, job: Job, described: Mapping[str, Any], chunk: int) -> None:
    """Writes the chunks into one store, one at a time, and removes them."""
    whole = parts(out) / "whole.zarr"
    shutil.rmtree(whole, ignore_errors=True)
    for index in range(-(-described["number"] // chunk)):
        rows = _rows(_chunk(out, index))
        piece = _dataset(job.take(slice(index * chunk, (index + 1) * chunk)), rows, described)
        if index:
            piece.to_zarr(whole, append_dim="point", zarr_format=3, consolidated=False)
        else:
            encoding = {name: {"chunks": (chunk, *piece[name].shape[1:])} for name in piece.variables}
            piece.to_zarr(whole, mode="w", zarr_format=3, consolidated=False, encoding=encoding)
    os.replace(whole, out)
    shutil.rmtree(parts(out), ignore_errors=True)


def read(out: Path) -> Any:
    """Returns the Dataset of a finished sweep, read lazily.

    Raises:
        BadFile: the folder is not a finished sweep.
    """
    xarray = require()
    try:
        return xarray.open_dataset(out, engine="zarr", consolidated=False, chunks=None)
    except (OSError, ValueError, KeyError) as error:
        raise BadFile(out, f"is not a sweep ({type(error).__name__})") from None


def _dataset(job: Job, rows: Mapping[str, Any], described: Mapping[str, Any]) -> Any:
    """Returns rows with names and units."""
    xarray, system = require(), job.system()
    robot = system.robot
    values = rows["multipliers"]
    largest = np.abs(values[:, 0])
    converged = rows["reason"] == list(REASONS).index(CONVERGED)
    unit = {"units": "m or rad"}
    variables = {
        "reason": ("point", rows["reason"], {"flag_values": list(range(len(REASONS))), "flag_meanings": MEANINGS}),
        "stable": ("point", converged & (largest < 1.0), {"long_name": "found, and every multiplier below 1"}),
        "largest_multiplier": ("point", largest, {"units": "1", "long_name": "modulus of the largest multiplier"}),
        "multiplier_re": (("point", "multiplier"), values.real, {"units": "1"}),
        "multiplier_im": (("point", "multiplier"), values.imag, {"units": "1"}),
        "residual": ("point", rows["residual"], {"long_name": "largest component of P(x) - x"}),
        "duration": (("point", "phase"), rows["durations"], {"units": "s"}),
        "q": (("point", "coordinate"), rows["q"], {**unit, "long_name": "configuration on the section"}),
        "v": (("point", "coordinate"), rows["v"], {"units": "m/s or rad/s", "long_name": "velocity on the section"}),
    }
    for name in job.vary:
        variables[name] = ("point", rows[f"solved_{name}"], {"long_name": "solved for"})
    units = {name: {"units": PARAMETERS[name].unit} if name in PARAMETERS else {} for name in job.points}
    coordinates = {name: ("point", column, units[name]) for name, column in job.points.items()}
    attributes = {
        "request": json.dumps(described, sort_keys=True),
        "robot": json.dumps(origin(robot)),
        "phases": list(system.phases),
        "coordinates_of": list(robot.coordinates),
        "names": list(job.points),
        "vary": list(job.vary),
    }
    return xarray.Dataset(variables, coordinates, attributes)


def _chunk(out: Path, index: int) -> Path:
    return parts(out) / f"{index:06d}.npz"


def _rows(path: Path) -> Rows:
    try:
        with np.load(path, allow_pickle=False) as rows:
            return dict(rows)
    except (OSError, ValueError, TypeError, EOFError, BadZipFile, zlib.error):
        raise BadFile(path, "is no part of a sweep; remove it and resume") from None


def _manifest(out: Path) -> dict[str, Any]:
    path = parts(out) / "manifest.json"
    try:
        found = parse_json(read_bytes(path).decode())
        if not isinstance(found, dict) or not isinstance(found.get("request"), dict):
            raise ValueError
    except (BadFile, ValueError):
        raise BadFile(path, "is not the manifest of a sweep; give another path, or remove it") from None
    return found


def _attribute(out: Path) -> dict[str, Any]:
    try:
        return dict(parse_json(read(out).attrs["request"]))
    except (KeyError, ValueError, TypeError):
        raise BadFile(out, "is not a sweep; expected a dataset that sweep wrote") from None


def _same(path: Path, before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Refuses to go on with another request."""
    differing = [name for name in now if before.get(name) != now[name]]
    if differing:
        raise BadFile(
            path, f"is of another sweep, which differs in {list_names(differing)}; give another path, or remove it"
        )


def fingerprint(robot: Robot) -> str:
    """Returns a digest of a robot's numbers, by which two robots can be distinguished."""
    model = robot.model
    parts = [body.toDynamicParameters() for body in model.inertias]
    parts += [place.homogeneous.ravel() for place in model.jointPlacements]
    parts += [model.armature, model.damping, model.rotorGearRatio]
    names = repr((robot.toes, robot.coordinates, robot.actuated)).encode()
    return _digest(names + np.concatenate(parts).tobytes())


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
