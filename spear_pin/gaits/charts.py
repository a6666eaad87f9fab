"""Charts of the section around many states at once, as `hybrid.periodic.chart` makes one.

Each lane's numbers depend on that lane alone, to the last digit: sums run over the last axis, in one order.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.engines.layout import with_fields
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.rules.footing import still
from spear_pin.hybrid.translation import translations
from spear_pin.model.planar import Planar

Array = NDArray[np.float64]
Lanes = NDArray[np.int64]
HEIGHT = 1e-15  # m: toes this near to the ground are on it


class Section:
    """Section of one robot, as its charts share it.

    Args:
        system: the system.
        ground: in place of the system's, its numbers arrays where lanes have ground of their own.
    """

    def __init__(self, system: HybridSystem, ground: Ground | None = None) -> None:
        robot, contacts = system.robot, system.of_phase(system.section_phase)[0].contacts
        self.planar, self.nv = Planar(robot), robot.nv
        self.toes = [toe for toe, mode in zip(robot.toes, contacts, strict=True) if mode != OPEN]
        self.ground, self.translations = ground or system.ground, translations(system, ground)

    def take(self, lanes: Any) -> Section:
        """Section of some lanes."""
        own = {name: value for name, value in vars(self.ground).items() if isinstance(value, np.ndarray)}
        if not own:
            return self
        other = copy(self)
        other.ground = with_fields(self.ground, {name: value[lanes] for name, value in own.items()})
        other.translations = self.translations[lanes] if self.translations.ndim == 3 else self.translations
        return other

    def geometry(self, q: Array) -> tuple[Array, Array]:
        """Distances of the closed toes from the ground, (n, k), their Jacobians, (n, k, 2, nv), of configurations."""
        n, rows = len(q), list(np.ascontiguousarray(q.T))
        feet = self.ground.seen(self.planar.feet(rows, [0.0] * self.nv, np), np)
        heights, jacobians = np.empty((n, len(self.toes))), np.empty((n, len(self.toes), 2, self.nv))
        for i, toe in enumerate(self.toes):
            heights[:, i] = feet.positions[toe][1]
            for axis, row in enumerate(feet.jacobians[toe]):
                for j, value in enumerate(row):
                    jacobians[:, i, axis, j] = value
        return heights, jacobians

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Which closed toes slide, (n, k)."""
        return np.asarray(~still(applied(self.geometry(q)[1][:, :, 0], v)))

    def charts(self, q: Array, v: Array, slides: NDArray[np.bool_]) -> Charts:
        """Charts around states in all of which the same toes slide, (k,)."""
        _, jacobians = self.geometry(q)
        fixed = np.broadcast_to(self.translations, (len(q), *self.translations.shape[-2:]))
        q_basis = null_spaces(np.concatenate([jacobians[:, :, 1], fixed], axis=1))
        return Charts(self, slides, q, v, q_basis, null_spaces(velocity_rows(jacobians, slides)))


@dataclass(frozen=True)
class Charts:
    """Coordinates ξ of the section near each of many states.

    Attributes:
        section: what they share.
        slides: which closed toes slide, (k,), the same ones in every lane.
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

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.q_bases.shape[2] + self.v_bases.shape[2])

    def take(self, lanes: Lanes) -> Charts:
        """Some lanes, in any order, one as often as wanted."""
        parts = (part[lanes] for part in (self.q, self.v, self.q_bases, self.v_bases))
        return Charts(self.section.take(lanes), self.slides, *parts)

    def states(self, xi: Array) -> tuple[Array, Array]:
        """The states on the section with coordinates ξ, (n, d); not finite where there is none."""
        dq = self.q_bases.shape[2]
        q, v = self.q + applied(self.q_bases, xi[:, :dq]), self.v + applied(self.v_bases, xi[:, dq:])
        near = np.abs(q).max(axis=1) < 1e6  # also False where it is not finite
        q[~near], v[~near] = np.nan, np.nan
        moving = np.flatnonzero(near)
        for _ in range(8):
            heights, jacobians = self.section.take(moving).geometry(q[moving])
            off = np.abs(heights).max(axis=1, initial=0.0) >= HEIGHT
            moving = moving[off]
            if not len(moving):
                break
            q[moving] -= applied(np.linalg.pinv(jacobians[off][:, :, 1]), heights[off])
        lanes = np.flatnonzero(near)
        rows = velocity_rows(self.section.take(lanes).geometry(q[lanes])[1], self.slides)
        v[lanes] -= applied(np.linalg.pinv(rows), applied(rows, v[lanes]))
        return q, v

    def coordinates(self, q: Array, v: Array) -> Array:
        """ξ of states on the section, (n, d)."""
        parts = (self.q_bases, q - self.q), (self.v_bases, v - self.v)
        return np.concatenate([applied(np.swapaxes(bases, 1, 2), part) for bases, part in parts], axis=1)


def velocity_rows(jacobians: Array, slides: NDArray[np.bool_]) -> Array:
    """Rows along which the velocity vanishes, (n, r, nv): not along a slipping toe's path."""
    rows = [jacobians[:, i, axis] for i, slide in enumerate(slides) for axis in ((1,) if slide else (0, 1))]
    return np.stack(rows, axis=1)


def null_spaces(rows: Array) -> Array:
    """Orthonormal bases of the null spaces of matrices of full rank, (n, r, m), as columns, (n, m, m - r)."""
    _, _, right = np.linalg.svd(rows, full_matrices=True)
    return np.ascontiguousarray(np.swapaxes(right[:, rows.shape[1] :], 1, 2))


def applied(matrices: Any, vectors: Any) -> Array:
    """Each matrix times its vector, summed in the same order whatever the number of lanes."""
    return np.asarray((matrices * np.asarray(vectors)[:, None, :]).sum(axis=2))
