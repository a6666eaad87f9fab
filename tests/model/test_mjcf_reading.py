"""Robots in MuJoCo's own format: dynamics, motors and limits, what is said to be left out, and what is refused."""

import os

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile
from spear_pin.model.limits import Limits
from spear_pin.model.loading import ROBOTS
from spear_pin.model.mjcf import to_mjcf
from tests.model.queries import refusal, state

I = 'mass="1" diaginertia="0.1 0.2 0.25"'  # noqa: E741
DOG = f"""
<mujoco model="dog">
  <compiler angle="radian" eulerseq="zyx"/>
  <option gravity="0 0 -1.62"/>
  <default>
    <joint armature="0.01" damping="0.2"/>
    <general gear="3"/>
    <default class="leg">
      <joint axis="0 1 0" damping="0.5"/>
      <default class="foot"><geom type="sphere" size="0.02" pos="0 0 -0.3"/></default>
      <default class="knee"><joint range="-2 -0.5" armature="0.03"/></default>
    </default>
  </default>
  <worldbody>
    <light pos="0 0 3"/>
    <body name="trunk" pos="0 0 0.4" childclass="leg">
      <freejoint name="float"/>
      <inertial pos="0.02 0 0.01" quat="0.7 0.1 0.2 0.3" mass="6" diaginertia="0.1 0.2 0.25"/>
      <geom type="mesh" mesh="nowhere"/>
      <body name="thigh" pos="0.2 0.1 0" euler="0.1 0.2 0.3">
        <joint name="hip_x" axis="1 0 0" pos="0.01 0 0"/>
        <joint name="hip_y" pos="0 0.03 0" range="-1 2"/>
        <inertial pos="0 0 -0.1" {I}/>
        <body name="shank" pos="0 0 -0.3">
          <joint name="knee" class="knee"/>
          <inertial pos="0 0 -0.1" mass="0.5" fullinertia="0.1 0.1 0.1 0.01 0.02 0"/>
          <geom name="foot" class="foot"/>
          <site name="sole" pos="0 0 -0.32"/>
        </body>
      </body>
      <body name="tail" pos="-0.3 0 0"><joint name="tail" type="ball"/>
        <geom type="capsule" fromto="0 0 0 -0.2 0 0" size="0.02" density="500"/></body>
    </body>
  </worldbody>
  <actuator>
    <motor name="a" joint="hip_x" ctrlrange="-4 4"/>
    <position joint="knee" gear="-2" kp="10" forcerange="-5 6" ctrlrange="-9 9"/>
  </actuator>
</mujoco>
"""
LEG = f"""
<mujoco model="leg"><worldbody><body name="thigh">
  <joint name="hip" axis="0 1 0"/><inertial pos="0.1 0 0" {I}/>
  <body name="shank" pos="0 0 -0.3"><joint name="knee" axis="0 1 0" damping="0.3"/><inertial pos="0.1 0 0" {I}/></body>
</body></worldbody><actuator><motor joint="hip"/><motor joint="knee" gear="5"/></actuator></mujoco>
"""


@pytest.fixture
def write_xml(tmp_path):
    """A function that writes a file beside others, and returns its path."""

    def write(text, name="dog.xml"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def edited(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


def said(path, **options):
    """The robot of a file, and the one line that loading it says."""
    with pytest.warns(RobotWarning) as caught:
        robot = load(path, **options)
    (text,) = [str(each.message) for each in caught]
    assert len(text.splitlines()) == 1
    return robot, text


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
        assert "'base_link' has no inertia" in str(refusal(BadFile, lambda: load(path, base="free")))
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
            ('damping="0.3"', 'frictionloss="0.4"', "not taken over: frictionloss of knee"),
            ('damping="0.3"', 'stiffness="9" springref="0.4"', "not taken over: stiffness of knee"),
            ('damping="0.3"', 'ref="0.4"', "q is MuJoCo's qpos less ref"),
            ("<actuator>", '<equality><joint name="e" joint1="hip"/></equality><actuator>', "equality constraints, e"),
            ("<actuator>", "<equality><weld body1='thigh'/></equality><actuator>", "equality constraints, a weld"),
            ("<actuator>", '<tendon><fixed name="t"/></tendon><actuator>', "tendons, t"),
            ('<motor joint="hip"/>', '<motor joint="hip"/><motor name="m" tendon="t"/>', "for each joint, m"),
            ('<motor joint="hip"/>', '<motor joint="hip"/><position joint="hip"/>', "for each joint, a position"),
            ("</body></worldbody>", '</body><body name="ball"><freejoint/></body></worldbody>', "beside it, ball"),
            ("<worldbody>", '<compiler settotalmass="3"/><worldbody>', "<compiler> settotalmass"),
            ("<worldbody>", '<compiler boundmass="0.1" settotalmass="3"/><worldbody>', "boundmass, settotalmass"),
        ],
    )
    def test_it_is_named(self, write_xml, old, new, says):
        robot, text = said(write_xml(edited(LEG, old, new)))
        assert says in text and text.startswith("leg: ")
        assert robot.nv == 2 and robot.actuated == ("hip", "knee")

    def test_in_one_line(self, write_xml):
        text = LEG.replace('axis="0 1 0"', 'axis="0 1 0" stiffness="1" frictionloss="2"')
        assert "frictionloss of hip, knee; stiffness of hip, knee" in said(write_xml(text))[1]

    def test_mass_of_a_mesh(self, write_xml):
        text = edited(LEG, f'<inertial pos="0.1 0 0" {I}/></body>', '<geom type="mesh" mesh="m"/></body>')
        assert "moves no inertia" in str(refusal(BadFile, lambda: load(write_xml(text))))
        with pytest.warns(RobotWarning) as caught:
            load(write_xml(text), repair=True)
        assert "mass of a mesh of shank" in str(caught[0].message) and "armature" in str(caught[1].message)


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_written_is_read_back(write_xml, name):
    """The robot comes back, but for its velocities' limits, which MJCF lacks."""
    robot = load(name)
    again = load(write_xml(to_mjcf(robot)), toes=robot.toes)
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
    assert "is an MJCF file, where a URDF is needed" in refusal(BadFile, lambda: to_mjcf(robot)).problem


