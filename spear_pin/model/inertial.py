"""The `<inertial>` of a link: checked, mended on request, copied in one notation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import child, number, numbers

ROUNDING = 1e-15  # kg·m²: a principal moment this little below zero is none
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def copy_inertial(path: Path, inertial: Any, link: Any, repair: bool) -> str | None:
    """Copy an `<inertial>` into a link of our own writing.

    Args:
        path: of the file.
        inertial: the element.
        link: the element that gets the copy.
        repair: make an inertia positive semidefinite that is not: its negative principal moments become zero.

    Returns:
        What was mended, if anything was.

    Raises:
        BadFile: the mass is negative, or the inertia not positive semidefinite and not to be mended.
    """
    name, note = link.get("name"), None
    mass = number(path, child(path, inertial, "mass"), "value")
    if mass < 0:
        raise BadFile(path, f"link {name!r} has the negative mass {mass}", inertial.sourceline)
    element = child(path, inertial, "inertia")
    moments = {each: number(path, element, each) for each in MOMENTS}
    mended, least = _mended(moments)
    if not _semidefinite(*moments.values()) and least < -ROUNDING:
        problem = f"link {name!r} has an inertia that is not positive semidefinite"
        if not repair:
            raise BadFile(path, f"{problem} (repair=True mends it)", element.sourceline)
        moments = mended
        note = f"{problem}, by a principal moment of {least:.3g} kg·m²: set to zero"
    part = etree.SubElement(link, "inertial")
    copy_origin(path, inertial, part)
    etree.SubElement(part, "mass", value=repr(mass))
    etree.SubElement(part, "inertia", {each: repr(value) for each, value in moments.items()})
    return note


def copy_origin(path: Path, element: Any, copy: Any) -> None:
    """Copy the `<origin>` of an element, if it has one."""
    origin = element.find("origin")
    if origin is None:
        return
    part = etree.SubElement(copy, "origin")
    for attribute in ("xyz", "rpy"):
        if origin.get(attribute) is not None:
            part.set(attribute, " ".join(map(repr, numbers(path, origin, attribute, 3))))


def _semidefinite(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float) -> bool:
    minors = (xx * yy - xy**2, xx * zz - xz**2, yy * zz - yz**2)
    determinant = xx * minors[2] - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    scale = max(abs(xx), abs(yy), abs(zz), 1e-300)
    return min(xx, yy, zz) >= 0 and min(minors) >= -1e-9 * scale**2 and determinant >= -1e-9 * scale**3


def _mended(moments: dict[str, float]) -> tuple[dict[str, float], float]:
    """The nearest positive semidefinite inertia, and the least principal moment before."""
    xx, xy, xz, yy, yz, zz = moments.values()
    values, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    matrix = (axes * np.maximum(values, 0.0)) @ axes.T
    rows, columns = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    return dict(zip(MOMENTS, map(float, matrix[rows, columns]), strict=True)), float(values[0])
