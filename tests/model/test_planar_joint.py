"""A planar joint moves in the plane whose normal its axis is, as two slides and a turn about it do."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load

BODY = """<inertial><origin xyz="{}"/><mass value="{}"/>
<inertia ixx="0.03" iyy="0.04" izz="0.05" ixy="0.001" ixz="0.002" iyz="0.003"/></inertial>"""
SLAB = f'<link name="slab">{BODY.format("0.1 0.05 -0.02", 2)}</link>'
PLACE = '<origin xyz="0.1 0.2 0.3" rpy="0.3 -0.2 0.4"/>'
LIMIT = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
REST = f"""<link name="arm">{BODY.format("0 0 -0.2", 0.5)}</link><link name="tip"/>
<joint name="bend" type="revolute"><origin xyz="0 0.1 -0.1" rpy="0.3 0 0"/><parent link="slab"/><child link="arm"/>
<axis xyz="0 1 0"/>{LIMIT}</joint>
<joint name="end" type="fixed"><origin xyz="0 0.1 -0.4"/><parent link="arm"/><child link="tip"/></joint>"""
AXES = ["0 1 0", "0 -1 0", "1 0 0", "0 0 1", "0 0 -1", "0.3 -0.5 0.2", "0 0 0.001", "0 -1e-9 -1"]


def planar(axis):
    return f"""<robot name="s"><link name="world"/>{SLAB}
    <joint name="glide" type="planar">{PLACE}<parent link="world"/><child link="slab"/><axis xyz="{axis}"/></joint>
    {REST}</robot>"""


def slides(axis):
    """The same of joints of one degree of freedom each, and the two directions in which they slide."""
    normal = np.array(axis.split(), dtype=float)
    normal /= np.linalg.norm(normal)
    turn = np.array(pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal).matrix())
    if normal[2] < -1 + 1e-12:
        turn = np.diag([1.0, -1.0, -1.0])
    joints, parent = "", "world"
    for i, way in enumerate(("prismatic", "prismatic", "revolute")):
        child = "slab" if i == 2 else f"rail{i}"
        joints += (
            f'<joint name="j{i}" type="{way}">{"" if i else PLACE}<parent link="{parent}"/><child link="{child}"/>'
            f'<axis xyz="{" ".join(map(repr, turn[:, i].tolist()))}"/>{LIMIT}</joint>'
        )
        parent = child
    links = '<link name="world"/><link name="rail0"/><link name="rail1"/>' + SLAB
    return f'<robot name="s">{links}{joints}{REST}</robot>'


@pytest.mark.parametrize("axis", AXES)
def test_as_two_slides_and_a_turn(write, axis):
    robot = load(write(planar(axis)), toes=["tip"], motors="all")
    plain = pin.buildModelFromXML(slides(axis))
    data = plain.createData()
    rng = np.random.default_rng(3)
    for x, y, angle, bend in rng.uniform(-1, 1, (4, 4)):
        q, q_plain = np.array([x, y, np.cos(angle), np.sin(angle), bend]), np.array([x, y, angle, bend])
        v = rng.normal(size=4)
        c, s = np.cos(angle), np.sin(angle)  # velocities of a planar joint are in what it moves
        v_plain = np.array([c * v[0] - s * v[1], s * v[0] + c * v[1], v[2], v[3]])
        pin.framesForwardKinematics(plain, data, q_plain)
        tip = data.oMf[plain.getFrameId("tip")].translation
        np.testing.assert_allclose(robot.toe_position(q, "tip"), tip, rtol=0, atol=1e-8)
        energy = 0.5 * v_plain @ pin.crba(plain, data, q_plain) @ v_plain
        assert robot.kinetic_energy(q, v) == pytest.approx(energy, rel=1e-8)
        power = pin.computeGeneralizedGravity(plain, data, q_plain) @ v_plain
        assert robot.gravity(q) @ v == pytest.approx(power, rel=1e-8, abs=1e-8)


def test_z_is_as_pinocchio_has_it(write):
    robot, plain = load(write(planar("0 0 1")), toes=["tip"], motors="all"), pin.buildModelFromXML(planar("0 0 1"))
    q = np.array([0.3, 0.2, np.cos(0.4), np.sin(0.4), 0.5])
    np.testing.assert_array_equal(robot.mass_matrix(q), pin.crba(plain, plain.createData(), q))


def test_that_is_locked(write):
    """Where it is held it is as if it were fixed, whatever its axis."""
    held = load(write(planar("0 1 0")), toes=["tip"], locked=["glide"], motors="all")
    fixed = load(write(planar("0 1 0").replace('"planar"', '"fixed"')), toes=["tip"], motors="all")
    np.testing.assert_allclose(held.toe_position([0.4], "tip"), fixed.toe_position([0.4], "tip"), rtol=0, atol=1e-15)
    np.testing.assert_allclose(held.mass_matrix([0.4]), fixed.mass_matrix([0.4]), rtol=1e-14)
