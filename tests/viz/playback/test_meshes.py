"""Meshes of other people's robots: where they may be, what is read of them, and how they are made light."""

import io
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from spear_pin.viz.playback import mesh_limits, meshes
from spear_pin.viz.playback.appearance import Undrawn
from spear_pin.viz.playback.meshes import Use, find_mesh, light_meshes, lightened
from tests.viz.playback import solids

FILES = {
    "stl": (solids.stl(), None),
    "STL": (solids.stl(), None),
    "obj": (solids.obj().encode(), None),
    "dae": (solids.dae().encode(), (1.0, 0.2, 0.0, 1.0)),
}


@pytest.fixture
def package(tmp_path):
    """The path of a URDF in the package "dog", with a mesh in it, one in the package "cat", and some outside."""
    for name in (
        "home/dog/meshes/leg.stl",
        "home/dog/urdf/parts/leg.stl",
        "home/cat/leg.stl",
        "home/cow/leg.stl",
        "etc/leg.stl",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(solids.stl())
    (tmp_path / "home/cat/package.xml").write_text("<package/>")
    (tmp_path / "home/dog/meshes/notes.txt").write_text("no mesh")
    (tmp_path / "home/dog/meshes/linked.stl").symlink_to(tmp_path / "home/dog/meshes/notes.txt")
    (tmp_path / "home/dog/meshes/folder.stl").mkdir()
    return tmp_path / "home/dog/urdf/dog.urdf"


def read(path, most=10**6):
    return light_meshes((Use(path, path.stat().st_mtime_ns, 1.0, 1),), most)[path]


class TestWhere:
    @pytest.mark.parametrize(
        ("name", "where"),
        [
            ("../meshes/leg.stl", "home/dog/meshes/leg.stl"),
            ("package://dog/meshes/leg.stl", "home/dog/meshes/leg.stl"),
            ("model://dog/meshes/leg.stl", "home/dog/meshes/leg.stl"),
            ("package://renamed/meshes/leg.stl", "home/dog/meshes/leg.stl"),
            ("package:///dog/meshes/leg.stl", "home/dog/meshes/leg.stl"),
            ("package://parts/leg.stl", "home/dog/urdf/parts/leg.stl"),
            ("package://cat/leg.stl", "home/cat/leg.stl"),
            ("../meshes/../meshes/leg.stl", "home/dog/meshes/leg.stl"),
        ],
    )
    def test_found(self, package, tmp_path, name, where):
        assert find_mesh(name, package) == tmp_path / where

    def test_an_absolute_path_inside(self, package, tmp_path):
        path = tmp_path / "home/dog/meshes/leg.stl"
        assert find_mesh(str(path), package) == find_mesh(f"file://{path}", package) == path

    @pytest.mark.parametrize(
        ("name", "why"),
        [
            ("../../../etc/leg.stl", "not in the robot's folders"),
            ("../meshes/../../../etc/leg.stl", "not in the robot's folders"),
            ("package://dog/../../../../etc/leg.stl", "not in the robot's folders"),
            ("package://dog/../../etc/leg.stl", "no such file"),  # but for "dog", in it
            ("package://../../etc/leg.stl", "not in the robot's folders"),
            ("package://cow/../../../etc/leg.stl", "not in the robot's folders"),
            ("{root}/etc/leg.stl", "not in the robot's folders"),
            ("file://{root}/etc/leg.stl", "not in the robot's folders"),
            ("package://cow/leg.stl", "no such file"),  # beside it, but no package
            ("../meshes/leg\0.stl", "not in the robot's folders"),
            ("../meshes/arm.stl", "no such file"),
            ("../meshes/folder.stl", "no such file"),
            ("../meshes/linked.stl", "no such file"),
            ("../meshes/notes.txt", "read are .stl, .obj, .dae"),
            ("", "read are .stl, .obj, .dae"),
            ("https://example.org/leg.stl", "nothing is fetched"),
        ],
    )
    def test_refused(self, package, tmp_path, name, why):
        with pytest.raises(Undrawn) as refused:
            find_mesh(name.replace("{root}", str(tmp_path)), package)
        assert refused.value.why == why

    def test_from_a_relative_path(self, package, monkeypatch):
        monkeypatch.chdir(package.parents[1])
        assert find_mesh("../meshes/leg.stl", Path("urdf/../urdf/dog.urdf")) == package.parents[1] / "meshes/leg.stl"
        with pytest.raises(Undrawn):
            find_mesh("package://../etc/leg.stl", Path("urdf/../urdf/dog.urdf"))


class TestReading:
    @pytest.mark.parametrize("suffix", FILES)
    def test_a_cube(self, tmp_path, suffix):
        path = tmp_path / f"cube.{suffix}"
        path.write_bytes(FILES[suffix][0])
        (mesh,) = read(path)
        assert len(mesh.vertices) == 8 and len(mesh.faces) == 12 and mesh.color == FILES[suffix][1]
        assert {tuple(map(round, corner)) for corner in mesh.vertices} == {tuple(corner) for corner in solids.CORNERS}
        corners = mesh.vertices[mesh.faces]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        assert areas == pytest.approx(0.5)

    def test_unit_and_place_of_collada(self, tmp_path):
        path = tmp_path / "cube.dae"
        path.write_text(solids.dae(meter=0.01, shift=3.0))
        (mesh,) = read(path)
        assert mesh.low == pytest.approx([0.03, 0, 0]) and mesh.high == pytest.approx([0.04, 0.01, 0.01])

    def test_collada_whose_material_is_broken(self, tmp_path):
        """As anymal's foot, whose texture is named and not there: its reader leaves the geometry out."""
        path = tmp_path / "foot.dae"
        path.write_text(solids.dae(effect=""))
        (mesh,) = read(path)
        assert len(mesh.faces) == 12 and mesh.color is None

    def test_other_files_are_not_read(self, tmp_path, monkeypatch):
        path = tmp_path / "cube.obj"
        path.write_text(solids.obj("mtllib /etc/passwd"))
        opened = []
        monkeypatch.setattr("builtins.open", lambda name, *_, **__: opened.append(name))
        assert len(read(path)[0].faces) == 12 and opened == []

    @pytest.mark.parametrize(
        ("name", "data", "why"),
        [
            ("junk.stl", b"junk", "no triangles"),
            ("none.stl", solids.stl(faces=solids.FACES[:0]), "no triangles"),
            ("junk.dae", b"<COLLADA", "cannot be read"),
            ("entity.dae", b'<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "b">]><COLLADA/>', "no plain COLLADA"),
            ("endless.stl", solids.stl(np.full((8, 3), np.nan)), "no numbers below"),
            ("flat.stl", solids.stl(np.zeros((8, 3))), "no triangles"),
            ("junk.obj", b"v 0 0 0\nf 1 2 9", "cannot be read"),
        ],
    )
    def test_broken_files(self, tmp_path, name, data, why):
        path = tmp_path / name
        path.write_bytes(data)
        said = read(path)
        assert isinstance(said, str) and why in said and "\n" not in said

    def test_an_archive_is_not_opened(self, tmp_path):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w") as archive:
            archive.writestr("cube.dae", solids.dae())
        path = tmp_path / "cube.dae"
        path.write_bytes(packed.getvalue())
        assert read(path) == "no plain COLLADA file"

    def test_a_file_too_large(self, tmp_path, monkeypatch):
        monkeypatch.setattr(meshes, "MOST_BYTES", 100)
        path = tmp_path / "cube.stl"
        path.write_bytes(solids.stl())
        assert read(path) == "more than 100 bytes"


DOUBLING = "".join(f'<node id="k{i}">{2 * f"""<instance_node url="#k{i - 1}"/>"""}</node>' for i in range(1, 60))
GROUPS = "".join(f"usemtl m{i}\ng g{i}\no o{i}\nf 1 2 3\n" for i in range(100_000))
TOO_MUCH = {  # what may take long, or much memory, though the file is small
    "of nodes that put nodes.dae": (
        lambda: solids.dae(nodes='<node id="k0"><instance_geometry url="#cube"/></node>' + DOUBLING, put="k59"),
        "more than 5000 nodes",
    ),
    "of nodes that put themselves.dae": (
        lambda: solids.dae(nodes='<node id="a"><instance_node url="#a"/></node>', put="a"),
        "more than 100 nodes in one another",
    ),
    "deep.dae": (
        lambda: solids.dae(nodes='<node id="a">' + "<node>" * 200 + "</node>" * 201, put="a"),
        "more than 100 nodes in one another",
    ),
    "deeper.dae": (lambda: "<node>" * 100_000, "cannot be read: Excessive depth"),
    "of materials.dae": (lambda: solids.dae(nodes="<material/>" * 6000), "more than 5000 material elements"),
    "of geometries.dae": (lambda: solids.dae(nodes="<geometry/>" * 6000), "more than 5000 geometry elements"),
    "of tags.dae": (lambda: solids.dae(nodes="<extra/>" * 300_000), "more than 300000 tags"),
    "of triangles.dae": (
        lambda: solids.dae(nodes=f"<geometry><triangles><input/><p>{'0 ' * 2_200_000}</p></triangles></geometry>"),
        "more than 700000 triangles",
    ),
    "of triangles.obj": (lambda: "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 700_001, "more than 700000 triangles"),
    "of one face.obj": (lambda: "v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + " 1 2 3" * 240_000, "more than 700000 triangles"),
    "of points.obj": (lambda: "v 0 0 0\n" * 2_000_002, "more than 2000000 points"),
    "of triangles.stl": (
        lambda: bytes(80) + (700_001).to_bytes(4, "little") + bytes(50 * 700_001),
        "more than 700000 triangles",
    ),
    "that lies.stl": (
        lambda: bytes(80) + b"\xff\xff\xff\xff" + bytes(5000),
        "says that it has 4294967295 triangles, and has room for 100",
    ),
    "in words.stl": (lambda: "solid a\n" + "vertex " * 2_100_003, "more than 700000 triangles"),
}


class TestLimits:
    @pytest.mark.parametrize("name", TOO_MUCH)
    def test_not_drawn(self, tmp_path, name):
        make, why = TOO_MUCH[name]
        data = make()
        path = tmp_path / name
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        said = read(path)
        assert isinstance(said, str) and re.search(why, said) and "\n" not in said

    def test_groups_and_materials_of_obj_do_not_count(self, tmp_path):
        path = tmp_path / "a.obj"
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + GROUPS)
        (mesh,) = read(path)
        assert len(mesh.faces) == 1

    def test_a_node_put_often_counts_often(self, tmp_path, monkeypatch):
        path = tmp_path / "a.dae"
        path.write_text(solids.dae(nodes='<node id="a"><instance_geometry url="#cube"/></node>', put="a"))
        monkeypatch.setattr(mesh_limits, "MOST_FACES", 24)
        assert sum(len(each.faces) for each in read(path)) == 24
        meshes.light_meshes.cache_clear()
        monkeypatch.setattr(mesh_limits, "MOST_FACES", 23)
        assert read(path) == "more than 23 triangles"

    def test_together(self, tmp_path, monkeypatch):
        uses = []
        for name in ("a.stl", "b.stl", "c.stl"):
            (tmp_path / name).write_bytes(solids.stl())
            uses.append(meshes.Use(tmp_path / name, 1, 1.0, 1))
        monkeypatch.setattr(meshes, "MOST_TOGETHER", 24)
        *drawn, left = light_meshes(tuple(uses), 100).values()
        assert [len(each) for each in drawn] == [1, 1] and left == "more than 24 triangles with the others"
        light_meshes.cache_clear()
        monkeypatch.setattr(meshes, "MOST_SECONDS", -1.0)
        assert set(light_meshes(tuple(uses), 100).values()) == {"reading the others took -1 s"}


def mesh(corners, faces):
    return meshes.Mesh(np.asarray(corners), np.asarray(faces))


class TestLightening:
    def test_what_is_light_stays(self):
        cube = mesh(solids.CORNERS, solids.FACES)
        assert lightened(cube, 12) is cube

    @pytest.mark.parametrize("most", [4000, 500, 150])
    def test_a_ball_stays_one(self, most):
        light = lightened(mesh(*solids.ball(100)), most)
        assert 0.3 * most < len(light.faces) <= most
        corners = light.vertices[light.faces]
        middles = np.linalg.norm(corners.mean(axis=1), axis=1)
        assert 1.0 - 6.0 / most**0.5 < middles.min() and np.linalg.norm(corners, axis=2).max() < 1.0 + 1e-9
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
        assert area == pytest.approx(4 * np.pi, rel=1.5 / most**0.5)

    def test_many_small_pieces_leave_the_large_one(self):
        """A hundred screws, of which decimation would keep some faces each, on a plate of one cube."""
        pieces = [solids.ball(12, (k % 10 / 10, k // 10 / 10, 0.5), 0.01) for k in range(100)]
        pieces.append((solids.CORNERS, solids.FACES))
        starts = np.cumsum([0] + [len(corners) for corners, _ in pieces[:-1]])
        whole = mesh(
            np.concatenate([corners for corners, _ in pieces]),
            np.concatenate([faces + start for (_, faces), start in zip(pieces, starts, strict=True)]),
        )
        light = lightened(whole, 300)
        assert len(light.faces) <= 300
        assert light.low == pytest.approx([0, 0, 0], abs=0.02) and light.high == pytest.approx([1, 1, 1], abs=0.02)

    def test_together_they_are_not_too_many(self, tmp_path):
        sizes = {"large.stl": 1.0, "small.stl": 0.1}
        for name, radius in sizes.items():
            (tmp_path / name).write_bytes(solids.stl(*solids.ball(60, radius=radius)))
        uses = tuple(Use(tmp_path / name, 0, 1.0, times) for name, times in (("large.stl", 1), ("small.stl", 4)))
        found = light_meshes(uses, 3000)
        counts = [sum(len(mesh.faces) for mesh in found[use.path]) for use in uses]
        assert 1500 < counts[0] + 4 * counts[1] <= 3000 and counts[0] > 5 * counts[1]

    def test_read_once(self, tmp_path):
        path = tmp_path / "cube.stl"
        path.write_bytes(solids.stl())
        assert read(path) is read(path)
        assert light_meshes((Use(path, 1, 1.0, 1),), 10**6)[path] is not read(path)
