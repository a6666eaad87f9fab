"""URDFs of other people: what is read all the same, left out or mended, and the one line that says so."""

import warnings

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import BadFile
from tests.model.planar_arm import ARM, edited, refusal

Q, V = np.array([0.3, -0.8]), np.array([1.1, 0.7])
DRIVE = '<transmission name="again"><joint name="{}"/><actuator name="m"/>{}</transmission></robot>'
COMMANDED = '<joint name="{}"><command_interface name="{}"/><state_interface name="position"/></joint>'


def said(path, **options):
    """The robot of a file, and the one line that loading it says."""
    with pytest.warns(RobotWarning) as caught:
        robot = load(path, **options)
    (text,) = [str(each.message) for each in caught]
    assert text.startswith("arm: ") and len(text.splitlines()) == 1
    return robot, text


def assert_arm(robot, rotor=0.05, moment=0.03):
    """The dynamics is that of plain Pinocchio, with this armature on the shoulder and this moment of its link."""
    model = pin.buildModelFromXML(ARM.replace('ixx="0.03"', f'ixx="{moment}"'))
    model.armature = np.array([rotor, 0.0])
    data = model.createData()
    np.testing.assert_allclose(robot.mass_matrix(Q), pin.crba(model, data, Q), rtol=1e-14)
    np.testing.assert_allclose(robot.bias(Q, V), pin.nonLinearEffects(model, data, Q, V), rtol=1e-13)


class TestInSilence:
    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ('<?xml version="1.0"?>', '<?xml version="0.0" ?>'),
            ('<?xml version="1.0"?>', '\n<?xml version="1.0"?>'),
            ('<?xml version="1.0"?>', "<!-- made by hand -->\n<?xml version='1.0'\n encoding='utf-8'?>"),
            ('<?xml version="1.0"?>', '<?xml version="1.0"?>\n<?xml version="1.0"?>'),
            (' xmlns:drake="http://drake.mit.edu"', ""),
        ],
        ids=["version 0.0", "after a line", "after a comment", "twice", "prefix not declared"],
    )
    def test_xml_that_others_read(self, write, capfd, old, new):
        assert_arm(load(write(edited(old, new))))
        assert capfd.readouterr() == ("", "")

    def test_lines_keep_their_numbers(self, write):
        text = edited('mass value="1.0"', 'mass value="-1.0"').replace("<?xml", "<!--\n-->\n<?xml")
        error = refusal(write(text), load)
        assert "negative mass" in error.problem and text.splitlines()[error.line - 1].strip() == "<inertial>"

    @pytest.mark.parametrize("axis", ["0 0 0", "0 1", "up"])
    def test_axis_of_a_fixed_joint(self, write, axis):
        foot = f'<joint name="f" type="fixed"><parent link="lower"/><child link="foot"/><axis xyz="{axis}"/></joint>'
        robot = load(write(edited("</robot>", f'<link name="foot"/>{foot}</robot>')), toes=["foot"])
        assert_arm(robot)

    @pytest.mark.parametrize("entity", ["<!DOCTYPE robot>", '<!DOCTYPE robot [<!ENTITY a "b">]>'])
    def test_document_types_stay_refused(self, write, entity):
        text = ARM.replace('<?xml version="1.0"?>', f'\n<?xml version="0.0"?>{entity}')
        assert "document type" in refusal(write(text), load).problem


