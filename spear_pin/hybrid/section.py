"""The Poincaré section just after its event (4.11), and charts of it around many states, or one.

Points on it satisfy the closed toes' constraints, so a chart has fewer coordinates than the state. A hop has three with
boom_x locked and four with it free, as translation along the ground is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid import spatial_section
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.engines.structure import OF_GROUND, with_fields
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.per_lane import applied, null_spaces
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.footing import closed_toes, still
from spear_pin.hybrid.rules.start import placed
from spear_pin.hybrid.spatial_section import SpatialCharts
from spear_pin.hybrid.translation import translations
from spear_pin.model.equations import mechanism_of
from spear_pin.model.mechanism import Mechanism
from spear_pin.model.robot import Robot

Lanes = NDArray[np.int64]
PROJECTIONS = 8  # most projections onto the ground; each squares the remaining error
FARTHEST = 1e6  # m, rad: no state is farther from the origin


@dataclass(frozen=True)
class Section:
    """The toes that are closed just after the section's event, and the ground under them.

    Attributes:
        robot: the robot.
        mechanism: its dynamics, if it moves in the plane.
        toes: the closed toes.
        ground: the ground; its numbers are arrays where each lane has its own.
        translations: directions along which the dynamics do not change, (k, nv), or (n, k, nv) if slopes differ.
    """

    robot: Robot
    mechanism: Mechanism | None
    toes: tuple[str, ...]
    ground: Ground
    translations: Array

    def take(self, lanes: Any) -> Section:
        """Returns the section of some lanes."""
        own = {name: value[lanes] for name, value in vars(self.ground).items() if isinstance(value, np.ndarray)}
        if not own:
            return self
        along = self.translations[lanes] if self.translations.ndim == 3 else self.translations
        return replace(self, ground=with_fields(self.ground, own), translations=along)

    def on(self, numbers: Mapping[str, Array]) -> Section:
        """Returns the section on ground with its own numbers in each lane, (n,), by name; other names are ignored."""
        own = {name: values for name, values in numbers.items() if name in OF_GROUND}
        return replace(self, ground=with_fields(self.ground, own)) if own else self

    def geometry(self, q: Array) -> tuple[Array, Array]:
        """Returns the closed toes' distances from the ground, (n, k), and their Jacobians, (n, k, 2, nv)."""
        heights, jacobians = np.empty((len(q), len(self.toes))), np.empty((len(q), len(self.toes), 2, self.robot.nv))
        if self.mechanism is None or type(self.ground) is not Ground:  # its shape may be defined for numbers only
            for lane, configuration in enumerate(q):
                ground = _of_lane(self.ground, lane)
                for i, toe in enumerate(self.toes):
                    heights[lane, i], jacobians[lane, i] = ground.foot(self.robot, configuration, toe)
            return heights, jacobians
        rows = list(np.ascontiguousarray(q.T))
        feet = self.ground.seen(self.mechanism.feet(rows, [0.0] * self.mechanism.nv, np), np)
        for i, toe in enumerate(self.toes):
            heights[:, i] = feet.positions[toe][1]
            for axis, row in enumerate(feet.jacobians[toe]):
                for j, value in enumerate(row):
                    jacobians[:, i, axis, j] = value
        return heights, jacobians

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide, (n, k)."""
        return np.asarray(~still(applied(self.geometry(q)[1][:, :, 0], v)))

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states that all have the same sliding toes, (k,)."""
        _, jacobians = self.geometry(q)
        fixed = np.broadcast_to(self.translations, (len(q), *self.translations.shape[-2:]))
        q_bases = null_spaces(np.concatenate([jacobians[:, :, 1], fixed], axis=1))
        return Charts(self, slides, q, v, q_bases, null_spaces(velocity_rows(jacobians, slides)))


def section(system: HybridSystem, numbers: Mapping[str, Array] | None = None) -> Section:
    """Returns the section of a system.

    Args:
        system: the system.
        numbers: numbers that differ from lane to lane, (n,) each, by name; the section uses those of the ground.
    """
    ground = with_fields(system.ground, {name: each for name, each in (numbers or {}).items() if name in OF_GROUND})
    domain = system.of_phase(system.section_phase)[0]
    toes = tuple(toe for toe, _ in closed_toes(system.robot.toes, domain))
    mechanism = mechanism_of(system.robot) if system.robot.planar else None
    return Section(system.robot, mechanism, toes, ground, translations(system, ground))


