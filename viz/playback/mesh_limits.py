"""Size of a mesh file, counted before it is read: meshes that take too much time or memory are not drawn."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Mapping
from typing import Any

from lxml import etree

MOST_BYTES = 50_000_000  # of a file
MOST_FACES = 700_000  # triangles of a file, wherever it puts them
MOST_TOGETHER = 2_000_000  # triangles of a robot's files
MOST_SECONDS = 8.0  # of the processor, for reading a robot's files
MOST_POINTS = 2_000_000
MOST_NODES = 5_000  # of a COLLADA file: nodes, wherever they are put, geometries, materials
MOST_TAGS = 300_000
DEEPEST = 100  # nodes in nodes
PARSER = {"resolve_entities": False, "no_network": True, "load_dtd": False, "huge_tree": True}
_FACE = re.compile(rb"^[ \t]*f[ \t]([^\n]*)", re.MULTILINE)
_GROUPS = re.compile(rb"^[ \t]*(usemtl|mtllib|[ogs])\b[^\n]*", re.MULTILINE)
_LISTED = ("geometry", "material", "effect", "image", "node", "controller")
Count = tuple[int, int]
Counts = dict[Any, Count]


def lean(data: bytes, kind: str) -> bytes:
    """Returns a mesh file's content without the parts that are not drawn.

    Args:
        data: content of the file.
        kind: kind of the file: obj, stl or dae.

    Raises:
        ValueError: the file holds too much, or is not what it says; the text says what.
    """
    if kind == "obj":
        return _lean_obj(data)
    _check_stl(data) if kind == "stl" else _check_dae(data)
    return data


def _require(count: float, most: int, what: str) -> None:
    if count > most:
        raise ValueError(f"more than {most} {what}")


def _lean_obj(data: bytes) -> bytes:
    """Returns an OBJ file without names of groups and materials, which would each make a mesh of its own."""
    _require(data.count(b"\nv"), MOST_POINTS, "points")
    faces = 0
    for found in _FACE.finditer(data):
        line = found[1]
        faces += max(line.count(b" ") + line.count(b"\t") - 1, 1)
        _require(faces, MOST_FACES, "triangles")
    return _GROUPS.sub(b"", data)


def _check_stl(data: bytes) -> None:
    if len(data) < 84:
        return
    said, held = int.from_bytes(data[80:84], "little"), max(len(data) - 84, 0) // 50
    if len(data) == 84 + 50 * said:
        _require(said, MOST_FACES, "triangles")
    elif data.lstrip()[:5].lower() != b"solid":
        raise ValueError(f"it says that it has {said} triangles, and has room for {held}")
    else:
        _require((data.count(b"ertex") + data.count(b"ERTEX")) / 3, MOST_FACES, "triangles")


def _check_dae(data: bytes) -> None:
    _require(data.count(b"<"), MOST_TAGS, "tags")
    root = etree.fromstring(data, etree.XMLParser(**PARSER))
    count = Counter(etree.QName(element).localname for element in root.iter(etree.Element))
    for tag in _LISTED:
        _require(count[tag], MOST_NODES, f"{tag} elements")
    own: dict[str, int] = {}
    for element in root.iter("{*}geometry"):
        own[element.get("id")] = max(own.get(element.get("id"), 0), _faces(element))
    _require(sum(own.values()), MOST_FACES, "triangles")
    known: Counts = {}
    named = defaultdict(list)
    for element in root.iter("{*}node"):
        named[element.get("id")].append(element)
    for scene in root.iter("{*}visual_scene"):
        nodes, faces = _put(scene, named, own, known, 0)
        _require(nodes, MOST_NODES, "nodes")
        _require(faces, MOST_FACES, "triangles")


def _faces(geometry: Any) -> int:
    """Returns the largest possible number of triangles of a COLLADA geometry."""
    total = 0
    for kind in ("triangles", "polylist", "polygons", "tristrips", "trifans"):
        for group in geometry.iter(f"{{*}}{kind}"):
            offsets = {element.get("offset", "0") for element in group.findall("{*}input")}
            corners = [_numbers(each) / max(len(offsets), 1) for each in group.iter("{*}p")]
            pieces = sum(map(_numbers, group.findall("{*}vcount"))) if kind == "polylist" else len(corners)
            total += int(sum(corners) / 3 if kind == "triangles" else max(sum(corners) - 2 * pieces, 0))
    return total


def _numbers(element: Any) -> int:
    """Returns the largest possible number of numbers in an element: one more than there are blanks."""
    text: str = element.text or ""
    return 1 + sum(map(text.strip().count, " \n\t"))


def _put(element: Any, named: Mapping[str, list[Any]], own: Mapping[str, int], known: Counts, deep: int) -> Count:
    """Returns how many nodes a node is with all in it, and how many triangles, each as often as it is placed.

    Args:
        element: the node, or the scene.
        named: nodes by their names, of which several may have one.
        own: numbers of triangles of geometries, by the geometries' names.
        known: results for nodes so far.
        deep: depth of nesting.
    """
    _require(deep, DEEPEST, "nodes in one another")
    if element not in known:
        nodes, faces = 1, 0
        for part in element.iterchildren(etree.Element):
            tag, target = etree.QName(part).localname, part.get("url", "").removeprefix("#")
            faces += own.get(target, 0) if tag in ("instance_geometry", "instance_controller") else 0
            put = [part] if tag == "node" else named.get(target, []) if tag == "instance_node" else []
            more = [_put(each, named, own, known, deep + 1) for each in put]
            nodes += max((count for count, _ in more), default=0)
            faces += max((count for _, count in more), default=0)
        known[element] = nodes, faces
    return known[element]
