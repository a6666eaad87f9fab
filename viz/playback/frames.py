"""Frames of a trajectory at a steady rate, checked, and never across an event."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.trajectory_tables import paths_of
from spear_pin.model.cable import Cabled
from spear_pin.model.path import Path
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import find_spanned
from spear_pin.viz.playback.trajectory import EventLike, TrajectoryLike, in_world, read_times

LARGEST = 1e15  # rad, m or N, that can be drawn


@dataclass(frozen=True)
class Span:
    """A domain with its begin and end, in s from the start of the motion."""

    name: str
    begin: float
    end: float


@dataclass(frozen=True)
class Switch:
    """A yes or no over time: the value holds from each time, in s from the start, until the next."""

    times: Array
    values: tuple[bool, ...]


@dataclass(frozen=True)
class Cable:
    """A spring that is drawn where its path runs.

    Attributes:
        name: name of the spring.
        path: a cable between points of bodies.
        pull: force of the spring over the largest of the motion, (m,).
        acts: whether the spring is engaged, (m,).
    """

    name: str
    path: Cabled
    pull: Array
    acts: NDArray[np.bool_]


@dataclass(frozen=True)
class Frames:
    """A trajectory as frames at a steady rate.

    Attributes:
        start: time of the trajectory's first sample, in s.
        t: times of the frames from there, (m,), in s; an event keeps its two frames.
        q: configurations, (m, nq).
        force: ground forces, (m, toes, 3), in N.
        spans: the domains, one after the other.
        events: name and time from the start, in s.
        springs: joint that each spring spans, and when it is engaged; without those that are cables.
        ground: ground of the motion.
        cables: springs that are cables.
    """

    start: float
    t: Array
    q: Array
    force: Array
    spans: tuple[Span, ...]
    events: tuple[tuple[str, float], ...]
    springs: tuple[tuple[str, Switch], ...]
    ground: Ground
    cables: tuple[Cable, ...] = ()

    @property
    def duration(self) -> float:
        """Duration, in s."""
        return float(self.t[-1])


def resample(robot: Robot, trajectory: TrajectoryLike, rate: float, name: str = "trajectory") -> Frames:
    """Returns frames at a rate, in 1/s, between the events; never across one.

    Args:
        robot: the robot that moves.
        trajectory: motion of the robot.
        rate: frame rate in 1/s.
        name: name of the trajectory in errors.

    Raises:
        BadValue: the trajectory has the wrong shape, is not finite, runs backward or lasts no time.
        UnknownName: a spring's joint, or a frame of its path, is not one of the robot's.
    """
    t = read_times(trajectory, name)
    n, toes = len(t), len(robot.toes)
    q = _table(f"{name}.q", trajectory.q, [(n, robot.nq)])
    force = _table(f"{name}.force", trajectory.force, [(n, toes, 2), (n, toes, 3)])
    ground = getattr(trajectory, "ground", None) or Ground()
    force = in_world(robot, q, force, ground)
    domain = np.asarray(trajectory.domain, dtype=str)
    if domain.shape != (n,):
        raise BadValue(f"{name}.domain", trajectory.domain, f"{n} names, one for each time")
    local = t - t[0]
    row, weight, times = _steady(local, rate)
    springs = _by_path(robot, trajectory)
    return Frames(
        start=float(t[0]),
        t=times,
        q=_blend(robot.model, q, row, weight),
        force=force[row] + weight[:, None, None] * (force[np.minimum(row + 1, n - 1)] - force[row]),
        spans=_spans(local, domain),
        events=tuple((str(event.name), _event_time(event, name) - float(t[0])) for event in trajectory.events),
        springs=_springs(robot, trajectory, local, name, springs),
        ground=ground,
        cables=_cables(springs, row, weight),
    )


def _event_time(event: EventLike, name: str) -> float:
    try:
        time = float(event.time)
    except (TypeError, ValueError):
        time = float("nan")
    if not np.isfinite(time):
        raise BadValue(f"{name}.events", event.time, "events with a finite time, in s")
    return time


def _table(name: str, value: ArrayLike, shapes: list[tuple[int, ...]]) -> Array:
    try:
        table = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadValue(name, value, "an array of numbers") from None
    if table.shape not in shapes:
        raise BadValue(name, table.shape, "the shape " + " or ".join(map(str, shapes)))
    if not (np.abs(table) < LARGEST).all():
        raise BadValue(name, float(table[~(np.abs(table) < LARGEST)][0]), f"numbers below {LARGEST:g}")
    return table


def _steady(t: Array, rate: float) -> tuple[NDArray[np.intp], Array, Array]:
    """Returns for each frame the sample before it, the fraction of the way to the next sample (0..1), and its time."""
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


def _springs(
    robot: Robot, trajectory: TrajectoryLike, t: Array, name: str, springs: Sequence[_Sprung]
) -> tuple[tuple[str, Switch], ...]:
    joints = tuple(trajectory.spring_joints)
    for joint in joints:
        robot.index(joint)
    engaged: NDArray[Any] = np.asarray(trajectory.engaged, dtype=bool)
    if engaged.size == 0 and not joints:
        return ()
    if engaged.shape == (len(t),) and len(joints) == 1:
        engaged = engaged[:, None]
    if engaged.shape != (len(t), len(joints)):
        raise BadValue(f"{name}.engaged", engaged.shape, f"the shape {(len(t), len(joints))}")
    told = {**dict(zip(joints, engaged.T, strict=True)), **_beside_cables(springs)}
    return tuple((joint, _switch(t, acts)) for joint in joints if (acts := told[joint]) is not None)


class _Sprung(NamedTuple):
    """A spring on a known path, with its pull and whether it is engaged, (n,), and the joints that it spans."""

    name: str
    path: Path
    pull: Array
    acts: NDArray[np.bool_]
    joints: tuple[str, ...]

    @property
    def cables(self) -> list[Cabled]:
        """The parts of its path that have a place in the world."""
        return [each for each in self.path.members if isinstance(each, Cabled)]


def _by_path(robot: Robot, trajectory: TrajectoryLike) -> list[_Sprung]:
    """Returns the springs whose paths are known.

    Raises:
        BadValue: a path does not fit the robot.
        UnknownName: the robot has no such joint or frame.
    """
    springs = paths_of(trajectory)
    if springs is None:
        return []
    rows = zip(springs.names, springs.paths, springs.pull.T, springs.acts.T, strict=True)
    known = [(name, path, pull, acts) for name, path, pull, acts in rows if path is not None]
    return [_Sprung(name, path, pull, acts, find_spanned(path, robot)) for name, path, pull, acts in known]


def _cables(springs: Sequence[_Sprung], row: NDArray[np.intp], weight: Array) -> tuple[Cable, ...]:
    """Returns the springs that are cables, those of a sum one after the other."""
    found = []
    for each in springs:
        pull, after = each.pull[row], each.pull[np.minimum(row + 1, len(each.pull) - 1)]
        shares = (pull + weight * (after - pull)) / max(float(np.abs(each.pull).max()), 1e-12)
        for i, cable in enumerate(each.cables):
            found.append(Cable(f"{each.name} {i}" if i else each.name, cable, shares, each.acts[row]))
    return tuple(found)


def _beside_cables(springs: Sequence[_Sprung]) -> dict[str, NDArray[np.bool_] | None]:
    """Returns for each joint on a path whether a spring that is no cable is engaged, (n,); None if all are cables."""
    found: dict[str, NDArray[np.bool_] | None] = {}
    for each in springs:
        for joint in each.joints:
            before = found.get(joint)
            found[joint] = before if each.cables else each.acts if before is None else before | each.acts
    return found


def _switch(t: Array, values: NDArray[np.bool_]) -> Switch:
    last_at_its_time = np.r_[t[1:] > t[:-1], True]
    times, held = t[last_at_its_time], values[last_at_its_time]
    # the first of two samples at one time is the end of what was before
    keep = np.r_[True, held[1:] != held[:-1]]
    return Switch(times[keep], tuple(bool(value) for value in held[keep]))
