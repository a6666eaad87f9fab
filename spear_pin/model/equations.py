"""Chooses the equations of motion of a robot for scalars of any kind: in the plane short formulas, else in space."""

from __future__ import annotations

from functools import lru_cache

from spear_pin.model.mechanism import Mechanism
from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot
from spear_pin.model.spatial import Spatial

REMEMBERED = 16  # robots: derivatives by the numbers of one ask for its equations again and again


@lru_cache(maxsize=REMEMBERED)
def mechanism_of(robot: Robot) -> Mechanism:
    """Returns the equations of motion of a robot whose joints have one coordinate each.

    Raises:
        BadValue: it has a joint of several coordinates, or is on a rotary boom.
    """
    return Planar(robot) if robot.planar else Spatial(robot)
