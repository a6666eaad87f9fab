"""Cables of springs in the picture: from point to point, over their pulleys, in a colour that tells their pull."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.model.cable import Over
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import RobotPosture, find_carrier
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.coil import link_end, places_across
from spear_pin.viz.playback.frames import Cable, Frames
from spear_pin.viz.playback.overlays import BRACKET_COLOR, Overlay, moves, stretch
from spear_pin.viz.playback.shapes import Shape, frame_along, segment
from spear_pin.viz.playback.stage import WORLD

SLACK_COLOR = (0.42, 0.46, 0.52)
LEAST_COLOR, MOST_COLOR = (1.0, 0.66, 0.20), (0.80, 0.07, 0.05)  # of a small pull and of the largest
# of the robot's height: radii of a cable and of its ends, and half the width of a pulley
THIN, END, HALF = 0.006, 0.011, 0.008
PULLS = 1e-3  # of the largest pull: less is slack
PULLEY_COLOR = (0.50, 0.53, 0.57, 1.0)
SIDEWAYS, UPWARD = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


def cable_path(name: str) -> str:
    """Returns the scene path of a spring's cable."""
    return f"{WORLD}/cable of {name.replace('/', ' ')}"


def cable_overlays(robot: Robot, frames: Frames, shapes: tuple[Shape, ...], size: float) -> list[Overlay]:
    """Returns the cables of springs.

    Args:
        robot: the robot.
        frames: motion of the robot.
        shapes: shapes of the links, which tell where a pair of legs is.
        size: height of the robot, in m.
    """
    posture, found = RobotPosture(robot, FLOATS), []
    for cable in frames.cables:
        line = np.array([cable.path.course(posture.at(q)) for q in frames.q])
        for side, place in _places(robot, cable, shapes).items():
            found.append(_drawn(cable_path(cable.name + side), line + place * SIDEWAYS, cable, frames.t, THIN * size))
    return found


def fittings(robot: Robot, frames: Frames, shapes: tuple[Shape, ...], size: float) -> list[Shape]:
    """Returns what holds cables, see `cable_overlays`: their ends, with brackets to the links, and their pulleys."""
    found = []
    for cable in frames.cables:
        for place in _places(robot, cable, shapes).values():
            for name, anchor in cable.path.anchors().items():
                joint, at = find_carrier(robot, anchor)
                at = at + place * SIDEWAYS
                if isinstance(cable.path, Over) and name == "centre":
                    half = HALF * size * SIDEWAYS
                    found.append(segment(joint, at - half, at + half, cable.path.radius - THIN * size, PULLEY_COLOR))
                    continue
                placement = np.eye(4)
                placement[:3, 3] = at
                found.append(Shape(joint, "sphere", (END * size,), placement, BRACKET_COLOR))
                root = _root(robot, joint, at)
                if joint and np.linalg.norm(at - root) > END * size:
                    found.append(segment(joint, root, at, 0.6 * END * size, BRACKET_COLOR))
    return found


def tints(pull: Array, acts: NDArray[np.bool_]) -> Array:
    """Returns the colours of a cable, (m, 3): by how it pulls, and grey where it is slack or not engaged.

    Args:
        pull: force over the largest, (m,).
        acts: whether its spring is engaged, (m,).
    """
    share = np.clip(np.abs(pull), 0.0, 1.0)[:, None]
    taut = (1.0 - share) * np.array(LEAST_COLOR) + share * np.array(MOST_COLOR)
    return np.where(acts[:, None] & (share > PULLS), taut, np.array(SLACK_COLOR))


def _drawn(path: str, line: Array, cable: Cable, t: Array, radius: float) -> Overlay:
    """Returns a cylinder for each piece of a line, (m, k, 3), in m, all in the colour of the pull."""
    colors = tints(cable.pull, cable.acts)
    changes = np.flatnonzero(_changes(colors))
    upright = np.eye(4)
    upright[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    upright[2, 3] = 0.5
    look = c.material(colors[0], shininess=50, specular=0x444444)
    commands, clips = list[c.Command](), dict[str, tuple[c.Track, ...]]()
    for i, (starts, ends) in enumerate(_pieces(line)):
        piece, vectors = f"{path}/{i}", ends - starts
        lengths = np.maximum(np.linalg.norm(vectors, axis=1), 1e-6)
        rotations = np.array([frame_along(vector if vector.any() else UPWARD, SIDEWAYS) for vector in vectors])
        own = f"{piece}/body/<object>"
        commands += [
            c.set_object(f"{piece}/body", c.cylinder(radius, 1.0), look),
            c.set_transform(f"{piece}/body", upright),
        ]
        clips[piece] = (*moves(t, starts, rotations), *stretch(t, np.ones(len(t)), lengths))
        clips[own] = (c.Track("material.color", "color", t[changes], colors[changes]),)
    return Overlay(tuple(commands), clips)


def _pieces(line: Array) -> Iterator[tuple[Array, Array]]:
    """Lists both ends of each piece of a line over time, (m, 3) each."""
    return zip(line.swapaxes(0, 1)[:-1], line.swapaxes(0, 1)[1:], strict=True)


def _changes(values: Array) -> NDArray[np.bool_]:
    """Tells at which frames values differ from those before or after, or are the first or the last."""
    differs = np.any(values[1:] != values[:-1], axis=1)
    return np.asarray(np.r_[True, differs] | np.r_[differs, True])


def _places(robot: Robot, cable: Cable, shapes: tuple[Shape, ...]) -> dict[str, float]:
    """Returns where along y a cable is drawn, in m, by what its name gets.

    In the plane that is the middle of its last link, of both of a pair; in space it is the cable's own place.
    """
    joints = [joint for each in cable.path.anchors().values() if (joint := find_carrier(robot, each)[0])]
    if not robot.planar:
        return {"": 0.0}
    places = places_across(shapes, joints[-1], SIDEWAYS)
    return dict(zip(("",) if len(places) == 1 else (" right", " left"), places, strict=True))


def _root(robot: Robot, joint: int, at: Array) -> Array:
    """Returns the point of a link's middle line that is nearest to a place on the link, (3,), in m."""
    end = link_end(robot, joint) if joint else at
    share = float(np.clip(at @ end / (end @ end), 0.0, 1.0)) if end @ end > 0 else 0.0
    return np.asarray(share * end + [0.0, at[1] - share * end[1], 0.0])
