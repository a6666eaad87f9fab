"""Writes a robot's tree as a URDF of nothing but joints, inertias, and frames, which any simulator reads."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree as xml

import numpy as np
import pinocchio as pin

from spear_pin.model.frames import frame_id
from spear_pin.model.robot import Robot

WORLD = "world"
WIDEST = "1000"  # limits that a URDF has to give, and that no problem reaches


def plain_urdf(robot: Robot, frames: Iterable[str]) -> list[str]:
    """Returns the lines of the URDF: joints of one coordinate, each with a link "NAME_link", and a link for each frame.

    Base and locked joints are as the robot has them. Rotors, whose inertia is `robot.model.armature`, are left out.

    Args:
        robot: a robot whose joints have one coordinate each.
        frames: names of frames that become links without inertia, such as its feet.
    """
    model = robot.model
    root = xml.Element("robot", name=robot.name)
    xml.SubElement(root, "link", name=WORLD)
    for i in range(1, model.njoints):
        name, inertia = model.names[i], model.inertias[i]
        link = xml.SubElement(root, "link", name=f"{name}_link")
        if inertia.mass > 0.0:
            body = xml.SubElement(link, "inertial")
            xml.SubElement(body, "origin", xyz=_text(inertia.lever))
            xml.SubElement(body, "mass", value=_text([inertia.mass]))
            about = {f"i{'xyz'[a]}{'xyz'[b]}": _text([inertia.inertia[a, b]]) for a in range(3) for b in range(a, 3)}
            xml.SubElement(body, "inertia", about)
        along = np.ravel(model.joints[i].createData().S)
        turns = bool(along[3:].any())
        joint = _joint(root, name, "revolute" if turns else "prismatic", model.parents[i], f"{name}_link", model)
        _place(joint, model.jointPlacements[i])
        xml.SubElement(joint, "axis", xyz=_text(along[3:] if turns else along[:3]))
        xml.SubElement(joint, "limit", lower=f"-{WIDEST}", upper=WIDEST, effort=WIDEST, velocity=WIDEST)
    for name in frames:
        frame = model.frames[frame_id(model, name)]
        xml.SubElement(root, "link", name=name)
        _place(_joint(root, f"{name}_fixed", "fixed", frame.parentJoint, name, model), frame.placement)
    parts = [xml.tostring(part, encoding="unicode") for part in root]
    return [f'<robot name="{robot.name}">', *parts, "</robot>"]


def _joint(root: xml.Element, name: str, kind: str, parent: int, child: str, model: pin.Model) -> xml.Element:
    joint = xml.SubElement(root, "joint", name=name, type=kind)
    xml.SubElement(joint, "parent", link=f"{model.names[parent]}_link" if parent else WORLD)
    xml.SubElement(joint, "child", link=child)
    return joint


def _place(joint: xml.Element, placement: pin.SE3) -> None:
    angles = pin.rpy.matrixToRpy(placement.rotation)
    xml.SubElement(joint, "origin", xyz=_text(placement.translation), rpy=_text(angles))


def _text(numbers: Iterable[float]) -> str:
    return " ".join(repr(float(number) + 0.0) for number in numbers)
