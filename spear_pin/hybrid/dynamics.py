"""The seam between control laws and engines: the dynamics where laws are evaluated, and elementary functions.

Scalars are whatever the engine reckons with: numbers, arrays of many lanes, symbols.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from spear_pin.hybrid.contact import solve

Row = Sequence[tuple[int, Any]]
"""A row vector over the coordinates, as (index, weight) of its entries; those of the same index add up."""


@dataclass(frozen=True)
class Operations:
    """Elementary functions of scalars, `ops` of a law.

    Attributes:
        sin, cos, tan, tanh, sqrt, exp: of one scalar.
        atan2, maximum: of two.
        solve: the solution of a small linear system, from rows of the matrix and the right-hand side.
    """

    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    tan: Callable[[Any], Any]
    tanh: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]
    exp: Callable[[Any], Any]
    atan2: Callable[[Any, Any], Any]
    maximum: Callable[[Any, Any], Any]
    solve: Callable[[Any, Any], Any]


FLOATS = Operations(
    sin=math.sin,
    cos=math.cos,
    tan=math.tan,
    tanh=math.tanh,
    sqrt=math.sqrt,
    exp=math.exp,
    atan2=math.atan2,
    maximum=max,
    solve=solve,
)
"""Those of plain numbers."""


class Dynamics(Protocol):
    """The dynamics at (q, v), `dyn` of a law.

    What depends on the motors' torques (`u`, `force`, `toe_acceleration`, `pivot`) is for guards only: a law gives
    them.
    """

    @property
    def u(self) -> Any:
        """Torques of the motors."""

    @property
    def friction_coefficient(self) -> Any:
        """μ of the ground."""

    @property
    def mass_matrix(self) -> Any:
        """D, nv rows of nv."""

    @property
    def bias(self) -> Any:
        """C v + G, nv."""

    def jacobian(self, toe: str) -> Any:
        """J of a toe, rows along the ground, one in the plane and two in space, and normal to it, of nv."""

    def height(self, frame: str) -> Any:
        """Distance of a frame from the ground, along its normal, in m."""

    def direction(self, toe: str, mode: str) -> tuple[Any, ...]:
        """Unit vector along the ground in which a toe slides, by its mode."""

    def toe_velocity(self, toe: str) -> tuple[Any, ...]:
        """Velocity of a toe, along the ground and normal to it, in m/s."""

    def toe_acceleration(self, toe: str) -> tuple[Any, ...]:
        """Acceleration of a toe, along the ground and normal to it, in m/s²."""

    def force(self, toe: str) -> tuple[Any, ...]:
        """Ground force on a toe, along the ground and normal to it, in N."""

    def pivot(self, toe: str) -> Any:
        """Effective inverse mass of the normal force of a slipping toe, in 1/kg."""

    def spring_torque(self, joint: str) -> Any:
        """Torque of the joint's spring, in N·m; 0 where none is engaged."""

    def normal_force(self, toe: str, u: Sequence[Any]) -> Any:
        """Normal force that motor torques would give with the toes on the ground at rest, in N: affine in them."""

    def response(self) -> tuple[Sequence[Any], Sequence[Sequence[Any]]]:
        """(a, A) with v̇ = a + A u with the toes on the ground at rest: nv, and nv rows of nu."""

    def imposing(
        self, rows: Sequence[Row], wanted: Sequence[Any], motors: Sequence[int], others: Sequence[tuple[int, Any]]
    ) -> Sequence[Any]:
        """Torques of some motors that make rows · v̇ = wanted with the toes on the ground at rest.

        Args:
            rows: over the coordinates.
            wanted: what the rows times v̇ shall be.
            motors: columns of those motors, as many as rows.
            others: columns and torques of all other motors.
        """
