"""MJCF files: read back by Pinocchio's own reader of them, and what they say beside the dynamics."""

import re

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile, BadValue
from spear_pin.model.boom import on_rotary_boom
from spear_pin.model.loading import ROBOTS
from spear_pin.model.mjcf import MeshFile, to_mjcf
from spear_pin.model.variants import vary

INERTIA = '<inertial><mass value="2"/><inertia ixx="{}" iyy="0.02" izz="0.03" ixy="0.001" ixz="0" iyz="0"/></inertial>'
TRUNK = """<robot name="trunk">
  <link name="base"><inertial><mass value="2"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>{}</link></robot>"""
JOINT = """<joint name="{0}" type="{0}"><parent link="base"/><child link="arm"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/><axis xyz="0 0.6 0.8"/>
    <limit effort="7" velocity="1"/><dynamics damping="0.3" friction="0.2"/></joint>"""


pytestmark = pytest.mark.filterwarnings("ignore:arm. not taken over:spear_pin.RobotWarning")


def urdf(tmp_path, kind, xx=0.03, visual=""):
    """A URDF of one link on one joint that is called as its type."""
    path = tmp_path / "arm.urdf"
    arm = f'<link name="arm">{INERTIA.format(xx)}{visual}</link>'
    path.write_text(f'<robot name="arm"><link name="base"/>{arm}{JOINT.format(kind)}</robot>')
    return path


def read_back(tmp_path, text):
    """Pinocchio's model of an MJCF file."""
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return pin.buildModelFromMJCF(str(path))


def assert_same(robot, other):
    """The mass matrix and bias of both are the same, where the same small steps lead from zero."""
    assert list(other.names) == list(robot.model.names)
    rng = np.random.default_rng(3)
    data = other.createData()
    for _ in range(10):
        away, v = rng.uniform(-2, 2, robot.nv), rng.uniform(-5, 5, robot.nv)
        q, there = (pin.integrate(model, pin.neutral(model), away) for model in (robot.model, other))
        np.testing.assert_allclose(pin.crba(other, data, there), robot.mass_matrix(q), rtol=0, atol=1e-9)
        np.testing.assert_allclose(pin.nonLinearEffects(other, data, there, v), robot.bias(q, v), rtol=0, atol=1e-9)


class TestDynamics:
    @pytest.mark.parametrize("name", ROBOTS)
    def test_of_a_shipped_robot(self, name, tmp_path):
        assert_same(load(name), read_back(tmp_path, to_mjcf(load(name))))

    def test_of_a_locked_and_varied_one(self, tmp_path):
        robot = vary(load("q_spear", locked=["torso_x", "anterior_knee"]), hip_distance=0.8, knee_ratio=20.0)
        assert_same(robot, read_back(tmp_path, to_mjcf(robot)))

    @pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
    def test_of_a_skew_joint(self, kind, tmp_path):
        robot = load(urdf(tmp_path, kind), motors=[])
        assert_same(robot, read_back(tmp_path, to_mjcf(robot)))


