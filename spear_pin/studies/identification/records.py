"""Records of the knee's angle as a laboratory has them, in volts, degrees or radians, as radians over seconds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.kinds import typed
from spear_pin.studies.identification.columns import read_columns

SYNTHETIC = "SYNTHETIC"  # the word by which a file says that nobody measured it
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}  # in s
ANGLES = {"rad": 1.0, "deg": np.pi / 180.0}  # in rad
VOLTAGES = {"V": 1.0, "mV": 1e-3}  # in V
COARSEST = 0.02  # s between samples: a swing lasts a tenth of a second and more
FINEST = 1e-5  # s between samples: no potentiometer is read faster
FEWEST = 50  # samples
LONGEST = 1e300  # in any unit of time, that is taken for a number
LARGEST = 2 * np.pi  # rad, that a knee may show
_TIME = re.compile(r"t|time|zeit|stamp|timestamp", re.IGNORECASE)
_UNIT = re.compile(r"(?:[_\s]+|[\[(/]\s*)(us|µs|ms|s|sec|min|rad|degrees|deg|°|mV|V|volts|volt)\s*[\])]?$")
_SPELLINGS = {"µs": "us", "sec": "s", "degrees": "deg", "°": "deg", "volts": "V", "volt": "V"}


@dataclass(frozen=True)
class Calibration:
    """A linear potentiometer: angle = (voltage - offset) / volts_per_rad.

    Attributes:
        volts_per_rad: its slope, in V/rad; negative if the voltage falls as the knee flexes.
        offset: its voltage at the straight leg, in V.
    """

    volts_per_rad: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        if not (np.isfinite(self.volts_per_rad) and self.volts_per_rad):
            raise BadValue("volts_per_rad", self.volts_per_rad, "a finite number other than zero, in V/rad")
        if not np.isfinite(self.offset):
            raise BadValue("offset", self.offset, "a finite number, in V")


@dataclass(frozen=True)
class Record:
    """The knee's angle over time.

    Attributes:
        source: name of the file.
        t: (n,), in s, increasing.
        angle: (n,), in rad.
        synthetic: whether the file says that it is.
        remarks: what was dropped or taken for granted.
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
    """Read a record from a CSV or .mat file.

    Units are read off the columns' names (`knee_V`, `angle [deg]`, `time_ms`) unless given.

    Args:
        path: of the file.
        column: of the voltage or angle (default: the only one beside the time).
        time_column: default: the one named t, time or the like, else the first.
        calibration: of the potentiometer, for a column in volts.
        unit: V, mV, rad or deg.
        time_unit: s, ms, us or min.

    Raises:
        BadFile: the file is no such record; the text says why.
        BadValue: a calibration that fits no voltage, or is missing for one.
        UnknownName: an unknown unit or column; the text lists the valid ones.
    """
    for name, choices in ((unit, VOLTAGES | ANGLES), (time_unit, TIMES)):
        if name is not None and name not in choices:
            raise UnknownName("unit", name, choices)
    columns = read_columns(path, lambda names: _chosen(path, names, column, time_column))
    (time_name, value_name), (t, value) = columns.names, columns.values
    time_unit = time_unit or _unit(time_name, TIMES) or "s"
    remarks = list(columns.remarks)
    unit = unit or _unit(value_name, VOLTAGES | ANGLES)
    if unit is None:
        unit = "V" if calibration else "rad"
        remarks.append(f"{value_name!r} names no unit: taken as {unit}")
    if (unit in VOLTAGES) != (calibration is not None):
        expected = "volts per radian (--volts-per-rad) and an offset" if unit in VOLTAGES else "none"
        raise BadValue(f"{path}: calibration of {value_name!r}, in {unit},", calibration, expected)
    t, value, dropped = _rows(path, t, value)
    remarks += dropped
    with np.errstate(over="ignore"):
        t = t * TIMES[time_unit]
        if calibration is None:
            angle = value * ANGLES[unit]
        else:
            angle = (value * VOLTAGES[unit] - calibration.offset) / calibration.volts_per_rad
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
            path, f"a column is missing: there is only {', '.join(names) or 'none'}; a time and a value are needed"
        )
    if time_column is None:
        timed = [name for name in names if _TIME.fullmatch(_UNIT.sub("", name).strip()) and name != column]
        time_column = timed[0] if timed else names[0]
    if column is None:
        others = [name for name in names if name != time_column]
        if len(others) > 1:
            raise BadFile(path, f"which column is the knee's? It has {', '.join(others)}; name one (--column)")
        column = others[0]
    if column == time_column:
        raise BadValue("column", column, f"another than the time's, one of {', '.join(names)}")
    return time_column, column


def _unit(name: str, units: dict[str, float]) -> str | None:
    found = _UNIT.search(name)
    unit = _SPELLINGS.get(found[1], found[1]) if found else None
    return unit if unit in units else None


def _rows(path: str | Path, t: Array, value: Array) -> tuple[Array, Array, list[str]]:
    """The rows that hold two numbers, each time once, and what was dropped."""
    good = (np.abs(t) < LONGEST) & np.isfinite(value)
    lost = int(good.size - good.sum())
    if 2 * lost > good.size:
        raise BadFile(path, f"{lost} of {good.size} rows hold no two finite numbers")
    remarks = []
    if lost:
        first = int(np.flatnonzero(~good)[0]) + 1
        remarks.append(f"dropped {lost} of {good.size} rows without two finite numbers, the first in row {first}")
        t, value = t[good], value[good]
    if t.size < FEWEST:
        raise BadFile(path, f"{t.size} rows of numbers; a release needs at least {FEWEST}")
    steps = np.diff(t)
    if (steps < 0).any():
        row = int(np.flatnonzero(steps < 0)[0])
        raise BadFile(path, f"time goes back from {t[row]:g} to {t[row + 1]:g} after {row + 1} rows of numbers")
    if (steps == 0).any():
        remarks.append(f"dropped {int((steps == 0).sum())} rows that repeat a time")
        kept = np.concatenate([[True], steps > 0])
        t, value = t[kept], value[kept]
    return t, value, remarks


def _check(path: str | Path, t: Array, angle: Array, unit: str, time_unit: str) -> None:
    """Refuse what cannot be a knee's angle in these units."""
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
        hint = "is the calibration right?" if unit in VOLTAGES else f"is it in {unit}, --unit?"
        raise BadFile(path, f"the knee's angle reaches {largest:.4g} rad at {t[np.abs(angle).argmax()]:g} s ({hint})")
