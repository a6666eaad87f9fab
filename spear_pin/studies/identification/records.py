"""Records of the knee's angle from a laboratory, in volts, degrees or radians, as radians over seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName, brief, list_names
from spear_pin.kinds import typed
from spear_pin.studies.tables.columns import read_columns
from spear_pin.studies.tables.readings import SYNTHETIC, find_gaps, read_clock, read_unit, read_values
from spear_pin.studies.tables.units import READOUTS, TIMES, VALUES, find_times

COARSEST = 0.02  # s between samples: a swing lasts a tenth of a second and more
FINEST = 1e-5  # s between samples: no potentiometer is read faster
FEWEST = 50  # samples
LARGEST = 2 * np.pi  # rad, that a knee may show


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
    """Reads a record from a CSV, .mat or .npz file.

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
    table = read_columns(path, lambda names: _chosen(path, names, column, time_column))
    (time_name, value_name), remarks = table.values, list(table.remarks)
    if value_name in table.moments:
        raise BadFile(
            path, f"column {brief(value_name)} holds dates or times of day, not the knee's: name another, --column"
        )
    clock = read_clock(table, time_name, time_unit, FEWEST, remarks)
    unit = read_unit(table, "'knee'", value_name, VALUES, unit)
    if unit is None:
        unit = "V" if calibration else "rad"
        remarks.append(f"{value_name!r} names no unit: taken as {unit}")
    if (unit in READOUTS) != (calibration is not None):
        words = "counts" if unit == "counts" else "volts"
        expected = f"{words} per radian (--volts-per-rad) and an offset" if unit in READOUTS else "none"
        raise BadValue(f"{path}: calibration of {value_name!r}, in {unit},", calibration, expected)
    size, to_angle = VALUES[unit], calibration or Calibration(1.0)
    angle = read_values(
        table, value_name, clock, lambda raw: (raw * size - to_angle.offset) / to_angle.volts_per_rad, True, remarks
    )
    good = ~np.isnan(angle)
    if good.sum() < max(FEWEST, good.size / 2):
        raise BadFile(path, f"{good.size - good.sum()} of {good.size} rows hold no angle; expected {FEWEST} that do")
    t, angle = table.values[time_name][clock.rows[good]], angle[good]
    t = (t - t[0]) * TIMES[clock.unit]
    _check(path, t, angle, unit, clock.unit)
    synthetic = any(comment.startswith(SYNTHETIC) for comment in table.comments)
    return Record(str(path), t, angle, synthetic, tuple(f"{path}: {remark}" for remark in [*remarks, *find_gaps(t)]))


def _chosen(path: str | Path, names: Sequence[str], column: str | None, time_column: str | None) -> tuple[str, str]:
    for asked in (column, time_column):
        if asked is not None and asked not in names:
            raise UnknownName(f"column of {path}:", asked, names)
    if len(names) < 2:
        raise BadFile(
            path, f"a column is missing: there is only {list_names(names) or 'none'}; a time and a value are needed"
        )
    if time_column is None:
        timed = [name for name in find_times(names) if name != column]
        time_column = timed[0] if timed else names[0]
    if column is None:
        others = [name for name in names if name != time_column]
        if len(others) > 1:
            raise BadFile(path, f"which column is the knee's? It has {list_names(others)}; name one (--column)")
        column = others[0]
    if column == time_column:
        raise BadValue("column", column, f"the column of the knee, not that of the time; columns: {list_names(names)}")
    return time_column, column


def _check(path: str | Path, t: Array, angle: Array, unit: str, time_unit: str) -> None:
    """Refuses values that cannot be a knee's angle in these units."""
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
