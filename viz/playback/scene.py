"""The whole scene: the robot's links in their tree, its overlays, and the stage around them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.hybrid.ground import Ground
from spear_pin.model.robot import Robot
from spear_pin.viz.playback import meshcat_commands as c
from spear_pin.viz.playback.cables import cable_overlays, fittings
from spear_pin.viz.playback.coil import places_across
from spear_pin.viz.playback.following import base_joint, follow
from spear_pin.viz.playback.frames import Frames
from spear_pin.viz.playback.kinematics import center_of_mass, local_poses, quaternions, world_poses
from spear_pin.viz.playback.looks import read_looks
from spear_pin.viz.playback.overlays import (
    TRAIL_POINTS,
    Overlay,
    arrow_overlay,
    arrow_path,
    spring_overlays,
    trail_overlay,
    trail_path,
)
from spear_pin.viz.playback.shapes import Shape
from spear_pin.viz.playback.stage import WORLD, View, fit_view, stage
from spear_pin.viz.playback.tracks import landings, track_overlays

ROBOT = f"{WORLD}/robot"
GHOST = f"{WORLD}/ghost"
REVOLUTE = "JointModelR"  # about an axis of the frame or any other; not those without limits, that have two numbers


@dataclass(frozen=True)
class Scene:
    """Scene for a viewer.

    Attributes:
        commands: objects, places and properties.
        clips: tracks by path, times in s from the start.
        view: view of the camera.
        peak_force: force of the longest arrow, a ground force on a foot, in N; each foot of a pair has half.
        paired: whether some legs are pairs.
        notes: one line for each part that is not drawn.
        follows: whether the picture moves with the robot.
        turns: whether the picture turns with the robot.
        arrows: path, toe and share of the toe's force for each arrow of a ground force.
        newtons: newtons per metre of an arrow.
        trails: paths in the scene of the toes' trails.
        tracks: paths in the scene of what stays on the ground in space: the way of the torso, the footprints.
        prints: x and y, in m, and colour of each footprint.
        joints: path of each joint with one angle, by its name.
    """

    commands: tuple[c.Command, ...]
    clips: Mapping[str, tuple[c.Track, ...]]
    view: View
    peak_force: float = 0.0
    paired: bool = False
    notes: tuple[str, ...] = ()
    follows: bool = False
    turns: bool = False
    arrows: tuple[tuple[str, str, float], ...] = ()
    newtons: float = 0.0
    trails: tuple[str, ...] = ()
    tracks: tuple[str, ...] = ()
    prints: tuple[tuple[float, float, str], ...] = ()
    joints: Mapping[str, str] = field(default_factory=dict)


def joint_paths(model: pin.Model, root: str = ROBOT) -> tuple[str, ...]:
    """Returns the path of each joint in the viewer, each below its parent's; the world's, `root`, at index 0."""
    paths = [root]
    for joint in range(1, model.njoints):
        paths.append(f"{paths[model.parents[joint]]}/{joint} {model.names[joint].replace('/', ' ')}")
    return tuple(paths)


def still(robot: Robot, q: Array) -> Scene:
    """Returns the scene of a robot standing still in a configuration, (nq,)."""
    looks, paths = read_looks(robot), joint_paths(robot.model)
    local = local_poses(robot.model, q[None])
    world = world_poses(robot.model, local)
    following = follow(robot.model, np.zeros(1), world, center_of_mass(robot.model, world))
    place, seen = following.place[0], following.poses
    view = fit_view(*_bounds(robot.model, looks.shapes, world, seen))
    placed = c.set_transform(WORLD, seen[0])
    commands = [placed, *_body(paths, local[0], looks.shapes), *stage(view, place, place, Ground())]
    return Scene(tuple(commands), {}, view, notes=looks.notes)


def moving(robot: Robot, frames: Frames, ghost: Frames | None = None, newtons: float | None = None) -> Scene:
    """Returns the scene of a robot in motion, with its springs, ground forces and toe paths.

    Args:
        robot: the robot.
        frames: motion of the robot.
        ghost: motion of a ghost of the robot, from the same instant on: joints below `GHOST`, without shapes.
        newtons: newtons per metre of an arrow; None: the longest arrow scales with the robot's height.
    """
    looks, paths = read_looks(robot), joint_paths(robot.model)
    local = local_poses(robot.model, frames.q)
    world = world_poses(robot.model, local)
    center = center_of_mass(robot.model, world)
    following = follow(robot.model, frames.t, world, center)
    seen = following.poses
    view = fit_view(*_bounds(robot.model, looks.shapes, world, seen))
    springs, brackets = spring_overlays(robot, frames, local, paths, looks.shapes)
    feet = _feet(robot, frames, world, looks.shapes)
    peak = max((float(np.linalg.norm(foot.force, axis=1).max(initial=0.0)) for foot in feet), default=0.0)
    size = max(float(center[:, 2].max()), 0.1)
    cables = cable_overlays(robot, frames, looks.shapes, size)
    brackets = [*brackets, *fittings(robot, frames, looks.shapes, size)]
    per_metre = peak / (0.6 * size) if newtons is None else newtons
    trails = [_trail(foot, frames.t, size, len(feet)) for foot in feet]
    arrows = [_arrow(foot, frames.t, size, 1.0 / per_metre) for foot in feet] if peak > 0 else []
    toes = {foot.toe: foot.position for foot in feet}
    tracks = track_overlays(robot, frames, world, toes, size)
    landed = landings(robot, frames, toes) if tracks else {}
    overlays = [*springs, *cables, *trails, *arrows, *tracks.values()]
    double, ghost_clips, reach = _ghost(robot.model, ghost) if ghost is not None else ([], {}, following.place)
    reach = np.concatenate((following.place, reach))
    commands = [
        c.set_transform(WORLD, seen[0]),
        *_body(paths, local[0], (*looks.shapes, *brackets)),
        *(command for overlay in overlays for command in overlay.commands),
        *double,
        *stage(view, reach.min(axis=0), reach.max(axis=0), frames.ground),
    ]
    clips = _joint_clips(paths, frames.t, local) | ghost_clips
    if following.moves or following.turns:
        clips[WORLD] = _pose_tracks(frames.t, seen)
    for overlay in overlays:
        clips.update(overlay.clips)
    return Scene(
        tuple(commands),
        clips,
        view,
        peak_force=peak,
        paired=len(feet) > len(robot.toes),
        notes=looks.notes,
        follows=WORLD in clips,
        turns=following.turns,
        arrows=tuple((arrow_path(foot.name), foot.toe, foot.share) for foot in feet) if arrows else (),
        newtons=per_metre,
        trails=tuple(trail_path(foot.name) for foot, trail in zip(feet, trails, strict=True) if trail.commands),
        prints=tuple(
            (round(float(x), 4), round(float(y), 4), color) for color, _, place in landed.values() for x, y in place
        ),
        tracks=tuple(path for path, track in tracks.items() if track.commands),
        joints=_angles(robot.model, paths),
    )


def _angles(model: pin.Model, paths: tuple[str, ...]) -> dict[str, str]:
    """Returns the path of each joint that turns about one axis, by its name."""
    turning = [
        number for number, joint in enumerate(model.joints) if joint.nq == 1 and joint.shortname().startswith(REVOLUTE)
    ]
    return {model.names[number]: paths[number] for number in turning}


def _ghost(model: pin.Model, frames: Frames) -> tuple[list[c.Command], dict[str, tuple[c.Track, ...]], Array]:
    """Returns where the joints of a ghost begin, how they move, and its places, (m, 2); the ghost is hidden after."""
    paths, local = joint_paths(model, GHOST), local_poses(model, frames.q)
    end = np.nextafter(np.float32(frames.duration), np.float32(np.inf))
    there = c.Track("visible", "bool", np.array([0.0, end]), [True, False])
    center = center_of_mass(model, world_poses(model, local))
    commands = [c.set_transform(path, pose) for path, pose in zip(paths, local[0], strict=True)]
    return commands, _joint_clips(paths, frames.t, local) | {GHOST: (there,)}, center[:, :2]


@dataclass(frozen=True)
class _Foot:
    """A toe as it is drawn: twice, with half the force each, where its leg is a pair."""

    name: str
    toe: str
    share: float
    position: Array
    force: Array


def _feet(robot: Robot, frames: Frames, world: Array, shapes: tuple[Shape, ...]) -> list[_Foot]:
    feet = []
    for number, toe in enumerate(robot.toes):
        frame = robot.model.frames[robot.toe_id(toe)]
        joint, at = int(frame.parentJoint), np.array(frame.placement.translation)
        places = places_across(shapes, joint, np.array([0.0, 1.0, 0.0]))
        touching = _touching(robot, toe, frames.q) if toe in robot.radii else np.zeros(3)
        named = [(f"{toe} right", places[0]), (f"{toe} left", places[1])] if len(places) == 2 else [(toe, at[1])]
        for name, y in named:
            position = (world[:, joint] @ [at[0], y, at[2], 1.0])[:, :3] + touching
            share = 1.0 / len(named)
            feet.append(_Foot(name, toe, share, position, share * frames.force[:, number]))
    return feet


def _touching(robot: Robot, toe: str, q: Array) -> Array:
    """Returns from a round foot's centre to where it touches, or would touch, (m, 3), in m."""
    data, frame, found = pin.Data(robot.model), robot.toe_id(toe), []
    for each in q:
        pin.forwardKinematics(robot.model, data, each)
        centre = np.array(pin.updateFramePlacement(robot.model, data, frame).translation)
        found.append(robot.directions.place(robot.model, data, frame) - centre)
    return np.array(found)


