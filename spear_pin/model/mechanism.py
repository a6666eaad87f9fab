"""The equations of motion of a robot for scalars of any kind: in the plane by short formulas, else in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Self

from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot
from spear_pin.model.spatial import Spatial
from spear_pin.model.terms import Feet, Terms


class Mechanism(Protocol):
    """Bodies on joints of one coordinate each, whose numbers and states may be scalars of any kind.

    Attributes:
        coordinates: names of the coordinates.
        nv: number of coordinates.
        toes: of each toe the number of its body, -1 for the world, and its place there.
    """

    coordinates: tuple[str, ...]
    nv: int

    @property
    def toes(self) -> Mapping[str, tuple[int, tuple[Any, ...]]]: ...  # noqa: D102

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Terms:
        """Returns the equations of motion at (q, v); `ops` has `sin` and `cos`."""

    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes alone."""

    def position(self, frame: str, q: Sequence[Any], ops: Any) -> tuple[Any, ...]:
        """Returns the position of any frame of the robot's model, in m."""

    @property
    def numbers(self) -> tuple[Any, ...]:
        """All its numbers: masses, inertias, rotors, placements and places of toes."""

    def with_numbers(self, numbers: Sequence[Any]) -> Self:
        """Returns the mechanism with other numbers, in the order of `numbers`; they may be symbols."""

    @property
    def shape(self) -> Any:
        """All of it but its numbers, and which of these are zero."""


def mechanism_of(robot: Robot) -> Mechanism:
    """Returns the equations of motion of a robot whose joints have one coordinate each.

    Raises:
        BadValue: it has a joint of several coordinates, or is on a rotary boom.
    """
    return Planar(robot) if robot.planar else Spatial(robot)
