"""What the columns of a table say: times of a clock, units that are named, numbers in SI units, angles that go on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, UnknownName, brief
from spear_pin.studies.tables.columns import Table
from spear_pin.studies.tables.units import OTHERS, TIME, TIMES, guess_time_unit, known_unit, split_name

SYNTHETIC = "SYNTHETIC"  # the word by which a file says that nobody measured it
GAP = 5.0  # median steps, from which on samples are missing
LARGEST = 1e300  # in any unit of time, that is taken for a number
LONGEST = 3600.0  # s without a sample: more is another clock
SAME = 1e-9  # s between samples: less is the same time
TURN = 2.0 * np.pi  # rad
NEARLY = 0.25  # of a turn, by which a jump may differ from one: the joint moves on while an encoder wraps
JUMP = 1.0  # rad from sample to sample, that no joint moves by
Whole = NDArray[np.intp]


@dataclass(frozen=True)
class Clock:
    """Times of a table, (n,), in s on its own clock, increasing, the rows that have them, and the unit they are in."""

    t: Array
    rows: Whole
    unit: str


def read_unit(table: Table, what: str, column: str, possible: Mapping[str, float], said: str | None) -> str | None:
    """Returns the unit of a column, None where nothing names it.

    Args:
        table: the table.
        what: what the column holds, in words.
        column: its name.
        possible: the units that it may have.
        said: the unit that goes before any other, if it is said.

    Raises:
        BadFile: its name and the row below name two.
        UnknownName: the unit that is named is none of those.
    """
    split, last, below = split_name(column), column.rpartition("_")[2], table.units.get(column)
    surely = split.meant or (split.unit and split.stem != column)
    own = split.word if surely else last if last != column and known_unit(last, OTHERS) else None
    if not said and own and below:
        one, other = known_unit(own, possible), known_unit(below, possible)
        if one and other and one != other:
            raise BadFile(
                table.path,
                f"column {brief(column)} is in {one}, and in {other} as the row below says; say which by --unit",
            )
    said = said or below or own
    unit = known_unit(said or last, possible)
    if said and unit is None:
        raise UnknownName(f"unit of {what}, column {brief(column)} of {table.path}:", said, possible)
    return unit


def read_clock(table: Table, column: str, said: str | None, least: int, remarks: list[str]) -> Clock:
    """Reads the times of a table's rows.

    Args:
        table: the table.
        column: name of the column with the times.
        said: their unit, if it is said.
        least: number of different times that are needed.
        remarks: to which is added what was dropped or assumed.

    Raises:
        BadFile: times go back, are too few, or jump to another clock.
        UnknownName: their unit is none of a time.
    """
    path, raw = table.path, table.values[column]
    if column in table.moments:
        unit = "s"
        if said or table.units.get(column) or split_name(column).unit:
            remarks.append(f"{column!r} holds dates or times of day: read to the second, whatever unit is named")
    elif named := read_unit(table, repr(TIME), column, TIMES, said):
        unit = named
    elif (unit := guess_time_unit(column, raw)) != "s":
        remarks.append(f"{column!r} names no unit: taken as {unit}, by its name or as Unix time")
    t = raw * TIMES[unit]
    rows = np.flatnonzero(np.abs(t) < LARGEST)
    if lost := t.size - rows.size:
        remarks.append(f"dropped {lost} of {t.size} rows without a time")
    steps = np.diff(t[rows])
    if (steps < 0).any():
        row = int(np.flatnonzero(steps < 0)[0])
        raise BadFile(
            path, f"time goes back after row {rows[row] + 1}, by {-steps[row]:.3g} s; expected times that increase"
        )
    if (same := steps < SAME).any():
        remarks.append(f"dropped {int(same.sum())} rows that repeat a time")
        rows = rows[np.concatenate([[True], ~same])]
    if rows.size < least:
        told = f"; {brief(column)} holds {table.words[column]}" if column in table.words else ""
        raise BadFile(path, f"{rows.size} rows have a time of their own; expected at least {least}{told}")
    steps = np.diff(t[rows])
    if steps.max() > LONGEST:
        row = rows[int(steps.argmax())] + 1
        raise BadFile(path, f"time jumps by {steps.max():.3g} s after row {row}; expected one clock, in {unit}")
    return Clock(t[rows], rows, unit)


def find_gaps(t: Array) -> list[str]:
    """Returns a remark on the gaps between samples, if there are any."""
    steps = np.diff(t)
    gaps = steps > GAP * np.median(steps)
    return [f"{gaps.sum()} gaps between samples, the longest {steps.max():.3g} s"] if gaps.any() else []


def read_values(
    table: Table, column: str, clock: Clock, scale: Callable[[Array], Array], turns: bool, remarks: list[str]
) -> Array:
    """Reads a column at the times of its table, (n,); NaN where it holds no number.

    Args:
        table: the table.
        column: name of the column.
        clock: its times.
        scale: makes SI values of numbers.
        turns: whether it is an angle, which goes on where an encoder wraps.
        remarks: to which is added what is missing or was repaired.

    Raises:
        BadFile: it holds no number.
    """
    raw = table.values[column][clock.rows]
    good = np.flatnonzero(np.isfinite(raw))
    words = f", but {table.words[column]}" if column in table.words else ""
    if not good.size:
        raise BadFile(table.path, f"column {brief(column)} holds no number{words}; name another")
    if lost := raw.size - good.size:
        remarks.append(f"{column!r} holds no number in {lost} of {raw.size} rows{words}")
    found = np.full(raw.size, np.nan)
    with np.errstate(over="ignore"):
        found[good] = scale(raw[good])
    if turns:
        found[good], jumps = unwrap(found[good], clock.rows[good])
        remarks += [f"{column!r}: {jump}" for jump in jumps]
    return found


def unwrap(angle: Array, rows: Whole) -> tuple[Array, list[str]]:
    """Returns the angle without jumps by a turn, near zero, and what was done; other jumps are reported."""
    with np.errstate(invalid="ignore"):
        steps = np.diff(angle)
        turns = np.rint(steps / TURN)
        wraps = (turns != 0.0) & (np.abs(steps - TURN * turns) <= NEARLY * TURN) & (np.abs(turns) <= 1.0)
    remarks = []
    for found, what in (
        ((np.abs(steps) > JUMP) & ~wraps, "{:.3g} rad after row {}{}"),
        (wraps, "a turn after row {1}{2}: such jumps are taken out"),
    ):
        if found.any():
            first = int(np.flatnonzero(found)[0])
            also = f", and {found.sum() - 1} times more" if found.sum() > 1 else ""
            remarks.append(f"the angle jumps by {what.format(steps[first], rows[first] + 1, also)}")
    if wraps.any():
        angle = angle - TURN * np.concatenate([[0.0], np.cumsum(np.where(wraps, turns, 0.0))])
        angle = angle - TURN * np.rint(np.median(angle) / TURN)
    return angle, remarks
