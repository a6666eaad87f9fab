"""Meshes of a robot: files that grow as they are read, counts that lie, ways out of the robot's folders."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path

from tests.hostile.case import Drawn
from tests.hostile.data import HARM
from tests.hostile.robots import Text, urdf
from tests.viz.playback import solids

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
FILES: Mapping[str, tuple[str, Text]] = {
    "nodes that put nodes": ("a.dae", lambda: doubling(60)),
    "nodes that put themselves": (
        "a.dae",
        lambda: solids.dae(nodes='<node id="a"><instance_node url="#a"/></node>', put="a"),
    ),
    "nodes 5000 deep": (
        "a.dae",
        lambda: solids.dae(put="a", nodes='<node id="a">' + "<node>" * 5000 + "</node>" * 5001),
    ),
    "900 nodes in one another": (
        "a.dae",
        lambda: solids.dae(put="a", nodes='<node id="a">' + "<node>" * 900 + "</node>" * 901),
    ),
    "100,000 nodes": ("a.dae", lambda: solids.dae(nodes="<node/>" * 100_000)),
    "100,000 materials of COLLADA": (
        "a.dae",
        lambda: solids.dae(
            nodes="".join(f'<material id="m{i}"><instance_effect url="#coat"/></material>' for i in range(100_000))
        ),
    ),
    "4000 effects": (
        "a.dae",
        lambda: solids.dae(effect=solids.EFFECT + "".join(solids.EFFECT.replace("coat", f"c{i}") for i in range(4000))),
    ),
    "50,000 parameters of an effect": (
        "a.dae",
        lambda: solids.dae(
            effect=solids.EFFECT.replace(
                "<technique",
                "".join(f'<newparam sid="p{i}"><float>1</float></newparam>' for i in range(50_000)) + "<technique",
                1,
            )
        ),
    ),
    "a million attributes": ("a.dae", lambda: "<COLLADA " + " ".join(f'a{i}=""' for i in range(1_000_000)) + "/>"),
    "a billion laughs": ("a.dae", lambda: '<!DOCTYPE a [<!ENTITY a "b">]>' + solids.dae()),
    "a picture of the disk": (
        "a.dae",
        lambda: solids.dae(effect='<image id="i"><init_from>file:///etc/passwd</init_from></image>' + solids.EFFECT),
    ),
    "a texture of 50,000 x 50,000": (
        "a.dae",
        lambda: solids.dae(effect='<image id="i"><init_from>bomb.png</init_from></image>'),
    ),
    "a count of 10^12": ("a.dae", lambda: solids.dae().replace('count="24"', 'count="1000000000000"')),
    "indices beyond the corners": ("a.dae", lambda: solids.dae().replace("<p>0", "<p>999999999")),
    "indices below zero": ("a.dae", lambda: solids.dae().replace("<p>0", "<p>-1")),
    "corners of 1e308": ("a.dae", lambda: solids.dae(shift=1e308)),
    "a unit of 1e300": ("a.dae", lambda: solids.dae(meter=1e300)),
    "a matrix of nan": ("a.dae", lambda: solids.dae(shift=float("nan"))),
    "2 million triangles of COLLADA": ("a.dae", lambda: solids.dae().replace("<p>", "<p>" + "0 1 2 " * 2_000_000)),
    "600,000 triangles of COLLADA": (
        "a.dae",
        lambda: (
            solids.dae()
            .replace('<triangles count="12"', '<triangles count="600012"')
            .replace("<p>", "<p>" + "0 1 2 " * 600_000)
        ),
    ),
    "a polygon of a million corners": ("a.obj", lambda: TRIANGLE + "f" + " 1 2 3" * 333_333),
    "60 MB of faces": ("a.obj", lambda: TRIANGLE + "f 1 2 3\n" * 7_500_000),
    "48 MB of faces": ("a.obj", lambda: TRIANGLE + "f 1 2 3\n" * 6_000_000),
    "600,000 faces": ("a.obj", lambda: TRIANGLE + "f 1/1/1 2/2/2 3/3/3\n" * 600_000),
    "100,000 materials": ("a.obj", lambda: TRIANGLE + "".join(f"usemtl m{i}\nf 1 2 3\n" for i in range(100_000))),
    "100,000 groups": ("a.obj", lambda: TRIANGLE + "".join(f"g a{i}\no b{i}\nf 1 2 3\n" for i in range(100_000))),
    "1.9 million points": ("a.obj", lambda: "v 0 0 0\n" * 1_900_000 + "f 1 2 3\n"),
    "a library of materials of the disk": (
        "a.obj",
        lambda: "mtllib /etc/passwd\nmtllib ../../../dev/zero\n" + TRIANGLE + "f 1 2 3\n",
    ),
    "corners that are none": ("a.obj", lambda: TRIANGLE + "f 1 2 999999999999999999999\n"),
    "corners of a million digits": ("a.obj", lambda: "v 0 0 " + "9" * 1_000_000 + "\n" + TRIANGLE + "f 1 2 3\n"),
    "words with escapes": ("a.obj", lambda: TRIANGLE + "\x1b]0;title\x07\nf a b c\n"),
    "four billion triangles that are not there": ("a.stl", lambda: bytes(80) + b"\xff" * 4 + bytes(500)),
    "980,000 triangles": ("a.stl", lambda: bytes(80) + struct.pack("<I", 980_000) + bytes(50 * 980_000)),
    "690,000 triangles": ("a.stl", lambda: bytes(80) + struct.pack("<I", 690_000) + _noise(690_000)),
    "100 MB": ("a.stl", lambda: bytes(80) + struct.pack("<I", 2_000_000) + bytes(100_000_000)),
    "triangles of nan": ("a.stl", lambda: solids.stl().replace(b"\0\0\x80?", b"\0\0\xc0\x7f")),
    "48 MB of words": ("a.stl", lambda: "solid a\n" + "facet normal 0 0 1 " * 2_500_000),
    "200,000 triangles in words": ("a.stl", lambda: "solid a\n" + _FACET * 200_000 + "endsolid a\n"),
    "a name with escapes": ("a.stl", lambda: "solid \x1b]0;title\x07\nendsolid"),
    "a solid that never ends": ("a.stl", lambda: "solid a\nfacet normal 0 0 1\nouter loop\n"),
    "noise as STL": ("a.stl", lambda: bytes(range(256)) * 1000),
    "noise as OBJ": ("a.obj", lambda: bytes(range(256)) * 1000),
    "noise as COLLADA": ("a.dae", lambda: bytes(range(256)) * 1000),
    "a zip that is called COLLADA": ("a.dae", lambda: b"PK\x03\x04" + bytes(1000)),
    "a picture of 50,000 x 50,000": ("a.png", lambda: _picture(50_000)),
    "a glTF of buffers without end": ("a.gltf", lambda: '{"buffers": [{"byteLength": 1000000000000}]}'),
}
_FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
PLACES = {
    "upwards": "../../../../../../etc/passwd",
    "upwards to a mesh": "../../../../../../tmp/a.stl",
    "a device": "/dev/zero",
    "a device that is called a mesh": "file:///dev/zero.stl",
    "the network": "http://127.0.0.1:9/a.stl",
    "a share of the network": "\\\\127.0.0.1\\a\\b.stl",
    "data": "data:model/stl;base64," + "A" * 1_000_000,
    "a name of 1 MB": "x" * 1_000_000 + ".stl",
    "a package without end": "package://" + "../" * 10_000 + "a.stl",
    "a folder": "folder.stl",
    "a link to a device": "link.stl",
}


def doubling(count: int) -> str:
    """Nodes of which each puts the one before twice."""
    nodes = "".join(f'<node id="k{i}">' + 2 * f'<instance_node url="#k{i - 1}"/>' + "</node>" for i in range(1, count))
    return solids.dae(nodes='<node id="k0"><instance_geometry url="#cube"/></node>' + nodes, put=f"k{count - 1}")


def cases() -> Iterator[Drawn]:
    """Every mesh."""
    for what, (name, content) in FILES.items():
        yield Drawn(f"mesh: {what}", _draw, _robot(name, name, content))
    for what, place in PLACES.items():
        yield Drawn(f"mesh elsewhere: {what}", _draw, _robot(place))
    for what, text in HARM.items():
        if what not in ("escapes", "lone surrogates"):  # XML has neither
            yield Drawn(f"mesh called with {what}", _draw, _robot(f"{text}.stl"))
    yield Drawn("10,000 meshes that are not there", _draw, _robots([f"m{i}.stl" for i in range(10_000)]))
    yield Drawn("200 meshes of 20,000 triangles", _draw, _robots([f"m{i}.stl" for i in range(200)], _noise(20_000)))


def _robot(shown: str, name: str = "", content: Text = bytes):
    def write(folder: Path) -> None:
        _write(folder, [shown])
        (folder / "folder.stl").mkdir()
        (folder / "link.stl").symlink_to("/dev/zero")
        (folder / "bomb.png").write_bytes(_picture(50_000))
        if name:
            data = content()
            (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())

    return write


def _robots(shown: list[str], content: bytes = b""):
    def write(folder: Path) -> None:
        _write(folder, shown)
        for name in shown if content else ():
            (folder / name).write_bytes(bytes(80) + struct.pack("<I", len(content) // 50) + content)

    return write


def _write(folder: Path, shown: list[str]) -> None:
    visuals = "".join(f'<visual><geometry><mesh filename="{_quoted(name)}"/></geometry></visual>' for name in shown)
    (folder / "a.urdf").write_text(urdf().replace('<link name="base"/>', f'<link name="base">{visuals}</link>'))


def _quoted(name: str) -> str:
    return "".join(char if char.isprintable() else f"&#{ord(char)};" for char in escape(name))


def _draw(folder: Path) -> object:
    """Read what a robot looks like, and print what is not drawn."""
    from spear_pin import load
    from spear_pin.viz.playback.looks import read_looks
    from spear_pin.viz.playback.meshes import light_meshes

    light_meshes.cache_clear()
    notes = read_looks(load("a.urdf", base="fixed", motors="all")).notes
    print(*notes, sep="\n")
    light_meshes.cache_clear()
    return notes


def _noise(count: int) -> bytes:
    """Triangles of an STL, each of other corners."""
    import numpy as np

    rows = np.zeros(count, dtype=[("numbers", "<f4", 12), ("more", "<u2")])
    rows["numbers"] = np.random.default_rng(0).random((count, 12), dtype=np.float32)
    return rows.tobytes()


def _picture(side: int) -> bytes:
    """A PNG of so many points a side, all black, in few bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 1, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(bytes(1_000_000), 9)) + chunk(b"IEND", b"")
