"""Heights of toes above the ground, at many states at once, with or without derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.dual import ARRAYS, Dual, derivative_of, make_varying, value_of
from spear_pin.hybrid.engines.structure import symbols
from spear_pin.hybrid.ground import Ground
from spear_pin.model.equations import mechanism_of
from spear_pin.model.mechanism import Mechanism


@dataclass(frozen=True)
class Heights:
    """Heights of toes.

    Attributes:
        mechanism: the robot; its lengths may be dual.
        ground: the ground; its numbers may be dual, or arrays of lanes.
    """

    mechanism: Mechanism
    ground: Ground

    def at(self, toe: str, q: Sequence[Any]) -> Any:
        """Returns the distance of a toe from the ground, along its normal, in m; coordinates are arrays, dual or not.

        The distance is of the same kind as the coordinates.
        """
        x, *_, z = self.mechanism.position(toe, q, ARRAYS)
        return self.ground.above(x, z, ARRAYS)

    def along(self, toe: str, q: Array, dq: Array) -> tuple[Array, Array]:
        """Returns heights at n states, in m, (n,), and derivatives along c directions at each, (n, c).

        Args:
            toe: name of the toe.
            q: coordinates, (nv, n).
            dq: their derivatives, (nv, n, c).
        """
        found = self.at(toe, [Dual(x[:, None], d) for x, d in zip(q, dq, strict=True)])
        n, c = dq.shape[1:]
        return np.broadcast_to(value_of(found), (n, 1))[:, 0], np.broadcast_to(derivative_of(found), (n, c))


def dual_heights(system: HybridSystem, numbers: Array, dnumbers: Array) -> Heights:
    """Returns heights that depend on a system's numbers as well.

    Args:
        system: the system.
        numbers: its run-time parameters without the held values, (p,).
        dnumbers: their derivatives, (p, c).
    """
    mechanism, scalars, _ = symbols(system, mechanism_of(system.robot), {}, make_varying(numbers, dnumbers))
    return Heights(mechanism, scalars.ground)
