"""Surroundings of the robot: ground, grid, light, background and camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.ground import Ground
from spear_pin.viz.playback import meshcat_commands as c

STAGE = "/stage"
WORLD = f"{STAGE}/world"

HORIZON = (0.93, 0.95, 0.97)
# part of the ground shines by itself, so that shadows stay light
GROUND, GROUND_GLOW = (0.42, 0.43, 0.44), (0.52, 0.54, 0.56)
MINOR_LINE, MAJOR_LINE = (0.83, 0.86, 0.89), (0.72, 0.76, 0.81)
FIELD_OF_VIEW = 28.0
FILLED = 0.80
TOWARD_CAMERA = np.array([0.42, -1.0, 0.17]) / np.linalg.norm([0.42, -1.0, 0.17])
CAMERA = "/Cameras/default/rotated/<object>"
REACH = 9.0


@dataclass(frozen=True)
class View:
    """View of the camera.

    Attributes:
        target: the point in the middle of the picture, (3,), in m.
        distance: distance of the camera from there, in m.
        aspect: width by height that a window needs to show everything; narrower ones zoom out.
    """

    target: Array
    distance: float
    aspect: float


def fit_view(low: Array, high: Array) -> View:
    """Returns the nearest view that shows a box between two corners, (3,), in m."""
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
    target = (low + high) / 2
    # room for the controls below
    target[2] -= 0.05 * (high[2] - low[2])
    right = np.cross([0.0, 0.0, 1.0], TOWARD_CAMERA)
    right /= np.linalg.norm(right)
    offsets = corners - target
    nearness = offsets @ TOWARD_CAMERA
    sideways, upward = np.abs(offsets @ right), np.abs(offsets @ np.cross(TOWARD_CAMERA, right))
    slope = FILLED * np.tan(np.radians(FIELD_OF_VIEW / 2))
    distance = float(max((upward / slope + nearness).max(), (sideways / (slope * 16 / 9) + nearness).max()))
    return View(target, distance, float((sideways / (slope * (distance - nearness))).max()))


def stage(view: View, first: Array, last: Array, ground: Ground) -> list[c.Command]:
    """Returns everything around the robot, for a motion on some ground between two corners, (2,), x and y in m.

    The ground moves with the world; lights, background and camera do not.
    """
    return [*_camera(view), *_light(), *_ground(first, last), *_placed(ground)]


def _camera(view: View) -> list[c.Command]:
    # the controls turn around the origin, so what is looked at goes there
    shifted = np.eye(4)
    shifted[:3, 3] = -view.target
    x, y, z = (view.distance * TOWARD_CAMERA).tolist()
    return [
        c.set_transform(STAGE, shifted),
        c.set_property(CAMERA, "fov", FIELD_OF_VIEW),
        c.set_property(CAMERA, "position", [x, z, -y]),
    ]


def _light() -> list[c.Command]:
    return [
        c.set_property("/Background", "top_color", list(HORIZON)),
        c.set_property("/Background", "bottom_color", list(HORIZON)),
        c.set_property("/Grid", "visible", False),
        c.set_property("/Axes", "visible", False),
        c.set_property("/Lights/AmbientLight/<object>", "intensity", 0.60),
        c.set_property("/Lights/PointLightNegativeX/<object>", "intensity", 0.15),
        c.set_property("/Lights/PointLightPositiveX/<object>", "intensity", 0.42),
        c.set_property("/Lights/FillLight/<object>", "position", [-0.9, -1.5, 3.2]),
        c.set_property("/Lights/FillLight/<object>", "intensity", 0.42),
        c.set_property("/Lights/FillLight/<object>", "castShadow", True),
    ]


def _ground(first: Array, last: Array) -> list[c.Command]:
    low, high = np.floor(first - REACH), np.ceil(last + REACH)
    spacing = 0.25 * np.ceil((high - low).max() / 80.0)
    (left, near), (right, far) = low, high
    corners = np.array([[left, near, 0], [right, near, 0], [right, far, 0], [left, far, 0]], dtype=float)
    glow = c.material(GROUND_GLOW)["color"]
    matte = c.material(GROUND, "MeshLambertMaterial", emissive=glow)
    path = f"{WORLD}/ground"
    lowered, raised = np.eye(4), np.eye(4)
    lowered[2, 3], raised[2, 3] = -1e-3, 2e-4
    return [
        c.set_object(f"{path}/plane", c.triangles(corners, [[0, 1, 2], [0, 2, 3]]), matte),
        c.set_transform(f"{path}/plane", lowered),
        _lines(f"{path}/minor", low, high, spacing, 0.003, MINOR_LINE),
        _lines(f"{path}/major", low, high, 4 * spacing, 0.006, MAJOR_LINE),
        c.set_transform(f"{path}/major", raised),
        *(c.set_property(f"{path}/{part}/<object>", "castShadow", False) for part in ("plane", "minor", "major")),
    ]


def _placed(ground: Ground) -> list[c.Command]:
    """Returns the plane at its place, if that is not level at height zero."""
    if ground.plain:
        return []
    pose = np.eye(4)
    pose[0, [0, 2]], pose[2, [0, 2]] = ground.world(*np.eye(2))
    pose[2, 3] = ground.height
    return [c.set_transform(f"{WORLD}/ground", pose)]


def _lines(path: str, low: Array, high: Array, spacing: float, width: float, color: Sequence[float]) -> c.Command:
    """Returns a grid of flat stripes; not every browser draws lines that pass the camera."""
    along, across = (
        np.arange(np.ceil(a / spacing), b / spacing + 1e-9) * spacing for a, b in zip(low, high, strict=True)
    )
    (left, near), (right, far), half = low, high, width / 2
    stripes = [(x - half, x + half, near, far) for x in along] + [(left, right, y - half, y + half) for y in across]
    corners = [[[a, b, 0], [d, b, 0], [d, e, 0], [a, e, 0]] for a, d, b, e in stripes]
    faces = np.array([[0, 1, 2], [0, 2, 3]]) + 4 * np.arange(len(stripes))[:, None, None]
    mesh = c.triangles(np.reshape(corners, (-1, 3)), faces.reshape(-1, 3))
    return c.set_object(path, mesh, c.material(color, "MeshBasicMaterial"))
