"""Reads logs: tables of any origin, a TOML file beside them that says what is in them, folders of files."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName, brief, list_names
from spear_pin.files import regular
from spear_pin.hybrid.column_names import heading
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.logs.log import Column, Log
from spear_pin.studies.tables.columns import MOST_BYTES as TABLE
from spear_pin.studies.tables.columns import Table, read_columns
from spear_pin.studies.tables.readings import (
    GAP,
    SYNTHETIC,
    Clock,
    find_gaps,
    read_clock,
    read_unit,
    read_values,
)
from spear_pin.studies.tables.units import (
    ANGLES,
    MODE,
    POSITIONS,
    TIME,
    TORQUE,
    find_times,
    find_units,
    known_unit,
    split_name,
)

MCAP, NPZ = ".mcap", ".npz"
SUFFIXES = ".csv", ".txt", ".tsv", ".dat", ".mat", NPZ, MCAP
SAVED = {"meta.npy", "event_time.npy", "ledger_work.npy"}  # members by which a saved trajectory is known
FOLDER = "log.toml"
SAMPLES = {"domain", "phase", "cycle"}  # columns by which a table of this package's own samples is known
OWN = {"q_": "", "v_": "_rate", "u_": TORQUE}  # how its other columns begin, and how the quantities' names end
SHOWN = 8  # columns that are not read
FEWEST = 20  # samples
MOST_BYTES = 1_000_000  # of the file that says what the columns are
Columns = Mapping[str, Column]
Units = Mapping[str, str]
UNSAID = Column("")
ENTRIES = [field.name for field in fields(Column)]


def read(path: str | Path, columns: Mapping[str, Any] | None, units: Units, map: str | Path | None) -> Log:
    """Reads a log; see `Log.read`."""
    path = Path(path)
    if columns is not None and map is not None:
        raise BadValue("map", map, "nothing where `columns` is given")
    if columns is None:
        asked = _asked(_beside(path) if map is None else Path(map))
    else:
        asked = _columns(columns, "columns")
    parts = [_read(file, asked, units) for file in _files(path, asked)]
    if len(parts) == 1:
        return parts[0]
    try:
        return Log.join(parts, str(path))
    except BadValue as error:
        raise BadFile(path, f"expected {error.expected}; or give the files one by one") from None


def _files(path: Path, asked: Columns) -> list[Path]:
    """Returns the files that follow one another, without those of other sensors."""
    if not path.is_dir():
        return [path]
    others = {column.file for column in asked.values()}
    found = sorted(each for each in path.iterdir() if each.suffix.lower() in SUFFIXES and each.name not in others)
    if not found:
        raise BadFile(path, f"there is no log in this folder; expected files that end in {', '.join(SUFFIXES)}")
    return found


# what the columns are


def _beside(path: Path) -> Path | None:
    """Returns the TOML file beside a log, None where there is none."""
    own = [] if path.is_dir() else [path.with_suffix(".toml"), path.parent / FOLDER]
    return next((each for each in own or [path / FOLDER] if each.is_file()), None)


def _asked(beside: Path | None) -> Columns:
    """Returns what a TOML file says of a log, nothing where there is none."""
    if beside is None:
        return {}
    try:
        said = tomllib.loads(regular(beside, MOST_BYTES).read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise BadFile(beside, f"not a TOML file: {error}; expected a table, [columns]") from None
    if [*said] != ["columns"] or not isinstance(said["columns"], dict):
        raise BadFile(beside, f"it has {list_names([*said]) or 'nothing'}; expected one table, [columns]")
    try:
        return _columns(said["columns"], "columns")
    except (BadValue, UnknownName) as error:
        raise BadFile(beside, str(error)) from None


def _columns(given: Mapping[str, Any], where: str) -> Columns:
    found = dict[str, Column]()
    for name, said in given.items():
        place = f"{where}.{name}"
        if isinstance(said, str):
            said = {"column": said}
        if isinstance(said, Column):
            said = {entry: value for entry in ENTRIES if (value := getattr(said, entry)) != getattr(UNSAID, entry)}
        if not isinstance(said, Mapping) or "column" not in said:
            raise BadValue(place, said, "the name of a column, or a table with `column`")
        valid = _entries(name)
        for entry in said:
            if entry not in valid:
                raise UnknownName(f"entry of {place}", entry, valid)
        try:
            found[name] = Column(**said)
        except BadValue as error:
            raise BadValue(f"{place}.{error.name.rpartition('.')[2]}", error.value, error.expected) from None
    return found


def _entries(name: str) -> list[str]:
    """Returns what may be said of the column of a quantity."""
    if name in (TIME, MODE):
        return ["column", "unit" if name == TIME else "modes"]
    return [entry for entry in ENTRIES if entry != "modes" and (entry != "at" or name.endswith(TORQUE))]


def _by_names(path: Path, tables: Sequence[Table], units: Units) -> Columns:
    """Takes what the columns hold from their names."""
    if path.suffix.lower() == MCAP:
        names = [name for table in tables for name in table.values if name != TIME]
        raise BadFile(
            path, f"say which columns it is about, by `columns` or a TOML file; it has {list_names(names, 8)}"
        )
    (table,) = tables
    found, times, sampled = dict[str, Column](), find_times([*table.values]), table.values.keys() >= SAMPLES
    for column, values in table.values.items():
        name, own = _stem(column), Column(column)
        if column in times or not np.isfinite(values).any() or (sampled and name[:2] not in OWN):
            continue
        if sampled:
            name = f"{name[2:]}{OWN[name[:2]]}"
        try:
            _unit(table, name, own, units)
        except UnknownName:
            if column in units:
                raise
            continue  # it is something else
        if name in found:
            both = f"columns {found[name].column!r} and {column!r}"
            raise BadFile(path, f"{both} both name {name!r}; say which by `columns` (--column {name}=...)")
        found[name] = own
    return found


def _stem(column: str) -> str:
    """Returns a column's name without its unit."""
    split = split_name(column)
    if split.unit or split.meant:
        return split.stem.strip(" _")
    stem, _, word = column.rpartition("_")
    return stem if stem and known_unit(word, find_units(stem)) else column


