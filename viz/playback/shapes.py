"""Shapes of the links: boxes, cylinders and spheres of the URDF, bones where it has none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from spear_pin.errors import SpearError
from spear_pin.model.document import document
from spear_pin.model.robot import Robot

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
    if robot.cut is not None:
        return Looks(_bones(robot, set()), (f"drawn as bones: cut out of {robot.cut.of}",))
    try:
        root = document(robot)
    except SpearError as error:
        return Looks(_bones(robot, set()), (f"drawn as bones: {error}",))
    palette = {material.get("name"): material for material in root.findall("material")}
    shapes, notes = [], []
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            try:
                shapes.append(_shape(robot, link.get("name"), visual, palette))
            except (ValueError, SpearError) as error:
                notes.append(f"not drawn: {error} of link {link.get('name')!r}")
    return Looks((*shapes, *_bones(robot, {shape.joint for shape in shapes})), tuple(notes))


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


def _shape(robot: Robot, link: str, visual: Any, palette: Mapping[str, Any]) -> Shape:
    """One visual of a link; a ValueError that says so if it is not a valid primitive."""
    element = next(iter(visual.find("geometry") if visual.find("geometry") is not None else ()), None)
    if element is None:
        raise ValueError("an empty visual")
    if element.tag not in PRIMITIVES:
        raise ValueError(f"mesh {element.get('filename')!r}" if element.tag == "mesh" else f"<{element.tag}>")
    attributes = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}[element.tag]
    size = tuple(number for attribute in attributes for number in _numbers(element, attribute))
    if len(size) != {"box": 3, "cylinder": 2, "sphere": 1}[element.tag] or not min(size) > 0:
        raise ValueError(f"a {element.tag} of size {size}")
    origin = visual.find("origin")
    xyz = _numbers(origin, "xyz", "0 0 0") if origin is not None else [0.0] * 3
    rpy = _numbers(origin, "rpy", "0 0 0") if origin is not None else [0.0] * 3
    frame = robot.model.frames[robot.model.getFrameId(link, pin.FrameType.BODY)]
    placement = frame.placement * pin.SE3(pin.rpy.rpyToMatrix(np.array(rpy)), np.array(xyz))
    return Shape(int(frame.parentJoint), element.tag, size, np.array(placement.homogeneous), _color(visual, palette))


def _color(visual: Any, palette: Mapping[str, Any]) -> tuple[float, float, float, float]:
    material = visual.find("material")
    for source in (material, palette.get(material.get("name")) if material is not None else None):
        color = None if source is None else source.find("color")
        if color is not None:
            red, green, blue, alpha = _numbers(color, "rgba")
            return red, green, blue, alpha
    return GREY


def _numbers(element: Any, attribute: str, default: str = "") -> list[float]:
    numbers = [float(part) for part in element.get(attribute, default).split()]
    if not numbers or not np.isfinite(numbers).all():
        raise ValueError(f"{attribute} of <{element.tag}> is {element.get(attribute)!r}")
    return numbers


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
