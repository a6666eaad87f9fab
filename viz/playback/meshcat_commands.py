"""meshcat's commands as plain dictionaries: objects, transforms, properties, one animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import umsgpack
from numpy.typing import ArrayLike

from spear_pin.arrays import Array

Command = dict[str, Any]
# in three.js JSON form, without an id
Geometry = Mapping[str, Any]

# msgpack extension types that the viewer decodes to typed arrays
TYPED = {"Uint16Array": (0x14, "<u2"), "Uint32Array": (0x16, "<u4"), "Float32Array": (0x17, "<f4")}
DOUBLE_SIDE = 2


@dataclass(frozen=True)
class Track:
    """A property over time.

    Attributes:
        name: three.js property of the animated object, for instance `position`.
        kind: how values are interpolated; `bool` values hold until the next key.
        times: keys, (k,), in s, nondecreasing.
        values: values at the keys, (k, ...).
    """

    name: str
    kind: Literal["vector3", "quaternion", "number", "color", "bool"]
    times: Array
    values: ArrayLike


def box(x: float, y: float, z: float) -> Geometry:
    """Returns a box with these side lengths, in m, around its centre."""
    return {"type": "BoxGeometry", "width": x, "height": y, "depth": z}


def sphere(radius: float) -> Geometry:
    """Returns a sphere around its centre; radius in m."""
    return {"type": "SphereGeometry", "radius": radius, "widthSegments": 32, "heightSegments": 20}


def cylinder(radius: float, length: float, top: float | None = None) -> Geometry:
    """Returns a cylinder, or a cone ending in the radius `top`, along y around its centre; lengths in m."""
    top = radius if top is None else top
    size = {"radiusTop": top, "radiusBottom": radius, "height": length, "radialSegments": 40}
    return {"type": "CylinderGeometry", **size}


def triangles(vertices: ArrayLike, faces: ArrayLike) -> Geometry:
    """Returns a mesh from (v, 3) vertices, in m, and (f, 3) indices of its corners."""
    index = _buffer(faces, "Uint16Array" if len(np.asarray(vertices)) < 2**16 else "Uint32Array", 1)
    attributes = {"position": _buffer(vertices, "Float32Array", 3)}
    return {"type": "BufferGeometry", "data": {"attributes": attributes, "index": index}}


def material(color: Sequence[float], kind: str = "MeshPhongMaterial", **properties: Any) -> dict[str, Any]:
    """Returns a three.js material in its JSON form; colour as red, green, blue and optionally alpha in 0..1."""
    red, green, blue = (round(255 * min(max(value, 0.0), 1.0)) for value in color[:3])
    alpha = float(color[3]) if len(color) > 3 else 1.0
    return {
        "type": kind,
        "color": red << 16 | green << 8 | blue,
        "side": DOUBLE_SIDE,
        "opacity": alpha,
        "transparent": alpha < 1,
        **properties,
    }


def set_object(path: str, geometry: Geometry, look: Mapping[str, Any]) -> Command:
    """Returns the command that puts a mesh at a path."""
    shape, surface = f"{path}#geometry", f"{path}#material"
    return {
        "type": "set_object",
        "path": path,
        "object": {
            "metadata": {"version": 4.5, "type": "Object"},
            "geometries": [{"uuid": shape, **geometry}],
            "materials": [{"uuid": surface, **look}],
            "object": {
                "uuid": f"{path}#object",
                "type": "Mesh",
                "geometry": shape,
                "material": surface,
                "matrix": np.eye(4).ravel().tolist(),
            },
        },
    }


def set_transform(path: str, matrix: Array) -> Command:
    """Returns the command that places a path in its parent by a (4, 4) pose."""
    return {"type": "set_transform", "path": path, "matrix": matrix.T.ravel().tolist()}


def set_property(path: str, name: str, value: Any) -> Command:
    """Returns the command that sets a property of the object at a path."""
    return {"type": "set_property", "path": path, "property": name, "value": value}


def set_animation(clips: Mapping[str, Sequence[Track]], duration: float, speed: float = 1.0) -> Command:
    """Returns the command that animates paths by tracks in a loop; duration in s of the motion, played at a speed."""
    return {
        "type": "set_animation",
        # a server sends what it keeps in the order of the paths' first use: the objects come first
        "path": "/animation",
        "animations": [
            {
                "path": path,
                "clip": {
                    "name": "motion",
                    "fps": speed,
                    "duration": duration / speed,
                    "tracks": [_track(track) for track in tracks],
                },
            }
            for path, tracks in clips.items()
            if tracks
        ],
        "options": {"play": True, "repetitions": 1_000_000},
    }


def pack(command: Command) -> bytes:
    """Returns a command in the viewer's format."""
    return bytes(umsgpack.packb(command))


def _track(track: Track) -> dict[str, Any]:
    values: Any
    if track.kind == "bool":
        values = [bool(value) for value in np.ravel(track.values)]
    else:
        values = _typed(track.values, "Float32Array")
    times = _typed(track.times, "Float32Array")
    return {"name": f".{track.name}", "type": track.kind, "times": times, "values": values}


def _buffer(values: ArrayLike, name: str, item_size: int) -> dict[str, Any]:
    return {"itemSize": item_size, "type": name, "array": _typed(values, name), "normalized": False}


def _typed(values: ArrayLike, name: str) -> umsgpack.Ext:
    code, dtype = TYPED[name]
    return umsgpack.Ext(code, np.asarray(values).astype(dtype).tobytes())
