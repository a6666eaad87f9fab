"""Overlays of the robot: engaged springs, ground forces, and paths of the toes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.model.robot import Robot
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.coil import Coil, fit_coil, helix, tube
from spear_pin.viz.playback.frames import Frames, Switch
from spear_pin.viz.playback.kinematics import quaternions
from spear_pin.viz.playback.shapes import Shape, frame_along, segment
from spear_pin.viz.playback.stage import WORLD

COIL_COLOR = (1.0, 0.42, 0.0)
ARROW_COLOR = (0.84, 0.0, 0.42)
TRAIL_COLOR = (0.0, 0.60, 0.72)
BRACKET_COLOR = (0.35, 0.37, 0.40, 1.0)
TRAIL_SIDES, TRAIL_POINTS = 4, 1000


@dataclass(frozen=True)
class Overlay:
    """Commands that add something to the scene, and the tracks that move it, by path."""

    commands: tuple[c.Command, ...]
    clips: dict[str, tuple[c.Track, ...]]


def spring_path(parent_path: str, joint: str) -> str:
    """Returns the path of a joint's coil, below the joint before it."""
    return f"{parent_path}/spring of {joint.replace('/', ' ')}"


def spring_overlays(
    robot: Robot, frames: Frames, local: Array, paths: tuple[str, ...], shapes: tuple[Shape, ...]
) -> tuple[list[Overlay], list[Shape]]:
    """Returns the coils, visible while engaged, and the brackets at their ends, which are always visible."""
    overlays, brackets = [], []
    for joint, switch in frames.springs:
        coil = fit_coil(robot, joint, _typical(frames, switch), shapes)
        parent = int(robot.model.parents[coil.joint])
        overlays.append(_spring(spring_path(paths[parent], joint), coil, switch, frames.t, local))
        brackets += _brackets(coil, parent, local)
    return overlays, brackets


def arrow_path(toe: str) -> str:
    """Returns the path of the arrow for the ground force on a toe."""
    return f"{WORLD}/force on {toe.replace('/', ' ')}"


