"""The motion to play: a trajectory, checked and resampled at a steady rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue
from spear_pin.hybrid.ground import Ground
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]


class EventLike(Protocol):
    """Something that happened: its name and its time in s."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def time(self) -> float: ...  # noqa: D102


@runtime_checkable
class TrajectoryLike(Protocol):
    """Motion that can be played.

    Attributes:
        t: (n,) times, in s, nondecreasing; an event has two samples, before and after.
        q: (n, nq) configurations.
        domain: (n,) names of the domains.
        force: (n, toes, 2), x and z, or (n, toes, 3): ground forces on the toes, in N.
        events: what happened, for the time bar.
        spring_joints: names of the joints that a spring spans.
        engaged: (n, springs) or, for one spring, (n,): whether each spring is engaged.

    What it stands on is its `ground`, in whose axes forces of two components are; without one, level ground at height
    zero.
    """

    @property
    def t(self) -> ArrayLike: ...  # noqa: D102
    @property
    def q(self) -> ArrayLike: ...  # noqa: D102
    @property
    def domain(self) -> ArrayLike: ...  # noqa: D102
    @property
    def force(self) -> ArrayLike: ...  # noqa: D102
    @property
    def events(self) -> Sequence[EventLike]: ...  # noqa: D102
    @property
    def spring_joints(self) -> Sequence[str]: ...  # noqa: D102
    @property
    def engaged(self) -> ArrayLike: ...  # noqa: D102


@dataclass(frozen=True)
class Part:
    """A stretch of a longer trajectory, as can be played; attributes as `TrajectoryLike`'s.

    Attributes:
        whole: when the trajectory begins and ends, in s.
    """

    t: Array
    q: Array
    domain: NDArray[np.str_]
    force: Array
    events: Sequence[EventLike]
    spring_joints: Sequence[str]
    engaged: NDArray[np.bool_]
    ground: Ground | None
    whole: tuple[float, float]

    @property
    def said(self) -> str:
        """Which part it is, in words."""
        begin, end = self.whole
        here = "first" if self.t[0] == begin else "last" if self.t[-1] == end else "middle"
        return f"the {here} {np.ptp(self.t):.1f} s of {end - begin:.1f} s, from {self.t[0]:.1f} to {self.t[-1]:.1f} s"


@dataclass(frozen=True)
class Span:
    """A domain and the times, in s from the start of the motion, it lasts from and to."""

    name: str
    begin: float
    end: float


@dataclass(frozen=True)
class Switch:
    """A yes or no over time: the value from each time, in s from the start, until the next."""

    times: Array
    values: tuple[bool, ...]


@dataclass(frozen=True)
class Motion:
    """A trajectory, resampled.

    Attributes:
        start: time of the trajectory's first sample, in s.
        t: (m,) times of the frames from there, in s; an event keeps its two frames.
        q: (m, nq) configurations.
        force: (m, toes, 3) ground forces, in N.
        spans: the domains, one after the other.
        events: name and time from the start, in s.
        springs: joint each spring spans, and when it is engaged.
        ground: on which it is.
    """

    start: float
    t: Array
    q: Array
    force: Array
    spans: tuple[Span, ...]
    events: tuple[tuple[str, float], ...]
    springs: tuple[tuple[str, Switch], ...]
    ground: Ground

    @property
    def duration(self) -> float:
        """How long it lasts, in s."""
        return float(self.t[-1])


def first(trajectory: TrajectoryLike, seconds: float) -> Part:
    """The beginning of a trajectory; see `between`."""
    begin = float(read_times(trajectory)[0])
    return between(trajectory, begin, begin + seconds)


def last(trajectory: TrajectoryLike, seconds: float) -> Part:
    """The end of a trajectory; see `between`."""
    end = float(read_times(trajectory)[-1])
    return between(trajectory, end - seconds, end)


def between(trajectory: TrajectoryLike, begin: float, end: float) -> Part:
    """The samples and events of a trajectory from one time to another, in s.

    Raises:
        BadValue: the trajectory's times are no times.
    """
    t = read_times(trajectory)
    rows = slice(*np.searchsorted(t, [begin, np.nextafter(end, np.inf)]))
    return Part(
        t=t[rows],
        q=np.asarray(trajectory.q)[rows],
        domain=np.asarray(trajectory.domain)[rows],
        force=np.asarray(trajectory.force)[rows],
        events=tuple(event for event in trajectory.events if begin <= event.time <= end),
        spring_joints=trajectory.spring_joints,
        engaged=np.asarray(trajectory.engaged)[rows],
        ground=getattr(trajectory, "ground", None),
        whole=(float(t[0]), float(t[-1])),
    )