class TestFiles:
    SCENE = '<mujoco model="scene"><include file="dog.xml"/><worldbody><geom type="plane"/></worldbody></mujoco>'

    def test_scene(self, write_xml):
        write_xml(DOG)
        assert load(write_xml(self.SCENE, "scene.xml")).nv == 12

    def test_included_defaults(self, write_xml):
        write_xml('<mujocoinclude><default><joint armature="0.7"/></default></mujocoinclude>', "d.xml")
        robot = load(write_xml(edited(LEG, "<worldbody>", '<include file="d.xml"/><worldbody>')))
        np.testing.assert_array_equal(robot.model.armature, [0.7, 0.7])

    @pytest.mark.parametrize("name", ["../dog.xml", "/etc/passwd", "inside/../../dog.xml", "link.xml", ""])
    def test_nothing_is_read_elsewhere(self, write_xml, tmp_path, name):
        write_xml(DOG)
        (tmp_path / "inside").mkdir()
        os.symlink(tmp_path / "dog.xml", tmp_path / "inside/link.xml")
        path = write_xml(self.SCENE.replace("dog.xml", name), "inside/scene.xml")
        problem = refusal(BadFile, lambda: load(path)).problem
        assert "not in its folder" in problem or "directory" in problem

    @pytest.mark.parametrize("name", ["scene.xml", "a.xml"])
    def test_loops(self, write_xml, name):
        write_xml(self.SCENE.replace("dog.xml", name), "a.xml")
        path = write_xml(self.SCENE.replace("dog.xml", "a.xml"), "scene.xml")
        assert "again" in refusal(BadFile, lambda: load(path)).problem

    def test_nested_deep(self, write_xml):
        levels = "<default class='c{}'>" * 100
        for i in range(9):
            more = f'<include file="{i + 1}.xml"/>' if i < 8 else ""
            classes = levels.format(*range(100 * i, 100 * i + 100))
            write_xml(f"<mujocoinclude>{classes}{more}{'</default>' * 100}</mujocoinclude>", f"{i}.xml")
        path = write_xml('<mujoco><default><include file="0.xml"/></default></mujoco>', "scene.xml")
        assert "nested deeper" in refusal(BadFile, lambda: load(path)).problem

    def test_missing(self, write_xml):
        path = write_xml(self.SCENE.replace("<include", "\n<include"), "scene.xml")
        error = refusal(BadFile, lambda: load(path))
        assert str(error).startswith(f"{path}:2: includes 'dog.xml'") and "No such file" in error.problem

    def test_place_in_what_is_included(self, write_xml):
        dog = write_xml(edited(DOG, 'axis="1 0 0"', 'axis="0 0 0"'))
        error = refusal(BadFile, lambda: load(write_xml(self.SCENE, "scene.xml")))
        line = DOG[: DOG.index('axis="1 0 0"')].count("\n") + 1
        assert (error.path, error.line) == (str(dog), line)

    def test_included_by_what_is_included(self, write_xml):
        inner = write_xml('<mujocoinclude>\n<include file="gone.xml"/></mujocoinclude>', "inner.xml")
        path = write_xml(self.SCENE.replace("dog.xml", "inner.xml"), "scene.xml")
        error = refusal(BadFile, lambda: load(path))
        assert (error.path, error.line) == (str(inner), 2) and "'gone.xml'" in error.problem

    @pytest.mark.parametrize(
        "start", ["<!DOCTYPE mujoco>", '<!DOCTYPE mujoco [<!ENTITY a SYSTEM "file:///etc/passwd">]>']
    )
    def test_entities(self, write_xml, start):
        path = write_xml(start + LEG)
        assert "document type" in refusal(BadFile, lambda: load(path)).problem
        write_xml(self.SCENE, "scene.xml")
        write_xml(start + DOG)
        assert "document type" in refusal(BadFile, lambda: load(path.parent / "scene.xml")).problem