class TestContents:
    def test_rotors_and_motors(self):
        root = etree.fromstring(to_mjcf(load("q_spear")))
        armature = {joint.get("name"): float(joint.get("armature", 0)) for joint in root.iter("joint")}
        assert armature == pytest.approx(
            {"torso_x": 0, "torso_z": 0, "pitch": 0}
            | {f"{end}_hip": 2 * 0.047 for end in ("posterior", "anterior")}
            | {f"{end}_knee": 2 * 0.027 for end in ("posterior", "anterior")}
        )
        motors = [(m.get("joint"), m.get("gear"), m.get("ctrlrange")) for m in root.iter("motor")]
        assert motors[:2] == [("posterior_hip", "60.0", "-4.0 4.0"), ("posterior_knee", "15.0", "-16.0 16.0")]
        assert len(motors) == 4

    def test_toes_shapes_and_ground(self):
        robot = load("q_spear_full")
        root = etree.fromstring(to_mjcf(robot))
        assert [site.get("name") for site in root.iter("site")] == list(robot.toes)
        kinds = [geom.get("type") for geom in root.iter("geom") if geom.get("group") != "3" or geom.get("name")]
        drawn = etree.fromstring(ROBOTS["q_spear_full"].path.read_bytes())
        for kind, beside in (("box", 0), ("cylinder", 0), ("sphere", len(robot.toes)), ("plane", 1)):
            assert kinds.count(kind) == len(drawn.findall(f".//visual//{kind}")) + beside
        hitting = [geom for geom in root.iter("geom") if geom.get("conaffinity") != "0"]
        trunk = [geom for geom in hitting if not geom.get("name")]
        assert sorted(geom.get("name") for geom in hitting if geom not in trunk) == sorted(["ground", *robot.toes])
        assert [geom.getparent().get("name") for geom in trunk] == ["torso"] * 2
        assert all((geom.get("contype"), geom.get("conaffinity")) == ("0", "1") for geom in trunk)  # the ground's only

    def test_a_round_foot_is_a_sphere_of_its_radius(self):
        (foot,) = etree.fromstring(to_mjcf(load("mups_v2"))).xpath("//geom[@name='toe']")
        assert (foot.get("type"), foot.get("size")) == ("sphere", "0.02")

    @pytest.mark.parametrize(
        ("shapes", "meshes", "kinds"),
        [
            ("<visual>{box}</visual>", None, ["box"]),
            ("<visual>{box}</visual><collision>{sphere}</collision>", None, ["sphere"]),
            ("<visual>{box}</visual><collision>{mesh}</collision>", None, ["box"]),
            ("<visual>{mesh}</visual>", [MeshFile(1, "of/it.stl", (1.0, 0.5, 0.0, 1.0))], ["mesh"]),
            (
                "<visual>{mesh}</visual><collision>{sphere}</collision>",
                [MeshFile(1, "it.stl", (1, 1, 1, 1))],
                ["sphere"],
            ),
            ("<visual>{mesh}</visual>", None, []),
            ("", None, []),
        ],
        ids=str,
    )
    def test_the_trunk_meets_the_ground(self, tmp_path, shapes, meshes, kinds):
        """By its collision, else by what it shows, a mesh by its hull; a trunk without shapes is said to be without."""
        forms = {"box": '<box size="1 2 3"/>', "sphere": '<sphere radius="1"/>', "mesh": '<mesh filename="it.stl"/>'}
        said = shapes.format(**{name: f"<geometry>{form}</geometry>" for name, form in forms.items()})
        path = tmp_path / "trunk.urdf"
        path.write_text(TRUNK.format(said), encoding="utf-8")
        text = to_mjcf(load(path, base="free", motors=[]), meshes=meshes)
        root = etree.fromstring(text)
        solid = [geom for geom in root.find("worldbody/body").iter("geom") if geom.get("conaffinity") == "1"]
        assert [geom.get("type") for geom in solid] == kinds
        assert ("the trunk has no shape here" in text) == (not kinds)
        assert [mesh.get("file") for mesh in root.iter("mesh")] == [mesh.file for mesh in meshes or ()]

    def test_what_is_missing_is_said(self, tmp_path):
        assert "switchable spring of a knee is not in this file" in re.sub(r"\s+", " ", to_mjcf(load("spear_ii")))
        mesh = '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual>'
        assert "a mesh of link arm is left out" in to_mjcf(load(urdf(tmp_path, "revolute", visual=mesh), motors=[]))

    def test_friction_and_limits_of_a_joint(self, tmp_path):
        joint = etree.fromstring(to_mjcf(load(urdf(tmp_path, "prismatic"), motors=[]))).find(".//joint")
        assert (joint.get("damping"), joint.get("frictionloss"), joint.get("range")) == ("0.3", "0.2", None)
        hip = etree.fromstring(to_mjcf(load("spear_ii"))).find(".//joint[@name='hip']")
        assert hip.get("range") == "-3.14 3.14" and hip.get("damping") is hip.get("frictionloss") is None

    def test_postures_are_keyframes(self):
        robot = load("q_spear_full")
        turned = np.r_[0.1, 0.2, 0.9, 0.0, 0.6, 0.0, 0.8, np.arange(12) / 10]
        keys = etree.fromstring(to_mjcf(robot, {"turned": turned})).findall(".//key")
        assert [key.get("name") for key in keys] == ["home", "turned"]
        home, turned_here = (np.array(key.get("qpos").split(), dtype=float) for key in keys)
        np.testing.assert_allclose(home[:7], [0, 0, 0.636, 1, 0, 0, 0], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(turned_here[:7], [0.1, 0.2, 0.9, 0.8, 0.0, 0.6, 0.0])
        with pytest.raises(BadValue, match="posture 'short'.*19 finite numbers"):
            to_mjcf(robot, {"short": [1.0]})


class TestRefusals:
    def test_a_joint_that_mjcf_lacks(self, tmp_path):
        with pytest.raises(BadValue, match="joint 'planar'.*one axis"):
            to_mjcf(load(urdf(tmp_path, "planar"), motors=[]))

    def test_an_inertia_of_no_body(self, tmp_path):
        with pytest.warns(RobotWarning, match="link 'arm'"):
            arm = load(urdf(tmp_path, "revolute", xx=0.06), motors=[])
        with pytest.raises(BadValue, match="inertia of link 'arm'.*MuJoCo"):
            to_mjcf(arm)

    def test_inertia_beside_the_model(self):
        with pytest.raises(BadValue, match="rotary boom"):
            to_mjcf(on_rotary_boom(load("spear_ii", locked=["boom_x"])))

    def test_entities(self, tmp_path):
        path = urdf(tmp_path, "revolute")
        robot = load(path, motors=[])
        path.write_text(f'<!DOCTYPE robot [<!ENTITY a "b">]>{path.read_text()}')
        with pytest.raises(BadFile, match="document type"):
            to_mjcf(robot)
