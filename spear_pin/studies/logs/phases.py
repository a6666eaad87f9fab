"""Cuts a log into stance and flight by the motion of the leg alone: not by the controller's modes, which may be wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks, savgol_filter

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import FLIGHT, STANCE, measured

SMOOTHED = 0.009  # s, over which the leg's rate is smoothed
STRONG = 0.5  # of the fastest shortening or lengthening in the log: what a touchdown or push-off has
ONSET = 0.03  # s before the fastest shortening, within which the leg touches down
SHORTEST = 0.03  # s of a phase
GRAVITY = 9.81  # m/s²
GAP = 0.012  # s without a sample, which a phase may have


@dataclass(frozen=True)
class LogPhase:
    """A stance or a flight in a log.

    Attributes:
        name: "stance" or "flight".
        begin: time at which it begins, in s of the log.
        end: time at which it ends, in s.
        whole: whether both of its ends are events, and not the log's own ends.
        left_out: why it is not used, "" if it is.
    """

    name: str
    begin: float
    end: float
    whole: bool
    left_out: str = ""

    @property
    def duration(self) -> float:
        """How long it takes, in s."""
        return self.end - self.begin


@typed
def find_phases(robot: Robot, log: Log) -> tuple[LogPhase, ...]:
    """Finds stance and flight in a log from the length of the leg over time.

    At touchdown the leg begins to shorten fast, but not while the base still rises from the last push. It lifts off
    where it lengthens fastest. A weaker motion, as of a controller that takes the air for the ground, is neither.

    Args:
        robot: a planar robot with one toe.
        log: a log with the positions of its joints.

    Raises:
        BadFile: the log has no hop.
        BadValue: the robot has more than one toe, or the log too few of its joints.
        UnknownName: the log has none of the robot's joints.
    """
    joints = measured(robot, log)
    positions = np.column_stack([log[name] for name in joints.joints])
    good = np.isfinite(positions).all(axis=1)
    times, rate = smooth_rate(log.t[good], joints.lengths(positions[good]))
    pushes, strikes = _strong(rate), _strong(-rate)
    rises = [(times[i], times[i] + rate[i] / GRAVITY) for i in pushes]  # until when the base rises, its toe in the air
    strikes = [i for i in strikes if not any(begin < times[i] < end for begin, end in rises)]
    events = [(times[i], FLIGHT) for i in pushes]
    onset = round(ONSET / (times[1] - times[0]))
    bends = np.gradient(rate)
    for i in strikes:
        begin = max(0, i - onset)
        place = begin + int(np.argmin(bends[begin : i + 1]))
        events.append((times[place], STANCE))
    return tuple(_phases(log, sorted(events)))


def smooth_rate(t: Array, values: Array) -> tuple[Array, Array]:
    """Returns even times, (m,), and the smoothed rate of a quantity at them, (m,)."""
    step = float(np.median(np.diff(t)))
    times = np.arange(t[0], t[-1] + 0.5 * step, step)
    width = max(5, 2 * round(0.5 * SMOOTHED / step) + 1)
    if len(times) <= width:
        raise BadValue("log", len(times), f"more than {width} samples")
    return times, savgol_filter(np.interp(times, t, values), width, 2, deriv=1, delta=step)


def _strong(rate: Array) -> Array:
    """Returns the places of peaks that are not much lower than the highest."""
    highest = float(rate.max())
    padded = np.concatenate([[rate.min()], rate, [rate.min()]])  # a peak may be at an end
    peaks, _ = find_peaks(padded, height=STRONG * highest, prominence=0.5 * STRONG * highest)
    return np.asarray(peaks - 1)


def _phases(log: Log, events: Sequence[tuple[float, str]]) -> list[LogPhase]:
    """Returns the phases between events; those at the ends of the log are not whole."""
    kept: list[tuple[float, str]] = []
    for time, name in events:  # of several in a row the first touchdown and the last push-off count
        if not kept and name == STANCE and time - log.t[0] < SHORTEST:
            continue  # the log begins with the touchdown itself
        if kept and kept[-1][1] == name:
            if name == FLIGHT:
                kept[-1] = (time, name)
        else:
            kept.append((time, name))
    if not kept:
        raise BadFile(log.source, "it has no hop: the leg neither touches down nor lifts off")
    first, last = float(log.t[0]), float(log.t[-1])
    begins = [(first, STANCE if kept[0][1] == FLIGHT else FLIGHT), *kept]
    ends = [*(time for time, _ in kept), last]
    found = []
    for (begin, name), end in zip(begins, ends, strict=True):
        inside = log.t[(log.t >= begin) & (log.t <= end)]
        why = ""
        if end - begin < SHORTEST or len(inside) < 5:
            why = f"it lasts {1e3 * (end - begin):.0f} ms only"
        elif (hole := float(np.diff(inside).max())) > GAP:
            why = f"{1e3 * hole:.0f} ms have no sample"
        found.append(LogPhase(name, float(begin), float(end), bool(begin > first and end < last), why))
    return [phase for phase in found if phase.duration > 0.0]