class TestRefused:
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ('mass="1"', 'mass="-1"', "mass '-1'"),
            ('mass="1"', 'mass="heavy"', "'heavy'"),
            ('diaginertia="0.1', 'diaginertia="-0.1', "positive semidefinite"),
            ('damping="0.3"', 'type="screw"', "valid: free, ball, slide, hinge"),
            ('axis="0 1 0"', 'axis="0 nan 0"', "'nan'"),
            ("<worldbody>", '<compiler coordinate="global"/><worldbody>', "global coordinates"),
            ('<body name="shank"', '<frame/><body name="shank"', "<frame>"),
            ("<worldbody>", '<worldbody><replicate count="3"/>', "<replicate>"),
            ("worldbody>", "world>", "no <body>"),
            ("<worldbody>", "<default><default/></default><worldbody>", "no class"),
            ("<worldbody>", '<option gravity="0 0"/><worldbody>', "gravity"),
        ],
    )
    def test_fault(self, write_xml, old, new, says):
        text = LEG.replace(old, new) if old == "worldbody>" else edited(LEG, old, new)
        path = write_xml(text)
        assert says in str(refusal(BadFile, lambda: load(path)))

    def test_motor_of_a_ball(self, write_xml):
        text = edited(DOG, '<motor name="a" joint="hip_x"', '<motor name="a" joint="tail"')
        assert load_quietly(write_xml(text)).actuated == ("knee",)

    def test_too_many_bodies(self, write_xml):
        text = edited(LEG, '<body name="shank"', "<body/>" * 600 + '<body name="shank"')
        assert "500 bodies" in refusal(BadFile, lambda: load(write_xml(text))).problem


def load_quietly(path):
    return said(path)[0]


class TestInertias:
    """As MuJoCo has them."""

    ARM = (
        '<mujoco>{}<worldbody><body name="arm"><joint name="j" axis="0 1 0"/><inertial pos="0 0 0" mass="1" {}/>'
        '<body pos="0 0 -1"><inertial pos="0 0 -0.5" mass="2" {}/></body></body></worldbody></mujoco>'
    )
    MOMENTS = 'diaginertia="0.1 0.2 0.25"'

    @pytest.mark.parametrize(
        ("compiler", "first", "second", "expected"),
        [
            ("", MOMENTS, "", 0.2 + 2 * 1.5**2),  # a point that is welded
            ("", "", MOMENTS, 0.2 + 2 * 1.5**2),
            ('<compiler balanceinertia="true"/>', 'diaginertia="0.1 0.1 0.4"', MOMENTS, 0.4 + 2 * 1.5**2),
            ('<compiler balanceinertia="true"/>', MOMENTS, 'fullinertia="0.1 0.1 0.4 0.05 0 0"', 0.4 + 2 * 1.5**2),
        ],
    )
    def test_of_what_is_said(self, write_xml, compiler, first, second, expected):
        robot = load(write_xml(self.ARM.format(compiler, first, second)), motors="all")
        assert robot.mass_matrix([0.3])[0, 0] == pytest.approx(expected, rel=1e-14)

    @pytest.mark.extra("mujoco")
    @pytest.mark.parametrize("first", ["", 'diaginertia="0.1 0.1 0.4"'])
    def test_mujoco_says_the_same(self, write_xml, first):
        import mujoco

        text = self.ARM.format('<compiler balanceinertia="true"/>', first, self.MOMENTS)
        theirs = mujoco.MjModel.from_xml_string(text)
        inertia = load(write_xml(text), motors="all").mass_matrix([0.0])
        data, full = mujoco.MjData(theirs), np.zeros((1, 1))
        mujoco.mj_forward(theirs, data)
        mujoco.mj_fullM(theirs, data, full)
        np.testing.assert_allclose(inertia, full, rtol=1e-13)

    def test_repair(self, write_xml):
        """The flat body with the same second moments, turned as in the file."""
        path = write_xml(self.ARM.format("", 'quat="1 1 0 0" diaginertia="0.1 0.2 0.4"', self.MOMENTS))
        assert "repair=True" in refusal(BadFile, lambda: load(path, motors="all")).problem
        robot, text = said(path, motors="all", repair=True)
        assert "body 'arm'" in text and "0.4 > 0.3 kg·m²: mended" in text
        assert robot.mass_matrix([0.0])[0, 0] == pytest.approx(0.4 + 0.2 + 2 * 1.5**2)  # its z is the joint's axis


