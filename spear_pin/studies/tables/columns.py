"""Named columns of numbers from a CSV, .mat or .npz file of any origin.

pandas reads the numbers. This module finds out how they are written. pandas would ask `csv.Sniffer`, which gives up
where comments precede the table; and neither knows a decimal comma.
"""

from __future__ import annotations

import io
import os
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, brief
from spear_pin.files import regular
from spear_pin.studies.tables.cells import find_remedy
from spear_pin.studies.tables.clocks import past_midnight, read_moments
from spear_pin.studies.tables.layout import HEAD, find_layout

ROWS = 1 << 18  # that are read at a time
LARGEST = 50_000_000  # values of a .mat variable
MOST_BYTES = 500_000_000
TRAJECTORY = {"coordinates", "events", "ledger"}  # variables by which `Trajectory.export` is known


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of one clock, of equal length.

    Attributes:
        path: path of the file.
        values: columns, (n,), by name, "column 1" and so on where the file has none; NaN where they hold no number.
        units: units of columns, where something other than their names says them.
        moments: names of columns that hold dates or times of day; their values are in s.
        words: of columns that hold something other than numbers, the first such cell, its row and what to write.
        comments: lines above the rows that begin with #, without the #, and titles.
        remarks: reasons why the file is doubtful.
    """

    path: Path
    values: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    moments: frozenset[str] = frozenset()
    words: Mapping[str, str] = field(default_factory=dict)
    comments: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Part:
    """Some rows of a column: their numbers, the first that is none with its row from 0, whether they are moments."""

    values: Array
    other: tuple[str, int] | None = None
    moments: bool = False


Choice = Callable[[tuple[str, ...]], Sequence[str]]


def read_columns(path: str | Path, choose: Choice) -> Table:
    """Reads some columns of a CSV file (comma, semicolon, tab or blanks; decimal comma too), a .mat or .npz file.

    Args:
        path: path of the file; a suffix .mat is MATLAB's, .npz NumPy's, anything else is text.
        choose: returns which columns to read, given all their names.

    Raises:
        BadFile: the file is missing, empty, not text, or not a table of numbers.
    """
    path = regular(path, MOST_BYTES)
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    if not head.strip(b"\0 \t\r\n\f\v"):  # nor do zeros, as in the hole of a sparse file, say anything
        raise BadFile(path, "the file is empty; expected rows of a time and what was measured then")
    packed = {".mat": _mat, ".npz": _npz}.get(path.suffix.lower())
    return packed(path, choose) if packed else _text(path, head, choose)


class _Text(io.BufferedReader):
    """Bytes of a text file: none is zero; the holes of a sparse file hold zeros."""

    def read(self, size: int | None = -1, /) -> bytes:
        """Reads some bytes."""
        return self._checked(super().read(size))

    def read1(self, size: int = -1, /) -> bytes:
        """Reads some bytes."""
        return self._checked(super().read1(size))

    def _checked(self, found: bytes) -> bytes:
        if b"\0" in found:
            raise ValueError("there are zero bytes in it")
        return found


def _text(path: Path, head: bytes, choose: Choice) -> Table:
    import pandas as pd

    layout = find_layout(path, head)
    wanted = tuple(choose(tuple(name for name in layout.names if name not in layout.empty)))
    places = [layout.names.index(name) for name in wanted]
    chunks: list[list[_Part]] = [[] for _ in wanted]
    try:
        with _Text(path.open("rb", buffering=0)) as file, warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            file.seek(layout.start)
            tables = pd.read_csv(
                file,
                sep=layout.separator,
                decimal=layout.decimal,
                header=None,
                names=list(range(len(layout.names))),
                index_col=False,
                comment="#",
                skipinitialspace=True,
                chunksize=ROWS,
                compression=None,
                low_memory=False,
                encoding="utf-8",
                encoding_errors="strict",
            )
            for table in tables:
                for place, chunk in zip(places, chunks, strict=True):
                    chunk.append(_numbers(table[place], layout.decimal))
    except pd.errors.EmptyDataError:
        raise BadFile(path, "has no rows; expected rows of a time and what was measured then") from None
    except pd.errors.ParserWarning:
        raise BadFile(
            path, f"rows have more fields than the {len(layout.names)} columns; give each column a name"
        ) from None
    except pd.errors.ParserError as error:
        expected = "expected rows of as many fields each"
        raise BadFile(path, f"not a table: {_reason(error, layout.line - 1)}; {expected}") from None
    except (UnicodeDecodeError, ValueError) as error:
        raise BadFile(path, f"not a table of numbers: {_reason(error)}; expected text in UTF-8") from None
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        ended = file.read(1) in b"\r\n"
    columns = dict(zip(wanted, chunks, strict=True))
    moments = frozenset(name for name, chunk in columns.items() if any(part.moments for part in chunk))
    values = {name: np.concatenate([np.empty(0), *(part.values for part in chunk)]) for name, chunk in columns.items()}
    units = zip(wanted, [layout.units[place] for place in places], strict=True) if layout.units else ()
    last = None if ended or all(np.isfinite(value[-1:]).all() for value in values.values()) else -1  # it is cut off
    return Table(
        path,
        {name: (past_midnight(value) if name in moments else value)[:last] for name, value in values.items()},
        {name: unit for name, unit in units if unit.strip("- ")},
        moments,
        {name: found for name, chunk in columns.items() if (found := _first_other(chunk))},
        layout.comments,
        (*layout.remarks, *(() if ended else ("the last line has no end: it may be cut off",))),
    )


def _first_other(chunk: Sequence[_Part]) -> str:
    for i, part in enumerate(chunk):
        if part.other:  # every part but the last has so many rows
            cell, row = part.other
            return f"{brief(cell)} in row {i * ROWS + row + 1}: {find_remedy(cell)}"
    return ""


def _numbers(column: Any, decimal: str) -> _Part:
    """Returns the numbers of some rows of a column, or its dates and times of day in s; NaN where it holds neither."""
    import pandas as pd

    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        return _Part(np.asarray(column, dtype=np.float64))
    text = column.astype(str)  # a word among them: they have been left as they were
    numbers = pd.to_numeric(text.str.replace(decimal, ".", regex=False), errors="coerce")
    values = np.asarray(numbers, dtype=np.float64)
    seconds = read_moments(text)
    moments = bool(2 * np.isfinite(seconds).sum() > np.isfinite(values).sum())
    values = seconds if moments else values
    other = np.flatnonzero(np.isnan(values) & np.asarray(column.notna()))
    return _Part(values, (str(text.iloc[other[0]]), int(other[0])) if other.size else None, moments)


def _mat(path: Path, choose: Choice) -> Table:
    from scipy.io import loadmat, whosmat

    found = _tried(path, whosmat)
    if {name for name, _, _ in found} >= TRAJECTORY:
        raise BadFile(path, "it is a trajectory, not columns; `spear export hop.npz --csv` writes them")
    sizes = {name: max(shape) for name, shape, kind in found if kind in _NUMBERS and _is_vector(shape)}
    wanted = tuple(choose(tuple(sizes)))
    for name in wanted:
        if sizes[name] > LARGEST:
            raise BadFile(path, f"{name} has {sizes[name]} values; at most {LARGEST} can be read")
    content = _tried(path, partial(loadmat, variable_names=list(wanted), squeeze_me=True))
    for name in wanted:
        if np.iscomplexobj(content[name]):
            raise BadFile(path, f"{name} is complex; expected real numbers")
    return _even(path, {name: np.asarray(content[name], dtype=np.float64) for name in wanted})


def _npz(path: Path, choose: Choice) -> Table:
    try:
        with ZipFile(path) as archive:
            size = sum(each.file_size for each in archive.infolist())
        if size > MOST_BYTES:
            raise ValueError(f"unpacked it has {size} bytes; at most {MOST_BYTES} are read")
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: _stored(stored, name) for name in stored.files}
    except Exception as error:  # a damaged file may raise anything
        raise BadFile(path, f"not an .npz file that can be read: {error}; expected columns of numbers") from None
    vectors = {name: each for name, each in arrays.items() if each.ndim == 1 or _is_vector(each.shape)}
    values = {name: each.ravel().astype(float) for name, each in vectors.items() if each.dtype.kind in "fiu"}
    return _even(path, {name: values[name] for name in choose(tuple(values))})


def _stored(stored: Any, name: str) -> NDArray[Any]:
    """Returns an array of an .npz file; one of Python objects is not read."""
    try:
        return np.asarray(stored[name])
    except ValueError as error:
        said = "holds Python objects" if "pickle" in str(error) else f"cannot be read: {error}"
        raise ValueError(f"array {brief(name)} {said}") from None


def _even(path: Path, values: Mapping[str, Array]) -> Table:
    if len({each.size for each in values.values()}) > 1:
        sizes = ", ".join(f"{name} has {each.size}" for name, each in values.items())
        raise BadFile(path, f"expected columns of equal length: {sizes}")
    return Table(path, values)


def _tried(path: Path, reader: Callable[[Path], Any]) -> Any:
    try:
        return reader(path)
    except NotImplementedError:
        raise BadFile(path, "a MATLAB 7.3 file: save it with -v7") from None
    except Exception as error:  # a damaged file may raise anything
        raise BadFile(path, f"not a .mat file that can be read: {_reason(error)}; save it again with -v7") from None


_NUMBERS = {"double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}


def _is_vector(shape: tuple[int, ...]) -> bool:
    return max(shape, default=0) > 1 and int(np.prod(shape, dtype=np.float64)) == max(shape)


def _reason(error: Exception, above: int = 0) -> str:
    """Returns a reader's message in one line, with line numbers counted from the file's first line."""
    text = " ".join(str(error).split()).removeprefix("Error tokenizing data. C error: ") or type(error).__name__
    return re.sub(r"\b(line|row) (\d+)", lambda found: f"{found[1]} {int(found[2]) + above}", text)
