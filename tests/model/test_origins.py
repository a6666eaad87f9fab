"""Rotations of a URDF's places by the quaternion of URDF 1.1: of joints, inertias and shapes alike."""

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from spear_pin import load
from spear_pin.errors import BadFile
from spear_pin.model.document import describe, document
from spear_pin.model.mjcf import to_mjcf
from spear_pin.viz.playback.looks import read_looks
from tests.model.queries import refusal

ORIGIN = '<origin xyz="0.1 -0.2 0.3" {}/>'
MADE = """<robot name="made" {}><link name="base"/><link name="arm">
<inertial>{1}<mass value="2"/><inertia ixx="0.03" iyy="0.04" izz="0.05" ixy="0.001" ixz="0.002" iyz="0.003"/></inertial>
<visual>{1}<geometry><box size="0.1 0.2 0.3"/></geometry></visual>
<collision>{1}<geometry><box size="0.1 0.2 0.3"/></geometry></collision></link><link name="tip"/>
<joint name="turn" type="revolute">{1}<parent link="base"/><child link="arm"/><axis xyz="0 0.6 0.8"/>
<limit lower="-1" upper="1" effort="3" velocity="4"/></joint>
<joint name="end" type="fixed">{1}<parent link="arm"/><child link="tip"/></joint></robot>"""


def made(turn, version='version="1.1"'):
    return MADE.replace("{1}", ORIGIN.format(turn)).format(version)


def quaternions():
    """Any, of any length, and those of which pitch is a right angle."""
    rng = np.random.default_rng(5)
    upright = [pin.Quaternion(pin.rpy.rpyToMatrix(0.4, sign * np.pi / 2, -1.1)).coeffs() for sign in (-1, 1)]
    return [*rng.normal(size=(6, 4)), *upright, np.array([0.0, 0.0, 0.0, -3.0])]


@pytest.mark.parametrize("quaternion", quaternions(), ids=lambda each: " ".join(f"{part:.2f}" for part in each))
def test_is_that_of_pinocchio(write, quaternion):
    path = write(made(f'quat_xyzw="{" ".join(map(repr, map(float, quaternion)))}"'))
    robot, plain = load(path, toes=["tip"], motors="all"), pin.buildModelFromUrdf(str(path))
    data = plain.createData()
    pin.framesForwardKinematics(plain, data, np.array([0.4]))
    tip = data.oMf[plain.getFrameId("tip")].translation
    np.testing.assert_allclose(robot.toe_position([0.4], "tip"), tip, rtol=0, atol=1e-14)
    np.testing.assert_allclose(robot.mass_matrix([0.4]), pin.crba(plain, data, np.array([0.4])), rtol=1e-13)


def test_shapes_turn_as_well(write):
    """What is shown and what is exported are those of the same file with three angles."""
    turned = pin.rpy.rpyToMatrix(0.3, -0.4, 0.5)
    quaternion = " ".join(map(repr, pin.Quaternion(turned).coeffs().tolist()))
    shown, exported, angles = [], [], []
    for turn in ('rpy="0.3 -0.4 0.5"', f'quat_xyzw="{quaternion}"'):
        robot = load(write(made(turn)), motors="all")
        shown.append(next(shape.placement for shape in read_looks(robot).shapes if shape.kind == "box"))
        exported.append(etree.fromstring(to_mjcf(robot)).find(".//geom[@type='box']").get("quat").split())
        angles.append(describe(robot).root.find(".//collision/origin").get("rpy").split())
        assert document(robot).find(".//visual/origin").get("rpy") is not None
    np.testing.assert_allclose(np.array(shown[1]), np.array(shown[0]), rtol=0, atol=1e-14)
    np.testing.assert_allclose(*(np.array(each, dtype=float) for each in exported), rtol=0, atol=1e-14)
    np.testing.assert_allclose(*(np.array(each, dtype=float) for each in angles), rtol=0, atol=1e-14)


@pytest.mark.parametrize("version", ["", 'version="1.0"', 'version="one"'])
def test_of_an_earlier_version_there_is_none(write, version):
    path = write(made('quat_xyzw="1 0 0 1"', version))
    with pytest.warns(match="not taken over: quat_xyzw in <origin> of 'arm', 'turn', 'end'"):
        robot = load(path, toes=["tip"], motors="all")
    plain = load(write(made("")), toes=["tip"], motors="all")
    np.testing.assert_array_equal(robot.toe_position([0.4], "tip"), plain.toe_position([0.4], "tip"))


@pytest.mark.parametrize(
    ("turn", "says"),
    [
        ('quat_xyzw="1 0 0"', "is '1 0 0'; expected 4 numbers"),
        ('quat_xyzw="0 0 0 0"', "expected x, y, z, w, not all zero"),
        ('quat_xyzw="a 0 0 1"', "'a'"),
        ('quat_xyzw="nan 0 0 1"', "finite number"),
        ('rpy="0 0 0" quat_xyzw="0 0 0 1"', "has rpy and quat_xyzw; one of them is valid"),
    ],
)
def test_refused(write, turn, says):
    assert says in str(refusal(BadFile, lambda: load(write(made(turn)))))


def test_a_shape_that_is_wrong_does_not_matter(write):
    text = made('quat_xyzw="0 0 0 1"')
    start = text.index("<visual>")
    text = text[:start] + text[start:].replace('"0 0 0 1"', '"0 0 0 0"', 1)
    assert load(write(text), motors="all").nv == 1
