"""Where all toes are above the ground, and how they move, compiled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.engines.structure import Structure, symbols
from spear_pin.hybrid.engines.taylor import MOST, operations, require
from spear_pin.hybrid.own import FOR_SYMBOLS, not_symbolic
from spear_pin.model.mechanism import Feet
from spear_pin.model.scalars import dot


class CompiledFeet:
    """The toes' distances from the ground, and their velocities.

    Args:
        structure: structure of the system.
        level: level of LLVM's optimisation.

    Raises:
        NotSymbolic: the ground does not take symbols.
    """

    def __init__(self, structure: Structure, level: int) -> None:
        hy, robot, ops = require(), structure.system.robot, operations([])
        state = hy.make_vars(*[f"{kind}_{name}" for kind in "qv" for name in robot.coordinates])
        mechanism, numbers, _ = symbols(structure.system, structure.mechanism, {}, hy.par)
        q, v = state[: robot.nv], state[robot.nv :]
        feet = mechanism.feet(q, v, ops)
        try:
            feet = numbers.ground.seen(feet, ops)
        except FOR_SYMBOLS as error:
            raise not_symbolic("the ground", numbers.ground.above, error) from error
        outputs = [hy.expression(0.0) + value for toe in robot.toes for value in self._of_toe(feet, toe, v)]
        self._shape = len(robot.toes), 1 + robot.dimension
        self._function = hy.cfunc(outputs, state, opt_level=level) if outputs else None

    @staticmethod
    def _of_toe(feet: Feet, toe: str, v: Sequence[Any]) -> Iterator[Any]:
        """Yields a toe's distance from the ground, and its velocity."""
        yield feet.positions[toe][-1]
        yield from (dot(row, v) for row in feet.jacobians[toe])

    def __call__(self, y: Array, parameters: Array) -> tuple[Array, Array]:
        """Evaluates the toes at one state or at n states.

        Args:
            y: the states, (2 nv,) or (2 nv, n).
            parameters: run-time parameters, (p,) or (p, n).

        Returns:
            distances from the ground in m, (toes,) or (toes, n).
            velocities along the ground and normal to it, in m/s, (toes, 2 or 3) or (toes, 2 or 3, n).
        """
        toes = np.zeros((*self._shape, *y.shape[1:]))
        if self._function is not None:  # the robot has toes
            y, pars = np.ascontiguousarray(y), np.ascontiguousarray(parameters[: self._function.nparams])
            toes = (self._function(y, pars=pars) if len(pars) else self._function(y)).reshape(toes.shape)
        return toes[:, 0], toes[:, 1:]


@lru_cache(MOST)
def compile_feet(structure: Structure, level: int) -> CompiledFeet:
    """Compiles the toes' motion, once for each structure."""
    return CompiledFeet(structure, level)
