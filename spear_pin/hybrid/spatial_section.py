"""The section in space, just before the first touchdown of some toes, and charts of it.

What is cyclic is left out: a state counts as it is seen from where the robot is and heads. The height follows from the
others, so that of a robot with nv coordinates 2 nv - 4 are left. They are means and differences of left and right: what
is symmetric and what is antisymmetric, between which a symmetric gait's return map has no first-order coupling but one,
|h'a| of which foot lands first, that central differences do not see.

Where a cycle is half a stride, and the other half its mirror image, states between the halves are seen in the mirror,
so that a cycle leads back to where it began.
"""

from __future__ import annotations

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
        system: of which it is the section.
        q: configurations with ξ = 0, (n, nv), x = y = yaw = 0.
        v: velocities with ξ = 0, (n, nv).
        q_basis: directions of q, orthonormal, (nv, dq), symmetric ones first.
        v_basis: directions of v, orthonormal, (nv, dv), symmetric ones first.
        even: whether a coordinate is symmetric, (dq + dv,).
    """

    system: HybridSystem
    q: Array
    v: Array
    q_basis: Array
    v_basis: Array
    even: NDArray[np.bool_]

    def __len__(self) -> int:
        """Number of lanes."""
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

    def take(self, lanes: Lanes) -> SpatialCharts:
        """Some lanes, in any order, one as often as wanted."""
        return replace(self, q=self.q[lanes], v=self.v[lanes])

    def on(self, numbers: Mapping[str, Array]) -> SpatialCharts:
        """The same on ground of other friction, on which no coordinate depends."""
        return self

    def states(self, xi: Array) -> tuple[Array, Array]:
        """The states on the section with coordinates ξ, (n, d)."""
        dq = self.q_basis.shape[1]
        q, v = self.q + xi[:, :dq] @ self.q_basis.T, self.v + xi[:, dq:] @ self.v_basis.T
        for each in q:
            if np.isfinite(each).all():
                each[Z] -= lowest(self.system, each, self.system.section_toes)
        return q, v

    def coordinates(self, q: Array, v: Array) -> Array:
        """ξ of states on the section, (n, d), wherever they are and head."""
        states = [seen(self.system, state) for state in zip(q, v, strict=True)]
        places, rates = (np.array(part) for part in zip(*states, strict=True))
        return np.concatenate([(places - self.q) @ self.q_basis, (rates - self.v) @ self.v_basis], axis=1)


def seen(system: HybridSystem, state: State) -> State:
    """A state on the section from where the robot is and heads; between the halves of a stride in the mirror."""
    q, v = headed(*state)
    toes, others = system.section_toes, system.mirrored_toes
    if not others or lowest(system, q, toes) <= lowest(system, q, others):
        return q, v
    mirror = mirror_of(system.robot)
    return mirror(q), mirror(v)


def lowest(system: HybridSystem, q: Array, toes: Sequence[str]) -> float:
    """Height of the lowest of some toes, in m."""
    return min(system.ground.foot(system.robot, q, toe)[0] for toe in toes)


def charts(system: HybridSystem, q: Array, v: Array) -> SpatialCharts:
    """Charts around states on the section, (n, nv) each."""
    mirror, nv = mirror_of(system.robot), system.robot.nv
    places = mirror.parts([i for i in range(nv) if i not in (X, Y, Z, YAW)])
    rates = mirror.parts(range(nv))
    even = np.concatenate([np.full(part.shape[1], i == 0) for parts in (places, rates) for i, part in enumerate(parts)])
    states = [seen(system, state) for state in zip(q, v, strict=True)]
    at, moving = (np.array(part) for part in zip(*states, strict=True))
    return SpatialCharts(system, at, moving, np.hstack(places), np.hstack(rates), even)
