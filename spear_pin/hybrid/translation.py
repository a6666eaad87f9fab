"""Translation along the ground, on which the dynamics do not depend: its directions over the coordinates."""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.ground import Ground
from spear_pin.model.planar import Planar

VERTICAL = 1e-12  # largest horizontal part of a vertical slider's direction


def translations(system: HybridSystem, ground: Ground | None = None) -> Array:
    """Returns the unit directions over the coordinates along which a motion may be moved, (k, nv).

    There is one for each cyclic coordinate. On level ground the direction is the coordinate itself; on a slope the
    robot has to be lifted with it.

    Args:
        system: the system.
        ground: replaces the system's ground; if n lanes have their own slopes, directions are (n, k, nv).

    Raises:
        BadValue: the ground is sloped, and no coordinate lifts the robot as a whole.
    """
    robot, ground = system.robot, ground or system.ground
    rows = np.eye(robot.nv)[[robot.index(name) for name in system.cyclic]]
    if ground.level or not system.cyclic:
        return rows
    slope = np.asarray(ground.slope)[..., None, None]
    return np.asarray(np.cos(slope) * rows + np.sin(slope) * np.eye(robot.nv)[_lift(system)], np.float64)


def without(rows: Array, motion: Array) -> Array:
    """Returns displacements over the coordinates, (..., nv), without their parts along unit rows, (..., k, nv)."""
    for row in np.moveaxis(rows, -2, 0):
        motion = motion - (motion * row).sum(axis=-1, keepdims=True) * row
    return motion


def _lift(system: HybridSystem) -> int:
    """Returns the index of the coordinate that lifts the robot as a whole."""
    bodies = Planar(system.robot).bodies
    for i, body in enumerate(bodies):
        trunk, parent = body.turns == 0.0, body.parent
        while trunk and parent >= 0:
            trunk, parent = bodies[parent].turns == 0.0, bodies[parent].parent
        if trunk and abs(body.slides[0]) < VERTICAL and body.slides[1] > 0.0:
            return i
    raise BadValue("cyclic", system.cyclic, "level ground, for no coordinate lifts this robot along a slope")
