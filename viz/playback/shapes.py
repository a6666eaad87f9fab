"""Shapes of the links: boxes, cylinders, spheres and meshes, and bones where there are none."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.appearance import Color
from spear_pin.viz.playback.meshes import Mesh

Kind = Literal["box", "cylinder", "sphere", "mesh"]
GREY: Color = (0.62, 0.65, 0.69, 1.0)
CHORDS = 32  # of a circle that is drawn


@dataclass(frozen=True)
class Shape:
    """One primitive or mesh, rigidly fixed to a joint of the (reduced) model.

    Attributes:
        joint: index of the joint with which it moves, 0 for the world.
        kind: box, cylinder (along its z), sphere or mesh.
        size: lengths x, y, z of a box; radius and length of a cylinder; radius of a sphere; in m; empty for a mesh.
        placement: (4, 4) pose in the joint's frame; for a mesh or an ellipsoid times its scale.
        color: colour of the whole shape.
        mesh: the mesh, if the shape is one.
    """

    joint: int
    kind: Kind
    size: tuple[float, ...]
    placement: Array
    color: Color = GREY
    mesh: Mesh | None = None

    @property
    def center(self) -> Array:
        """Middle of the bounding box in the joint's frame, (3,), in m."""
        middle = np.zeros(3) if self.mesh is None else (self.mesh.low + self.mesh.high) / 2
        return np.asarray(self.placement[:3, :3] @ middle + self.placement[:3, 3])

    @property
    def half_extent(self) -> Array:
        """Half the side lengths of the bounding box in its own frame, (3,), in m."""
        if self.mesh is not None:
            return (self.mesh.high - self.mesh.low) / 2
        if self.kind == "box":
            return np.array(self.size) / 2
        if self.kind == "cylinder":
            return np.array([self.size[0], self.size[0], self.size[1] / 2])
        return np.full(3, self.size[0])


def segment(joint: int, start: Array, end: Array, radius: float, color: Color) -> Shape:
    """Returns a cylinder between two points, in m, of a joint's frame."""
    placement = np.eye(4)
    placement[:3, :3] = frame_along(end - start)
    placement[:3, 3] = (start + end) / 2
    return Shape(joint, "cylinder", (radius, float(np.linalg.norm(end - start))), placement, color)


def frame_along(direction: Array, side: Array | None = None) -> Array:
    """Returns a rotation, (3, 3), whose z axis is the direction and whose x axis is nearest to `side`."""
    z = direction / np.linalg.norm(direction)
    for candidate in (np.eye(3)[0] if side is None else side, *np.eye(3)):
        x = candidate - (candidate @ z) * z
        if np.linalg.norm(x) > 1e-3:
            x = x / np.linalg.norm(x)
            return np.column_stack((x, np.cross(z, x), z))
    raise AssertionError("one of three axes is always across")


def soles(robot: Robot) -> tuple[Shape, ...]:
    """Returns thin cylinders along the arcs of round feet, full circles where the arcs have no ends."""
    found = []
    for toe, radius in robot.radii.items():
        frame, arc = robot.model.frames[robot.toe_id(toe)], robot.arcs.get(toe)
        neutral = pin.Data(robot.model)
        pin.framesForwardKinematics(robot.model, neutral, pin.neutral(robot.model))
        turned = frame.placement.rotation @ neutral.oMf[robot.toe_id(toe)].rotation.T  # to the joint's axes
        first, last = (-np.pi, np.pi) if arc is None else (arc.start, arc.stop)
        ends = np.linspace(first, last, 2 + int(CHORDS * (last - first) / (2 * np.pi)))
        x, z = -radius * np.sin(ends), -radius * np.cos(ends)
        points = frame.placement.translation + np.column_stack((x, np.zeros_like(x), z)) @ turned.T
        joint, thick = int(frame.parentJoint), 0.04 * radius
        found += [segment(joint, *pair, thick, GREY) for pair in pairwise(points)]
    return tuple(found)


def bones(robot: Robot, drawn: set[int]) -> tuple[Shape, ...]:
    """Returns thin cylinders from each joint that has no shape to the joints and toes that it carries."""
    model, ends = robot.model, []
    for joint in range(1, model.njoints):
        ends.append((int(model.parents[joint]), np.array(model.jointPlacements[joint].translation)))
    for toe in robot.toes:
        frame = model.frames[robot.toe_id(toe)]
        ends.append((int(frame.parentJoint), np.array(frame.placement.translation)))
    return tuple(
        segment(joint, np.zeros(3), end, 0.012, GREY)
        for joint, end in ends
        if joint > 0 and joint not in drawn and np.linalg.norm(end) > 1e-3
    )
