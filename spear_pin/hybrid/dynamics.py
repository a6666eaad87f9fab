"""The interface between control laws and engines: the dynamics at a state, and elementary functions.

Scalars are of the engine's kind: numbers, arrays of many lanes, symbols.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from spear_pin.hybrid.contact import solve
from spear_pin.hybrid.pull import Pull

Row = Sequence[tuple[int, Any]]
"""A row vector over the coordinates, as (index, weight) of its entries; those of the same index add up."""


@dataclass(frozen=True)
class Operations:
    """Elementary functions of scalars, `ops` of a law.

    Attributes:
        sin, cos, tan, tanh, sqrt, exp: functions of one scalar.
        atan2, maximum: functions of two scalars.
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

    Only guards may use what depends on the motor torques (`u`, `force`, `toe_acceleration`, `pivot`), for the law
    determines these torques.
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
        """Returns J of a toe: one row of nv along the ground in the plane, two in space, and one normal to it."""

    @property
    def loop_jacobian(self) -> Any:
        """A of the closed loops, rows of nv; none without loops."""

    def height(self, frame: str) -> Any:
        """Returns the distance of a frame from the ground, along its normal, in m."""

    def direction(self, toe: str) -> tuple[Any, ...]:
        """Returns the unit vector along which a toe slides in space; in the plane its mode gives the direction."""

    def toe_velocity(self, toe: str) -> tuple[Any, ...]:
        """Returns the velocity of a toe, along the ground and normal to it, in m/s."""

    def toe_acceleration(self, toe: str) -> tuple[Any, ...]:
        """Returns the acceleration of a toe, along the ground and normal to it, in m/s²."""

    def force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on a toe, along the ground and normal to it, in N."""

    def foot_force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on all toes of a toe's body, along the ground and normal to it, in N."""

    def pivot(self, toe: str) -> Any:
        """Returns the effective inverse mass of the normal force of a slipping toe, in 1/kg."""

    def spring_torque(self, joint: str) -> Any:
        """Returns the torque of all engaged springs on a joint, in N·m; 0 where none is engaged."""

    def stretch(self, name: str) -> Any:
        """Returns how much longer an engaged spring's path is than at rest, in rad or m, by the name of its mount."""

    def pull(self, name: str) -> Pull:
        """Returns what an engaged spring does, by the name of its mount: its stretch, its rate, its numbers."""

    def normal_force(self, toe: str, u: Sequence[Any]) -> Any:
        """Returns the normal force that motor torques would give with the toes on the ground at rest, in N.

        The force is affine in the torques.
        """

    def imposing(
        self, rows: Sequence[Row], wanted: Sequence[Any], motors: Sequence[int], others: Sequence[tuple[int, Any]]
    ) -> Sequence[Any]:
        """Finds torques of some motors that make rows · v̇ = wanted with the toes on the ground at rest.

        Args:
            rows: rows over the coordinates.
            wanted: wanted values of the rows times v̇.
            motors: columns of these motors, as many as rows.
            others: columns and torques of all other motors.
        """
