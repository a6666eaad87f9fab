"""Directional derivatives of a domain's motion and of an impact's numbers, at many states and in many directions.

Each domain has one function, which heyoka compiles where it is installed. Dual numbers of heyoka's expressions pass
through the same `Motion` that is integrated. Every number is an argument, so that one function serves all derivatives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.dual import (
    ARRAYS,
    Dual,
    derivative_of,
    derivatives,
    duals,
    make_varying,
    operations,
    solve_all,
    value_of,
)
from spear_pin.hybrid.dynamics import Operations
from spear_pin.hybrid.elimination import Matrix, eliminate, responses
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.structure import Structure, symbols
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.tangent import seeds
from spear_pin.hybrid.tangent.terms import ArrayMechanism
from spear_pin.model.equations import mechanism_of
from spear_pin.model.mechanism import Mechanism
from spear_pin.model.path import Joints
from spear_pin.model.robot_posture import row_along
from spear_pin.model.scalars import dot

NONE = np.empty(0)  # of a robot without loops


class Values(NamedTuple):
    """The values of a domain at a state, or their derivatives.

    Attributes:
        rows: all values, (rows, ...).
        ends: rows at which the first three of the four parts end.
    """

    rows: Array
    ends: tuple[int, int, int]

    @property
    def slopes(self) -> Array:
        """dy/dt, (2 nv, ...)."""
        return self.rows[: self.ends[0]]

    @property
    def guards(self) -> Array:
        """Values of its guards, (g, ...)."""
        return self.rows[self.ends[0] : self.ends[1]]

    @property
    def u(self) -> Array:
        """Torques of the motors, (nu, ...)."""
        return self.rows[self.ends[1] : self.ends[2]]

    @property
    def forces(self) -> Array:
        """Ground force on each closed toe, along the ground and normal to it, in N; 2 or 3 rows a toe."""
        return self.rows[self.ends[2] :]


@dataclass(frozen=True, eq=False)
class TangentField:
    """Motion, guards, torques and forces of a domain, each with a derivative along any direction.

    Attributes:
        structure: the structure that is compiled in.
    """

    structure: Structure

    def at(self, t: Array, y: Array, numbers: Array, dt: Any, dy: Array, dnumbers: Array) -> tuple[Values, Values]:
        """Returns values at n states, (..., n), and derivatives along c directions at each, (..., n, c).

        Args:
            t: times since the phase began, in s, (n,).
            y: states, (2 nv, n).
            numbers: run-time parameters with the held values, (p,).
            dt: derivative of the time, a number, (c,) or (n, c).
            dy: derivatives of the states, (2 nv, n, c), or (2 nv, 1, c) where they are all the same.
            dnumbers: derivatives of the parameters, (p, c).
        """
        rows, n, c = len(y), len(t), dy.shape[2]
        if not compiles(self.structure):
            return self._interpreted(t, y, numbers, dt, dy, dnumbers)
        inputs = np.empty((2 * (1 + rows + len(numbers)), n, c))
        half = len(inputs) // 2
        inputs[0], inputs[1 : 1 + rows], inputs[1 + rows : half] = t[:, None], y[:, :, None], numbers[:, None, None]
        inputs[half], inputs[half + 1 : half + 1 + rows], inputs[half + 1 + rows :] = dt, dy, dnumbers[:, None, :]
        found = self._function(inputs.reshape(len(inputs), -1)).reshape(-1, n, c)
        half = len(found) // 2
        return Values(found[:half, :, 0], self._ends), Values(found[half:], self._ends)

    def values(self, t: Array, y: Array, numbers: Array) -> Values:
        """Returns values at n states, each with its own numbers, (p, n), without derivatives; this needs heyoka."""
        inputs = np.concatenate([t[None], y, numbers])
        found = self._function(np.concatenate([inputs, np.zeros_like(inputs)]))
        return Values(found[: len(found) // 2], self._ends)

    @cached_property
    def _ends(self) -> tuple[int, int, int]:
        robot, guards = self.structure.system.robot, len(self.structure.domain.guards)
        return 2 * robot.nv, 2 * robot.nv + guards, 2 * robot.nv + guards + robot.nu

    @cached_property
    def _mechanism(self) -> Mechanism:
        return mechanism(self.structure)

    @cached_property
    def _function(self) -> Any:
        """Compiles the function that returns values, then derivatives."""
        system, held = self.structure.system, flatten(self.structure.held.values())
        count = 1 + 2 * system.robot.nv + len(seeds.numbers(system)) + len(held)
        return compile_function(self._of, count, system.robot.nv)

    def _of(self, duals: Sequence[Any], ops: Operations) -> list[Any]:
        """Returns all outputs, for scalars of any kind."""
        system, domain, nv = self.structure.system, self.structure.domain, self.structure.system.robot.nv
        t, q, v = duals[0], duals[1 : 1 + nv], duals[1 + nv : 1 + 2 * nv]
        mechanism, numbers, held = symbols(system, self._mechanism, self.structure.held, duals[1 + 2 * nv :])
        motion = Motion(system, domain, mechanism, t, q, v, held, numbers, ops)
        feet = [force for toe, _ in closed_toes(system.robot.toes, domain) for force in motion.force(toe)]
        return [*v, *motion.a, *motion.guards, *motion.u, *feet]

    def _interpreted(
        self, t: Array, y: Array, numbers: Array, dt: Any, dy: Array, dnumbers: Array
    ) -> tuple[Values, Values]:
        """Returns what `at` returns, without heyoka, from arrays; what does not change has no derivative."""
        n, c = len(t), dy.shape[2]
        parts: list[Any] = [Dual(t[:, None], np.broadcast_to(dt, (n, c)))]
        parts += [Dual(x[:, None], d) for x, d in zip(y, dy, strict=True)]
        parts += make_varying(numbers, dnumbers)
        outputs = self._of(parts, ARRAYS)
        values = np.array([np.broadcast_to(value_of(each), (n, 1))[:, 0] for each in outputs])
        slopes = np.array([np.broadcast_to(derivative_of(each), (n, c)) for each in outputs])
        return Values(values, self._ends), Values(slopes, self._ends)


@dataclass(frozen=True, eq=False)
class TangentFeet:
    """Numbers of toes and of the mass matrix on which impacts and sections depend, with derivatives.

    Attributes:
        structure: structure of the system.
        toes: names of the toes.
        grips: paths that brakes bring to rest before the toes strike.
    """

    structure: Structure
    toes: tuple[str, ...]
    grips: tuple[Joints, ...] = ()

    def at(self, y: Array, numbers: Array, dy: Array, dnumbers: Array) -> tuple[ToeNumbers, ToeNumbers]:
        """Returns the numbers at a state, and their derivatives along c directions, (..., c).

        Args:
            y: the state, (2 nv,).
            numbers: run-time parameters without the held values, (p,).
            dy: derivatives of the state, (2 nv, c).
            dnumbers: derivatives of the parameters, (p, c).
        """
        x, d = np.concatenate([y, numbers]), np.concatenate([dy, dnumbers])
        if not compiles(self.structure):
            outputs = self._of(duals(x, d), ARRAYS, solve_all)
            values = np.array([value_of(each) for each in outputs])
            return self._named(values), self._named(derivatives(outputs, d.shape[1]))
        found = self._function(np.concatenate([np.repeat(x[:, None], d.shape[1], axis=1), d]))
        half = len(found) // 2
        return self._named(found[:half, 0]), self._named(found[half:])

    def _named(self, rows: Array) -> ToeNumbers:
        rest = rows.shape[1:]
        return ToeNumbers(rows[0], *(rows[part].reshape(*shape, *rest) for part, shape in self._parts))

    @cached_property
    def _mechanism(self) -> Mechanism:
        return mechanism(self.structure)

    @cached_property
    def _parts(self) -> list[tuple[slice, tuple[int, ...]]]:
        """Place among the outputs, and shape, of each of `ToeNumbers` except the first."""
        robot, m = self.structure.system.robot, len(self.toes)
        nv, k, loops = robot.nv, robot.dimension, 0 if robot.closure is None else robot.closure.size
        shapes: list[tuple[int, ...]] = [(m,), (m, k, nv), (m, k, nv), (k * m, k * m), (k * m,)]
        shapes += [(loops,), (loops, nv), (nv,)]
        ends = np.cumsum([1, *map(math.prod, shapes)]).tolist()
        return [(slice(i, j), shape) for i, j, shape in zip(ends[:-1], ends[1:], shapes, strict=True)]

    @cached_property
    def _function(self) -> Any:
        system = self.structure.system
        return compile_function(self._of, 2 * system.robot.nv + len(seeds.numbers(system)), system.robot.nv)

    def _of(
        self, duals: Sequence[Any], ops: Operations, solved: Callable[[Matrix, Matrix], Matrix] = eliminate
    ) -> list[Any]:
        nv = self.structure.system.robot.nv
        mechanism, numbers, _ = symbols(self.structure.system, self._mechanism, {}, duals[2 * nv :])
        terms = mechanism.terms(duals[:nv], duals[nv : 2 * nv], ops)
        feet = numbers.ground.seen(terms, ops)
        rows = [row for toe in self.toes for row in feet.jacobians[toe]]
        grips = [row_along(path, self.structure.system.robot).tolist() for path in self.grips]
        moved, v = responses(terms, rows, solved, grips), list(duals[nv : 2 * nv])
        after = v
        if grips:
            momentum = [dot(row, v) for row in terms.mass_matrix]
            after = responses(terms, [momentum], solved, grips)[0]
        outputs = [numbers.ground.friction, *(feet.positions[toe][-1] for toe in self.toes)]
        outputs += [number for each in (rows, moved) for row in each for number in row]
        outputs += [dot(row, response) for row in rows for response in moved]
        outputs += [dot(row, after) for row in rows]
        outputs += [*terms.loop_gaps, *(number for row in terms.loop_rows for number in row)]
        return [*outputs, *(one - other if grips else 0.0 for one, other in zip(after, v, strict=True))]


class ToeNumbers(NamedTuple):
    """Numbers of m toes with k axes each, or their derivatives; k is 2 in the plane and 3 in space.

    Attributes:
        friction: the coefficient of friction.
        heights: heights of the toes, in m, (m, ...).
        rows: rows of their Jacobians, along the ground and normal to it, (m, k, nv, ...).
        responses: velocities for unit impulses along those rows, see `elimination.responses`, (m, k, nv, ...).
        inverse_inertia: J times these, of all toes together, (k m, k m, ...).
        speeds: J v, (k m, ...), after brakes have gripped.
        gaps: φ of the robot's loops, (l, ...).
        loops: A of these, (l, nv, ...).
        braked: change of velocity as brakes grip, (nv, ...).
    """

    friction: Any
    heights: Array
    rows: Array
    responses: Array
    inverse_inertia: Array
    speeds: Array
    gaps: Array = NONE
    loops: Array = NONE
    braked: Any = 0.0


def compile_function(of: Callable[[Sequence[Any], Operations], list[Any]], count: int, nv: int) -> Any:
    """Compiles a function that takes inputs, then their derivatives, and returns values, then their derivatives.

    Args:
        of: the function, for scalars and operations of any kind.
        count: number of its inputs.
        nv: number of the robot's velocities.
    """
    hy = taylor.require()
    variables = hy.make_vars(*[f"{kind}{i}" for kind in "xd" for i in range(count)])
    duals = [Dual(x, d) for x, d in zip(variables[:count], variables[count:], strict=True)]
    outputs, zero = of(duals, operations(taylor.operations([]), hy.relup)), hy.expression(0.0)
    rows = [zero + part(each) for part in (value_of, derivative_of) for each in outputs]
    return hy.cfunc(rows, variables, compact_mode=nv > taylor.UNROLLED, opt_level=taylor.LEVEL)


def compiles(structure: Structure) -> bool:
    """Tells whether derivatives of a structure are compiled: not in space, where that takes longer than many cycles."""
    return taylor.available() and structure.system.robot.planar and not structure.system.pins


def mechanism(structure: Structure) -> Mechanism:
    """Returns the mechanism that is differentiated: itself compiled, where a whole domain is not."""
    plain = structure.mechanism
    return ArrayMechanism(plain) if taylor.available() and not compiles(structure) else plain


@lru_cache(taylor.MOST)
def tangent_field(structure: Structure) -> TangentField:
    """Returns the tangent field of a domain, made once for each structure."""
    return TangentField(structure)


def field_of(system: HybridSystem, domain: Domain, held: Mapping[str, Any]) -> TangentField:
    """Returns the tangent field of one of a system's domains, with the values that are held there."""
    return tangent_field(Structure(system, domain, held, mechanism_of(system.robot)))


@lru_cache(taylor.MOST)
def tangent_feet(structure: Structure, toes: tuple[str, ...], grips: tuple[Joints, ...] = ()) -> TangentFeet:
    """Returns the tangent feet of a system, made once for each structure and choice of toes and brakes."""
    return TangentFeet(structure, toes, grips)