def arrow_overlay(toe: str, t: Array, position: Array, force: Array, scale: float, width: float) -> Overlay:
    """Returns the arrow for the ground force on a toe, from the toe on; hidden while there is no force.

    Args:
        toe: name of the toe.
        t: times of the frames, (m,), in s.
        position: places of the toe, (m, 3), in m.
        force: forces, (m, 3), in N.
        scale: length of the arrow, in m/N.
        width: width of the shaft, in m.
    """
    path = arrow_path(toe)
    length = scale * np.linalg.norm(force, axis=1)
    there = length > 1e-3 * length.max(initial=0.0)
    # a force that sets in between two frames grows from the first of them
    visible = there | np.r_[there[1:], False]
    shown = np.flatnonzero(visible | np.r_[False, visible[:-1]])
    rotations = np.array([frame_along(vector) for vector in force[_nearest(shown, there)]]).reshape(-1, 3, 3)
    head = np.minimum(5.0 * width, 0.5 * length[shown])
    shaft = length[shown] - head
    look = c.material(ARROW_COLOR, "MeshBasicMaterial", depthTest=False, transparent=True)
    upright = np.eye(4)
    upright[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    upright[2, 3] = 0.5
    return Overlay(
        (
            c.set_object(f"{path}/shaft/body", c.cylinder(width / 2, 1.0), look),
            c.set_transform(f"{path}/shaft/body", upright),
            c.set_object(f"{path}/head/body", c.cylinder(0.32, 1.0, top=0.0), look),
            c.set_transform(f"{path}/head/body", upright),
            c.set_property(f"{path}/shaft/body/<object>", "castShadow", False),
            c.set_property(f"{path}/head/body/<object>", "castShadow", False),
            c.set_property(path, "visible", False),
        ),
        {
            path: (*moves(t[shown], position[shown], rotations), _visibility(Switch(t, tuple(visible.tolist())))),
            f"{path}/shaft": stretch(t[shown], np.ones(len(shown)), shaft),
            f"{path}/head": (
                *moves(t[shown], shaft[:, None] * [0.0, 0.0, 1.0]),
                *stretch(t[shown], head, head),
            ),
        },
    )


def trail_path(toe: str) -> str:
    """Returns the scene path of a toe's trail."""
    return f"{WORLD}/path of {toe.replace('/', ' ')}"


def trail_overlay(toe: str, t: Array, position: Array, radius: float, most: int = TRAIL_POINTS) -> Overlay:
    """Returns the trail of a toe, (m, 3), in m, as a thin tube with at most `most` points that grows with time."""
    keep = spread(position, most)
    if len(keep) < 2:
        return Overlay((), {})
    path = trail_path(toe)
    vertices, faces = tube(position[keep] + [0.0, 0.0, radius], radius, TRAIL_SIDES)
    look = c.material((*TRAIL_COLOR, 0.75), "MeshBasicMaterial")
    drawn = np.arange(len(keep)) * TRAIL_SIDES * 6
    count = c.Track("geometry[drawRange].count", "number", t[keep], drawn)
    own = f"{path}/<object>"
    tubing = c.set_object(path, c.triangles(vertices, faces), look)
    return Overlay((tubing, c.set_property(own, "castShadow", False)), {own: (count,)})


def _spring(path: str, coil: Coil, switch: Switch, t: Array, local: Array) -> Overlay:
    length = np.maximum(np.linalg.norm(coil.vectors(local), axis=1), 1e-3)
    vertices, faces = helix(coil, float(np.median(length)))
    look = c.material(COIL_COLOR, shininess=60, specular=0x664433, emissive=0x471C00)
    placement = np.eye(4)
    placement[:3, 3] = coil.start
    shown = np.flatnonzero(_during(t, switch))
    return Overlay(
        (
            c.set_object(path, c.triangles(vertices, faces), look),
            c.set_transform(path, placement),
            c.set_property(path, "visible", switch.values[0]),
        ),
        {
            path: (
                *moves(t[shown], None, coil.rotations(local[shown])),
                *stretch(t[shown], np.ones(len(shown)), length[shown]),
                _visibility(switch),
            )
        },
    )


def _brackets(coil: Coil, parent: int, local: Array) -> list[Shape]:
    across = {parent: coil.side, coil.joint: local[0, coil.joint, :3, :3].T @ coil.side}
    found = []
    for joint, root, end in ((parent, coil.start_root, coil.start), (coil.joint, coil.end_root, coil.end)):
        for shift in coil.shifts if np.linalg.norm(end - root) > 1e-6 else ():
            offset = shift * across[joint]
            found.append(segment(joint, root + offset, end + offset, 1.5 * coil.wire, BRACKET_COLOR))
    return found


def moves(t: Array, position: Array | None, rotations: Array | None = None) -> tuple[c.Track, ...]:
    """Returns tracks of a pose; nothing moves while nothing is shown."""
    tracks = []
    if len(t) and position is not None:
        tracks.append(c.Track("position", "vector3", t, position))
    if len(t) and rotations is not None:
        tracks.append(c.Track("quaternion", "quaternion", t, quaternions(rotations)))
    return tuple(tracks)


def stretch(t: Array, across: Array, along: Array) -> tuple[c.Track, ...]:
    """Returns the track of a scale across and along z; the scale is never zero, which has no inverse."""
    scale = np.maximum(np.column_stack((across, across, along)), 1e-6)
    return (c.Track("scale", "vector3", t, scale),) if len(t) else ()


def _nearest(frames: NDArray[np.intp], chosen: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Returns for each frame the nearest of the chosen frames."""
    among = np.flatnonzero(chosen)
    if not len(among):
        return frames[:0]
    after = np.searchsorted(among, frames).clip(0, len(among) - 1)
    before = np.maximum(after - 1, 0)
    closer = np.abs(among[before] - frames) < np.abs(among[after] - frames)
    return np.asarray(among[np.where(closer, before, after)])


def _during(t: Array, switch: Switch) -> NDArray[np.bool_]:
    """Tells whether a switch is on at each time, or was on until then."""
    values = np.array(switch.values)
    after = values[np.searchsorted(switch.times, t, side="right") - 1]
    before = values[np.maximum(np.searchsorted(switch.times, t, side="left") - 1, 0)]
    return np.asarray(after | before)


def _typical(frames: Frames, switch: Switch) -> Array:
    """Returns a configuration in the middle of those in which a spring is engaged, (nq,)."""
    engaged = np.flatnonzero(_during(frames.t, switch))
    frame = engaged[len(engaged) // 2] if len(engaged) else len(frames.t) // 2
    return np.asarray(frames.q[frame])


def _visibility(switch: Switch) -> c.Track:
    values = np.array(switch.values)
    keep = np.r_[True, values[1:] != values[:-1]]
    return c.Track("visible", "bool", switch.times[keep], values[keep])


def spread(position: Array, most: int) -> NDArray[np.intp]:
    """Returns indices of at most `most` points that lie apart along a path."""
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=1))]
    step = max(along[-1] / most, 2e-3)
    cell = np.floor(along / step)
    return np.flatnonzero(np.r_[True, cell[1:] > cell[:-1]])