def _unit(table: Table, name: str, column: Column, units: Units) -> str | None:
    said = units.get(column.column, column.unit)
    return read_unit(table, repr(name), column.column, find_units(name), said)


# what they hold


def _read(path: Path, asked: Columns, units: Units) -> Log:
    """Reads one file, and those of other sensors beside it."""
    wanted = [column.column for column in asked.values()]
    files = dict.fromkeys([None, *(column.file for column in asked.values())])
    tables = {file: _tables(path.parent / file if file else path, wanted) for file in files}
    whole = [table for each in tables.values() for table in each]
    remarks = [remark for table in whole for remark in table.remarks]
    for name in units:
        if not any(name in table.values for table in whole):
            raise UnknownName(f"column in units, of {path}:", name, [key for table in whole for key in table.values])
    guessed, asked = not asked, asked or _by_names(path, tables[None], units)
    sources = {name: _table(tables[column.file], name, column.column) for name, column in asked.items() if name != TIME}
    main = next((table for name, table in sources.items() if asked[name].file is None and name != MODE), None)
    if main is None:
        raise BadFile(
            path, f"no column is a joint's; it has {list_names([name for each in whole for name in each.values])}"
        )
    if TIME in asked:
        _table([main], TIME, asked[TIME].column)
    clocks = {table: _clock(table, asked.get(TIME), units, remarks) for table in dict.fromkeys(sources.values())}
    t = clocks[main].t
    values, modes, bare = dict[str, Array](), None, list[str]()
    for name, table in sources.items():
        column, clock = asked[name], clocks[table]
        if name == MODE:
            modes = _modes(table, column, clock)
            continue
        unit = _unit(table, name, column, units)
        bare += [] if unit else [repr(column.column)]
        unit = unit if unit or guessed or find_units(name) is not POSITIONS else "rad"
        values[name] = _measured(table, name, column, unit, clock, remarks)
        if table is not main or column.lag:
            values[name] = _at(t, clock.t - column.lag, values[name])
            if np.isnan(values[name]).all():
                apart = f"has no sample at times of {path}: {_spans(clock.t, t)}; expected one clock, or its `lag`"
                raise BadFile(table.path, f"{column.column!r} {apart}")
    if bare:
        remarks.append(f"no unit is named, so SI units and radians are taken, of {', '.join(bare)}")
    if path.suffix.lower() != MCAP and (unread := [*main.values.keys() - {*_used(asked, main)}]):
        remarks.append(f"columns that are not read: {list_names([*map(brief, sorted(unread))], SHOWN)}")
    remarks += find_gaps(t)
    synthetic = any(comment.startswith(SYNTHETIC) for table in whole for comment in table.comments)
    at_motor = frozenset(name for name, column in asked.items() if column.at == "motor")
    told = tuple(f"{path.name}: {each}" for each in remarks)
    return Log(str(path), t - t[0], values, at_motor, modes, synthetic, told, float(t[0]))


