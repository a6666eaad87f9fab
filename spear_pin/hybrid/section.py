"""The Poincaré section of a system, and the chart of it around a state.

There are two kinds::

                       After the impact (4.11)             Before it
  of                   the plane, a robot on a boom        quadrupeds in space, on level ground
  toes that touch      all that are closed                 the lowest of some
  what is left out     translation along the ground        translation, heading; the mirror, between half strides
  coordinates          tangent directions                  means and differences of left and right

A hop has three coordinates with boom_x locked and four with it free. A quadruped with nv coordinates has 2 nv - 4.

A symmetric gait's return map does not couple symmetric and antisymmetric coordinates to first order, except for the
size of h'a, which decides which foot lands first; central differences do not see it. If a cycle is half a stride, and
the other half its mirror image, states between the halves are mirrored, so that a cycle leads back to its beginning.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart, Charts, Section
from spear_pin.hybrid.fields import with_fields
from spear_pin.hybrid.ground import PLACE, Ground
from spear_pin.hybrid.per_lane import apply_matrices, null_spaces
from spear_pin.hybrid.result import State
from spear_pin.hybrid.rules.footing import closed_toes, still
from spear_pin.hybrid.rules.start import is_placed as on_the_ground
from spear_pin.hybrid.symmetry import YAW, Mirror, X, Y, Z, head_state, mirror_of
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
    if system.section_toes:
        return BeforeImpact(system.robot, system.section_toes, system.ground, system.mirrored_toes)
    ground = with_fields(system.ground, {name: each for name, each in (numbers or {}).items() if name in PLACE})
    domain = system.of_phase(system.section_phase)[0]
    toes = tuple(toe for toe, _ in closed_toes(system.robot.toes, domain))
    mechanism = mechanism_of(system.robot) if system.robot.planar else None
    return AfterImpact(system.robot, toes, ground, mechanism, translations(system, ground))


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
class AfterImpact(Section):
    """The section just after its event. States on it satisfy the closed toes' constraints.

    Attributes:
        mechanism: the robot's dynamics, if it moves in the plane.
        translations: directions along which the dynamics do not change, (k, nv), or (n, k, nv) if slopes differ.
    """

    closed = True
    mechanism: Mechanism | None
    translations: Array

    def take(self, lanes: Any) -> Self:
        """Returns the section of some lanes."""
        if not any(isinstance(value, np.ndarray) for value in vars(self.ground).values()):
            return self
        along = self.translations[lanes] if self.translations.ndim == 3 else self.translations
        return replace(self, ground=_of_lanes(self.ground, lanes), translations=along)

    def on(self, numbers: Mapping[str, Array]) -> Self:
        """Returns the section on other ground, see `Section`; `translations` stay those that charts leave out."""
        own = {name: values for name, values in numbers.items() if name in PLACE}
        return replace(self, ground=with_fields(self.ground, own)) if own else self

    def geometry(self, q: Array) -> tuple[Array, Array]:
        """Returns the closed toes' distances from the ground, (n, k), and their Jacobians, (n, k, 2, nv)."""
        heights, jacobians = np.empty((len(q), len(self.toes))), np.empty((len(q), len(self.toes), 2, self.robot.nv))
        if self.mechanism is None or type(self.ground) is not Ground:  # its shape may be defined for numbers only
            for lane, configuration in enumerate(q):
                ground = _of_lanes(self.ground, lane)
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

    def loops(self, q: Array) -> tuple[Array, Array]:
        """Returns how far the robot's loops are from closed, (n, m), and their rows, (n, m, nv)."""
        closure = self.robot.closure
        if closure is None:
            return np.empty((len(q), 0)), np.empty((len(q), 0, q.shape[1]))
        gaps, rows = np.empty((len(q), closure.size)), np.empty((len(q), closure.size, q.shape[1]))
        for lane, configuration in enumerate(q):
            gaps[lane], rows[lane] = closure.at(configuration)
        return gaps, rows

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide, (n, k)."""
        return np.asarray(~still(apply_matrices(self.geometry(q)[1][:, :, 0], v)))

    def displacement(self, begins: tuple[Array, Array], ends: tuple[Array, Array]) -> Array:
        """Returns ends minus begins over (q, v), without translation along the ground, (n, 2 nv)."""
        return np.concatenate([without(self.translations, ends[0] - begins[0]), ends[1] - begins[1]], axis=1)

    def placed(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Returns states with closed toes on the ground, at rest unless they slide, and closed loops; see `Section`."""
        q, v = q.copy(), v.copy()
        near = np.abs(q).max(axis=1) < FARTHEST  # also False where q is not finite
        q[~near], v[~near] = np.nan, np.nan
        moving = lanes = np.flatnonzero(near)
        nv, size = q.shape[1], 0 if self.robot.closure is None else self.robot.closure.size
        jacobians, closing = np.empty((len(q), len(slides), 2, nv)), np.empty((len(q), size, nv))
        for _ in range(PROJECTIONS):
            heights, jacobians[moving] = self.take(moving).geometry(q[moving])
            gaps, closing[moving] = self.loops(q[moving])
            away = np.concatenate([heights, gaps], axis=1)
            off = ~on_the_ground(away).all(axis=1)
            moving = moving[off]
            if not len(moving):
                break
            rows = np.concatenate([jacobians[moving, :, 1], closing[moving]], axis=1)
            q[moving] -= apply_matrices(np.linalg.pinv(rows), away[off])
        rows = np.concatenate([velocity_rows(jacobians[lanes], slides), closing[lanes]], axis=1)
        v[lanes] -= apply_matrices(np.linalg.pinv(rows), apply_matrices(rows, v[lanes]))
        return q, v

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states that all have the same sliding toes, (k,)."""
        (_, jacobians), (_, closing) = self.geometry(q), self.loops(q)
        fixed = np.broadcast_to(self.translations, (len(q), *self.translations.shape[-2:]))
        q_bases = null_spaces(np.concatenate([jacobians[:, :, 1], fixed, closing], axis=1))
        v_bases = null_spaces(np.concatenate([velocity_rows(jacobians, slides), closing], axis=1))
        return Charts(self, slides, q, v, q_bases, v_bases, np.ones(q_bases.shape[2] + v_bases.shape[2], bool))


@dataclass(frozen=True)
class BeforeImpact(Section):
    """The section in space, on level ground, just before the first touchdown of some toes.

    The height follows from the other coordinates.

    Attributes:
        mirrored: toes whose first touchdown is the section between the halves of a stride, if a cycle is a half.
    """

    closed = False
    mirrored: tuple[str, ...]

    @cached_property
    def mirror(self) -> Mirror:
        """The mirror that exchanges left and right."""
        return mirror_of(self.robot)

    def take(self, lanes: Any) -> Self:
        """Returns the section itself, as all lanes have the same ground."""
        return self

    def on(self, numbers: Mapping[str, Array]) -> Self:
        """Returns the section itself, as the ground's friction does not move it."""
        return self

    def lowest(self, q: Array, toes: tuple[str, ...]) -> float:
        """Returns the height of the lowest of some toes, in m."""
        return min(self.ground.foot(self.robot, q, toe)[0] for toe in toes)

    def between_halves(self, q: Array) -> bool:
        """Tells whether a configuration on the section is one between the halves of a stride."""
        known = bool(self.mirrored) and bool(np.isfinite(q).all())
        return known and self.lowest(q, self.toes) > self.lowest(q, self.mirrored)

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide: before the impact, no toe is closed, (n, 0)."""
        return np.zeros((len(q), 0), bool)

    def displacement(self, begins: tuple[Array, Array], ends: tuple[Array, Array]) -> Array:
        """Returns ends minus begins over (q, v), each as it is seen, (n, 2 nv)."""
        return np.concatenate(self.seen(*ends), axis=1) - np.concatenate(self.seen(*begins), axis=1)

    def seen(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Returns states relative to the robot's position and heading; those between half strides are mirrored."""
        found = np.empty_like(q), np.empty_like(v)
        for lane, state in enumerate(zip(q, v, strict=True)):
            own = head_state(*state)
            if self.between_halves(own[0]):
                own = self.mirror(own[0]), self.mirror(own[1])
            found[0][lane], found[1][lane] = own
        return found

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of `seen` for changes of states, (n, 2 nv, c)."""
        nv, found = q.shape[1], np.array(moves)
        for at, moving, move in zip(q, v, found, strict=True):
            c, s = math.cos(at[YAW]), math.sin(at[YAW])
            turn = np.array([[c, s], [-s, c]])
            ahead, aside = turn @ moving[:2]
            dq, dv = move[:nv], move[nv:]
            dv[:2] = turn @ dv[:2] + np.outer([aside, -ahead], dq[YAW])
            dq[[X, Y, YAW]] = 0.0
            if self.between_halves(at):
                dq[:], dv[:] = self.mirror(dq.T).T, self.mirror(dv.T).T
        return found

    def placed(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Returns states lifted so that the lowest toe touches the ground."""
        q = q.copy()
        for each in q:
            if np.isfinite(each).all():
                each[Z] -= self.lowest(each, self.toes)
        return q, v

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Returns the charts around states; before the impact, no toes slide."""
        nv = self.robot.nv
        parts = [self.mirror.parts([i for i in range(nv) if i not in (X, Y, Z, YAW)]), self.mirror.parts(range(nv))]
        q_bases, v_bases = (np.broadcast_to(each, (len(q), *each.shape)) for each in map(np.hstack, parts))
        even = np.concatenate([np.full(part.shape[1], i == 0) for both in parts for i, part in enumerate(both)])
        return Charts(self, slides, *self.seen(q, v), q_bases, v_bases, even)


def velocity_rows(jacobians: Array, slides: NDArray[np.bool_]) -> Array:
    """Returns the rows along which the velocity vanishes, (n, r, nv), without the path of a slipping toe."""
    n, k, axes, nv = jacobians.shape
    return jacobians.reshape(n, k * axes, nv)[:, np.column_stack([~slides, np.ones_like(slides)]).ravel()]


def _of_lanes(ground: Ground, lanes: Any) -> Ground:
    """Returns the ground of some lanes, or of one."""
    own = {name: value[lanes] for name, value in vars(ground).items() if isinstance(value, np.ndarray)}
    return with_fields(ground, own)
