"""Named columns of numbers from a CSV or .mat file that somebody else wrote.

pandas reads the numbers. How they are written is found out here: `csv.Sniffer`, which pandas would ask, gives up where
comments precede the table, and neither knows a decimal comma.
"""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile
from spear_pin.files import regular

HEAD = 1 << 16  # bytes of a file that are looked at to tell its format
MAX_BYTES = 2_000_000_000
ROWS = 1 << 18  # that are read at a time
LARGEST = 200_000_000  # values of a .mat variable


@dataclass(frozen=True)
class Columns:
    """A file's columns, of equal length.

    Attributes:
        names: as in the file; "column 1" and so on where it has none.
        values: one array per column that was asked for, in rows of the file, NaN where it holds no number.
        comments: lines of the file that begin with #, without it.
        remarks: what makes the file doubtful.
    """

    names: tuple[str, ...]
    values: tuple[Array, ...]
    comments: tuple[str, ...]
    remarks: tuple[str, ...] = ()


Choice = Callable[[tuple[str, ...]], Sequence[str]]


def read_columns(path: str | Path, choose: Choice) -> Columns:
    """Read some columns of a CSV file (comma, semicolon, tab or blanks; decimal comma too) or of a .mat file.

    Args:
        path: of the file; a suffix .mat is MATLAB's, anything else is text.
        choose: says which columns to read, from all their names.

    Raises:
        BadFile: the file is missing, empty, not text, or not a table of numbers.
    """
    path = regular(path)
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    if not head.strip():
        raise BadFile(path, "the file is empty")
    if path.stat().st_size > MAX_BYTES:
        raise BadFile(path, f"has more than {MAX_BYTES} bytes")
    return _mat(path, choose) if path.suffix.lower() == ".mat" else _text(path, head, choose)


class _Text(io.BufferedReader):
    """Bytes of a text: none is zero, as they are in the holes of a sparse file."""

    def read(self, size: int | None = -1, /) -> bytes:
        """Read some bytes."""
        return self._checked(super().read(size))

    def read1(self, size: int = -1, /) -> bytes:
        """Read some bytes."""
        return self._checked(super().read1(size))

    def _checked(self, found: bytes) -> bytes:
        if b"\0" in found:
            raise ValueError("there are zero bytes in it")
        return found


@dataclass(frozen=True)
class _Dialect:
    """Layout of a table: comment lines, then names or not, a separator, a decimal mark."""

    comments: tuple[str, ...]
    skipped: int
    names: tuple[str, ...]
    headed: bool
    separator: str
    decimal: str


def _text(path: Path, head: bytes, choose: Choice) -> Columns:
    import pandas as pd

    dialect = _dialect(path, head)
    wanted = tuple(choose(dialect.names))
    places = [dialect.names.index(name) for name in wanted]
    chunks: list[list[Array]] = [[] for _ in wanted]
    try:
        with _Text(path.open("rb", buffering=0)) as file, warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            tables = pd.read_csv(
                file,
                sep=dialect.separator,
                decimal=dialect.decimal,
                header=None,
                skiprows=dialect.skipped + dialect.headed,
                names=list(range(len(dialect.names))),
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
                    chunk.append(_numbers(table[place], dialect.decimal))
    except pd.errors.EmptyDataError:
        raise BadFile(path, "there are no rows in it") from None
    except pd.errors.ParserWarning:
        raise BadFile(path, f"rows have more fields than the {len(dialect.names)} columns") from None
    except pd.errors.ParserError as error:
        raise BadFile(path, f"not a table: {_reason(error)}") from None
    except (UnicodeDecodeError, ValueError) as error:
        raise BadFile(path, f"not a table of numbers: {_reason(error)}") from None
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    values = tuple(np.concatenate(chunk) if chunk else np.empty(0) for chunk in chunks)
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        ended = file.read(1) in b"\r\n"
    return Columns(wanted, values, dialect.comments, () if ended else ("the last line has no end: it may be cut off",))


def _numbers(column: Any, decimal: str) -> Array:
    """The numbers of a column of a table, NaN where it holds none."""
    import pandas as pd

    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        return np.asarray(column, dtype=np.float64)
    text = column.astype(str)  # a word among them: they have been left as they were
    return np.asarray(pd.to_numeric(text.str.replace(decimal, ".", regex=False), errors="coerce"), dtype=np.float64)


def _dialect(path: Path, head: bytes) -> _Dialect:
    try:
        text = head.decode("utf-8-sig") if len(head) < HEAD else head[: head.rfind(b"\n") + 1].decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadFile(path, "not a text file in UTF-8, nor a .mat file: save it as UTF-8") from None
    if "\0" in text or not text:
        raise BadFile(path, "not a text file, nor a .mat file")
    lines = re.split(r"\r\n|\r|\n", text)
    skipped = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if skipped is None:
        raise BadFile(path, "there are no rows in it")
    comments = tuple(line[1:].strip() for line in lines[:skipped] if line.startswith("#"))
    rows = [line for line in lines[skipped : skipped + 20] if line.strip()]
    separator = next((mark for mark in ("\t", ";", ",") if mark in rows[-1]), r"\s+")
    split = (
        re.compile(r"\s+").split if separator == r"\s+" else lambda line: next(csv.reader([line], delimiter=separator))
    )
    first = [field.strip() for field in split(rows[0].strip())]
    headed = not all(_is_number(field.replace(",", ".")) or not field for field in first)
    names = tuple(field if headed and field else f"column {i + 1}" for i, field in enumerate(first))
    if len(set(names)) < len(names):
        raise BadFile(path, f"two columns have the same name among {', '.join(names)}", skipped + 1)
    decimal = (
        "," if separator in (";", "\t", r"\s+") and any(re.search(r"\d,\d", row) for row in rows[headed:]) else "."
    )
    return _Dialect(comments, skipped, names, headed, separator, decimal)


def _mat(path: Path, choose: Choice) -> Columns:
    from scipy.io import loadmat, whosmat

    sizes = {name: max(shape) for name, shape, kind in _tried(path, whosmat) if kind in _NUMBERS and _is_vector(shape)}
    wanted = tuple(choose(tuple(sizes)))
    for name in wanted:
        if sizes[name] > LARGEST:
            raise BadFile(path, f"{name} has {sizes[name]} values; at most {LARGEST} can be read")
    content = _tried(path, partial(loadmat, variable_names=list(wanted), squeeze_me=True))
    for name in wanted:
        if np.iscomplexobj(content[name]):
            raise BadFile(path, f"{name} is complex")
    values = tuple(np.asarray(content[name], dtype=np.float64) for name in wanted)
    if len({value.size for value in values}) > 1:
        described = ", ".join(f"{name} has {value.size}" for name, value in zip(wanted, values, strict=True))
        raise BadFile(path, f"columns of different length: {described}")
    return Columns(wanted, values, ())


def _tried(path: Path, reader: Callable[[Path], Any]) -> Any:
    try:
        return reader(path)
    except NotImplementedError:
        raise BadFile(path, "a MATLAB 7.3 file: save it with -v7") from None
    except Exception as error:  # a damaged file may raise anything
        raise BadFile(path, f"not a .mat file that can be read: {_reason(error)}") from None


_NUMBERS = {"double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}


def _is_vector(shape: tuple[int, ...]) -> bool:
    return max(shape, default=0) > 1 and int(np.prod(shape, dtype=np.float64)) == max(shape)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()).removeprefix("Error tokenizing data. C error: ") or type(error).__name__
