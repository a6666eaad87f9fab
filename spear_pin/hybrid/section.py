"""The Poincaré section of a system, and the chart of it around a state.

                       in the plane                        in space
  toes that touch      all that are closed                 the lowest of some
  side of the cut      just after the event (4.11)         just before the impact
  what is left out     translation along the ground        translation, heading; the mirror, between half strides
  coordinates          tangent directions                  means and differences of left and right

A hop has three coordinates with boom_x locked and four with it free, a robot in space with nv coordinates has 2 nv - 4.

A symmetric gait's return map does not couple symmetric and antisymmetric coordinates to first order, except for |h'a|,
which decides which foot lands first; central differences do not see it. If a cycle is half a stride, and the other half
its mirror image, states between the halves are mirrored, so that a cycle leads back to its beginning.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart, Charts, Section
from spear_pin.hybrid.engines.structure import OF_GROUND, with_fields
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.per_lane import applied, null_spaces
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.footing import closed_toes, still
from spear_pin.hybrid.rules.start import placed
from spear_pin.hybrid.symmetry import YAW, X, Y, Z, headed, mirror_of
from spear_pin.hybrid.translation import translations, without
from spear_pin.model.equations import mechanism_of
from spear_pin.model.mechanism import Mechanism

PROJECTIONS = 8  # most projections onto the ground; each squares the remaining error
FARTHEST = 1e6  # m, rad: no state is farther from the origin


def section(system: HybridSystem, numbers: Mapping[str, Array] | None = None) -> Section:
    """Returns the section of a system.

    Args:
        system: the system.
        numbers: numbers that differ from lane to lane, (n,) each, by name; the section uses those of the ground.
    """
    ground = with_fields(system.ground, {name: each for name, each in (numbers or {}).items() if name in OF_GROUND})
    if system.section_toes:
        return Before(system.robot, system.section_toes, ground, system.mirrored_toes)
    domain = system.of_phase(system.section_phase)[0]
    toes = tuple(toe for toe, _ in closed_toes(system.robot.toes, domain))
    mechanism = mechanism_of(system.robot) if system.robot.planar else None
    return After(system.robot, toes, ground, mechanism, translations(system, ground))


def chart(system: HybridSystem, state: State, slides: NDArray[np.bool_] | None = None) -> Chart:
    """Returns the chart of the section around a state on it.

    Args:
        system: the system.
        state: (q, v).
        slides: which of the closed toes slide, (k,); by default the toes that slide at the state.

    Raises:
        BadValue: the state has the wrong shape or is not finite.
    """
    system.robot.bias(*state)  # checks both
    q, v = (np.array(part, dtype=float)[None] for part in state)
    whole = section(system)
    return Chart(whole.charts(q, v, whole.sliding(q, v)[0] if slides is None else slides))


@dataclass(frozen=True)
class After(Section):
    """The section just after its event. States on it satisfy the closed toes' constraints.

    Attributes:
        mechanism: the robot's dynamics, if it moves in the plane.
        translations: directions along which the dynamics do not change, (k, nv), or (n, k, nv) if slopes differ.
    """

    mechanism: Mechanism | None
    translations: Array
    closed = True
    even = None

    def take(self, lanes: Any) -> Self:
        """Returns the section of some lanes."""
        along = self.translations[lanes] if self.translations.ndim == 3 else self.translations
        return replace(super().take(lanes), translations=along)

    def geometry(self, q: Array) -> tuple[Array, Array]:
        """Returns the closed toes' distances from the ground, (n, k), and their Jacobians, (n, k, 2, nv)."""
        heights, jacobians = np.empty((len(q), len(self.toes))), np.empty((len(q), len(self.toes), 2, self.robot.nv))
        if self.mechanism is None or type(self.ground) is not Ground:  # its shape may be defined for numbers only
            for lane, configuration in enumerate(q):
                ground = self.ground_of(lane)
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

    def seen(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Returns states without their translation along the ground, (n, nv) each."""
        return without(self.translations, q), v

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes as they are: a chart's directions are normal to translation."""
        return moves

    def placed(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Moves the closed toes of states to the ground, where the others come to rest; see `Section`."""
        near = np.abs(q).max(axis=1) < FARTHEST  # also False where q is not finite
        q[~near], v[~near] = np.nan, np.nan
        moving = lanes = np.flatnonzero(near)
        jacobians = np.empty((len(q), len(slides), 2, q.shape[1]))
        for _ in range(PROJECTIONS):
            heights, jacobians[moving] = self.take(moving).geometry(q[moving])
            off = ~placed(heights).all(axis=1)
            moving = moving[off]
            if not len(moving):
                break
            q[moving] -= applied(np.linalg.pinv(jacobians[moving, :, 1]), heights[off])
        rows = velocity_rows(jacobians[lanes], slides)
        v[lanes] -= applied(np.linalg.pinv(rows), applied(rows, v[lanes]))
        return q, v

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states that all have the same sliding toes, (k,)."""
        _, jacobians = self.geometry(q)
        fixed = np.broadcast_to(self.translations, (len(q), *self.translations.shape[-2:]))
        q_bases = null_spaces(np.concatenate([jacobians[:, :, 1], fixed], axis=1))
        return Charts(self, slides, q, v, q_bases, null_spaces(velocity_rows(jacobians, slides)))


@dataclass(frozen=True)
class Before(Section):
    """The section in space, just before the first touchdown of some toes.

    The height follows from the other coordinates.

    Attributes:
        mirrored: toes whose first touchdown is the section between the halves of a stride, if a cycle is a half.
    """

    mirrored: tuple[str, ...]
    closed = False

    @property
    def even(self) -> NDArray[np.bool_]:
        """Whether the mirror leaves a coordinate of the charts as it is, (d,)."""
        kinds = [np.full(part.shape[1], i == 0) for parts in self._directions() for i, part in enumerate(parts)]
        return np.concatenate(kinds)

    def _directions(self) -> list[tuple[Array, Array]]:
        """Returns symmetric and antisymmetric directions of q, and of v, (nv, k) each."""
        mirror, nv = mirror_of(self.robot), self.robot.nv
        return [mirror.parts([i for i in range(nv) if i not in (X, Y, Z, YAW)]), mirror.parts(range(nv))]

    def lowest(self, lane: int, q: Array, toes: tuple[str, ...]) -> float:
        """Returns the height of the lowest of some toes, in m."""
        ground = self.ground_of(lane)
        return min(ground.foot(self.robot, q, toe)[0] for toe in toes)

    def halfway(self, lane: int, q: Array) -> bool:
        """Tells whether a configuration on the section is one between the halves of a stride."""
        return bool(self.mirrored) and self.lowest(lane, q, self.toes) > self.lowest(lane, q, self.mirrored)

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide: before the impact, no toe is closed, (n, 0)."""
        return np.zeros((len(q), 0), bool)

    def seen(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Returns states relative to the robot's position and heading; those between half strides are mirrored."""
        found = np.empty_like(q), np.empty_like(v)
        for lane, (at, moving) in enumerate(zip(q, v, strict=True)):
            own = headed(at, moving)
            if self.halfway(lane, own[0]):
                mirror = mirror_of(self.robot)
                own = mirror(own[0]), mirror(own[1])
            found[0][lane], found[1][lane] = own
        return found

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of `seen` for changes of states, (n, 2 nv, c)."""
        nv, found = q.shape[1], np.array(moves)
        for lane, (at, moving, move) in enumerate(zip(q, v, found, strict=True)):
            c, s = math.cos(at[YAW]), math.sin(at[YAW])
            turn = np.array([[c, s], [-s, c]])
            ahead, aside = turn @ moving[:2]
            dq, dv = move[:nv], move[nv:]
            dv[:2] = turn @ dv[:2] + np.outer([aside, -ahead], dq[YAW])
            dq[[X, Y, YAW]] = 0.0
            if self.halfway(lane, at):
                mirror = mirror_of(self.robot)
                dq[:], dv[:] = mirror(dq.T).T, mirror(dv.T).T
        return found

    def placed(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Lifts states so that the lowest toe touches the ground."""
        for lane, each in enumerate(q):
            if np.isfinite(each).all():
                each[Z] -= self.lowest(lane, each, self.toes)
        return q, v

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states; before the impact, no toes slide."""
        bases = (np.broadcast_to(each, (len(q), *each.shape)) for each in map(np.hstack, self._directions()))
        return Charts(self, slides, *self.seen(q, v), *bases)


def velocity_rows(jacobians: Array, slides: NDArray[np.bool_]) -> Array:
    """Returns the rows along which the velocity vanishes, (n, r, nv), without the path of a slipping toe."""
    n, k, axes, nv = jacobians.shape
    return jacobians.reshape(n, k * axes, nv)[:, np.column_stack([~slides, np.ones_like(slides)]).ravel()]
