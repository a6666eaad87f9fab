"""Sections, and charts of one around many states, or around one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.per_lane import apply_matrices
from spear_pin.hybrid.result import State
from spear_pin.model.robot import Robot

Lanes = NDArray[np.int64]


@dataclass(frozen=True)
class Section(ABC):
    """What a cycle begins and ends on, as an impact passes: some toes, and symmetries that are left out.

    Attributes:
        robot: the robot.
        toes: the toes that may touch the ground.
        ground: the ground; its numbers are arrays where each lane has its own.
        closed: whether the section is just after the impact, with all its toes closed; else it is just before it, and
            only the lowest toe touches.
    """

    robot: Robot
    toes: tuple[str, ...]
    ground: Ground
    closed: ClassVar[bool]

    @abstractmethod
    def take(self, lanes: Any) -> Self:
        """Returns the section of some lanes."""

    @abstractmethod
    def on(self, numbers: Mapping[str, Array]) -> Self:
        """Returns the section on ground with its own numbers in each lane, (n,), by name; other names are ignored."""

    @abstractmethod
    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide, (n, k)."""

    @abstractmethod
    def placed(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Returns states moved onto the section; not finite where there is none nearby.

        Args:
            q: configurations, (n, nv).
            v: velocities, (n, nv).
            slides: which closed toes slide, (k,).
        """

    @abstractmethod
    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states that all have the same sliding toes, (k,)."""

    @abstractmethod
    def displacement(self, begins: tuple[Array, Array], ends: tuple[Array, Array]) -> Array:
        """Returns ends minus begins over (q, v), without what symmetries change, (n, 2 nv), in m, rad, m/s, rad/s."""

    def seen(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Returns states without what symmetries change, unless the directions of charts leave it out, (n, nv) each."""
        return q, v

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of `seen` for changes of states, (n, 2 nv, c)."""
        return moves


@dataclass(frozen=True)
class Charts:
    """Coordinates ξ of the section near each of many states: displacements along directions over the coordinates.

    Attributes:
        section: the section that all charts share.
        slides: which closed toes slide, (k,), the same in every lane.
        q: configurations with ξ = 0, as `Section.seen` returns them, (n, nv).
        v: velocities with ξ = 0, (n, nv).
        q_bases: directions of q, orthonormal, (n, nv, dq).
        v_bases: directions of v, orthonormal, (n, nv, dv).
        even: whether the mirror leaves a coordinate as it is, (dq + dv,); all true where there is no mirror.
    """

    section: Section
    slides: NDArray[np.bool_]
    q: Array
    v: Array
    q_bases: Array
    v_bases: Array
    even: NDArray[np.bool_]

    def __len__(self) -> int:
        """Returns the number of lanes."""
        return len(self.q)

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.q_bases.shape[2] + self.v_bases.shape[2])

    def take(self, lanes: Lanes) -> Charts:
        """Returns the charts of some lanes, in any order, with repetitions allowed."""
        q, v, q_bases, v_bases = (part[lanes] for part in (self.q, self.v, self.q_bases, self.v_bases))
        return Charts(self.section.take(lanes), self.slides, q, v, q_bases, v_bases, self.even)

    def on(self, numbers: Mapping[str, Array]) -> Charts:
        """Returns charts with these coordinates on other ground, see `Section.on`."""
        return replace(self, section=self.section.on(numbers))

    def states(self, xi: Array) -> tuple[Array, Array]:
        """Returns the states on the section with coordinates ξ, (n, d); not finite where there is none."""
        dq = self.q_bases.shape[2]
        q, v = self.q + apply_matrices(self.q_bases, xi[:, :dq]), self.v + apply_matrices(self.v_bases, xi[:, dq:])
        return self.section.placed(q, v, self.slides)

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide at the first of some states, (k,)."""
        found: NDArray[np.bool_] = self.section.sliding(q[:1], v[:1])[0]
        return found

    def coordinates(self, q: Array, v: Array) -> Array:
        """Returns the coordinates ξ of states on the section, (n, d)."""
        q, v = self.section.seen(q, v)
        parts = (self.q_bases, q - self.q), (self.v_bases, v - self.v)
        return np.concatenate([apply_matrices(np.swapaxes(bases, 1, 2), part) for bases, part in parts], axis=1)

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of ξ, (n, d, c), for changes of states on the section, (n, 2 nv, c)."""
        moves, nv = self.section.changes(q, v, moves), q.shape[1]
        parts = (self.q_bases, moves[:, :nv]), (self.v_bases, moves[:, nv:])
        return np.concatenate([np.swapaxes(bases, 1, 2) @ part for bases, part in parts], axis=1)


@dataclass(frozen=True)
class Chart:
    """Coordinates ξ of the section near a state: charts with one lane, without the axis of lanes.

    Attributes:
        lane: the charts.
    """

    lane: Charts

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self.lane.dimension

    @property
    def q_basis(self) -> Array:
        """Directions of q, orthonormal, (nq, dq)."""
        basis: Array = self.lane.q_bases[0]
        return basis

    @property
    def v_basis(self) -> Array:
        """Directions of v, orthonormal, (nv, dv)."""
        basis: Array = self.lane.v_bases[0]
        return basis

    @property
    def even(self) -> NDArray[np.bool_]:
        """Whether the mirror leaves a coordinate as it is, (d,); all true where there is no mirror."""
        return self.lane.even

    def state(self, xi: Array) -> State:
        """Returns the state on the section with coordinates ξ."""
        q, v = self.lane.states(xi[None])
        return q[0], v[0]

    def coordinates(self, state: State) -> Array:
        """Returns the coordinates ξ of a state on the section."""
        q, v = state
        xi: Array = self.lane.coordinates(q[None], v[None])[0]
        return xi

    def changes(self, y: Array, dy: Array) -> Array:
        """Returns the changes of ξ, (d, c), for changes of a state on the section, (2 nv,), by dy, (2 nv, c)."""
        nv = len(y) // 2
        xi: Array = self.lane.changes(y[None, :nv], y[None, nv:], dy[None])[0]
        return xi
