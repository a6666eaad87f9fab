"""Looks of other people's robots: primitives and meshes of URDF and MJCF, and what is said of what is not drawn."""

import numpy as np
import pytest

from spear_pin import load, monopod
from spear_pin.viz import player
from spear_pin.viz.playback.looks import FACES, read_looks
from spear_pin.viz.playback.shapes import GREY, soles
from tests.model.legged import quadruped
from tests.model.round_feet import round_spear
from tests.viz.playback import solids
from tests.viz.playback.test_grafting import dressed
from tests.viz.recording import read
from tests.viz.samples import hop

MJCF = """<mujoco model="dog">
  <compiler meshdir="parts" angle="degree"/>
  <default><default class="look"><geom group="2" material="tin"/></default>
    <default class="touch"><geom group="3" rgba="1 0 0 1"/></default></default>
  <asset><mesh file="cube.stl" scale="0.1 0.2 0.3"/><material name="tin" rgba="0.6 0.6 0.7 1"/></asset>
  <worldbody><geom type="plane" size="9 9 1"/>
    <body name="trunk" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="5" diaginertia="0.1 0.1 0.1"/>
      <geom class="look" type="mesh" mesh="cube" pos="0 0 0.5" euler="0 0 90"/>
      <geom class="look" type="box" size="0.1 0.2 0.3" rgba="0 1 0 1"/>
      <geom class="touch" type="box" size="0.5 0.5 0.5"/>
      <body name="arm" pos="0.1 0 0"><joint name="turn" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
        <geom class="look" type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
        <geom class="look" type="cylinder" size="0.03 0.1" zaxis="1 0 0"/>
        <geom class="look" type="ellipsoid" size="0.1 0.2 0.3"/>
        <geom class="look" type="sphere" size="0.04" rgba="1 1 1 0"/>
        <geom class="look" type="sphere" size="-1"/>
      </body></body></worldbody></mujoco>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/cube.stl").write_bytes(solids.stl())
    return tmp_path


def urdf(folder, *visuals):
    """A robot of one link with visuals."""
    shown = "".join(f"<visual>{visual}</visual>" for visual in visuals)
    body = '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    path = folder / "one.urdf"
    path.write_text(
        '<robot name="one"><material name="blue"><color rgba="0 0 1 1"/></material><link name="world"/>'
        f'<link name="body">{body}{shown}</link><joint name="turn" type="revolute"><parent link="world"/>'
        '<child link="body"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    return load(path, motors=[])


def mesh(name, scale="1 1 1", rest=""):
    return f'<geometry><mesh filename="{name}" scale="{scale}"/></geometry>{rest}'


class TestUrdf:
    def test_a_mesh(self, folder):
        robot = urdf(folder, mesh("parts/cube.stl", "0.1 0.2 -0.3", '<origin xyz="0 0 1"/><material name="blue"/>'))
        (shape,) = read_looks(robot).shapes
        assert (shape.kind, shape.joint, shape.color) == ("mesh", 1, (0.0, 0.0, 1.0, 1.0))
        assert shape.center == pytest.approx([0.05, 0.1, 0.85])
        assert np.abs(shape.placement[:3, :3] @ shape.half_extent) == pytest.approx([0.05, 0.1, 0.15])

    def test_the_colour_of_a_mesh_goes_before_the_links(self, folder):
        (folder / "parts/cube.dae").write_text(solids.dae())
        robot = urdf(folder, mesh("parts/cube.dae", rest='<material name="blue"/>'), mesh("parts/cube.stl"))
        assert [shape.color for shape in read_looks(robot).shapes] == [(1.0, 0.2, 0.0, 1.0), GREY]

    def test_a_capsule(self, folder):
        robot = urdf(folder, '<geometry><capsule radius="0.1" length="0.4"/></geometry>')
        cylinder, *ends = read_looks(robot).shapes
        assert cylinder.kind == "cylinder" and cylinder.size == (0.1, 0.4)
        assert sorted(end.center[2] for end in ends) == pytest.approx([-0.2, 0.2])

    def test_what_is_missing_is_said_once_in_a_line(self, folder):
        box = '<geometry><box size="1"/></geometry>'
        visuals = [*[mesh("parts/none.stl")] * 3, mesh("../../etc/x.stl"), mesh("a.stl"), box]
        looks = read_looks(urdf(folder, *visuals))
        first = "a visual of 'body' (size of <box> is '1'), mesh 'parts/none.stl' of 'body' (no such file)"
        assert looks.notes == (f"not drawn: {first} and 2 more",)

    def test_bones_where_there_is_no_mesh(self, folder):
        path = folder / "dog.urdf"
        shown = f"</inertial><visual>{mesh('no.stl')}</visual></link>"
        path.write_text(quadruped().replace("</inertial></link>", shown))
        looks = read_looks(monopod(load(path, motors="all"), "FL"))
        assert [shape.kind for shape in looks.shapes] == ["cylinder"] * 2  # thigh and shank
        assert looks.notes == ("not drawn: mesh 'no.stl' of 'trunk' (no such file)",)

    @pytest.mark.parametrize("scale", ["1 1", "0 1 1", "nan 1 1", "x"])
    def test_scales_that_are_none(self, folder, scale):
        looks = read_looks(urdf(folder, mesh("parts/cube.stl", scale)))
        assert not looks.shapes and looks.notes[0].startswith("not drawn: ")


class TestMjcf:
    def test_geoms_that_are_shown(self, folder):
        path = folder / "dog.xml"
        path.write_text(MJCF)
        robot = load(path, motors=[])
        cube, box, capsule, *ends, cylinder, ellipsoid = (looks := read_looks(robot)).shapes
        trunk, arm = (robot.model.getJointId(name) for name in robot.model.names[1:])
        assert [shape.joint for shape in looks.shapes] == [trunk] * 2 + [arm] * 5
        assert cube.kind == "mesh" and cube.center == pytest.approx([-0.1, 0.05, 0.65])
        assert cube.color == (0.6, 0.6, 0.7, 1.0) and box.color == (0.0, 1.0, 0.0, 1.0)
        assert box.size == (0.2, 0.4, 0.6)
        assert capsule.size == pytest.approx((0.02, 0.3)) and capsule.center == pytest.approx([0.15, 0.0, 0.0])
        assert sorted(end.center[0] for end in ends) == pytest.approx([0.0, 0.3])
        assert cylinder.size == (0.03, 0.2) and np.abs(cylinder.placement[:3, 2]) == pytest.approx([1, 0, 0])
        assert np.linalg.norm(ellipsoid.placement[:3, :3], axis=0) == pytest.approx([0.1, 0.2, 0.3])
        assert looks.notes == ("not drawn: a sphere of size (-1.0,) of 'arm'",)

    @pytest.mark.parametrize(
        ("turn", "axis"),
        [
            ('quat="2 0 2 0"', (1, 0, 0)),
            ('axisangle="0 2 0 90"', (1, 0, 0)),
            ('euler="0 90 0"', (1, 0, 0)),
            ('xyaxes="0 0 -2 0 1 1"', (1, 0, 0)),
            ('zaxis="3 0 0"', (1, 0, 0)),
        ],
    )
    def test_orientations(self, folder, turn, axis):
        path = folder / "dog.xml"
        path.write_text(MJCF.replace('zaxis="1 0 0"', turn))
        cylinder = next(shape for shape in read_looks(load(path, motors=[])).shapes if shape.size == (0.03, 0.2))
        assert cylinder.placement[:3, 2] == pytest.approx(axis, abs=1e-12)


class TestPages:
    @pytest.fixture
    def heavy(self, folder):
        """A dog each of whose links is a ball of 20,000 faces."""
        (folder / "parts/ball.stl").write_bytes(solids.stl(*solids.ball(100, radius=0.05)))
        ball = f"</inertial><visual>{mesh('parts/ball.stl')}</visual></link>"
        path = folder / "dog.urdf"
        path.write_text(quadruped().replace("</inertial></link>", ball))
        return monopod(load(path, motors="all"), "FL")

    def test_a_page_of_heavy_meshes(self, heavy, folder):
        """Light, of itself alone, and the same again."""
        text = player.page(heavy, hop())
        assert len(text.encode()) < player.MOST_BYTES and str(folder) not in text and "ball.stl" not in text
        record = read(text)
        drawn = [c["object"] for c in record.commands if c["type"] == "set_object" and "/shape " in c["path"]]
        balls = [each for each in drawn if each["geometries"][0]["type"] == "BufferGeometry"]
        assert len(balls) == 5 and all(each["materials"][0]["flatShading"] for each in balls)
        assert sum(len(each["geometries"][0]["data"]["index"]["array"].data) // 6 for each in balls) <= FACES
        assert record.data["notes"] == [] and text == player.page(heavy, hop())

    def test_the_spring_is_at_the_knee(self, heavy):
        record = read(player.page(heavy, hop()))
        path = next(path for path in record.paths if "spring of knee" in path)
        stance = hop().t[40]
        coil = np.linalg.inv(record.pose("/stage/world", stance)) @ record.pose(path, stance)
        q = hop().q[40]
        assert abs(coil[1, 3]) < 0.02 and np.linalg.norm(coil[[0, 2], 3] - q[:2]) < 0.3


def test_a_dressed_dog_has_no_notes(tmp_path):
    path = tmp_path / "dog.urdf"
    path.write_text(dressed(quadruped()))
    assert read_looks(load(path, motors=[])).notes == ()


@pytest.mark.parametrize(("ends", "chords"), [("", 33), ("from = -0.6\nto = 0.2\n", 5)])
def test_round_feet_are_drawn_where_they_touch(tmp_path, ends, chords):
    """Every chord ends on the arc; with all joints at zero the lowest point is straight below the centre."""
    robot = round_spear(tmp_path, f"[feet.toe]\nradius = 0.02\n{ends}")
    drawn, centre = soles(robot), robot.model.frames[robot.toe_id("toe")].placement.translation
    middles = np.array([each.placement[:3, 3] - centre for each in drawn])
    across = np.array([each.placement[:3, 2] * each.size[1] / 2 for each in drawn])
    assert len(drawn) == chords
    np.testing.assert_allclose(np.linalg.norm(middles + across, axis=1), 0.02, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(middles - across, axis=1), 0.02, rtol=1e-12)
