"""The URDF a robot was loaded from, as a tree of elements."""

from __future__ import annotations

from typing import Any

from lxml import etree

from spear_pin.model.loading import path_of
from spear_pin.model.robot import Robot
from spear_pin.model.urdf import read_urdf


def document(robot: Robot) -> Any:
    """The root element of the URDF, without comments; entities are neither expanded nor fetched.

    Raises:
        BadFile: the file is gone, or no longer valid (see `read_urdf`).
    """
    text = read_urdf(path_of(robot.source), repair=True).document
    return etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False, no_network=True))
