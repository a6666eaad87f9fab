"""Meshes that a robot's file names: found only in its folders, read without downloads, and reduced for a page."""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path, PurePosixPath
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadFile
from spear_pin.files import regular
from spear_pin.viz.playback.appearance import Color, Undrawn
from spear_pin.viz.playback.mesh_limits import MOST_BYTES, MOST_SECONDS, MOST_TOGETHER, PARSER, lean

SUFFIXES = (".stl", ".obj", ".dae")
REMOTE = ("http:", "https:", "ftp:", "data:")
LARGEST = 1e9
WELD = 1e-5  # of a mesh's size: corners that are nearer are one
FINEST, COARSEST = 512, 2  # cells of joined corners, along a mesh's size
FEWEST = 12  # faces


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with one colour.

    Attributes:
        vertices: corners, (v, 3), in m.
        faces: indices of corners, (f, 3).
        color: colour; None where the file has none.
    """

    vertices: Array
    faces: NDArray[np.intp]
    color: Color | None = None

    @cached_property
    def low(self) -> Array:
        """Least x, y and z, (3,), in m."""
        return np.asarray(self.vertices.min(axis=0))

    @cached_property
    def high(self) -> Array:
        """Largest x, y and z, (3,), in m."""
        return np.asarray(self.vertices.max(axis=0))


def find_mesh(name: str, file: Path) -> Path:
    """Returns the path of a mesh that a robot's file names.

    The mesh is in the folder of the file, or in the package around it: the nearest folder above with a `package.xml`,
    else the parent folder. `package://NAME/...` is searched for in the folders above with that name, or with a package
    of that name in them, and in the package around the file, with and without NAME.

    Args:
        name: name in the file.
        file: path of the file.

    Raises:
        Undrawn: the mesh is elsewhere, there is no such file, or it is of another kind.
    """
    what = f"mesh {name!r}"
    if name.lower().startswith(REMOTE):
        raise Undrawn(what, "nothing is fetched")
    if PurePosixPath(name).suffix.lower() not in SUFFIXES:
        raise Undrawn(what, f"read are {', '.join(SUFFIXES)}")
    candidates = list(_candidates(name, Path(os.path.abspath(file))))
    inside = [path for folder, path in candidates if _within(folder, path)]
    if not inside:
        raise Undrawn(what, "not in the robot's folders")
    for path in inside:
        try:
            # a link leads to a mesh, or nowhere
            if regular(path).resolve().suffix.lower() in SUFFIXES:
                return path
        except BadFile:
            continue
    raise Undrawn(what, "no such file")


def _candidates(name: str, file: Path) -> Iterator[tuple[Path, Path]]:
    """Returns folders in which a mesh may be, and its path there, without any `..`."""
    scheme, colon, rest = name.partition("://")
    around = _package(file)
    if colon and scheme in ("package", "model"):
        package, _, rest = rest.lstrip("/").partition("/")
        for folder in file.parents:
            if folder.name == package:
                yield folder, _plain(folder, rest)
            elif package not in ("", ".", "..") and (folder / package / "package.xml").is_file():
                yield folder / package, _plain(folder / package, rest)
        yield around, _plain(around, rest)
        yield around, _plain(file.parent, f"{package}/{rest}")
        return
    path = rest if colon and scheme == "file" else name
    yield around, _plain(file.parent, path)


def _package(file: Path) -> Path:
    """Returns the folder around a robot's file in which its meshes may be."""
    for folder in file.parents:
        if (folder / "package.xml").is_file():
            return folder
    above = file.parent.parent
    return file.parent if above == above.parent else above  # not the whole disk


def _plain(folder: Path, name: str) -> Path:
    return Path(os.path.normpath(folder / name))


def _within(folder: Path, path: Path) -> bool:
    return path.is_relative_to(folder) and "\0" not in str(path)


class Use(NamedTuple):
    """A mesh file as it is drawn.

    Attributes:
        path: path of the file.
        changed: time at which the file was written, in ns.
        scale: largest scale at which it is drawn.
        times: how often it is drawn.
    """

    path: Path
    changed: int
    scale: float
    times: int


