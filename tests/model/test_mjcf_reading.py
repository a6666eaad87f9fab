"""Robots in MuJoCo's own format: dynamics, motors and limits, and what is said to be left out."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile
from spear_pin.model.fitting import CannotFloat
from spear_pin.model.limits import Limits
from spear_pin.model.loading import ROBOTS
from spear_pin.model.mjcf import to_mjcf
from tests.model.mjcf_made import DOG, LEG, I, edited, one_body, said
from tests.model.queries import refusal, state


class TestRobot:
    def test_names(self, write_xml):
        robot = load(write_xml(DOG), toes=["foot"])
        assert robot.name == "dog" and robot.nv == 6 + 3 + 3
        assert robot.coordinates[0] == "float_vx" and robot.coordinates[6:9] == ("hip_x", "hip_y", "knee")
        assert robot.toes == ("foot",) and robot.actuated == ("hip_x", "knee")

    def test_gears_are_never_squared_into_armatures(self, write_xml):
        robot = load(write_xml(DOG))
        np.testing.assert_array_equal(robot.model.armature[6:9], [0.01, 0.01, 0.03])
        assert (robot.gear_ratio("hip_x"), robot.gear_ratio("knee")) == (3.0, -2.0)
        knee = robot.index("knee")
        assert robot.model.rotorInertia[knee] * robot.gear_ratio("knee") ** 2 == pytest.approx(0.03)

    def test_damping_is_viscous_friction(self, write_xml):
        np.testing.assert_array_equal(load(write_xml(DOG)).model.damping[6:9], [0.5, 0.5, 0.5])

    def test_limits(self, write_xml):
        limits = load(write_xml(DOG)).limits
        assert limits["hip_x"] == Limits(effort=12.0)
        assert limits["hip_y"] == Limits(position=(-1.0, 2.0))
        assert limits["knee"] == Limits(position=(-2.0, -0.5), effort=12.0)

    def test_effort_of_a_joint(self, write_xml):
        text = edited(LEG, 'damping="0.3"', 'damping="0.3" actuatorfrcrange="-7 7"')
        assert load(write_xml(text)).limits["knee"].effort == 7.0

    def test_a_named_geom_is_a_frame(self, write_xml):
        robot, q = load(write_xml(DOG), toes=["foot", "sole"]), pin.neutral(load(write_xml(DOG)).model)
        gap = robot.toe_position(q, "sole") - robot.toe_position(q, "foot")
        assert np.linalg.norm(gap) == pytest.approx(0.02)

    def test_q_of_a_floating_base_is_its_place(self, write_xml):
        robot = load(write_xml(DOG), toes=["trunk"])
        q = pin.neutral(robot.model)
        np.testing.assert_array_equal(robot.toe_position(q, "trunk"), np.zeros(3))

    def test_gravity(self, write_xml):
        robot = load(write_xml(DOG))
        assert robot.gravity(pin.neutral(robot.model))[2] == pytest.approx(1.62 * robot.mass)

    def test_several_joints_of_a_body(self, write_xml):
        """Pinocchio makes one joint of them, with the same numbers."""
        text = edited(DOG, '<geom type="mesh" mesh="nowhere"/>', "")
        plain = pin.buildModelFromMJCF(str(write_xml(text)))
        robot, data = load(write_xml(DOG)), plain.createData()
        q = pin.integrate(plain, pin.neutral(plain), np.linspace(-1, 1, plain.nv))
        np.testing.assert_allclose(robot.mass_matrix(q), pin.crba(plain, data, q), rtol=1e-12, atol=1e-14)

    def test_silent(self, write_xml, capfd):
        load(write_xml(DOG))
        assert capfd.readouterr() == ("", "")

    @pytest.mark.extra("mujoco")
    @pytest.mark.parametrize("floating", ["", 'type="free"'], ids=["freejoint", "free joint of a class"])
    def test_mass_matrix_is_that_of_mujoco(self, write_xml, floating):
        import mujoco

        text = DOG.replace('<geom type="mesh" mesh="nowhere"/>', "")
        if floating:
            text = edited(text, "<freejoint", f"<joint {floating}")
        robot, theirs = load(write_xml(text)), mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(theirs)
        q = pin.integrate(robot.model, pin.neutral(robot.model), np.linspace(-1, 1, robot.nv))
        data.qpos[:] = q[[0, 1, 2, 6, 3, 4, 5, 7, 8, 9, 13, 10, 11, 12]]
        mujoco.mj_forward(theirs, data)
        full, turn = np.zeros((robot.nv, robot.nv)), np.eye(robot.nv)
        mujoco.mj_fullM(theirs, data, full)
        turn[:3, :3] = pin.Quaternion(q[3:7]).matrix()
        np.testing.assert_allclose(robot.mass_matrix(q), turn.T @ full @ turn, rtol=1e-12, atol=1e-13)
        np.testing.assert_array_equal(robot.model.damping, theirs.dof_damping)
        np.testing.assert_allclose(turn[:3, :3] @ robot.gravity(q)[:3], data.qfrc_bias[:3], rtol=1e-12, atol=1e-12)


class TestBase:
    def test_free(self, write_xml):
        text = edited(LEG, '<joint name="hip" axis="0 1 0"/>', "").replace('<motor joint="hip"/>', "")
        robot = load(write_xml(text), base="free")
        assert robot.coordinates[0] == "base_vx" and robot.nv == 7 and robot.mass == 2.0

    def test_free_below_a_joint(self, write_xml):
        path = write_xml(LEG)
        assert "'base_link' has no inertia" in str(refusal(CannotFloat, lambda: load(path, base="free")))
        assert load(path, base="free", locked=["hip"]).nv == 7

    def test_free_already(self, write_xml):
        assert load(write_xml(DOG), base="free").nv == 12

    def test_fixed(self, write_xml):
        robot = load(write_xml(DOG), base="fixed", toes=["trunk"])
        assert robot.nv == 6
        np.testing.assert_array_equal(robot.toe_position(pin.neutral(robot.model), "trunk"), [0, 0, 0.4])

    def test_a_trunk_that_stays_fixed_is_told(self, write_xml):
        text = edited(LEG, '<joint name="hip" axis="0 1 0"/>', "").replace('<motor joint="hip"/>', "")
        assert "its root 'thigh', of 1 kg, stays fixed" in said(write_xml(text))[1]


class TestLeftOut:
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ('damping="0.3"', 'frictionloss="0.4"', "not taken over: frictionloss of 'knee'"),
            ('damping="0.3"', 'stiffness="9" springref="0.4"', "not taken over: stiffness in <joint> of 'knee'"),
            ('damping="0.3"', 'ref="0.4"', "q is MuJoCo's qpos less ref"),
            (
                "<actuator>",
                '<equality><joint name="e" joint1="hip"/></equality><actuator>',
                "<joint> 'e' in <equality>",
            ),
            ("<actuator>", "<equality><weld body1='thigh'/></equality><actuator>", "<weld> 'thigh' in <equality>"),
            ("<actuator>", '<tendon><fixed name="t"/></tendon><actuator>', "<fixed> 't' in <tendon>"),
            ('<motor joint="hip"/>', '<motor joint="hip"/><motor name="m" tendon="t"/>', "for each joint of 'm'"),
            (
                '<motor joint="hip"/>',
                '<motor joint="hip"/><position joint="hip"/>',
                "for each joint of 'position of hip'",
            ),
            ("</body></worldbody>", '</body><body name="ball"><freejoint/></body></worldbody>', "beside it of 'ball'"),
            ("<worldbody>", '<compiler settotalmass="3"/><worldbody>', "settotalmass in <compiler>"),
            (
                "<worldbody>",
                '<compiler boundmass="0.1" settotalmass="3"/><worldbody>',
                "boundmass, settotalmass in <compiler>",
            ),
        ],
    )
    def test_it_is_named(self, write_xml, old, new, says):
        robot, text = said(write_xml(edited(LEG, old, new)))
        assert says in text and text.startswith("leg: ")
        assert robot.nv == 2 and robot.actuated == ("hip", "knee")

    def test_in_one_line(self, write_xml):
        text = LEG.replace('axis="0 1 0"', 'axis="0 1 0" stiffness="1" frictionloss="2"')
        assert "frictionloss of 'hip', 'knee'; stiffness in <joint> of 'hip', 'knee'" in said(write_xml(text))[1]

    def test_mass_of_a_mesh(self, write_xml):
        text = edited(LEG, f'<inertial pos="0.1 0 0" {I}/></body>', '<geom type="mesh" mesh="m"/></body>')
        assert "moves no inertia" in str(refusal(BadFile, lambda: load(write_xml(text))))
        with pytest.warns(RobotWarning) as caught:
            load(write_xml(text), repair=True)
        assert "mass of a mesh of 'shank'" in str(caught[0].message) and "armature" in str(caught[1].message)


@pytest.mark.filterwarnings("ignore:.*not taken over. friction in .geom. of 'ground'")
@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_written_is_read_back(write_xml, name):
    """The robot comes back, but for its velocities' limits, which MJCF lacks, and what only its TOML file says."""
    robot = load(name)
    path = write_xml(to_mjcf(robot))
    beside = "" if robot.post is None else 'post = "boom_yaw"\n'
    beside += f"toes = {list(robot.toes)}\n" if robot.radii else ""
    beside += "".join(f"[feet.{toe}]\nradius = {radius}\n" for toe, radius in robot.radii.items())
    if beside:
        path.with_suffix(".toml").write_text(beside)
    again = load(path, toes=robot.toes)
    q, v = state(robot)
    assert (again.coordinates, again.actuated, again.name) == (robot.coordinates, robot.actuated, robot.name)
    np.testing.assert_allclose(again.mass_matrix(q), robot.mass_matrix(q), rtol=0, atol=1e-13)
    np.testing.assert_allclose(again.bias(q, v), robot.bias(q, v), rtol=1e-12, atol=1e-12)
    for toe in robot.toes:
        np.testing.assert_allclose(again.toe_jacobian(q, toe), robot.toe_jacobian(q, toe), rtol=0, atol=1e-14)
    for joint in robot.actuated:
        assert again.limits[joint].effort == pytest.approx(robot.limits[joint].effort)
        assert again.gear_ratio(joint) == robot.gear_ratio(joint)


def test_what_needs_a_urdf_says_so(write_xml):
    robot = load(write_xml(LEG))
    assert "is an MJCF file; expected a URDF" in refusal(BadFile, lambda: to_mjcf(robot)).problem


def test_gravity_that_is_disabled(tmp_path):
    robot = load(one_body(tmp_path, '<option><flag gravity="disable"/></option>'), motors="all")
    assert robot.gravity([0.3])[0] == 0.0


@pytest.mark.parametrize(
    ("parts", "lost"),
    [
        ({"body": 'gravcomp="1"'}, "gravcomp in <body> of 'x'"),
        ({"joint": 'springdamper="0.1 1"'}, "springdamper in <joint> of 'j'"),
        ({"geom": '<geom type="box" size="0.1 0.1 0.1" shellinertia="true"/>'}, "shellinertia in <geom> of 'x'"),
        ({"before": '<option viscosity="1"/>'}, "viscosity in <option>"),
    ],
)
def test_what_acts_on_a_body_and_is_left_out_is_named(tmp_path, parts, lost):
    with pytest.warns(RobotWarning, match=lost):
        load(one_body(tmp_path, **parts), motors="all")
