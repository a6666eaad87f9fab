"""Visuals of a URDF's links for drawing: their form, size, place and colour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.viz.playback.appearance import Color, Form, Shown, Undrawn

SIZES: Mapping[Form, Mapping[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
}
"""How many numbers the attributes of a primitive have."""


def read_visual(visual: Any, palette: Mapping[str, Any]) -> Shown:
    """Returns the visible part of a visual.

    Args:
        visual: element of the visual.
        palette: the robot's materials by name.

    Raises:
        Undrawn: the visual is not valid, or of another kind.
    """
    geometry, origin = visual.find("geometry"), visual.find("origin")
    element = next(iter(geometry if geometry is not None else ()), None)
    if element is None:
        raise Undrawn("an empty visual")
    xyz = _numbers(origin, "xyz", "0 0 0", 3) if origin is not None else [0.0] * 3
    rpy = _numbers(origin, "rpy", "0 0 0", 3) if origin is not None else [0.0] * 3
    place = pin.SE3(pin.rpy.rpyToMatrix(np.array(rpy)), np.array(xyz))
    if element.tag == "mesh":
        scale = tuple(_numbers(element, "scale", "1 1 1", 3))
        if 0.0 in scale:
            raise Undrawn(f"mesh {element.get('filename')!r}", f"scale {scale}")
        return Shown("mesh", scale, place, _color(visual, palette), element.get("filename") or "")
    for form, attributes in SIZES.items():
        if element.tag == form:
            size = [number for name, count in attributes.items() for number in _numbers(element, name, count=count)]
            if not min(size) > 0:
                raise Undrawn(f"a {form} of size {tuple(size)}")
            return Shown(form, tuple(size), place, _color(visual, palette))
    raise Undrawn(f"<{element.tag}>")


def _color(visual: Any, palette: Mapping[str, Any]) -> Color | None:
    material = visual.find("material")
    for source in (material, palette.get(material.get("name")) if material is not None else None):
        color = None if source is None else source.find("color")
        if color is not None:
            red, green, blue, alpha = _numbers(color, "rgba", count=4)
            return red, green, blue, alpha
    return None


def _numbers(element: Any, attribute: str, default: str = "", count: int = 1) -> Sequence[float]:
    try:
        numbers = [float(part) for part in element.get(attribute, default).split()]
    except ValueError:
        numbers = []
    if not np.isfinite(numbers).all() or len(numbers) != count:
        raise Undrawn("a visual", f"{attribute} of <{element.tag}> is {element.get(attribute)!r}")
    return numbers
