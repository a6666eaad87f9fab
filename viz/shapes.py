"""What the links look like: boxes, cylinders and spheres of the URDF, bones where it has none."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pinocchio as pin
from lxml import etree
from numpy.typing import NDArray

from spear_pin.errors import BadFile
from spear_pin.model.loading import ROBOTS
from spear_pin.model.robot import Robot
from spear_pin.model.urdf import read_urdf

Array = NDArray[np.float64]
Kind = Literal["box", "cylinder", "sphere"]
PRIMITIVES = ("box", "cylinder", "sphere")
GREY = (0.62, 0.65, 0.69, 1.0)


@dataclass(frozen=True)
class Shape:
    """One primitive, rigidly fixed to a joint of the (reduced) model.

    Attributes:
        joint: index of the joint it moves with, 0 for the world.
        kind: box, cylinder (along its z) or sphere.
        size: lengths x, y, z of a box; radius and length of a cylinder; radius of a sphere; in m.
        placement: (4, 4) pose in the joint's frame.
        color: red, green, blue, alpha, each in 0..1.
    """

    joint: int
    kind: Kind
    size: tuple[float, ...]
    placement: Array
    color: tuple[float, float, float, float] = GREY

    @property
    def half_extent(self) -> Array:
        """Half the side lengths of the bounding box in its own frame, (3,), in m."""
        if self.kind == "box":
            return np.array(self.size) / 2
        if self.kind == "cylinder":
            return np.array([self.size[0], self.size[0], self.size[1] / 2])
        return np.full(3, self.size[0])


@dataclass(frozen=True)
class Looks:
    """The shapes of a robot, and one line for each thing that cannot be drawn."""

    shapes: tuple[Shape, ...]
    notes: tuple[str, ...] = ()


def read_looks(robot: Robot) -> Looks:
    """Shapes from the URDF the robot was loaded from; never fails, what is not drawn is in the notes."""
    shipped = ROBOTS.get(robot.source)
    try:
        urdf = read_urdf(shipped.path if shipped else Path(robot.source))
    except BadFile as error:
        return Looks(_bones(robot, set()), (f"drawn as bones: {error}",))
    text, notes = _primitives_only(urdf.text)
    try:
        shapes = _visuals(robot, text)
    except (ValueError, RuntimeError, IndexError) as error:
        shapes = ()
        notes.append(f"drawn as bones: {str(error).strip().splitlines()[0]}")
    return Looks(shapes + _bones(robot, {shape.joint for shape in shapes}), tuple(notes))


def segment(joint: int, start: Array, end: Array, radius: float, color: tuple[float, float, float, float]) -> Shape:
    """A cylinder between two points, in m, of a joint's frame."""
    placement = np.eye(4)
    placement[:3, :3] = frame_along(end - start)
    placement[:3, 3] = (start + end) / 2
    return Shape(joint, "cylinder", (radius, float(np.linalg.norm(end - start))), placement, color)


def frame_along(direction: Array, side: Array | None = None) -> Array:
    """A rotation, (3, 3), whose z axis is the direction and whose x axis is nearest to `side`."""
    z = direction / np.linalg.norm(direction)
    for candidate in (np.eye(3)[0] if side is None else side, *np.eye(3)):
        x = candidate - (candidate @ z) * z
        if np.linalg.norm(x) > 1e-3:
            x = x / np.linalg.norm(x)
            return np.column_stack((x, np.cross(z, x), z))
    raise AssertionError("one of three axes is always across")


def _primitives_only(text: str) -> tuple[str, list[str]]:
    root = etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False, no_network=True))
    notes = []
    for visual in list(root.iter("visual")):
        geometry = visual.find("geometry")
        kinds = [] if geometry is None else [child.tag for child in geometry if isinstance(child.tag, str)]
        if len(kinds) == 1 and kinds[0] in PRIMITIVES:
            continue
        link = visual.getparent()
        mesh = None if geometry is None else geometry.find("mesh")
        what = f"mesh {mesh.get('filename')!r}" if mesh is not None else f"<{kinds[0]}>" if kinds else "an empty visual"
        notes.append(f"not drawn: {what} of link {link.get('name')!r}")
        link.remove(visual)
    return etree.tostring(root, encoding="unicode"), notes


def _visuals(robot: Robot, text: str) -> tuple[Shape, ...]:
    full = pin.buildModelFromXML(text)
    geometry = pin.buildGeomFromUrdfString(full, text, pin.VISUAL)
    if robot.locked:
        ids = [full.getJointId(joint) for joint in robot.locked]
        full, geometry = pin.buildReducedModel(full, geometry, ids, pin.neutral(full))
    if list(full.names) != list(robot.model.names):
        raise ValueError("its URDF has other joints than the robot")
    return tuple(shape for item in geometry.geometryObjects if (shape := _shape(item)) is not None)


def _shape(item: pin.GeometryObject) -> Shape | None:
    primitive, kind = item.geometry, item.meshPath.lower()
    size: tuple[float, ...]
    if kind == "box":
        size = tuple(2 * float(side) for side in primitive.halfSide)
    elif kind == "cylinder":
        size = (float(primitive.radius), 2 * float(primitive.halfLength))
    else:
        kind, size = "sphere", (float(primitive.radius),)
    if not (np.isfinite(size).all() and min(size) > 0):
        return None
    red, green, blue, alpha = (float(value) for value in item.meshColor) if item.overrideMaterial else GREY
    return Shape(int(item.parentJoint), kind, size, np.array(item.placement.homogeneous), (red, green, blue, alpha))


def _bones(robot: Robot, drawn: set[int]) -> tuple[Shape, ...]:
    """Thin cylinders from each joint that has no shape to the joints and toes it carries."""
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
