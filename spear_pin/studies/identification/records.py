"""Records of the knee's angle from a laboratory, in volts, degrees or radians, as radians over seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName, brief, listed
from spear_pin.kinds import typed
from spear_pin.studies.identification.cells import find_remedy
from spear_pin.studies.identification.columns import Columns, read_columns
from spear_pin.studies.identification.units import (
    ANGLES,
    READOUTS,
    TIMES,
    VALUES,
    find_times,
    guess_time_unit,
    is_rate,
    require_unit,
    split_name,
)

SYNTHETIC = "SYNTHETIC"  # the word by which a file says that nobody measured it
COARSEST = 0.02  # s between samples: a swing lasts a tenth of a second and more
FINEST = 1e-5  # s between samples: no potentiometer is read faster
FEWEST = 50  # samples
LONGEST = 1e300  # in any unit of time, that is taken for a number
LARGEST = 2 * np.pi  # rad, that a knee may show
TURN = 2.0 * np.pi  # rad
NEARLY = 0.25  # of a turn, by which a jump may differ from one: the knee moves on while an encoder wraps
JUMP = 1.0  # rad from sample to sample, that no knee moves by
Whole = NDArray[np.intp]


@dataclass(frozen=True)
class Calibration:
    """A linear potentiometer: angle = (voltage - offset) / volts_per_rad; or an encoder, with counts for volts.

    Attributes:
        volts_per_rad: slope, in V/rad; negative if the voltage falls as the knee flexes.
        offset: voltage at the straight leg, in V.
    """

    volts_per_rad: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        if not (np.isfinite(self.volts_per_rad) and self.volts_per_rad):
            raise BadValue("volts_per_rad", self.volts_per_rad, "a finite number other than zero, in V/rad")
        if not np.isfinite(self.offset):
            raise BadValue("offset", self.offset, "a finite number, in V")


@dataclass(frozen=True)
class Record:
    """The knee's angle over time.

    Attributes:
        source: name of the file.
        t: times, (n,), in s, from the first sample on, increasing.
        angle: angles, (n,), in rad.
        synthetic: whether the file says that it is.
        remarks: what was dropped, repaired or assumed.
    """

    source: str
    t: Array
    angle: Array
    synthetic: bool = False
    remarks: tuple[str, ...] = ()

    @cached_property
    def step(self) -> float:
        """Median time between samples, in s."""
        return float(np.median(np.diff(self.t)))


@typed
def read_record(
    path: str | Path,
    *,
    column: str | None = None,
    time_column: str | None = None,
    calibration: Calibration | None = None,
    unit: str | None = None,
    time_unit: str | None = None,
) -> Record:
    """Reads a record from a CSV or .mat file.

    Units are taken from the columns' names (`knee_V`, `angle [deg]`, `time_ms`) or a row below them unless given. Times
    count from the first sample. An angle that jumps by a turn, as encoders wrap, is unwrapped.

    Args:
        path: path of the file.
        column: name of the column with voltage or angle (default: the only one beside the time).
        time_column: default: the one named t, time, stamp or the like, else the first.
        calibration: calibration of the potentiometer or encoder, for a column in volts or counts.
        unit: V, mV, counts, rad, mrad, deg or turns; or such a word as degrees.
        time_unit: s, ms, us, ns, min or h; or such a word as seconds.

    Raises:
        BadFile: the file is not such a record; the text says why.
        BadValue: a calibration that fits no voltage, or is missing for one.
        UnknownName: an unknown unit or column; the text lists the valid ones.
    """
    unit = None if unit is None else require_unit(unit, VALUES)
    time_unit = None if time_unit is None else require_unit(time_unit, TIMES)
    columns = read_columns(path, lambda names: _chosen(path, names, column, time_column))
    (time_name, value_name), (t, value) = columns.names, columns.values
    remarks = list(columns.remarks)
    if columns.moments[1]:
        raise BadFile(
            path, f"column {brief(value_name)} holds dates or times of day, not the knee's: name another, --column"
        )
    if columns.moments[0]:
        if time_unit or split_name(time_name).unit or columns.units[0]:
            remarks.append(f"{time_name!r} holds dates or times of day: read to the second, whatever unit is named")
        time_unit = "s"
    time_unit = time_unit or _unit(path, time_name, columns.units[0], TIMES, "--time-unit")
    if time_unit is None:
        time_unit = guess_time_unit(time_name, t)
        if time_unit != "s":
            remarks.append(f"{time_name!r} names no unit: taken as {time_unit}, by its name or as Unix time")
    unit = unit or _unit(path, value_name, columns.units[1], VALUES, "--unit")
    if unit is None:
        unit = "V" if calibration else "rad"
        remarks.append(f"{value_name!r} names no unit: taken as {unit}")
    if (unit in READOUTS) != (calibration is not None):
        words = "counts" if unit == "counts" else "volts"
        expected = f"{words} per radian (--volts-per-rad) and an offset" if unit in READOUTS else "none"
        raise BadValue(f"{path}: calibration of {value_name!r}, in {unit},", calibration, expected)
    rows, dropped = _rows(path, t, value, _told(columns))
    remarks += dropped
    t, value = t[rows], value[rows]
    with np.errstate(over="ignore"):
        t = (t - t[0]) * TIMES[time_unit]
        if calibration is None:
            angle = value * ANGLES[unit]
        else:
            angle = (value * READOUTS[unit] - calibration.offset) / calibration.volts_per_rad
    angle, jumps = unwrapped(angle, rows)
    remarks += jumps
    _check(path, t, angle, unit, time_unit)
    gaps = np.diff(t) > 5 * np.median(np.diff(t))
    if gaps.any():
        remarks.append(f"{gaps.sum()} gaps between samples, the longest {np.diff(t).max():.3g} s")
    synthetic = any(comment.startswith(SYNTHETIC) for comment in columns.comments)
    return Record(str(path), t, angle, synthetic, tuple(f"{path}: {remark}" for remark in remarks))


def _chosen(path: str | Path, names: Sequence[str], column: str | None, time_column: str | None) -> tuple[str, str]:
    for asked in (column, time_column):
        if asked is not None and asked not in names:
            raise UnknownName(f"column of {path}:", asked, names)
    if len(names) < 2:
        raise BadFile(
            path, f"a column is missing: there is only {listed(names) or 'none'}; a time and a value are needed"
        )
    if time_column is None:
        timed = [name for name in find_times(names) if name != column]
        time_column = timed[0] if timed else names[0]
    if column is None:
        others = [name for name in names if name != time_column]
        if len(others) > 1:
            raise BadFile(path, f"which column is the knee's? It has {listed(others)}; name one (--column)")
        column = others[0]
    if column == time_column:
        raise BadValue("column", column, f"the column of the knee, not that of the time; columns: {listed(names)}")
    return time_column, column


def _unit(path: str | Path, name: str, below: str, units: dict[str, float], option: str) -> str | None:
    """Returns the unit that a column's name says, or the row below it."""
    said = split_name(name)
    found = said.unit if said.unit in units else None
    if said.meant and found is None:
        raise BadFile(path, _unknown(f"column {brief(name)}", said.word, units, option))
    if below.strip("- "):
        unit = split_name(f"[{below.strip('[]()')}]").unit
        if unit is None or unit not in units:
            raise BadFile(path, _unknown(f"the row below {brief(name)}", below, units, option))
        if found not in (None, unit):
            raise BadFile(
                path,
                f"column {brief(name)} is in {found}, and in {unit} as the row below says; name its unit by {option}",
            )
        return unit
    return found


