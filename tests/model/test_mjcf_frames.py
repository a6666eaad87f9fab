"""Inertias, turns, joints and their ranges of an MJCF file, as MuJoCo has them."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile
from tests.model.mjcf_made import I, said
from tests.model.queries import refusal


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
