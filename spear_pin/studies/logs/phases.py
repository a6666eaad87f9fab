"""Cuts a log into stance and flight by the motion of the leg alone: not by the controller's modes, which may be wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.signal import find_peaks, savgol_filter

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.studies.logs.log import Log

STANCE, FLIGHT = "stance", "flight"
SMOOTHED = 0.009  # s, over which the leg's rate is smoothed
STRONG = 0.5  # of the fastest shortening or lengthening in the log: what a touchdown or push-off has
ONSET = 0.03  # s before the fastest shortening, within which the leg touches down
SHORTEST = 0.03  # s of a phase
GAP = 0.012  # s without a sample, which a phase may have
SETTLED, STEPS = 1e-12, 30


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


@dataclass(frozen=True)
class Measured:
    """The joints of a robot's leg that a log has, and what follows from them while the toe is on the ground.

    Attributes:
        robot: a robot with one toe.
        joints: names of the joints with a measured position.
    """

    robot: Robot
    joints: tuple[str, ...]

    @cached_property
    def rows(self) -> list[int]:
        """Rows of the measured joints in q."""
        return [self.robot.index(name) for name in self.joints]

    @cached_property
    def leading(self) -> list[int]:
        """Rows of measured joints whose rates determine the motion with the toe at rest.

        Raises:
            BadValue: the rates of the measured joints do not determine it.
        """
        q = self.configuration(np.zeros(len(self.rows)), None)
        rows, found = self._constraints(q), list[int]()
        for row in self.rows:
            more = np.vstack([rows, np.eye(self.robot.nv)[row]])
            if np.linalg.matrix_rank(more, 1e-6) > np.linalg.matrix_rank(rows, 1e-6):
                rows, found = more, [*found, row]
        if np.linalg.matrix_rank(rows, 1e-6) < self.robot.nv:
            others = [name for name in self.robot.coordinates if name not in self.joints]
            raise BadValue("log", list(self.joints), f"positions of more joints: one of {', '.join(others)} at least")
        return found

    def configuration(self, positions: Array, near: Array | None) -> Array:
        """Returns the configuration, (nv,), with the toe on the ground, from measured positions, (m,).

        Args:
            positions: the measured positions.
            near: a configuration nearby; None for one far from singular.
        """
        robot, toe = self.robot, self.robot.toes[0]
        q = robot.closed(np.zeros(robot.nq)) if near is None and robot.loops else np.zeros(robot.nq) if near is None else near.copy()
        q[self.rows] = positions
        free = [i for i in range(robot.nv) if i not in self.rows]
        for _ in range(STEPS):
            gap = np.append(robot.loop_gap(q) if robot.loops else [], self._height(q))
            if np.abs(gap).max() < SETTLED or not free:
                break
            slope = np.vstack([self._loops(q), robot.toe_jacobian(q, toe)[-1:]])
            q[free] -= np.linalg.lstsq(slope[:, free], gap, rcond=None)[0]
        return q

    def state(self, positions: Array, rates: Array, near: Array) -> Array:
        """Returns the state, (2 nv,), with the toe on the ground at rest, from positions and the leading rates."""
        q = self.configuration(positions, near)
        rows = np.vstack([self._constraints(q), np.eye(self.robot.nv)[self.leading]])
        wanted = np.concatenate([np.zeros(len(rows) - len(rates)), rates])
        return np.concatenate([q, np.linalg.lstsq(rows, wanted, rcond=None)[0]])

    def configurations(self, log: Log) -> Array:
        """Returns the configuration at each sample of a log, (n, nv), with the toe on the ground."""
        found, near = [], None
        for positions in np.column_stack([log[name] for name in self.joints]):
            near = self.configuration(positions, near)
            found.append(near)
        return np.array(found)

    def height_of_base(self, q: Array) -> float:
        """Returns how far the robot's base is above its toe, in m."""
        still = q.copy()
        still[self._base] = 0.0
        return -float(self.robot.toe_position(still, self.robot.toes[0])[-1])

    @cached_property
    def _base(self) -> list[int]:
        return [i for i, name in enumerate(self.robot.coordinates) if name in ("boom_x", "boom_z")]

    def _height(self, q: Array) -> float:
        return float(self.robot.toe_position(q, self.robot.toes[0])[-1])

    def _loops(self, q: Array) -> Array:
        return self.robot.loop_jacobian(q) if self.robot.loops else np.empty((0, self.robot.nv))

    def _constraints(self, q: Array) -> Array:
        return np.vstack([self._loops(q), self.robot.toe_jacobian(q, self.robot.toes[0])])


def measured(robot: Robot, log: Log) -> Measured:
    """Returns the joints of a robot that a log has.

    Raises:
        BadValue: the robot is none in the plane with one toe.
        UnknownName: the log has the position of none of its joints.
    """
    if not robot.planar or len(robot.toes) != 1:
        raise BadValue("robot", robot.name, "a planar robot with one toe")
    joints = tuple(name for name in robot.coordinates if name in log.values)
    if not joints:
        raise UnknownName(f"joint of {robot.name} in the log {log.source}", [*log.values], robot.coordinates)
    return Measured(robot, joints)


@typed
def find_phases(robot: Robot, log: Log) -> tuple[LogPhase, ...]:
    """Finds stance and flight in a log from the length of the leg over time.

    At touchdown the leg begins to shorten fast. It lifts off where it lengthens fastest. A weaker motion, such as that
    of a controller which takes the leg in the air for stance, is neither.

    Args:
        robot: a planar robot with one toe.
        log: a log with the positions of its joints.

    Raises:
        BadFile: the log has no hop.
        BadValue: the robot has more than one toe, or the log too few of its joints.
        UnknownName: the log has none of the robot's joints.
    """
    joints = measured(robot, log)
    good = np.isfinite(np.column_stack([log[name] for name in joints.joints])).all(axis=1)
    t, length = log.t[good], np.array([joints.height_of_base(q) for q in joints.configurations(_good(log, good))])
    times, rate = smooth_rate(t, length)
    pushes, strikes = _strong(rate), _strong(-rate)
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


def _good(log: Log, good: Array) -> Log:
    return Log(log.source, log.t[good], {name: each[good] for name, each in log.values.items()})
