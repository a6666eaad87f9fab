"""Reads logs: tables of any origin, a TOML file beside them that says what is in them, folders of files."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName, brief, listed, require
from spear_pin.files import regular
from spear_pin.studies.identification.columns import read_columns
from spear_pin.studies.identification.records import SYNTHETIC, unwrapped
from spear_pin.studies.identification.units import ANGLES, TIMES, find_times, guess_time_unit, split_name
from spear_pin.studies.logs.log import Column, Log
from spear_pin.studies.logs.units import MODE, TIME, known_unit, units_of

SUFFIXES = ".csv", ".txt", ".tsv", ".dat", ".mat", ".npz"
FOLDER = "log.toml"
GAP = 5.0  # median steps, from which on samples are missing
FEWEST = 20  # samples
MOST_BYTES = 1_000_000  # of the file that says what the columns are
Columns = Mapping[str, Column]


@dataclass(frozen=True)
class Table:
    """Columns of one file by name, with their units where a row below the names gives them."""

    values: Mapping[str, Array]
    units: Mapping[str, str]
    moments: frozenset[str]
    comments: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def read(path: str | Path, columns: Mapping[str, Any] | None, units: Mapping[str, str]) -> Log:
    """Reads a log; see `Log.read`."""
    path = Path(path)
    files = _files(path)
    asked = _asked(path) if columns is None else _columns(columns, "columns")
    parts = [_read(file, asked, units) for file in files]
    if len(parts) == 1:
        return parts[0]
    try:
        return Log.join(parts, str(path))
    except BadValue as error:
        raise BadFile(path, f"expected {error.expected}") from None


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [regular(path)]
    found = sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES)
    if not found:
        raise BadFile(path, f"there is no log in this folder; expected files that end in {listed(SUFFIXES)}")
    return found


def _asked(path: Path) -> Columns:
    """Returns what the TOML file beside a log says, nothing where there is none."""
    beside = path / FOLDER if path.is_dir() else path.with_suffix(".toml")
    if not beside.is_file() and not path.is_dir():
        beside = path.parent / FOLDER
    if not beside.is_file():
        return {}
    try:
        said = tomllib.loads(regular(beside, MOST_BYTES).read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise BadFile(beside, f"not a TOML file: {error}") from None
    if [*said] != ["columns"] or not isinstance(said["columns"], dict):
        raise BadFile(beside, f"it has {listed(said) or 'nothing'}; expected one table, [columns]")
    try:
        return _columns(said["columns"], "columns")
    except (BadValue, UnknownName) as error:
        raise BadFile(beside, str(error)) from None


def _columns(given: Mapping[str, Any], where: str) -> Columns:
    known, found = [field.name for field in fields(Column)], dict[str, Column]()
    for name, said in given.items():
        if isinstance(said, str):
            said = {"column": said}
        if isinstance(said, Column):
            said = {field: getattr(said, field) for field in known}
        if not isinstance(said, Mapping) or not isinstance(said.get("column"), str):
            raise BadValue(f"{where}.{name}", said, "the name of a column, or a table with `column`")
        for field in said:
            if field not in known:
                raise UnknownName(f"entry of {where}.{name}", field, known)
        found[str(name)] = column = Column(**said)
        require(f"{where}.{name}.sign", column.sign, lambda sign: abs(sign) == 1, "1 or -1")
        require(f"{where}.{name}.zero", column.zero, lambda _: True, "a finite number")
        require(f"{where}.{name}.lag", column.lag, lambda _: True, "a finite number, in s")
        if column.at not in ("joint", "motor"):
            raise BadValue(f"{where}.{name}.at", column.at, "'joint' or 'motor'")
    return found


def _table(path: Path) -> Table:
    """Reads all columns of a file."""
    if path.suffix.lower() == ".npz":
        try:
            with np.load(path, allow_pickle=False) as stored:
                arrays = {name: np.asarray(stored[name]) for name in stored.files}
        except Exception as error:  # a damaged file may raise anything
            raise BadFile(path, f"not an .npz file that can be read: {error}") from None
        values = {name: each.astype(float) for name, each in arrays.items() if each.ndim == 1 and each.dtype.kind in "fiu"}
        if len({each.size for each in values.values()}) > 1:
            raise BadFile(path, "expected columns of equal length: " + ", ".join(f"{k} {v.size}" for k, v in values.items()))
        return Table(values, {}, frozenset())
    read = read_columns(path, lambda names: names)
    named = list(zip(read.names, read.values, strict=True))
    units = {name: unit for name, unit in zip(read.names, read.units, strict=True) if unit.strip("- ")}
    moments = frozenset(name for name, each in zip(read.names, read.moments, strict=True) if each)
    return Table(dict(named), units, moments, read.comments, read.remarks)


def _read(path: Path, asked: Columns, units: Mapping[str, str]) -> Log:
    """Reads one file."""
    table = _table(path)
    remarks = list(table.remarks)
    asked = asked or _by_names(path, table, remarks)
    if TIME not in asked:
        times = find_times([*table.values])
        if not times:
            raise BadFile(path, f"which column is the time? It has {listed(table.values)}; name one as `time`")
        asked = {TIME: Column(times[0]), **asked}
    for name, column in asked.items():
        if column.file is None and column.column not in table.values:
            raise UnknownName(f"column of {path} for {name!r}", column.column, table.values)
    for name in units:
        if name not in table.values:
            raise UnknownName(f"column of {path} in units", name, table.values)
    t, rows, dropped = _times(path, table, asked[TIME], units)
    remarks += dropped
    values: dict[str, Array] = {}
    modes = None
    for name, column in asked.items():
        if name == TIME:
            continue
        if column.file is not None:
            values[name] = _beside(path, name, column, asked[TIME], units, t, remarks)
        elif name == MODE:
            modes = _modes(table.values[column.column][rows], column)
        else:
            values[name], unit = _scaled(path, name, column, table, units, remarks)
            values[name] = values[name][rows]
            if unit in ANGLES:
                values[name], jumps = unwrapped(values[name], rows)
                remarks += jumps
            if column.lag:
                values[name] = _at(t, t - column.lag, values[name])
    if not values:
        raise BadFile(path, f"no column is a joint's; it has {listed(table.values)}")
    used = {column.column for column in asked.values() if column.file is None}
    if unread := [name for name in table.values if name not in used]:
        remarks.append(f"columns that are not read: {', '.join(map(brief, unread))}")
    steps = np.diff(t)
    if (gaps := steps > GAP * np.median(steps)).any():
        remarks.append(f"{gaps.sum()} gaps between samples, the longest {steps.max():.3g} s")
    synthetic = any(comment.startswith(SYNTHETIC) for comment in table.comments)
    at_motor = frozenset(name for name, column in asked.items() if column.at == "motor")
    told = tuple(f"{path.name}: {each}" for each in remarks)
    return Log(str(path), t - t[0], values, at_motor, modes, synthetic, told, float(t[0]))


def _by_names(path: Path, table: Table, remarks: list[str]) -> Columns:
    """Takes what the columns hold from their names."""
    found, times = dict[str, Column](), find_times([*table.values])
    for column in table.values:
        if column not in times:
            name = _stem(column)
            if name in found:
                raise BadFile(path, f"columns {found[name].column!r} and {column!r} both name {name!r}; say which by `columns`")
            found[name] = Column(column)
    return found


def _stem(column: str) -> str:
    """Returns a column's name without its unit."""
    split = split_name(column)
    if split.unit or split.meant:
        return split.stem.strip(" _")
    stem, _, word = column.rpartition("_")
    return stem if stem and known_unit(word, units_of(stem)) else column