@dataclass(frozen=True)
class Charts:
    """Coordinates ξ of the section near each of many states: displacements along its tangent spaces.

    Attributes:
        section: the section that all charts share.
        slides: which closed toes slide, (k,), the same in every lane.
        q: configurations with ξ = 0, (n, nv).
        v: velocities with ξ = 0, (n, nv).
        q_bases: tangent directions of q, orthonormal, (n, nv, dq).
        v_bases: tangent directions of v, orthonormal, (n, nv, dv).
    """

    section: Section
    slides: NDArray[np.bool_]
    q: Array
    v: Array
    q_bases: Array
    v_bases: Array

    def __len__(self) -> int:
        """Returns the number of lanes."""
        return len(self.q)

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.q_bases.shape[2] + self.v_bases.shape[2])

    def take(self, lanes: Lanes) -> Charts:
        """Returns the charts of some lanes, in any order, with repetitions allowed."""
        parts = (part[lanes] for part in (self.q, self.v, self.q_bases, self.v_bases))
        return Charts(self.section.take(lanes), self.slides, *parts)

    def on(self, numbers: Mapping[str, Array]) -> Charts:
        """Returns charts with these coordinates on other ground, see `Section.on`."""
        return replace(self, section=self.section.on(numbers))

    def of(self, system: HybridSystem) -> Charts:
        """Returns charts with these coordinates on the section of a system with other numbers."""
        return replace(self, section=section(system))

    def states(self, xi: Array) -> tuple[Array, Array]:
        """Returns the states on the section with coordinates ξ, (n, d); not finite where there is none."""
        dq = self.q_bases.shape[2]
        q, v = self.q + applied(self.q_bases, xi[:, :dq]), self.v + applied(self.v_bases, xi[:, dq:])
        near = np.abs(q).max(axis=1) < FARTHEST  # also False where q is not finite
        q[~near], v[~near] = np.nan, np.nan
        moving = lanes = np.flatnonzero(near)
        jacobians = np.empty((len(q), len(self.slides), 2, q.shape[1]))
        for _ in range(PROJECTIONS):
            heights, jacobians[moving] = self.section.take(moving).geometry(q[moving])
            off = ~placed(heights).all(axis=1)
            moving = moving[off]
            if not len(moving):
                break
            q[moving] -= applied(np.linalg.pinv(jacobians[moving, :, 1]), heights[off])
        rows = velocity_rows(jacobians[lanes], self.slides)
        v[lanes] -= applied(np.linalg.pinv(rows), applied(rows, v[lanes]))
        return q, v

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide at the first of some states, (k,)."""
        found: NDArray[np.bool_] = self.section.sliding(q[:1], v[:1])[0]
        return found

    def coordinates(self, q: Array, v: Array) -> Array:
        """Returns the coordinates ξ of states on the section, (n, d)."""
        parts = (self.q_bases, q - self.q), (self.v_bases, v - self.v)
        return np.concatenate([applied(np.swapaxes(bases, 1, 2), part) for bases, part in parts], axis=1)

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of ξ, (n, d, c), for changes of states, (n, nq + nv, c); they are linear in these."""
        nv = self.q.shape[1]
        parts = (self.q_bases, moves[:, :nv]), (self.v_bases, moves[:, nv:])
        return np.concatenate([np.swapaxes(bases, 1, 2) @ part for bases, part in parts], axis=1)


@dataclass(frozen=True)
class Chart:
    """Coordinates ξ of the section near a state: charts with one lane, without the axis of lanes.

    Attributes:
        lane: the charts.
    """

    lane: Charts | SpatialCharts

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self.lane.dimension

    @property
    def q_basis(self) -> Array:
        """Tangent directions of q, orthonormal, (nq, dq)."""
        basis: Array = self.lane.q_bases[0]
        return basis

    @property
    def v_basis(self) -> Array:
        """Tangent directions of v, orthonormal, (nv, dv)."""
        basis: Array = self.lane.v_bases[0]
        return basis

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


def chart(system: HybridSystem, state: State, slides: NDArray[np.bool_] | None = None) -> Chart:
    """Returns the chart of the section around a state on it.

    Args:
        system: the system.
        state: (q, v).
        slides: in the plane, which of the toes on the ground slide, (k,); by default the toes that slide at the state.

    Raises:
        BadValue: the state has the wrong shape or is not finite.
    """
    system.robot.bias(*state)  # checks both
    q, v = (np.array(part, dtype=float)[None] for part in state)
    if system.section_toes:
        return Chart(spatial_section.charts(system, q, v))
    whole = section(system)
    return Chart(whole.charts(q, v, whole.sliding(q, v)[0] if slides is None else slides))


def velocity_rows(jacobians: Array, slides: NDArray[np.bool_]) -> Array:
    """Returns the rows along which the velocity vanishes, (n, r, nv), without the path of a slipping toe."""
    n, k, axes, nv = jacobians.shape
    return jacobians.reshape(n, k * axes, nv)[:, np.column_stack([~slides, np.ones_like(slides)]).ravel()]


def _of_lane(ground: Ground, lane: int) -> Ground:
    """Returns the ground of one lane."""
    own = {name: float(value[lane]) for name, value in vars(ground).items() if isinstance(value, np.ndarray)}
    return with_fields(ground, own)