def resample(robot: Robot, trajectory: TrajectoryLike, rate: float) -> Motion:
    """Frames at a rate, in 1/s, between the events; never across one.

    Raises:
        BadValue: the trajectory has the wrong shape, is not finite, runs backward or lasts no time.
        UnknownName: a spring's joint is not one of the robot's.
    """
    t = read_times(trajectory)
    n, toes = len(t), len(robot.toes)
    q = _table("trajectory.q", trajectory.q, [(n, robot.nq)])
    force = _table("trajectory.force", trajectory.force, [(n, toes, 2), (n, toes, 3)])
    ground = getattr(trajectory, "ground", None) or Ground()
    if force.shape[2] == 2:
        x, z = ground.world(force[:, :, 0], force[:, :, 1])
        force = np.stack((x, np.zeros((n, toes)), z), axis=2)
    domain = np.asarray(trajectory.domain, dtype=str)
    if domain.shape != (n,):
        raise BadValue("trajectory.domain", trajectory.domain, f"{n} names, one for each time")
    local = t - t[0]
    row, weight, frames = _frames(local, rate)
    return Motion(
        start=float(t[0]),
        t=frames,
        q=_blend(robot.model, q, row, weight),
        force=force[row] + weight[:, None, None] * (force[np.minimum(row + 1, n - 1)] - force[row]),
        spans=_spans(local, domain),
        events=tuple((str(event.name), _event_time(event) - float(t[0])) for event in trajectory.events),
        springs=_springs(robot, trajectory, local),
        ground=ground,
    )


def read_times(trajectory: TrajectoryLike) -> Array:
    """The times of a trajectory's samples, (n,), in s.

    Raises:
        BadValue: they are no times, run backward, or are all the same.
    """
    expected = "two or more finite nondecreasing times, in s"
    try:
        t = np.asarray(trajectory.t, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadValue("trajectory.t", trajectory.t, expected) from None
    if t.ndim != 1 or len(t) < 2 or not np.isfinite(t).all() or np.diff(t).min() < 0 or t[-1] == t[0]:
        raise BadValue("trajectory.t", trajectory.t, expected)
    return t


def _event_time(event: EventLike) -> float:
    try:
        time = float(event.time)
    except (TypeError, ValueError):
        time = float("nan")
    if not np.isfinite(time):
        raise BadValue("trajectory.events", event.time, "events with a finite time, in s")
    return time


def _table(name: str, value: ArrayLike, shapes: list[tuple[int, ...]]) -> Array:
    try:
        table = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadValue(name, value, "an array of numbers") from None
    if table.shape not in shapes:
        raise BadValue(name, table.shape, "the shape " + " or ".join(map(str, shapes)))
    if not np.isfinite(table).all():
        raise BadValue(name, float(table[~np.isfinite(table)][0]), "finite numbers")
    return table


def _frames(t: Array, rate: float) -> tuple[NDArray[np.intp], Array, Array]:
    """For each frame: the sample before it, how far it is to the next one (0..1), and its time."""
    ends = np.flatnonzero(np.diff(t) == 0)
    rows, weights, times = [], [], []
    for first, last in zip(np.r_[0, ends + 1], np.r_[ends, len(t) - 1], strict=True):
        count = max(1, int(np.ceil((t[last] - t[first]) * rate - 1e-9))) + 1 if last > first else 1
        time = np.linspace(t[first], t[last], count)
        row = np.clip(np.searchsorted(t[first : last + 1], time, side="right") - 1 + first, first, max(first, last - 1))
        step = t[np.minimum(row + 1, last)] - t[row]
        rows.append(row)
        weights.append(np.divide(time - t[row], step, out=np.zeros(count), where=step > 0))
        times.append(time)
    return np.concatenate(rows), np.concatenate(weights), np.concatenate(times)


def _blend(model: pin.Model, q: Array, row: NDArray[np.intp], weight: Array) -> Array:
    after = q[np.minimum(row + 1, len(q) - 1)]
    if model.nq == model.nv:
        return np.asarray(q[row] + weight[:, None] * (after - q[row]))
    return np.array([pin.interpolate(model, a, b, w) for a, b, w in zip(q[row], after, weight, strict=True)])


def _spans(t: Array, domain: NDArray[np.str_]) -> tuple[Span, ...]:
    first = np.r_[0, np.flatnonzero(domain[1:] != domain[:-1]) + 1]
    begin, end = t[first], np.r_[t[first[1:]], t[-1]]
    names = (str(name) for name in domain[first])
    spans = [Span(name, float(a), float(b)) for name, a, b in zip(names, begin, end, strict=True)]
    return tuple(span for span in spans if span.end > span.begin)


def _springs(robot: Robot, trajectory: TrajectoryLike, t: Array) -> tuple[tuple[str, Switch], ...]:
    joints = tuple(trajectory.spring_joints)
    for joint in joints:
        robot.index(joint)
    engaged: NDArray[Any] = np.asarray(trajectory.engaged, dtype=bool)
    if engaged.size == 0 and not joints:
        return ()
    if engaged.shape == (len(t),) and len(joints) == 1:
        engaged = engaged[:, None]
    if engaged.shape != (len(t), len(joints)):
        raise BadValue("trajectory.engaged", engaged.shape, f"the shape {(len(t), len(joints))}")
    return tuple((joint, _switch(t, engaged[:, column])) for column, joint in enumerate(joints))


def _switch(t: Array, values: NDArray[np.bool_]) -> Switch:
    last_at_its_time = np.r_[t[1:] > t[:-1], True]
    times, held = t[last_at_its_time], values[last_at_its_time]
    # the first of two samples at one time is the end of what was before
    keep = np.r_[True, held[1:] != held[:-1]]
    return Switch(times[keep], tuple(bool(value) for value in held[keep]))
