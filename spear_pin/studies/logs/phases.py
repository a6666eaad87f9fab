"""Cuts a log into stance and flight by the motion of the leg alone: the controller's modes may be wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.signal import find_peaks, savgol_filter

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import FLIGHT, STANCE, find_measured

SMOOTHED = 0.009  # s, over which the leg's rate is smoothed
STRONG = 0.5  # of the fastest shortening or lengthening in the log: what a touchdown or push-off has
SUDDEN = 0.3  # of the rate of a push: by how much a touchdown changes the rate at once
SLOWEST = 0.05  # m/s, with which a leg may touch down or push off
NEAR = 0.02  # s, within which a touchdown is where free fall has it, and before the fastest shortening
SHORTEST = 0.03  # s of a phase
SLOWEST_RATE = 6e-3  # s between samples: with fewer a touchdown is not seen
GAP = 0.012  # s without a sample, which a phase may have
SPLIT, FEWEST = 0.1, 20  # s without a sample, from which on a log is cut, and samples of a part


@dataclass(frozen=True)
class LogPhase:
    """A stance or a flight in a log.

    Attributes:
        name: "stance" or "flight".
        begin: time at which it begins, in s of the log.
        end: time at which it ends, in s.
        whole: whether both of its ends are events, and not the log's own ends.
        left_out: why it is not used, "" if it is.
        source: name of the log.
    """

    name: str
    begin: float
    end: float
    whole: bool
    left_out: str = ""
    source: str = ""

    @property
    def duration(self) -> float:
        """How long it takes, in s."""
        return self.end - self.begin


@typed
def find_phases(robot: Robot, log: Log) -> tuple[LogPhase, ...]:
    """Finds stance and flight in a log from the height of the centre of mass above the toe, which the joints tell.

    The toe lifts off where, after a push, the centre of mass falls freely. From there on its height above the ground is
    known, and so is that of the toe: it touches down about where that vanishes, at the sharpest bend.

    Args:
        robot: a planar robot with one toe, on level ground.
        log: a log with the positions of its joints.

    Raises:
        BadFile: the log has no hop.
        BadValue: the robot has more than one toe, or the log too few of its joints.
        UnknownName: the log has none of the robot's joints.
    """
    joints = find_measured(robot, log)
    _ = joints.leading  # its error says which positions are missing
    positions = np.column_stack([log[name] for name in joints.joints])
    good = np.isfinite(positions).all(axis=1)
    t, heights = log.t[good], joints.heights(positions[good])
    if (step := float(np.median(np.diff(t)))) > SLOWEST_RATE:
        raise BadFile(log.source, f"samples are {step:.3g} s apart; a hop needs {SLOWEST_RATE:g} s or less")
    cuts = np.flatnonzero(np.diff(t) > SPLIT) + 1
    parts = [
        _Part(log.source, times, each, *smooth_rate(times, each))
        for times, each in zip(np.split(t, cuts), np.split(heights, cuts), strict=True)
        if len(times) > FEWEST
    ]
    fastest, slowest = (float(max((way * part.rate).max() for part in parts)) for way in (1.0, -1.0))
    found = [
        phase
        for part in parts
        for phase in _phases(part, _events(part, STRONG * fastest, STRONG * slowest, joints.gravity))
    ]
    if not any(phase.whole or phase.name == FLIGHT for phase in found):
        raise BadFile(
            log.source,
            "it has no hop: the leg neither touches down nor lifts off; name columns, signs and units (--column)",
        )
    return tuple(found)


@dataclass(frozen=True)
class _Part:
    """A part of a log without long gaps: heights of the centre of mass above the toe, (n,), its rate at even times."""

    source: str
    t: Array
    heights: Array
    even: Array
    rate: Array

    @cached_property
    def bend(self) -> Array:
        """Rate of the rate, (m,)."""
        return np.asarray(np.gradient(self.rate, self.even))


def _events(part: _Part, push: float, strike: float, gravity: float) -> list[tuple[float, str]]:
    """Returns when which phase begins, from pushes and strikes that are at least so fast."""
    t, rate, bend = part.even, part.rate, part.bend
    height, events = np.interp(t, part.t, part.heights), list[tuple[float, str]]()
    pushes = _peaks(rate, push)
    landed = _first(part, pushes, strike)
    if landed is not None:
        events.append((float(t[landed]), STANCE))
    begin = 0 if landed is None else landed
    for place in pushes:
        falls = np.flatnonzero(bend[place:] < -gravity)
        if place < begin or not falls.size:
            continue
        leaves = place + int(falls[0])
        events.append((float(t[leaves]), FLIGHT))
        since = t[leaves:] - t[leaves]
        toe = height[leaves] + rate[leaves] * since - 0.5 * gravity * since**2 - height[leaves:]
        below = np.flatnonzero((toe < 0.0) & (since > rate[leaves] / gravity))  # not while it rises
        if not below.size:
            break
        begin = _sharpest(t, bend, leaves + int(below[0]))
        if not _falls(t, rate, begin, rate[place]):
            break
        events.append((float(t[begin]), STANCE))
    return events


def _first(part: _Part, pushes: Array, strike: float) -> int | None:
    """Returns the place of a touchdown before the first push, None where the part begins on the ground."""
    t, rate = part.even, part.rate
    early = [int(i) for i in _peaks(-rate, strike) if not len(pushes) or i < pushes[0]]
    if not early:
        return None
    place = _sharpest(t, part.bend, early[-1], after=0.0)
    sudden = _falls(t, rate, place, rate[pushes].max(initial=0.0))
    return place if t[place] - t[0] > SHORTEST and sudden else None


def _falls(t: Array, rate: Array, place: int, push: float) -> bool:
    """Tells whether the rate falls at once by some of that of a push, as at a touchdown."""
    ends = np.interp([t[place] - SMOOTHED, t[place] + SMOOTHED], t, rate)
    return bool(ends[0] - ends[1] > SUDDEN * push)


def _sharpest(t: Array, bend: Array, place: int, after: float = NEAR) -> int:
    """Returns the place at which the rate falls most steeply, near another."""
    near = np.flatnonzero((t > t[place] - NEAR) & (t <= t[place] + after))
    return int(near[np.argmin(bend[near])])


def smooth_rate(t: Array, values: Array) -> tuple[Array, Array]:
    """Returns even times, (m,), and the smoothed rate of a quantity at them, (m,)."""
    step = float(np.median(np.diff(t)))
    times = np.arange(t[0], t[-1] + 0.5 * step, step)
    width = max(5, 2 * round(0.5 * SMOOTHED / step) + 1)
    if len(times) <= width:
        raise BadValue("log", len(times), f"more than {width} samples")
    return times, savgol_filter(np.interp(times, t, values), width, 2, deriv=1, delta=step)


def _peaks(rate: Array, least: float) -> Array:
    """Returns the places of peaks that are at least so high; one may be at an end."""
    padded = np.concatenate([[rate.min()], rate, [rate.min()]])
    peaks, _ = find_peaks(padded, height=max(least, SLOWEST), prominence=0.5 * least)
    return np.asarray(peaks - 1)


def _phases(part: _Part, events: Sequence[tuple[float, str]]) -> list[LogPhase]:
    """Returns the phases between events; those at its ends are not whole."""
    if not events:
        return []
    first, last = float(part.t[0]), float(part.t[-1])
    begins = [(first, STANCE if events[0][1] == FLIGHT else FLIGHT), *events]
    ends = [*(time for time, _ in events), last]
    found = []
    for (begin, name), end in zip(begins, ends, strict=True):
        inside = part.t[(part.t >= begin) & (part.t <= end)]
        why = ""
        if end - begin < SHORTEST or len(inside) < 5:
            why = f"it lasts {1e3 * (end - begin):.0f} ms only"
        elif (hole := float(np.diff(inside).max())) > GAP:
            why = f"{1e3 * hole:.0f} ms have no sample"
        found.append(LogPhase(name, float(begin), float(end), bool(begin > first and end < last), why, part.source))
    return [phase for phase in found if phase.duration > 0.0]