def _unknown(place: str, word: str, units: dict[str, float], option: str) -> str:
    rate = ", that of a rate of change" if is_rate(word) else ""
    return f"{place} has the unit {brief(word)}{rate}; valid: {', '.join(units)}; {option} says another"


def unwrapped(angle: Array, rows: Whole) -> tuple[Array, list[str]]:
    """Returns the angle without jumps by a turn, near zero, and what was done; other jumps are reported."""
    with np.errstate(invalid="ignore"):
        steps = np.diff(angle)
        turns = np.rint(steps / TURN)
        wraps = (turns != 0.0) & (np.abs(steps - TURN * turns) <= NEARLY * TURN) & (np.abs(turns) <= 1.0)
    remarks = []
    strange = np.flatnonzero((np.abs(steps) > JUMP) & ~wraps)
    if strange.size:
        first = int(strange[0])
        also = f", and {strange.size - 1} times more" if strange.size > 1 else ""
        remarks.append(f"the angle jumps by {steps[first]:.3g} rad after row {rows[first] + 1}{also}")
    if wraps.any():
        angle = angle - TURN * np.concatenate([[0.0], np.cumsum(np.where(wraps, turns, 0.0))])
        angle = angle - TURN * np.rint(np.median(angle) / TURN)
        first = int(np.flatnonzero(wraps)[0])
        also = f", and {wraps.sum() - 1} times more" if wraps.sum() > 1 else ""
        remarks.append(f"the angle jumps by a turn after row {rows[first] + 1}{also}: such jumps are taken out")
    return angle, remarks