@lru_cache(maxsize=8)  # a page is tried several times
def light_meshes(uses: tuple[Use, ...], most: int) -> Mapping[Path, tuple[Mesh, ...] | str]:
    """Returns the meshes of some files, one for each of a file's colours; or the reason in a line why there are none.

    Args:
        uses: the files.
        most: largest number of faces of all together, roughly; large meshes get more than small ones.
    """
    found: dict[Path, tuple[Mesh, ...] | str] = {}
    begun, faces = process_time(), 0
    for use in uses:
        try:
            if process_time() > begun + MOST_SECONDS:
                raise ValueError(f"reading the others took {MOST_SECONDS:g} s")
            meshes = _read(use.path)
            if (faces := faces + sum(len(mesh.faces) for mesh in meshes)) > MOST_TOGETHER:
                raise ValueError(f"more than {MOST_TOGETHER} triangles with the others")
            found[use.path] = meshes
        except OSError as error:
            found[use.path] = error.strerror or str(error)
        except ValueError as error:
            found[use.path] = str(error)
    read = [(use, mesh) for use in uses for mesh in found[use.path] if isinstance(mesh, Mesh)]
    counts = np.array([len(mesh.faces) for _, mesh in read], dtype=float)
    sizes = np.array([use.scale * float(np.linalg.norm(mesh.high - mesh.low)) for use, mesh in read])
    share = _shares(counts, sizes, np.array([use.times for use, _ in read]), most)
    light: dict[Path, list[Mesh]] = {use.path: [] for use in uses}
    for (use, mesh), each in zip(read, share, strict=True):
        light[use.path].append(lightened(mesh, each))
    return {
        path: meshes if isinstance(meshes, str) else tuple(mesh for mesh in light[path] if len(mesh.faces))
        for path, meshes in found.items()
    }


def _shares(faces: Array, sizes: Array, counts: NDArray[Any], most: int) -> list[int]:
    """Returns the number of faces that each mesh may have: all, or a share by its size if they are too many."""
    low, high = 0.0, float((faces / sizes).max(initial=0.0))
    if counts @ faces > most:
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if counts @ np.minimum(faces, middle * sizes) <= most else (low, middle)
    return [max(FEWEST, int(each)) for each in np.minimum(faces, high * sizes)]


def _read(path: Path) -> tuple[Mesh, ...]:
    """Returns the meshes of a file; raises ValueError with the reason where there are none."""
    if path.stat().st_size > MOST_BYTES:
        raise ValueError(f"more than {MOST_BYTES} bytes")
    data, kind = path.read_bytes(), path.suffix.lower().removeprefix(".")
    # of a zip pycollada reads what is in it
    if kind == "dae" and (data[:2] in (b"PK", b"\xff\xfe", b"\xfe\xff") or b"<!DOCTYPE" in data or b"<!ENTITY" in data):
        raise ValueError("no plain COLLADA file")
    data = _lean(data, kind)
    parts = _parts(data, kind)
    if kind == "dae" and not parts:  # a geometry is left out where one of its materials is broken
        parts = _parts(_bare(data), kind)
    meshes = [
        _welded(corners[0] if len(corners) == 1 else np.concatenate(corners), color) for color, corners in parts.items()
    ]
    meshes = [mesh for mesh in meshes if len(mesh.faces)]
    if not meshes:
        raise ValueError("it has no triangles")
    return tuple(meshes)


def _lean(data: bytes, kind: str) -> bytes:
    try:
        return lean(data, kind)
    except etree.XMLSyntaxError as error:
        raise ValueError(f"cannot be read: {error.msg}"[:200]) from None


def _bare(data: bytes) -> bytes:
    """Returns a COLLADA file without its materials."""
    root = etree.fromstring(data, etree.XMLParser(**PARSER))
    for tag in ("bind_material", "library_images", "library_effects", "library_materials"):
        for element in list(root.iter(f"{{*}}{tag}")):
            element.getparent().remove(element)
    return bytes(etree.tostring(root))


