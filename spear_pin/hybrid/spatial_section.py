"""The section in space, just before the first touchdown of some toes, and charts of it.

Cyclic coordinates are left out: a state is expressed relative to the robot's position and heading. The height follows
from the other coordinates, so that a robot with nv coordinates has 2 nv - 4 left. They are means and differences of
left and right, symmetric and antisymmetric coordinates. A symmetric gait's return map does not couple these to first
order, except for |h'a|, which decides which foot lands first; central differences do not see it.

If a cycle is half a stride, and the other half its mirror image, states between the halves are mirrored, so that a
cycle leads back to its beginning.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import YAW, X, Y, Z, headed, mirror_of

Lanes = NDArray[np.int64]


@dataclass(frozen=True)
class SpatialCharts:
    """Coordinates ξ of the section near each of many states.

    Attributes:
        system: the system of the section.
        q: configurations with ξ = 0, (n, nv), x = y = yaw = 0.
        v: velocities with ξ = 0, (n, nv).
        q_basis: directions of q, orthonormal, (nv, dq), first the symmetric ones.
        v_basis: directions of v, orthonormal, (nv, dv), first the symmetric ones.
        even: whether a coordinate is symmetric, (dq + dv,).
    """

    system: HybridSystem
    q: Array
    v: Array
    q_basis: Array
    v_basis: Array
    even: NDArray[np.bool_]

    def __len__(self) -> int:
        """Returns the number of lanes."""
        return len(self.q)

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.even)

    @property
    def q_bases(self) -> Array:
        """Directions of q of each lane, (n, nv, dq)."""
        return np.broadcast_to(self.q_basis, (len(self), *self.q_basis.shape))

    @property
    def v_bases(self) -> Array:
        """Directions of v of each lane, (n, nv, dv)."""
        return np.broadcast_to(self.v_basis, (len(self), *self.v_basis.shape))

    @property
    def slides(self) -> NDArray[np.bool_]:
        """Which closed toes slide: on this section, before the impact, no toe is closed, (0,)."""
        return np.zeros(0, bool)

    def sliding(self, q: Array, v: Array) -> NDArray[np.bool_]:
        """Tells which closed toes slide, (0,)."""
        return self.slides

    def take(self, lanes: Lanes) -> SpatialCharts:
        """Returns the charts of some lanes, in any order, with repetitions allowed."""
        return replace(self, q=self.q[lanes], v=self.v[lanes])

    def on(self, numbers: Mapping[str, Array]) -> SpatialCharts:
        """Returns the same charts, as coordinates do not depend on the ground's friction."""
        return self

    def of(self, system: HybridSystem) -> SpatialCharts:
        """Returns charts with these coordinates on the section of a system with other numbers."""
        return replace(self, system=system)

    def states(self, xi: Array) -> tuple[Array, Array]:
        """Returns the states on the section with coordinates ξ, (n, d)."""
        dq = self.q_basis.shape[1]
        q, v = self.q + xi[:, :dq] @ self.q_basis.T, self.v + xi[:, dq:] @ self.v_basis.T
        for each in q:
            if np.isfinite(each).all():
                each[Z] -= lowest(self.system, each, self.system.section_toes)
        return q, v

    def coordinates(self, q: Array, v: Array) -> Array:
        """Returns the coordinates ξ of states on the section, (n, d), at any position and heading."""
        states = [seen(self.system, state) for state in zip(q, v, strict=True)]
        places, rates = (np.array(part) for part in zip(*states, strict=True))
        return np.concatenate([(places - self.q) @ self.q_basis, (rates - self.v) @ self.v_basis], axis=1)

    def changes(self, q: Array, v: Array, moves: Array) -> Array:
        """Returns the changes of ξ, (n, d, c), for changes of states on the section, (n, 2 nv, c).

        Args:
            q: configurations of the states, (n, nv), at any position and heading.
            v: velocities, (n, nv).
            moves: changes of both.
        """
        nv, found = q.shape[1], []
        for at, moving, move in zip(q, v, moves, strict=True):
            c, s = math.cos(at[YAW]), math.sin(at[YAW])
            turn = np.array([[c, s], [-s, c]])
            ahead, aside = turn @ moving[:2]
            dq, dv = move[:nv], move[nv:].copy()
            dv[:2] = turn @ dv[:2] + np.outer([aside, -ahead], dq[YAW])
            if halfway(self.system, at):
                mirror = mirror_of(self.system.robot)
                dq, dv = mirror(dq.T).T, mirror(dv.T).T
            found.append(np.concatenate([self.q_basis.T @ dq, self.v_basis.T @ dv]))
        return np.array(found)


def seen(system: HybridSystem, state: State) -> State:
    """Returns a state on the section relative to the robot's position and heading.

    Between the halves of a stride the state is mirrored.
    """
    q, v = headed(*state)
    if not halfway(system, q):
        return q, v
    mirror = mirror_of(system.robot)
    return mirror(q), mirror(v)


def halfway(system: HybridSystem, q: Array) -> bool:
    """Tells whether a configuration on the section is one between the halves of a stride."""
    others = system.mirrored_toes
    return bool(others) and lowest(system, q, system.section_toes) > lowest(system, q, others)


def lowest(system: HybridSystem, q: Array, toes: Sequence[str]) -> float:
    """Returns the height of the lowest of some toes, in m."""
    return min(system.ground.foot(system.robot, q, toe)[0] for toe in toes)


def charts(system: HybridSystem, q: Array, v: Array) -> SpatialCharts:
    """Returns the charts around states on the section, (n, nv) each."""
    mirror, nv = mirror_of(system.robot), system.robot.nv
    places = mirror.parts([i for i in range(nv) if i not in (X, Y, Z, YAW)])
    rates = mirror.parts(range(nv))
    even = np.concatenate([np.full(part.shape[1], i == 0) for parts in (places, rates) for i, part in enumerate(parts)])
    states = [seen(system, state) for state in zip(q, v, strict=True)]
    at, moving = (np.array(part) for part in zip(*states, strict=True))
    return SpatialCharts(system, at, moving, np.hstack(places), np.hstack(rates), even)