class TestLeftOut:
    def test_mimic(self, write):
        elbow = ARM.index('<joint name="elbow"')
        text = ARM[:elbow] + ARM[elbow:].replace("</joint>", '<mimic joint="shoulder"/></joint>', 1)
        robot, text = said(write(text))
        assert "not taken over: <mimic> in <joint> of 'elbow'" in text
        assert_arm(robot)

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("</robot>", DRIVE.format("sholder", ""), "'sholder', which is not there; valid: shoulder, elbow"),
            ("</robot>", DRIVE.format("elbow", '<actuator name="n"/>'), "2 <actuator>"),
            ("</robot>", DRIVE.format("elbow", "").replace('<actuator name="m"/>', ""), "no <actuator>"),
            ("</robot>", DRIVE.format("elbow", '<joint name="shoulder"/>'), "2 <joint>"),
            ("</robot>", DRIVE.format("shoulder", ""), "joint 'shoulder' has two"),
            (
                "</robot>",
                DRIVE.format("f", "").replace(
                    "</robot>",
                    '<link name="foot"/><joint name="f" type="fixed"><parent link="lower"/><child link="foot"/></joint>'
                    "</robot>",
                ),
                "'f', which is fixed",
            ),
        ],
    )
    def test_transmission(self, write, old, new, says):
        robot, text = said(write(edited(old, new)))
        assert "transmission 'again' is left out" in text and says in text
        assert robot.actuated == ("shoulder",)
        assert_arm(robot)

    @pytest.mark.parametrize("reduction", ["50:1", "", "reduction"])
    def test_reduction_that_is_no_number(self, write, reduction):
        robot, text = said(write(edited(">50<", f">{reduction}<")), motors=["shoulder"])
        assert f"its <mechanicalReduction> is {reduction!r}, not a number" in text
        assert robot.gear_ratio("shoulder") == 1.0
        assert_arm(robot, rotor=0.0)


class TestRos2Control:
    @staticmethod
    def controlled(inside):
        start = ARM.index("<transmission")
        return f'{ARM[:start]}<ros2_control name="c" type="system">{inside}</ros2_control></robot>'

    def test_commanded_joints_have_motors(self, write):
        text = self.controlled(COMMANDED.format("elbow", "effort") + COMMANDED.format("shoulder", "position"))
        robot = load(write(text))
        assert robot.actuated == ("shoulder", "elbow") and robot.gear_ratio("elbow") == 1.0

    def test_what_is_only_measured_has_none(self, write):
        text = self.controlled(COMMANDED.format("elbow", "effort") + '<joint name="shoulder"/>')
        assert load(write(text)).actuated == ("elbow",)

    @pytest.mark.parametrize(
        "gear",
        [
            '<actuator name="m"/><joint name="elbow"><mechanical_reduction>9</mechanical_reduction></joint>',
            '<joint name="elbow"/><actuator name="m"><mechanicalReduction>9</mechanicalReduction></actuator>',
        ],
    )
    def test_transmission(self, write, gear):
        inside = f'{COMMANDED.format("elbow", "effort")}<transmission name="t">{gear}</transmission>'
        robot = load(write(self.controlled(inside)))
        assert robot.actuated == ("elbow",) and robot.gear_ratio("elbow") == 9.0

    def test_transmission_of_ros_1_goes_before(self, write):
        start = ARM.index("<transmission")
        text = self.controlled(COMMANDED.format("shoulder", "effort")).replace("</robot>", ARM[start:])
        robot = load(write(text))
        assert robot.actuated == ("shoulder",) and robot.gear_ratio("shoulder") == 50.0

    def test_unknown_joint(self, write):
        text = edited("</robot>", f"<ros2_control>{COMMANDED.format('wrist', 'effort')}</ros2_control></robot>")
        assert "'wrist'" in said(write(text))[1]