def _trail(foot: _Foot, t: Array, size: float, feet: int) -> Overlay:
    return trail_overlay(foot.name, t, foot.position, 0.005 * size, 2 * TRAIL_POINTS // max(2, feet))


def _arrow(foot: _Foot, t: Array, size: float, scale: float) -> Overlay:
    return arrow_overlay(foot.name, t, foot.position, foot.force, scale, 0.022 * size)


def _body(paths: tuple[str, ...], local: Array, shapes: tuple[Shape, ...]) -> list[c.Command]:
    commands = [c.set_transform(path, pose) for path, pose in zip(paths, local, strict=True)]
    for number, shape in enumerate(shapes):
        path = f"{paths[shape.joint]}/shape {number}"
        placement = shape.placement.copy()
        if shape.kind == "cylinder":
            placement[:3, :3] = placement[:3, :3] @ [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
        look = c.material(shape.color, shininess=35, specular=0x333333)
        if shape.mesh is not None:
            look["flatShading"] = True
        commands += [c.set_object(path, _geometry(shape), look), c.set_transform(path, placement)]
    return commands


def _geometry(shape: Shape) -> c.Geometry:
    if shape.mesh is not None:
        return c.triangles(shape.mesh.vertices, shape.mesh.faces)
    if shape.kind == "box":
        return c.box(*shape.size)
    return c.cylinder(*shape.size) if shape.kind == "cylinder" else c.sphere(*shape.size)


def _joint_clips(paths: tuple[str, ...], t: Array, local: Array) -> dict[str, tuple[c.Track, ...]]:
    return {path: _pose_tracks(t, poses) for path, poses in list(zip(paths, local.swapaxes(0, 1), strict=True))[1:]}


def _pose_tracks(t: Array, poses: Array) -> tuple[c.Track, ...]:
    """Returns tracks of the parts of a pose that change, (m, 4, 4)."""
    tracks = []
    if np.ptp(poses[:, :3, 3], axis=0).max() > 0:
        tracks.append(c.Track("position", "vector3", t, poses[:, :3, 3]))
    if np.ptp(poses[:, :3, :3], axis=0).max() > 0:
        tracks.append(c.Track("quaternion", "quaternion", t, quaternions(poses[:, :3, :3])))
    return tuple(tracks)


def _bounds(model: pin.Model, shapes: tuple[Shape, ...], world: Array, seen: Array) -> tuple[Array, Array]:
    """Returns corners, (3,), in m, of a box around the robot's motion, in the world as it is seen, (m, 4, 4).

    Links without mass, such as the rails of a test stand, may extend beyond the box.
    """
    some = np.unique(np.linspace(0, len(world) - 1, 60).astype(int))
    poses = seen[some, None] @ world[some]
    corners = [poses[:, base_joint(model) or 1 :, :3, 3].reshape(-1, 3)]
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    heavy = {joint for joint in range(1, model.njoints) if model.inertias[joint].mass > 0}
    for shape in (shape for shape in shapes if shape.joint in heavy):
        local = np.column_stack(((signs * shape.half_extent) @ shape.placement[:3, :3].T + shape.center, np.ones(8)))
        corners.append(np.einsum("fab,kb->fka", poses[:, shape.joint], local)[:, :, :3].reshape(-1, 3))
    points = np.concatenate(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    low[2] = min(low[2], 0.0)
    return low, np.maximum(high, low + 0.1)
