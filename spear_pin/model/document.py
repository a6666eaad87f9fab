"""The file from which a robot was loaded: its elements, and its look."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from spear_pin.model.elements import parse
from spear_pin.model.loading import path_of
from spear_pin.model.mjcf_reading import Look, mjcf_of
from spear_pin.model.robot import Robot
from spear_pin.model.urdf import read_urdf, urdf_of


@dataclass(frozen=True)
class Description:
    """The parts of a robot's file that describe its look.

    Attributes:
        path: path of the file.
        root: its root element, without comments.
        look: look of the bodies, for an MJCF file.
    """

    path: Path
    root: Any
    look: Look | None = None


def document(robot: Robot) -> Any:
    """Returns the root element of the URDF, without comments; entities are neither expanded nor fetched.

    Raises:
        BadFile: the file is gone, or no longer valid (see `read_urdf`).
    """
    text = read_urdf(path_of(robot.source), repair=True).document
    return etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False, no_network=True))


def describe(robot: Robot) -> Description:
    """Returns the file from which a robot was loaded.

    Raises:
        UnknownName: the robot is not installed any more.
        BadFile: the file is gone, or no longer valid.
    """
    path, root = parse(path_of(robot.source))
    if root.tag == "mujoco":
        return Description(path, root, mjcf_of(path, root, robot.options.get("base")).look)
    urdf_of(path, root, repair=True)
    return Description(path, root)
