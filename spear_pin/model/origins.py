"""The `<origin>` of a URDF: positions, and rotations by three angles or by the quaternion of URDF 1.1."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import fault, numbers

QUATERNION = "quat_xyzw"
SINCE = (1, 1)  # first version of URDF with quaternions
SHORTEST = 1e-9  # a quaternion that is shorter has no direction


def turn_quaternions(path: Path, root: Any) -> None:
    """Writes every quaternion of a URDF 1.1 as roll, pitch and yaw, in joints, inertias and shapes.

    Quaternions in a file of an earlier version, or without a version, stay as they are, and are not read.

    Raises:
        BadFile: a joint or an inertia has an invalid quaternion, or both a quaternion and `rpy`. Such a shape is left
            as it is.
    """
    version = tuple(map(int, re.findall(r"\d+", root.get("version", ""))[:2]))
    if version < SINCE:
        return
    for origin in root.iter("origin"):
        if QUATERNION not in origin.attrib:
            continue
        try:
            origin.set("rpy", " ".join(map(repr, _angles(path, origin))))
            del origin.attrib[QUATERNION]
        except BadFile:
            if origin.getparent().tag in ("joint", "inertial"):
                raise


def _angles(path: Path, origin: Any) -> list[float]:
    if "rpy" in origin.attrib:
        raise fault(path, origin, f"<origin> has rpy and {QUATERNION}; one of them is valid")
    values = np.array(numbers(path, origin, QUATERNION, 4))
    length = float(np.linalg.norm(values))
    if length < SHORTEST:
        problem = f"{QUATERNION} of <origin> is {origin.get(QUATERNION)!r}; expected x, y, z, w, not all zero"
        raise fault(path, origin, problem)
    angles: list[float] = pin.rpy.matrixToRpy(pin.Quaternion(values / length).matrix()).tolist()
    return angles


def copy_origin(path: Path, element: Any, copy: Any) -> None:
    """Copies the `<origin>` of an element, if it has one."""
    origin = element.find("origin")
    if origin is None:
        return
    part = etree.SubElement(copy, "origin")
    for attribute in ("xyz", "rpy"):
        if origin.get(attribute) is not None:
            part.set(attribute, " ".join(map(repr, numbers(path, origin, attribute, 3))))
