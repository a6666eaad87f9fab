"""Marks of a robot on the ground in space: the way of its torso, and footprints where its toes came down."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.model.robot import Robot
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.following import base_joint
from spear_pin.viz.playback.footfalls import contacts, footfalls
from spear_pin.viz.playback.frames import Frames
from spear_pin.viz.playback.overlays import Overlay, spread
from spear_pin.viz.playback.stage import WORLD

WAY = f"{WORLD}/way of the torso"
WAY_COLOR = (0.48, 0.36, 0.70)  # seen by day and by night
WAY_POINTS, CORNERS = 600, 14
# of the robot's height: half the width of the way, the radius of a footprint
NARROW, ROUND = 0.012, 0.035
LOW, HIGHER = 1.0e-3, 2.0e-3  # m above the ground, so that what lies there is seen
AT_ONCE = 1e-4  # s


def footprints_path(toe: str) -> str:
    """Returns the path of the footprints of a toe."""
    return f"{WORLD}/footprints of {toe.replace('/', ' ')}"


def track_overlays(
    robot: Robot, frames: Frames, world: Array, toes: Mapping[str, Array], size: float
) -> dict[str, Overlay]:
    """Returns the tracks of a robot that moves in space, by path; none for a planar one.

    Args:
        robot: the robot.
        frames: motion of the robot.
        world: poses of its joints, (m, joints, 4, 4).
        toes: places of each of its toes, (m, 3), in m.
        size: height of the robot, in m.
    """
    base = base_joint(robot.model)
    if base is None or not frames.ground.plain:
        return {}
    tracks = {WAY: _way(frames.t, world[:, base, :2, 3], NARROW * size)}
    for toe, (named, landed, place) in landings(robot, frames, toes).items():
        path, color = footprints_path(toe), [int(named[at : at + 2], 16) / 255 for at in (1, 3, 5)]
        tracks[path] = _prints(path, frames.t[landed], place, ROUND * size, color)
    return tracks


def landings(robot: Robot, frames: Frames, toes: Mapping[str, Array]) -> dict[str, tuple[str, NDArray[np.intp], Array]]:
    """Returns each toe's colour, the frames in which it came down, and where, (k, 2), in m; see `track_overlays`."""
    found = {}
    for number, each in enumerate(footfalls(robot.toes, frames.t, frames.force)):
        landed = np.array([first for first, _ in contacts(frames.force[:, number])], dtype=np.intp)
        found[each.toe] = (each.color, landed, toes[each.toe][landed, :2])
    return found


def _way(t: Array, place: Array, half: float) -> Overlay:
    """Returns a flat stripe along places, (m, 2), in m, that grows with time."""
    keep = spread(np.column_stack((place, np.zeros(len(place)))), WAY_POINTS)
    if len(keep) < 2:
        return Overlay((), {})
    ahead = np.gradient(place[keep], axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    across = half * np.column_stack((-ahead[:, 1], ahead[:, 0]))
    sides = np.stack((place[keep] + across, place[keep] - across), axis=1).reshape(-1, 2)
    here = 2 * np.arange(len(keep) - 1)
    faces = np.stack((here, here + 1, here + 3, here, here + 3, here + 2), axis=1).reshape(-1, 3)
    return _flat(WAY, sides, LOW, faces, (*WAY_COLOR, 0.85), t[keep], 6 * np.arange(len(keep)))


def _prints(path: str, t: Array, place: Array, radius: float, color: Sequence[float]) -> Overlay:
    """Returns discs at places, (k, 2), in m, each visible from its time on."""
    if not len(t):
        return Overlay((), {})
    angle = 2 * np.pi * np.arange(CORNERS) / CORNERS
    rim = radius * np.column_stack((np.cos(angle), np.sin(angle)))
    corners = (place[:, None] + rim).reshape(-1, 2)
    middle = np.arange(1, CORNERS - 1)
    fan = np.column_stack((np.zeros_like(middle), middle, middle + 1))
    faces = (fan + CORNERS * np.arange(len(t))[:, None, None]).reshape(-1, 3)
    count = 3 * len(fan) * np.arange(len(t) + 1)
    times = np.concatenate(([0.0], np.column_stack((t - AT_ONCE, t)).ravel()))
    drawn = np.concatenate(([0], np.column_stack((count[:-1], count[1:])).ravel()))
    return _flat(path, corners, HIGHER, faces, (*color, 0.85), np.maximum(times, 0.0), drawn)


def _flat(
    path: str,
    corners: Array,
    height: float,
    faces: NDArray[np.intp],
    color: Sequence[float],
    t: Array,
    drawn: NDArray[np.integer[Any]],
) -> Overlay:
    """Returns a mesh on the ground; from each time on a given number of corners of faces is drawn."""
    mesh = c.triangles(np.column_stack((corners, np.full(len(corners), height))), faces)
    own = f"{path}/<object>"
    count = c.Track("geometry[drawRange].count", "number", t, drawn)
    put = c.set_object(path, mesh, c.material(color, "MeshBasicMaterial"))
    return Overlay((put, c.set_property(own, "castShadow", False)), {own: (count,)})
