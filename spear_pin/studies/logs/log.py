"""A log: what was measured of a leg over time, by the names of the robot's joints, in SI units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.kinds import typed


@typed
@dataclass(frozen=True)
class Column:
    """Where a quantity is in a log's file, and how its SI value follows: sign (number - zero) size of its unit.

    Attributes:
        column: name of the column.
        unit: its unit; None for the one that its name says, else SI units.
        sign: 1 or -1.
        zero: number that the column shows at zero, in its unit.
        at: "joint" or "motor", of a torque: that of a motor is the joint's divided by the gear ratio.
        modes: names of the numbers in a column of modes.
        file: another file, beside the log's, that has the column with its own times.
        lag: how late its stamps are, in s.
    """

    column: str
    unit: str | None = None
    sign: float = 1.0
    zero: float = 0.0
    at: str = "joint"
    modes: Mapping[str, str] = field(default_factory=dict)
    file: str | None = None
    lag: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("sign", self.sign, lambda sign: abs(sign) == 1, "1 or -1")
        require("zero", self.zero, lambda _: True, "a finite number, in the column's unit")
        require("lag", self.lag, lambda _: True, "a finite number, in s")
        if self.at not in ("joint", "motor"):
            raise BadValue("at", self.at, "'joint' or 'motor'")
        for number in self.modes:
            if not str(number).removeprefix("-").replace(".", "", 1).isdecimal():
                raise BadValue("modes", number, "numbers in the column, each with a name")


@dataclass(frozen=True, repr=False)
class Log:
    """What was measured of a leg over time.

    Attributes:
        source: path of the file or folder.
        t: times, (n,), in s, from the first sample on, increasing; they may be irregular and have gaps.
        values: quantities by name, (n,) each, in SI units: a joint's position by the joint's name, its rate and torque
            as "crank_rate" and "crank_torque". Where there is none, it is NaN.
        at_motor: names of the torques that are those of motors, before the gears.
        modes: name of the controller's mode at each sample, (n,); empty where it is not logged.
        synthetic: whether the file says that nobody measured it.
        remarks: what was dropped, repaired, assumed or not read.
        begin: time of the first sample on the file's own clock, in s.

    Example:
        >>> import numpy as np
        >>> from spear_pin import Log
        >>> t = np.linspace(0.0, 1.0, 101)
        >>> Log("by hand", t, {"knee": np.sin(t)})
        Log('by hand': 101 samples in 1 s; knee)
    """

    source: str
    t: Array
    values: Mapping[str, Array]
    at_motor: frozenset[str] = frozenset()
    modes: NDArray[np.str_] | None = None
    synthetic: bool = False
    remarks: tuple[str, ...] = ()
    begin: float = 0.0

    def __post_init__(self) -> None:
        """Checks that times increase, and that there is a value at each."""
        t = np.asarray(self.t)
        if t.ndim != 1 or t.size < 2 or not np.isfinite(t).all() or not (np.diff(t) > 0).all():
            raise BadValue("t", self.t, "two times or more that increase, in s")
        others = {} if self.modes is None else {"modes": self.modes}
        for name, each in {**self.values, **others}.items():
            if np.shape(each) != t.shape:
                raise BadValue(f"values[{name!r}]", each, f"{t.size} values, one for each time")

    @classmethod
    @typed
    def read(
        cls,
        path: str | Path,
        columns: Mapping[str, Any] | None = None,
        units: Mapping[str, str] | None = None,
        *,
        map: str | Path | None = None,
    ) -> Log:
        """Reads a log from a CSV, .mat, .npz or MCAP file, or a folder of files that follow one another on one clock.

        What a column holds is said by `columns`, else by a TOML file of the same name beside it, or "log.toml" in the
        folder, with a table `[columns]`, else by the columns' own names: `knee_deg`, `knee_torque [Nm]`, `time_ms`.
        Saved trajectories (.npz) and tables of `Trajectory.export` (.csv) say it themselves.
        In an MCAP file columns are numbers of JSON or protobuf messages, by topic and field:
        "/joint_states.knee.position". The first of them gives the times; another topic is interpolated at them.

        Args:
            path: path of the file or folder.
            columns: for each quantity the name of its column, or what `Column` has: {"crank": "x_deg"}. Quantities are
                "time", the name of a joint for its position, that name with "_rate" or "_torque", and "mode".
            units: units of columns, by the column's name, where the name does not say it.
            map: path of the TOML file, in the place of the one beside the log.

        Raises:
            BadFile: the file is not such a log; the text says why.
            BadValue: a sign, a lag or another entry is not valid, or `columns` and `map` are both given.
            MissingExtra: the library that reads MCAP files is not installed.
            UnknownName: a column, an entry or a unit that is not there; the text lists the valid ones.
        """
        from spear_pin.studies.logs.reading import read

        return read(path, columns, units or {}, map)

    @staticmethod
    @typed
    def join(parts: Sequence[Log], source: str) -> Log:
        """Joins logs of one clock in the order of their times, with the quantities that all of them have.

        Args:
            parts: the logs.
            source: what the whole is called.

        Raises:
            BadValue: there are none, they overlap in time, or their torques are at different places.
        """
        parts = sorted(parts, key=lambda part: part.begin)
        if not parts:
            raise BadValue("parts", parts, "a log at least")
        for one, other in pairwise(parts):
            if other.begin <= one.begin + one.t[-1]:
                expected = f"logs of one clock that follow one another: {other.source} begins before {one.source} ends"
                raise BadValue("parts", source, expected)
            if other.at_motor != one.at_motor:
                raise BadValue("parts", source, "logs with the same torques at motors, and the same at joints")
        first, modes = parts[0], [part.modes for part in parts if part.modes is not None]
        names = [name for name in first.values if all(name in part.values for part in parts)]
        return Log(
            source,
            np.concatenate([part.t + (part.begin - first.begin) for part in parts]),
            {name: np.concatenate([part[name] for part in parts]) for name in names},
            first.at_motor,
            np.concatenate(modes) if len(modes) == len(parts) else None,
            any(part.synthetic for part in parts),
            tuple(dict.fromkeys(remark for part in parts for remark in part.remarks)),
            first.begin,
        )

    def __repr__(self) -> str:
        kind = "synthetic, " if self.synthetic else ""
        return f"Log({self.source!r}: {kind}{len(self.t)} samples in {np.ptp(self.t):.4g} s; {', '.join(self.values)})"

    def __getitem__(self, name: str) -> Array:
        """Returns a quantity, (n,), by its name.

        Raises:
            UnknownName: the log has no such quantity.
        """
        if name not in self.values:
            raise UnknownName(f"quantity of the log {self.source}", name, self.values)
        return self.values[name]
