"""Layout of a table in a text: titles, names, units, rows of numbers, separator and decimal mark."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from spear_pin.errors import BadFile, brief, list_names
from spear_pin.studies.tables.units import find_times, find_unit

HEAD = 1 << 16  # bytes of a file that are looked at to tell its format
LOOKED_AT = 200  # lines that hold something
MARKS = ("\t", ";", ",")  # that separate columns, the surest first; else blanks do
_BRACKETS = re.compile(r"\s+([\[(][^\])]*[\])])")  # after a name: of its unit
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_ENDS = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True)
class Layout:
    """Where the rows of a table begin, and what stands above them.

    Attributes:
        comments: lines above that begin with #, without the #, and titles.
        names: names of the columns; "column 1" and so on where the file has none.
        units: units below the names, one per column, empty where it gives none; () without such a row.
        start: offset of the first row, in bytes.
        line: number of the first row's line, from 1.
        separator: separator of columns, in pandas's form.
        decimal: decimal mark.
        remarks: what was skipped.
        empty: names of columns with neither a name nor a value.
    """

    comments: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    start: int
    line: int
    separator: str
    decimal: str
    remarks: tuple[str, ...]
    empty: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Line:
    number: int  # from 1
    start: int  # in characters
    fields: tuple[str, ...]

    @property
    def numeric(self) -> tuple[bool, ...]:
        return tuple(_is_number(field.replace(",", ".")) for field in self.fields)

    @property
    def all_numbers(self) -> bool:
        return all(_is_number(field.replace(",", ".")) or not field for field in self.fields)


def find_layout(path: Path, head: bytes) -> Layout:
    """Finds out how a table is written from the beginning of its file.

    Raises:
        BadFile: the file is not text in UTF-8, or has no rows.
    """
    text = _decoded(path, head)
    starts = [0, *(end.end() for end in _ENDS.finditer(text))]
    lines = [text[one:other].rstrip("\r\n") for one, other in zip(starts, [*starts[1:], len(text)], strict=True)]
    filled = [i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")][:LOOKED_AT]
    if not filled:
        raise BadFile(path, "has no rows; expected rows of a time and what was measured then")
    written = [lines[i] for i in filled]
    mark = next((mark for mark in MARKS if 2 * sum(mark in line for line in written) > len(written)), None)
    rows = [_Line(i + 1, starts[i], _fields(lines[i], mark)) for i in filled]
    first = _first_row(rows)
    above, data = rows[:first], rows[first:]
    comments = tuple(line[1:].strip() for line in lines[: filled[0]] if line.startswith("#"))
    width = len(rows[first].fields) if data else len(above[-1].fields)
    names, units, taken = _names(above, width, comments, mark)
    if len(set(names)) < len(names):
        raise BadFile(path, f"two columns have the same name among {list_names(names)}; rename one", above[-1].number)
    titles = [lines[line.number - 1].strip() for line in above[: len(above) - taken]]
    commas = _decimal_commas(data) if mark == "," else any(re.search(r"\d,\d", lines[line.number - 1]) for line in data)
    begin = data[0] if data else _Line(len(lines) + 1, len(text), ())
    marked = 3 * head.startswith(b"\xef\xbb\xbf")
    return Layout(
        (*comments, *titles),
        names,
        units,
        marked + len(text[: begin.start].encode()),
        begin.number,
        mark or r"\s+",
        "," if commas else ".",
        (f"passed over above the table: {list_names([brief(title) for title in titles])}",) if titles else (),
        tuple(
            name
            for i, name in enumerate(names)
            if name == _nameless(i) and not any("".join(line.fields[i : i + 1]) for line in data)
        ),
    )


def _decoded(path: Path, head: bytes) -> str:
    try:
        text = head.decode("utf-8-sig") if len(head) < HEAD else head[: head.rfind(b"\n") + 1].decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadFile(path, "not a text file in UTF-8, nor a .mat file: save it as UTF-8") from None
    if "\0" in text or not text:
        raise BadFile(path, "not a text file, nor a .mat file; save it as text in UTF-8")
    return text


def _fields(line: str, mark: str | None) -> tuple[str, ...]:
    if mark is None:
        return tuple(_BRACKETS.sub(r"\1", line).split())
    return tuple(field.strip() for field in next(csv.reader([line.strip(" ")], delimiter=mark, skipinitialspace=True)))


def _first_row(rows: Sequence[_Line]) -> int:
    """Returns the index of the first row of numbers.

    Most rows have numbers in the same columns. The first such row counts, and so do rows above it that hold a number.
    The uppermost row counts only if it holds nothing else.
    """
    usual = Counter(line.numeric for line in rows if any(line.numeric)).most_common(1)
    if not usual:
        return 0 if rows[0].all_numbers else 1
    first = next(i for i, line in enumerate(rows) if line.numeric == usual[0][0])
    while first > 0 and any(rows[first - 1].numeric) and (first > 1 or rows[0].all_numbers):
        first -= 1
    return first


def _names(
    above: Sequence[_Line], width: int, comments: Sequence[str], mark: str | None
) -> tuple[tuple[str, ...], tuple[str, ...], int]:
    """Returns names of the columns, their units where a row below has them, and the number of these lines."""
    fields, units, taken = tuple[str, ...](), tuple[str, ...](), 0
    if above and len(above[-1].fields) >= min(width, 2):
        fields, taken = above[-1].fields, 1
        if len(above) > 1 and len(above[-2].fields) == len(fields) and _are_units(fields, above[-2].fields):
            fields, units, taken = above[-2].fields, fields, 2
    if not above and comments:  # as NumPy writes a header
        commented = _fields(comments[-1], mark)
        fields = commented if len(commented) == width else ()
    padded = [*fields, *[""] * (0 if taken else width - len(fields))]
    return tuple(field or _nameless(i) for i, field in enumerate(padded)), units, taken


def _nameless(i: int) -> str:
    """Returns the name for a column that has none, by its place from 0."""
    return f"column {i + 1}"


def _decimal_commas(data: Sequence[_Line]) -> bool:
    """Tells whether quoted numbers have decimal commas: no number has a dot, and not all may be thousands."""
    fields = [field for line in data for field in line.fields]
    if any("." in field and _is_number(field.replace(",", "")) for field in fields):
        return False
    return any(
        _is_number(field.replace(",", ".")) and not _THOUSANDS.fullmatch(field) for field in fields if "," in field
    )


def _are_units(fields: Sequence[str], above: Sequence[str]) -> bool:
    """Tells whether a row holds units: most are known, all are in brackets, or times are above, by their name."""
    words = [field for field in fields if field]
    known = sum(find_unit(word) is not None for word in words)
    bracketed = bool(words) and all(word[0] in "[(" and word[-1] in "])" for word in words)
    return bracketed or 2 * known > len(words) or (known > 0 and bool(find_times(above)))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