def _told(columns: Columns) -> str:
    """Returns, for each column, its first cell that holds no number and what to write; empty where there is none."""
    found = [(name, *other) for name, other in zip(columns.names, columns.others, strict=True) if other]
    return "".join(
        f"; column {brief(name)} holds {brief(cell)} in row {row + 1}: {find_remedy(cell)}" for name, cell, row in found
    )


def _rows(path: str | Path, t: Array, value: Array, told: str = "") -> tuple[Whole, list[str]]:
    """Returns the rows, from 0, that hold two numbers, each time once, and what was dropped."""
    good = (np.abs(t) < LONGEST) & np.isfinite(value)
    lost = int(good.size - good.sum())
    if 2 * lost > good.size:
        raise BadFile(path, f"{lost} of {good.size} rows hold no two finite numbers{told}")
    remarks = []
    if lost:
        first = int(np.flatnonzero(~good)[0]) + 1
        remarks.append(f"dropped {lost} of {good.size} rows without two finite numbers, the first in row {first}")
    rows = np.flatnonzero(good)
    if rows.size < FEWEST:
        raise BadFile(path, f"{rows.size} rows of numbers; a release needs at least {FEWEST}")
    t = t[rows]
    steps = np.diff(t)
    if (steps < 0).any():
        row = int(np.flatnonzero(steps < 0)[0])
        raise BadFile(
            path,
            f"time goes back from {t[row]:g} to {t[row + 1]:g} after {row + 1} rows; expected times that increase",
        )
    if (steps == 0).any():
        remarks.append(f"dropped {int((steps == 0).sum())} rows that repeat a time")
        rows = rows[np.concatenate([[True], steps > 0])]
    return rows, remarks


def _check(path: str | Path, t: Array, angle: Array, unit: str, time_unit: str) -> None:
    """Refuses values that cannot be a knee's angle in these units."""
    if t.size < FEWEST:
        raise BadFile(path, f"{t.size} samples at different times; a release needs at least {FEWEST}")
    step = float(np.median(np.diff(t)))
    if step > COARSEST:
        hint = f"are the times in {time_unit}, --time-unit?"
        raise BadFile(path, f"samples are {step:.3g} s apart; a release needs {COARSEST:g} s or less ({hint})")
    if step < FINEST:
        raise BadFile(path, f"samples are {step:.3g} s apart: are the times in {time_unit}, --time-unit?")
    largest = float(np.abs(angle).max())
    if largest > LARGEST:
        hint = "is the calibration right?" if unit in READOUTS else f"is it in {unit}, --unit?"
        raise BadFile(path, f"the knee's angle reaches {largest:.4g} rad at {t[np.abs(angle).argmax()]:g} s ({hint})")
