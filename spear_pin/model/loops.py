"""Closed loops of a planar robot: points of two bodies that a pin holds together, and joints tied by belts or gears.

A robot's file describes a tree. Its loops are permanent constraints φ(q) = 0 on the tree's coordinates, with the rows
A = ∂φ/∂q and the drift γ = Ȧ v. A pin has two rows, the distance of its ends along x and z; a belt has one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.frames import frame_id

PLANE = [0, 2]  # x and z
CLOSED = 1e-8  # m or rad, and per s: a state with a larger gap, or whose gap grows faster, does not close its loops
SETTLED, STEPS, LONGEST = 1e-13, 50, 0.5  # of Newton's method: a gap that counts as zero, steps, and the longest step
TOGGLE = 1e10  # condition number of the dependent columns at which a loop is at a toggle
FAR = 1e-2  # smallest singular value of the dependent columns, relative to the largest, far from a toggle
TIED = 1e-9  # m or rad per unit of a coordinate: it does not move a loop's ends apart
DEPENDENT = 1e-9  # singular value, relative to the largest, up to which rows depend on each other


@dataclass(frozen=True)
class Loop:
    """A closed loop: two points that a pin holds together, or joints whose weighted sum of angles stays zero.

    Attributes:
        name: its name.
        ends: frames of the model that coincide; none for a belt.
        joints: names and weights of the joints that a belt or gears tie.
    """

    name: str
    ends: tuple[str, str] | tuple[()] = ()
    joints: tuple[tuple[str, float], ...] = ()

    @property
    def size(self) -> int:
        """Number of its rows."""
        return len(PLANE) if self.ends else 1


class Closure:
    """The constraints that close a robot's loops, on data of Pinocchio's that are up to date.

    Args:
        model: the tree.
        coordinates: names of its coordinates.
        loops: the loops.

    Attributes:
        size: number of rows, m.
        tied: names of the coordinates that the loops tie to others.

    Raises:
        UnknownName: a belt ties a joint that is not there, or locked.
    """

    def __init__(self, model: pin.Model, coordinates: Sequence[str], loops: Sequence[Loop]) -> None:
        self._model, self._data, self.size = model, pin.Data(model), sum(loop.size for loop in loops)
        self._ends = [tuple(frame_id(model, frame) for frame in loop.ends) for loop in loops]
        self._ties = [np.zeros(model.nv) for _ in loops]
        for loop, tie in zip(loops, self._ties, strict=True):
            for joint, weight in loop.joints:
                if joint not in coordinates:
                    raise UnknownName(f"joint of the loop {loop.name!r}", joint, coordinates)
                tie[coordinates.index(joint)] += weight
        some = np.random.default_rng(0).uniform(-0.5, 0.5, model.nv)
        most = np.abs(self.at(some)[1]).max(axis=0)
        self.tied = tuple(name for name, each in zip(coordinates, most.tolist(), strict=True) if each > TIED)

    def gap(self, q: Array, data: pin.Data) -> Array:
        """Returns φ, (m,), in m or rad, after `pin.forwardKinematics` with these data."""
        parts = []
        for ends, tie in zip(self._ends, self._ties, strict=True):
            places = [pin.updateFramePlacement(self._model, data, end).translation[PLANE] for end in ends]
            parts.append(places[1] - places[0] if ends else np.array([tie @ q]))
        return np.concatenate(parts)

    def rows(self, data: pin.Data) -> Array:
        """Returns A, (m, nv), after `pin.computeJointJacobians` with these data."""
        parts = []
        for ends, tie in zip(self._ends, self._ties, strict=True):
            each = [pin.getFrameJacobian(self._model, data, end, WORLD_ALIGNED)[PLANE] for end in ends]
            parts.append(each[1] - each[0] if ends else tie[None])
        return np.concatenate(parts)

    def drift(self, data: pin.Data) -> Array:
        """Returns γ = Ȧ v, (m,), after `pin.forwardKinematics` with these data at v̇ = 0."""
        parts = []
        for ends in self._ends:
            each = [pin.getFrameClassicalAcceleration(self._model, data, end, WORLD_ALIGNED).linear for end in ends]
            parts.append((each[1] - each[0])[PLANE] if ends else np.zeros(1))
        return np.concatenate(parts)

    def at(self, q: Array) -> tuple[Array, Array]:
        """Returns φ, (m,), and A, (m, nv), at a configuration."""
        pin.computeJointJacobians(self._model, self._data, q)
        return self.gap(q, self._data), self.rows(self._data)

    def closed(self, q: Array, free: Sequence[int] | None = None) -> Array:
        """Closes the loops by Newton's method, and returns the configuration, (nv,); NaN where it finds none.

        Args:
            q: a configuration nearby, (nv,).
            free: the coordinates that may move; by default all do, as little as possible.
        """
        q, moving = q.copy(), list(range(len(q)) if free is None else free)
        for _ in range(STEPS):
            gap, rows = self.at(q)
            if np.abs(gap).max() < SETTLED:
                return q
            if not np.isfinite(rows).all():
                break
            step = np.linalg.lstsq(rows[:, moving], gap, rcond=None)[0]
            q[moving] -= step * min(1.0, LONGEST / (np.abs(step).max() + SETTLED))
        return q if np.abs(self.at(q)[0]).max() < CLOSED else np.full_like(q, np.nan)

    def assembled(self, starts: Sequence[Array], dependent: Sequence[int]) -> list[Array]:
        """Returns configurations with closed loops near some others, (nv,) each, without those at a toggle."""
        found = [q for q in map(self.closed, starts) if np.isfinite(q).all()]
        sizes = [np.linalg.svd(self.at(q)[1][:, dependent], compute_uv=False) for q in found]
        return [q for q, each in zip(found, sizes, strict=True) if each[-1] > FAR * each[0]]

    def holds(self, q: Array, v: Array) -> tuple[bool, bool]:
        """Tells whether a configuration closes the loops, and whether rates keep them closed."""
        gap, rows = self.at(q)
        return bool(np.abs(gap).max() <= CLOSED), bool(np.abs(rows @ v).max() <= CLOSED)

    def projected(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Returns the state with closed loops that is nearest to a state, NaN where there is none nearby."""
        whole = self.closed(q)
        rows = self.at(whole)[1]
        return whole, v - np.linalg.lstsq(rows, rows @ v, rcond=None)[0]


@dataclass(frozen=True)
class Reduced:
    """A robot's motion in the coordinates that its loops leave independent: D v̇_i + bias = Tᵀ (B u + Σ Jᵀ F).

    Attributes:
        q: the whole configuration, (nv,).
        v: the whole velocity, T v_i, (nv,).
        T: the velocity for each unit of an independent one, (nv, n).
        c: the acceleration at v̇_i = 0, (nv,).
        mass_matrix: Tᵀ D T, (n, n).
        bias: Tᵀ (C v + G + D c), (n,).
    """

    q: Array
    v: Array
    T: Array
    c: Array
    mass_matrix: Array
    bias: Array