def _tables(path: Path, wanted: Sequence[str]) -> list[Table]:
    """Reads all columns of a file; of an MCAP file the first message of each topic, and all with wanted columns."""
    if path.suffix.lower() != MCAP:
        return [_trajectory(path) if _is_trajectory(path) else read_columns(path, lambda names: names)]
    from spear_pin.studies.logs.topics import read_topics

    return read_topics(regular(path, TABLE), wanted)


def _is_trajectory(path: Path) -> bool:
    """Tells whether `Trajectory.save` wrote a file."""
    if path.suffix.lower() != NPZ:
        return False
    try:
        with ZipFile(path) as archive:
            return {*archive.namelist()} >= SAVED
    except Exception:  # a damaged file may raise anything; reading it says what
        return False


def _trajectory(path: Path) -> Table:
    """Returns the columns that `Trajectory.export` writes."""
    saved = Trajectory.load(path)
    (names, values), units = saved.columns(), saved.units()
    columns = {heading(name, units[name]): each for name, each in zip(names, values.T, strict=True)}
    words = np.full(len(saved), np.nan)
    return Table(path, {**columns, **{name: words for name in SAMPLES - columns.keys()}})


def _used(asked: Columns, main: Table) -> list[str]:
    """Returns the columns that are read."""
    times = [] if TIME in asked else find_times([*main.values])[:1]
    return [*times, *(column.column for column in asked.values())]


def _table(tables: Sequence[Table], name: str, column: str) -> Table:
    """Returns the table that has a column."""
    found = next((table for table in tables if column in table.values), None)
    if found is None:
        valid = [key for table in tables for key in table.values]
        raise UnknownName(f"column for {name!r} in {tables[0].path if tables else 'an empty file'}:", column, valid)
    return found


def _spans(one: Array, other: Array) -> str:
    return f"{one[0]:.6g} to {one[-1]:.6g} s, and {other[0]:.6g} to {other[-1]:.6g} s"


def _measured(table: Table, name: str, column: Column, unit: str | None, clock: Clock, remarks: list[str]) -> Array:
    """Returns a column in SI units at the times of its table."""
    size = find_units(name).get(unit or "", 1.0)
    return read_values(
        table, column.column, clock, lambda raw: column.sign * (raw - column.zero) * size, unit in ANGLES, remarks
    )


def _clock(table: Table, asked: Column | None, units: Units, remarks: list[str]) -> Clock:
    """Returns the times of a table's rows, in s."""
    times = find_times([*table.values])
    if asked is None or (asked.column not in table.values and times):
        if not times:
            raise BadFile(
                table.path, f"which column is the time? It has {list_names([*table.values])}; name one as `time`"
            )
        asked = Column(times[0])
    if asked.column not in table.values:
        raise UnknownName(f"column for {TIME!r} in {table.path}:", asked.column, table.values)
    return read_clock(table, asked.column, units.get(asked.column, asked.unit), FEWEST, remarks)


def _modes(table: Table, column: Column, clock: Clock) -> Any:
    """Returns the name of the mode in each row."""
    if column.column in table.words:
        raise BadFile(table.path, f"column {column.column!r}, for 'mode', holds {table.words[column.column]}")
    names = {float(number): name for number, name in column.modes.items()}
    return np.array([names.get(value, f"{value:g}") for value in table.values[column.column][clock.rows].tolist()])


def _at(t: Array, times: Array, values: Array) -> Array:
    """Interpolates at times t; NaN beyond the samples and in their gaps."""
    steps = np.diff(times)
    found = np.interp(t, times, values, left=np.nan, right=np.nan)
    place = np.clip(np.searchsorted(times, t), 1, len(times) - 1)
    return np.where((steps[place - 1] > GAP * np.median(steps)) & (t < times[place]), np.nan, found)
