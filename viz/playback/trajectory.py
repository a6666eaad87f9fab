"""Trajectories that can be played, and parts of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.path_springs import PathSprings
from spear_pin.hybrid.trajectory_tables import paths_of
from spear_pin.model.robot import Robot

LONGEST = 1e10  # s: of clocks that count from 1970, too
Table = tuple[Sequence[str], Array]


class EventLike(Protocol):
    """An event: its name and its time in s."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def time(self) -> float: ...  # noqa: D102


@runtime_checkable
class TrajectoryLike(Protocol):
    """A motion that can be played.

    Attributes:
        t: times, (n,), in s, nondecreasing; an event has two samples, before and after.
        q: configurations, (n, nq).
        domain: names of the domains, (n,).
        force: (n, toes, 2), x and z or round a post and z, or (n, toes, 3): ground forces on the toes, in N.
        events: events for the time bar.
        spring_joints: names of the joints that a spring spans.
        engaged: (n, springs) or, for one spring, (n,): whether each spring is engaged.

    `springs`, see `PathSprings`, are drawn where they run. `ground` is what it stands on; forces with two components
    are in the ground's axes. Without it the ground is level at height zero.
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
    """A part of a longer trajectory that can be played; see `TrajectoryLike` for the attributes.

    Attributes:
        whole: times at which the trajectory begins and ends, in s.
        table: names and values, (n, ...), of its columns; None if the trajectory has none.
        phase: names of the phases, (n,); None if the trajectory has none.
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
    table: Table | None = None
    phase: NDArray[np.str_] | None = None
    springs: PathSprings | None = None

    @property
    def said(self) -> str:
        """Part in words."""
        begin, end = self.whole
        here = "first" if self.t[0] == begin else "last" if self.t[-1] == end else "middle"
        return f"the {here} {np.ptp(self.t):.1f} s of {end - begin:.1f} s, from {self.t[0]:.1f} to {self.t[-1]:.1f} s"


def first(trajectory: TrajectoryLike, seconds: float) -> Part:
    """Returns the beginning of a trajectory; see `between`."""
    begin = float(read_times(trajectory)[0])
    return between(trajectory, begin, begin + seconds)


def last(trajectory: TrajectoryLike, seconds: float) -> Part:
    """Returns the end of a trajectory; see `between`."""
    end = float(read_times(trajectory)[-1])
    return between(trajectory, end - seconds, end)


def between(trajectory: TrajectoryLike, begin: float, end: float) -> Part:
    """Returns the samples and events of a trajectory from one time to another, in s.

    Raises:
        BadValue: the trajectory's times are not valid.
    """
    t = read_times(trajectory)
    rows = slice(*np.searchsorted(t, [begin, np.nextafter(end, np.inf)]))
    table, phase, springs = table_of(trajectory), getattr(trajectory, "phase", None), paths_of(trajectory)
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
        table=table and (table[0], table[1][rows]),
        phase=None if phase is None else np.asarray(phase)[rows],
        springs=springs and springs.part(rows),
    )


def table_of(trajectory: TrajectoryLike) -> Table | None:
    """Returns names and values, (n, ...), of a trajectory's columns, see `Trajectory.columns`; None if it has none."""
    if isinstance(trajectory, Part):
        return trajectory.table
    columns = getattr(trajectory, "columns", None)
    return columns() if callable(columns) else None


def in_world(robot: Robot, q: Array, force: Array, ground: Ground | None) -> Array:
    """Returns ground forces in axes of the world, (n, toes, 3), in N.

    Args:
        robot: the robot on which they act.
        q: configurations, (n, nq).
        force: forces, (n, toes, 3), in the world; or (n, toes, 2), along the ground and normal to it.
        ground: ground whose axes the latter refer to; None: level.
    """
    if force.shape[2] == 3:
        return force
    along = np.stack((ground or Ground()).world(force[:, :, 0], force[:, :, 1]), axis=2)
    return robot.directions.world(
        along, lambda: np.array([[robot.toe_position(each, toe) for toe in robot.toes] for each in q])
    )


def read_times(trajectory: TrajectoryLike, name: str = "trajectory") -> Array:
    """Returns the times of a trajectory's samples, (n,), in s.

    Args:
        trajectory: the trajectory.
        name: name of the trajectory in errors.

    Raises:
        BadValue: they are not times, run backward, or are all the same.
    """
    expected = f"two or more nondecreasing times below {LONGEST:g}, in s"
    try:
        t = np.asarray(trajectory.t, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadValue(f"{name}.t", trajectory.t, expected) from None
    if t.ndim != 1 or len(t) < 2 or not (np.abs(t) < LONGEST).all() or np.diff(t).min() < 0 or t[-1] == t[0]:
        raise BadValue(f"{name}.t", trajectory.t, expected)
    return t