def _parts(data: bytes, kind: str) -> dict[Color | None, list[Array]]:
    """Returns corners of the triangles of a file, (f, 3, 3), by their colour.

    Raises:
        ValueError: the file cannot be read.
    """
    import trimesh

    options: dict[str, Any] = {"skip_materials": True} if kind == "obj" else {}
    parts: dict[Color | None, list[Array]] = {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # from memory, so that it names no other file to read
            scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False, **options)
            for node in scene.graph.nodes_geometry:
                pose, name = scene.graph[node]
                geometry = scene.geometry[name]
                if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
                    pose = _unit(geometry.units) * np.asarray(pose)[:3]
                    vertices = np.asarray(geometry.vertices) @ pose[:, :3].T + pose[:, 3]
                    parts.setdefault(_color(geometry.visual), []).append(vertices[np.asarray(geometry.faces)])
    except Exception as error:  # what its readers raise at a broken file is not said
        raise ValueError(f"cannot be read: {str(error) or type(error).__name__}"[:200]) from None
    return parts


def _unit(units: str | None) -> float:
    """Returns the metres of a unit in COLLADA."""
    number, times, _ = (units or "").partition("*")
    return float(number) if times else 1.0


def _color(visual: Any) -> Color | None:
    """Returns the colour of most of a mesh; none where it is white, as it is where the file gives no colour."""
    if not visual.defined:
        return None
    material = getattr(visual, "material", visual)
    red, green, blue = (float(part) / 255.0 for part in np.asarray(material.main_color)[:3])
    return None if min(red, green, blue) == 1.0 else (red, green, blue, 1.0)


def _welded(corners: Array, color: Color | None) -> Mesh:
    """Returns a mesh of triangles, (f, 3, 3), with their common corners joined."""
    points = corners.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    if not (low.min() > -LARGEST and high.max() < LARGEST):
        raise ValueError(f"it has corners that are no numbers below {LARGEST:g}")
    cell = WELD * float((high - low).max()) or 1.0
    base, keys = round(1.0 / WELD) + 2, np.zeros(len(points), np.int64)
    for column, least in zip(points.T, low, strict=True):  # one after the other: of a million faces all are large
        keys = keys * base + np.round((column - least) / cell).astype(np.int64)
    _, first, index = np.unique(keys, return_index=True, return_inverse=True)
    return _tidy(points[first], index.reshape(-1, 3), color)


def _tidy(vertices: Array, faces: NDArray[Any], color: Color | None) -> Mesh:
    """Returns a mesh without degenerate or repeated triangles, and without unused corners."""
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    first, _, _ = _distinct(np.sort(faces, axis=1))
    used, index = np.unique(faces[np.sort(first)], return_inverse=True)
    return Mesh(np.asarray(vertices[used], dtype=np.float64), index.reshape(-1, 3), color)


def _distinct(rows: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Returns, for rows of three numbers >= 0, the first of each kind, the kind of each row, and the counts."""
    base = int(rows.max(initial=0)) + 1
    # as one number each they are sorted in a tenth of the time
    keys = rows @ np.array([base * base, base, 1]) if base < 2**21 else rows
    _, first, index, count = np.unique(keys, axis=0, return_index=True, return_inverse=True, return_counts=True)
    return first, index.ravel(), count


def lightened(mesh: Mesh, most: int) -> Mesh:
    """Returns a mesh with a limited number of faces: near corners are joined until there are few enough.

    Decimation edge by edge takes more time for half a million faces. It also destroys large pieces where small ones,
    such as the many parts of a screw, may not vanish.
    """
    light, cells = mesh, FINEST
    while len(light.faces) > most and cells >= COARSEST:
        light = _joined(mesh, cells)
        # of a surface, faces are as the square of the cells
        cells = int(cells * np.clip(np.sqrt(most / max(1, len(light.faces))), 0.25, 0.95))
    return light


def _joined(mesh: Mesh, cells: int) -> Mesh:
    """Returns a mesh in which corners in the same cell, of so many along its size, are joined in their middle."""
    low = mesh.low
    cell = float((mesh.high - low).max()) / cells
    _, index, count = _distinct(np.floor((mesh.vertices - low) / cell).astype(np.int64))
    middles = np.column_stack([np.bincount(index, column) for column in mesh.vertices.T]) / count[:, None]
    return _tidy(middles, index[mesh.faces], mesh.color)