def _unit_of(path: Path, name: str, column: Column, table: Table, units: Mapping[str, str], remarks: list[str]) -> str:
    """Returns the unit of a column, "" where nothing names it."""
    possible, said = units_of(name), units.get(column.column, column.unit)
    if said is not None:
        unit = known_unit(said, possible)
        if unit is None:
            raise UnknownName(f"unit of {name!r} in {path}", said, possible)
        return unit
    for word in (table.units.get(column.column), split_name(column.column).word, column.column.rpartition("_")[2]):
        if word and (unit := known_unit(word, possible)) is not None:
            return unit
    remarks.append(f"{column.column!r} names no unit: taken as SI units and radians")
    return ""


def _scaled(
    path: Path, name: str, column: Column, table: Table, units: Mapping[str, str], remarks: list[str]
) -> tuple[Array, str]:
    """Returns a column in SI units, and its own unit."""
    unit = _unit_of(path, name, column, table, units, remarks)
    return column.sign * (table.values[column.column] - column.zero) * units_of(name).get(unit, 1.0), unit or "rad"


def _times(path: Path, table: Table, column: Column, units: Mapping[str, str]) -> tuple[Array, Any, list[str]]:
    """Returns times in s, on the file's own clock, which rows have one, and what was dropped."""
    raw, remarks = table.values[column.column], list[str]()
    named = split_name(column.column).unit
    if column.column in table.moments:
        t = raw
    else:
        if column.unit or column.column in units or named in TIMES or column.column in table.units:
            unit = _unit_of(path, TIME, column, table, units, remarks)
        elif (unit := guess_time_unit(column.column, raw)) != "s":
            remarks.append(f"{column.column!r} names no unit: taken as {unit}, by its name or as Unix time")
        t = raw * TIMES.get(unit, 1.0)
    good = np.isfinite(t)
    rows = np.flatnonzero(good)
    if rows.size < FEWEST:
        raise BadFile(path, f"{rows.size} rows have a time; a log needs at least {FEWEST}")
    if lost := int(good.size - rows.size):
        remarks.append(f"dropped {lost} of {good.size} rows without a time")
    steps = np.diff(t[rows])
    if (steps < 0).any():
        row = int(np.flatnonzero(steps < 0)[0])
        raise BadFile(path, f"time goes back after {row + 1} rows, by {-steps[row]:.3g} s; expected times that increase")
    if (same := steps < 1e-9).any():
        remarks.append(f"dropped {int(same.sum())} rows that repeat a time")
        rows = rows[np.concatenate([[True], ~same])]
    return t[rows], rows, remarks


