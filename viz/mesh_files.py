"""Meshes of a robot as files for other programs: binary STL, each in the frame of the joint that moves it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from spear_pin.arrays import Array
from spear_pin.files import atomic
from spear_pin.model.mjcf import MeshFile
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.looks import read_looks

FACES = 150_000  # of all meshes together, or about
HEADER = 80  # bytes of a binary STL, before the number of its faces


def write_meshes(robot: Robot, folder: Path) -> tuple[list[MeshFile], tuple[str, ...]]:
    """Writes the meshes that a robot's file shows into a folder, which is made if there are some.

    Args:
        robot: the robot as it was loaded.
        folder: folder next to the file that will name them.

    Returns:
        The files, each with its path from the folder's parent on; and one line for each part not drawn as it is.

    Raises:
        BadFile: a mesh cannot be written.
        OSError: the folder cannot be made.
    """
    looks = read_looks(robot, FACES)
    shown = [shape for shape in looks.shapes if shape.mesh is not None]
    if shown:
        folder.mkdir(exist_ok=True)
    found = []
    for i, shape in enumerate(shown):
        assert shape.mesh is not None
        name = f"{i:02d}.stl"
        corners = shape.mesh.vertices @ shape.placement[:3, :3].T + shape.placement[:3, 3]
        faces = shape.mesh.faces
        if np.linalg.det(shape.placement[:3, :3]) < 0.0:  # in a mirror they are seen from inside
            faces = faces[:, ::-1]
        with atomic(folder / name) as temporary:
            temporary.write_bytes(_stl(corners[faces]))
        found.append(MeshFile(shape.joint, f"{folder.name}/{name}", tuple(shape.color)))
    return found, looks.notes


def _stl(triangles: Array) -> bytes:
    """Returns a binary STL file of triangles, (f, 3, 3)."""
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    records["normal"], records["corners"] = normals / np.where(size > 0.0, size, 1.0), triangles
    return bytes(HEADER) + len(triangles).to_bytes(4, "little") + records.tobytes()
