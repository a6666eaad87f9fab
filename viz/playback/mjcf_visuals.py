"""Geoms of an MJCF file for drawing: their form, size, place and colour."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.mjcf_reading import Look
from spear_pin.model.mjcf_rotations import NOTATIONS, rotation
from spear_pin.viz.playback.appearance import Color, Form, Shown, Undrawn

LENGTHS: Mapping[Form, tuple[float, ...]] = {
    "sphere": (1.0,),
    "capsule": (1.0, 2.0),
    "cylinder": (1.0, 2.0),
    "box": (2.0, 2.0, 2.0),
    "ellipsoid": (1.0, 1.0, 1.0),
}
"""What the sizes of a form are to be multiplied by: half of a length is said."""

LAST_GROUP = 2  # of those that MuJoCo's own viewer shows at first; the others are for contact


def is_shown(said: Mapping[str, str]) -> bool:
    """Tells whether a geom with such attributes is visible."""
    group, rgba = said.get("group", "0"), said.get("rgba", "").split()
    return not (group.isdigit() and int(group) > LAST_GROUP) and rgba[3:] not in (["0"], ["0.0"])


def read_geom(said: Mapping[str, str], look: Look) -> Shown:
    """Returns the visible part of a geom.

    Args:
        said: attributes of the geom, with those of its class.
        look: appearance settings of the file.

    Raises:
        Undrawn: the geom is not valid, or of another kind.
    """
    if "mesh" in said:
        return _of_mesh(said, look)
    kind = said.get("type", "sphere")
    for form, factors in LENGTHS.items():
        if kind == form:
            size, place = _of_ends(form, said) if "fromto" in said else (_numbers(said, "size"), _place(said, look))
            if len(size) < len(factors) or not size[: len(factors)].min() > 0:
                raise Undrawn(f"a {form} of size {tuple(size.tolist())}")
            lengths = size[: len(factors)] * factors
            return Shown(form, tuple(map(float, lengths)), place, _color(said, look))
    raise Undrawn(f"a geom of type {kind!r}")


def _of_ends(form: Form, said: Mapping[str, str]) -> tuple[Array, pin.SE3]:
    """Returns size and place of a geom from one point to another."""
    size, ends = _numbers(said, "size"), _numbers(said, "fromto", 6).reshape(2, 3)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length == 0.0:
        raise Undrawn("a geom from a point to itself")
    along = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), (ends[1] - ends[0]) / length).matrix()
    across = size[[0, 0]] if form in ("box", "ellipsoid") else size[:1]
    return np.append(across, length / 2), pin.SE3(along, ends.mean(axis=0))


def _of_mesh(said: Mapping[str, str], look: Look) -> Shown:
    asset = look.assets.get(("mesh", said["mesh"]), {})
    if "file" not in asset:
        raise Undrawn(f"mesh {said['mesh']!r}", "it names no file")
    if {"refpos", "refquat"} & set(asset):
        raise Undrawn(f"mesh {said['mesh']!r}", "refpos and refquat are not read")
    folder = look.compiler.get("meshdir", look.compiler.get("assetdir", ""))
    name = str(PurePosixPath(folder) / asset["file"])
    scale = _numbers(asset, "scale", 3) if "scale" in asset else np.ones(3)
    if not scale.all():
        raise Undrawn(f"mesh {said['mesh']!r}", f"scale {tuple(scale.tolist())}")
    return Shown("mesh", tuple(map(float, scale)), _place(said, look), _color(said, look), name)


def _place(said: Mapping[str, str], look: Look) -> pin.SE3:
    turned = np.eye(3)
    for notation, count in NOTATIONS.items():
        if notation in said:
            try:
                turned = rotation(notation, tuple(_numbers(said, notation, count)), look.compiler)
            except ValueError as error:
                raise Undrawn("a geom", str(error)) from None
    return pin.SE3(turned, _numbers(said, "pos", 3) if "pos" in said else np.zeros(3))


def _color(said: Mapping[str, str], look: Look) -> Color | None:
    for source in (said, look.assets.get(("material", said.get("material", "")), {})):
        if "rgba" in source:
            red, green, blue, alpha = map(float, _numbers(source, "rgba", 4))
            return red, green, blue, alpha
    return None


def _numbers(said: Mapping[str, str], attribute: str, count: int | None = None) -> Array:
    """Returns the numbers of an attribute, at least one."""
    try:
        numbers = np.array([float(part) for part in said.get(attribute, "").split()])
    except ValueError:
        numbers = np.zeros(0)
    if not len(numbers) or not np.isfinite(numbers).all() or count not in (None, len(numbers)):
        raise Undrawn("a geom", f"{attribute} is {said.get(attribute)!r}")
    return numbers