class TestRepair:
    INDEFINITE = edited('ixx="0.03" ixy="0"', 'ixx="0.03" ixy="0.05"')

    def test_inertia(self, write):
        path = write(self.INDEFINITE)
        assert "link 'upper'" in refusal(path, load).problem and "repair=True" in refusal(path, load).problem
        robot, text = said(path, repair=True)
        assert "link 'upper'" in text and "mended to the nearest that a body can have" in text
        below, middle, most = np.linalg.eigvalsh([[0.03, 0.05, 0], [0.05, 0.02, 0], [0, 0, 0.01]])
        moments = np.linalg.eigvalsh(robot.model.inertias[1].inertia)
        excess = most - middle - below  # the second moment across both is half of it below zero
        np.testing.assert_allclose(moments, [below + excess / 2, middle + excess / 2, most], rtol=1e-12)

    def test_inertia_of_no_body(self, write):
        """One principal moment exceeds the sum of the others: real files have it, and their mass matrices are sound."""
        path = write(edited('ixx="0.03"', 'ixx="0.04"'))
        robot, text = said(path)
        assert "link 'upper'" in text and "0.04 > 0.03 kg·m²" in text and "repair=True" in text
        assert robot.model.inertias[1].inertia[0, 0] == 0.04
        mended, text = said(path, repair=True)
        assert "0.04 > 0.03 kg·m²: mended" in text
        expected = np.diag([0.04, 0.025, 0.015])  # the flat body with these second moments
        np.testing.assert_allclose(mended.model.inertias[1].inertia, expected, atol=1e-15)

    def test_inertias_of_no_bodies_are_told_in_one_line(self, write):
        text = edited('ixx="0.03"', 'ixx="0.04"').replace('ixx="0.01"', 'ixx="0.03"')
        assert "and so have 'lower'" in said(write(text))[1]

    def test_a_plate_needs_none(self, write):
        """Its third moment is the sum of the others but for the digits that are written."""
        assert_arm(load(write(edited('ixx="0.03"', 'ixx="0.03000000001"'))), moment=0.03000000001)

    def test_rounding_needs_none(self, write):
        link = '<link name="tip"><inertial><mass value="1e-9"/><inertia {}/></inertial></link>'.format(
            'ixx="-1.4e-20" iyy="1e-20" izz="0" ixy="0" ixz="0" iyz="0"'
        )
        tip = '<joint name="t" type="fixed"><parent link="lower"/><child link="tip"/></joint>'
        assert load(write(edited("</robot>", f"{link}{tip}</robot>"))).nv == 2

    def test_joint_without_inertia(self, write):
        start = ARM.index('<link name="lower">')
        path = write(ARM[:start] + '<link name="lower"/>' + ARM[ARM.index("</link>", start) + 7 :])
        assert "repair=True" in refusal(path, load).problem
        robot, text = said(path, repair=True)
        assert "joint 'elbow' moves no inertia: mended by an armature of 0.0001 kg·m²" in text
        assert robot.mass_matrix(Q)[1, 1] == 1e-4 and robot.mass_matrix(Q)[0, 1] == 0.0

    def test_two_joints_that_move_alike(self, write):
        text = edited('<origin xyz="0 0 -0.3"/>', "").replace('<mass value="2.0"/>', '<mass value="0"/>')
        text = text.replace('ixx="0.03" ixy="0" ixz="0" iyy="0.02"', 'ixx="0" ixy="0" ixz="0" iyy="0"')
        text = text.replace('<drake:rotor_inertia value="2e-5"/>', "").replace('izz="0.01"', 'izz="0"', 1)
        robot, text = said(write(text), repair=True)
        assert "singular" in text and "'elbow'" in text
        assert np.linalg.eigvalsh(robot.mass_matrix(Q))[0] > 1e-5

    def test_a_sound_robot_is_left_alone(self, write):
        assert_arm(load(write(ARM), repair=True))

    def test_negative_mass_stays_refused(self, write):
        path = write(edited('mass value="1.0"', 'mass value="-1.0"'))
        with pytest.raises(BadFile, match="negative mass"):
            load(path, repair=True)


class TestXacro:
    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ('<link name="base"/>', '<xacro:include filename="legs.xacro"/>'),
            ('<link name="base"/>', '<xacro:leg name="left"/>'),
            ('mass value="1.0"', 'mass value="${mass}"'),
        ],
    )
    def test_it_is_told_as_such(self, write, old, new):
        text = edited("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ').replace(old, new)
        assert "is a xacro, not yet a URDF" in refusal(write(text), load).problem

    def test_what_an_expanded_one_still_declares(self, write):
        text = edited("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
        assert_arm(load(write(text)))


def test_warnings_can_be_silenced(write):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        assert load(write(ARM.split("<transmission")[0] + "</robot>")).nu == 0