TURNED = """<mujoco><compiler {}/><worldbody><body name="arm" {}><joint name="j" axis="0 1 0"/>
  <inertial pos="0.1 0.02 -0.3" mass="1" diaginertia="0.1 0.2 0.25"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("compiler", "place", "order"),
    [
        ('angle="radian" eulerseq="XYZ"', 'euler="0.3 0.2 0.1"', "zyx"),  # capitals: about axes that stay
        ('angle="radian" eulerseq="xYz"', 'euler="0.3 0.2 0.1"', "yxz"),
        ("", f'euler="{np.degrees(0.3)} {np.degrees(0.2)} {np.degrees(0.1)}"', "xyz"),
        ("", f'axisangle="0 3 0 {np.degrees(0.2)}"', "y"),  # of any length
    ],
)
def test_turns_of_every_notation_are_mujocos(tmp_path, compiler, place, order):
    path = tmp_path / "arm.xml"
    path.write_text(TURNED.format(compiler, place))
    rotation = load(path, motors="all").model.jointPlacements[1].rotation
    expected = np.eye(3)
    for letter in order:
        expected = expected @ pin.utils.rotate(letter, {"x": 0.3, "y": 0.2, "z": 0.1}[letter])
    np.testing.assert_allclose(rotation, expected, atol=1e-12)


def test_a_body_of_several_joints_is_the_frame_that_all_of_them_move(tmp_path):
    path = tmp_path / "hopper.xml"
    slides = '<joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>'
    path.write_text(
        f'<mujoco><worldbody><body name="torso" pos="0 0 1">{slides}<joint name="pitch" axis="0 1 0"/>'
        f'<inertial pos="0 0 0.1" {I}/></body></worldbody></mujoco>'
    )
    np.testing.assert_allclose(load(path, motors="all").frame_position([0.3, 0.5, 0.2], "torso"), [0.3, 1.5])


def test_ranges_of_slides_are_lengths_and_ref_is_taken_off_places_and_limits(tmp_path):
    path = tmp_path / "lift.xml"
    path.write_text(
        f'<mujoco><worldbody><body name="lift" pos="0 0 1"><joint name="z" type="slide" ref="0.1" range="-1 2"/>'
        f'<inertial pos="0 0 0.1" {I}/></body></worldbody></mujoco>'
    )
    with pytest.warns(RobotWarning, match="ref"):
        lift = load(path, motors="all")
    np.testing.assert_allclose(lift.limits["z"].position, (-1.1, 1.9))
    np.testing.assert_allclose(lift.frame_position([0.0], "lift"), [0.0, 1.0])


def one_body(tmp_path, before="", body="", joint="", geom='<geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>'):
    path = tmp_path / "one.xml"
    path.write_text(
        f'<mujoco>{before}<worldbody><body name="x" {body}><joint name="j" axis="0 1 0" {joint}/>{geom}</body>'
        "</worldbody></mujoco>"
    )
    return path


def test_gravity_that_is_disabled(tmp_path):
    robot = load(one_body(tmp_path, '<option><flag gravity="disable"/></option>'), motors="all")
    assert robot.gravity([0.3])[0] == 0.0


@pytest.mark.parametrize(
    ("parts", "lost"),
    [
        ({"body": 'gravcomp="1"'}, "gravcomp of x"),
        ({"joint": 'springdamper="0.1 1"'}, "springdamper of j"),
        ({"geom": '<geom type="box" size="0.1 0.1 0.1" shellinertia="true"/>'}, "shellinertia of x"),
        ({"before": '<option viscosity="1"/>'}, "the fluid's viscosity"),
    ],
)
def test_what_acts_on_a_body_and_is_left_out_is_named(tmp_path, parts, lost):
    with pytest.warns(RobotWarning, match=lost):
        load(one_body(tmp_path, **parts), motors="all")


@pytest.mark.parametrize(
    ("parts", "problem"),
    [
        ({"joint": 'class="typo"'}, "there is no class 'typo'"),
        (
            {"geom": '<geom size="0.1"/><body><joint name="j"/><geom size="0.1"/></body>'},
            "joint 'j' is defined 2 times",
        ),
        ({"geom": '<geom size="0.1"/><body><joint name="universe"/><geom size="0.1"/></body>'}, "Pinocchio's name"),
    ],
)
def test_names_that_mislead_are_refused(tmp_path, parts, problem):
    with pytest.raises(BadFile, match=problem):
        load(one_body(tmp_path, **parts), motors="all")
