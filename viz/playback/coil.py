"""Place of a joint's spring in the picture: between a point before the joint and one behind it, next to the links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.kinematics import local_poses
from spear_pin.viz.playback.shapes import Shape, frame_along

# in parts of the shorter link
ALONG, BESIDE, RADIUS, WIRE = 0.5, 0.17, 0.085, 0.017
TURNS = 7


@dataclass(frozen=True)
class Coil:
    """A spring across a joint, drawn from a point of the link before it to a point of the link behind.

    Attributes:
        joint: index of the joint that it spans.
        start: its end on the link before the joint, (3,), in m in that link's joint frame.
        end: its end on the link behind, (3,), in m in the joint's frame.
        start_root: point of the link to which a bracket holds `start`, (3,), in m in the same frame.
        end_root: point of the link to which a bracket holds `end`, (3,), in m in the same frame.
        side: direction across the coil, (3,), in the frame of `start`.
        shifts: places along `side`, in m; a pair of legs has two.
        radius: radius of the coil, in m.
        wire: radius of the wire, in m.
    """

    joint: int
    start: Array
    end: Array
    start_root: Array
    end_root: Array
    side: Array
    shifts: tuple[float, ...]
    radius: float
    wire: float

    def vectors(self, local: Array) -> Array:
        """Returns vectors from start to end over the frames, (frames, 3), in m in the frame of `start`."""
        poses = local[:, self.joint]
        return np.asarray(poses[:, :3, :3] @ self.end + poses[:, :3, 3] - self.start)

    def rotations(self, local: Array) -> Array:
        """Returns rotations that bring z along the coil, (frames, 3, 3), in the frame of `start`."""
        return np.array([frame_along(vector, self.side) for vector in self.vectors(local)])


def fit_coil(robot: Robot, joint: str, q: Array, shapes: tuple[Shape, ...]) -> Coil:
    """Returns the coil that shows the spring of a joint.

    Args:
        robot: the robot.
        joint: name of the joint that the spring spans.
        q: a configuration, (nq,), in which the spring is engaged: the coil lies inside its angle.
        shapes: shapes of the links.
    """
    model = robot.model
    index = int(model.getJointId(joint))
    pose = np.asarray(local_poses(model, q[None])[0, index])
    axis = _axis(model, index, pose)
    origin, behind = np.array(model.jointPlacements[index].translation), link_end(robot, index)
    if axis is None:
        reach = np.asarray(pose[:3, :3] @ behind + pose[:3, 3] - origin)
        length = max(float(np.linalg.norm(reach)), 1e-3)
        side = frame_along(reach)[:, 0]
        return Coil(index, origin, behind, origin, behind, side, (0.0,), 1.5 * RADIUS * length, WIRE * length)
    before = -origin if np.linalg.norm(origin) > 1e-3 else pose[:3, :3] @ -behind
    length = float(min(np.linalg.norm(before), np.linalg.norm(behind)))
    upper, lower = _unit(before), _unit(np.asarray(pose[:3, :3] @ behind))
    inward = upper + lower
    if np.linalg.norm(inward) < 0.05:
        inward = np.cross(axis, upper)
    back = pose[:3, :3].T
    start_root, end_root = pose[:3, 3] + ALONG * length * upper, ALONG * length * (back @ lower)
    start = start_root + BESIDE * length * _across(inward, upper)
    end = end_root + BESIDE * length * (back @ _across(inward, lower))
    shifts = places_across(shapes, index, back @ axis)
    return Coil(index, start, end, start_root, end_root, axis, shifts, RADIUS * length, WIRE * length)


def helix(coil: Coil, length: float) -> tuple[Array, NDArray[np.intp]]:
    """Returns vertices and faces of the coil along z from 0 to 1; its wire is round if stretched to a length, in m."""
    angle = np.linspace(0.0, 2 * np.pi * TURNS, 14 * TURNS + 1)
    # the ends run to the axis, where the brackets hold them
    taper = np.clip(np.minimum(angle, angle[::-1]) / (0.6 * np.pi), 0.0, 1.0)
    line = np.column_stack(
        (coil.radius * taper * np.cos(angle), coil.radius * taper * np.sin(angle), np.linspace(0.0, length, len(angle)))
    )
    vertices, faces = tube(line, coil.wire, 8)
    vertices = vertices / [1.0, 1.0, length]
    copies = [vertices + [shift, 0.0, 0.0] for shift in coil.shifts]
    return np.concatenate(copies), np.concatenate([faces + k * len(vertices) for k in range(len(copies))])


def tube(line: Array, radius: float, sides: int) -> tuple[Array, NDArray[np.intp]]:
    """Returns vertices and faces of a tube around a line of (k, 3) points; the faces are in the line's order."""
    tangent = np.gradient(line, axis=0)
    frames = []
    side = np.array([0.0, 1.0, 0.0])
    for row in tangent:
        direction = np.asarray(row)
        if np.linalg.norm(direction) > 0:
            side = frame_along(direction, side)[:, 0]
        frames.append((side, np.cross(_unit(direction), side)))
    angle = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    vertices = (line[:, None, :] + radius * np.einsum("sc,kcx->ksx", ring, np.array(frames))).reshape(-1, 3)
    here = np.arange(sides)
    beside = (here + 1) % sides
    band = np.stack((here, beside, beside + sides, here, beside + sides, here + sides), axis=1).reshape(-1, 3)
    faces = band[None] + (np.arange(len(line) - 1) * sides)[:, None, None]
    return vertices, faces.reshape(-1, 3)


def _axis(model: pin.Model, index: int, pose: Array) -> Array | None:
    """Returns the axis of a revolute joint in its parent's frame; none for any other joint."""
    joint = model.joints[index]
    if joint.nv != 1:
        return None
    data = pin.Data(model)
    pin.computeJointJacobians(model, data, pin.neutral(model))
    column = pin.getJointJacobian(model, data, index, pin.ReferenceFrame.LOCAL)[3:, joint.idx_v]
    return np.asarray(pose[:3, :3] @ column) if np.linalg.norm(column) > 0.5 else None


def link_end(robot: Robot, index: int) -> Array:
    """Returns the end of the link behind a joint: its toe, else its next joint, else past its centre of mass."""
    model = robot.model
    toes = [model.frames[robot.toe_id(toe)] for toe in robot.toes]
    ends = [frame.placement.translation for frame in toes if frame.parentJoint == index]
    ends += [model.jointPlacements[j].translation for j in range(1, model.njoints) if model.parents[j] == index]
    ends += [2 * model.inertias[index].lever, [0.0, 0.0, -0.2]]
    return np.array(next(end for end in ends if np.linalg.norm(end) > 1e-3))


def places_across(shapes: tuple[Shape, ...], index: int, axis: Array) -> tuple[float, ...]:
    """Returns places of a joint's link along its axis, in m: one, or two for a pair of legs, the right one first.

    Args:
        shapes: shapes of the links.
        index: index of the joint that carries the link.
        axis: direction in the joint's frame, (3,).
    """
    places = np.array([shape.center @ axis for shape in shapes if shape.joint == index])
    if not len(places):
        return (0.0,)
    if places.min() < -0.05 and places.max() > 0.05:
        return (float(places[places < 0].mean()), float(places[places > 0].mean()))
    return (float(places.mean()),)


def _across(vector: Array, direction: Array) -> Array:
    return _unit(vector - (vector @ direction) * direction)


def _unit(vector: Array) -> Array:
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-12))
