"""Tables of a log's file, each on one clock: one of a CSV, .mat or .npz file, one for each topic of an MCAP file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, brief
from spear_pin.files import regular
from spear_pin.studies.identification.columns import MOST_BYTES, read_columns

MCAP = ".mcap"
SUFFIXES = ".csv", ".txt", ".tsv", ".dat", ".mat", ".npz", MCAP


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of one clock.

    Attributes:
        path: path of the file.
        values: columns, (n,), by name; NaN where they hold no number.
        units: units of columns, where something other than their names says them.
        moments: names of columns that hold dates or times of day; their values are in s.
        words: of columns that hold something other than numbers, the first such cell with its row, in words.
        comments: lines above the rows that begin with #, without the #.
        remarks: reasons why the file is doubtful.
    """

    path: Path
    values: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    moments: frozenset[str] = frozenset()
    words: Mapping[str, str] = field(default_factory=dict)
    comments: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def read_tables(path: Path, wanted: Iterable[str]) -> list[Table]:
    """Reads all columns of a file; of an MCAP file the first message of each topic, and all with wanted columns.

    Raises:
        BadFile: the file cannot be read as what its name ends in.
        MissingExtra: the library that reads MCAP files is not installed.
    """
    path = regular(path, MOST_BYTES)
    if path.suffix.lower() == MCAP:
        from spear_pin.studies.logs.topics import read_topics

        return [Table(path, each.values, each.units, remarks=each.remarks) for each in read_topics(path, [*wanted])]
    return [_npz(path) if path.suffix.lower() == ".npz" else _columns(path)]


def _columns(path: Path) -> Table:
    read = read_columns(path, lambda names: names)
    named = {name: i for i, name in enumerate(read.names)}
    return Table(
        path,
        {name: read.values[i] for name, i in named.items()},
        {name: read.units[i] for name, i in named.items() if read.units[i].strip("- ")},
        frozenset(name for name, i in named.items() if read.moments[i]),
        {name: f"{brief(other[0])} in row {other[1] + 1}" for name, i in named.items() if (other := read.others[i])},
        read.comments,
        read.remarks,
    )


def _npz(path: Path) -> Table:
    try:
        with ZipFile(path) as archive:
            size = sum(each.file_size for each in archive.infolist())
        if size > MOST_BYTES:
            raise ValueError(f"unpacked it has {size} bytes; at most {MOST_BYTES} are read")
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: np.asarray(stored[name]) for name in stored.files}
    except Exception as error:  # a damaged file may raise anything
        raise BadFile(path, f"not an .npz file that can be read: {error}; expected columns of numbers") from None
    values = {name: each.astype(float) for name, each in arrays.items() if each.ndim == 1 and each.dtype.kind in "fiu"}
    if len({each.size for each in values.values()}) > 1:
        sizes = ", ".join(f"{name} has {each.size}" for name, each in values.items())
        raise BadFile(path, f"expected columns of equal length: {sizes}")
    return Table(path, values)