def _modes(raw: Array, column: Column) -> Any:
    """Returns the name of the mode in each row."""
    names = {float(number): name for number, name in column.modes.items()}
    return np.array([names.get(value, f"{value:g}") for value in raw.tolist()])


def _beside(
    path: Path, name: str, column: Column, time: Column, units: Mapping[str, str], t: Array, remarks: list[str]
) -> Array:
    """Reads a quantity from another file, at the times of the log; NaN where it has no samples."""
    other = path.parent / str(column.file)
    table = _table(regular(other))
    clock = time if time.column in table.values else Column((find_times([*table.values]) or ["time"])[0])
    for each in (clock.column, column.column):
        if each not in table.values:
            raise UnknownName(f"column of {other} for {name!r}", each, table.values)
    own = {key: unit for key, unit in units.items() if key in table.values}
    times, rows, _ = _times(other, table, clock, own)
    values, _ = _scaled(other, name, column, table, own, remarks)
    return _at(t, times - column.lag, values[rows])


def _at(t: Array, times: Array, values: Array) -> Array:
    """Interpolates at times t; NaN beyond the samples and in their gaps."""
    steps = np.diff(times)
    found = np.interp(t, times, values, left=np.nan, right=np.nan)
    place = np.clip(np.searchsorted(times, t), 1, len(times) - 1)
    return np.where(steps[place - 1] > GAP * np.median(steps), np.nan, found)
