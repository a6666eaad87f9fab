"""Reading URDFs: what is refused and how the refusal reads, what is extracted, and that nothing is fetched."""

import os
import subprocess
import sys
from dataclasses import dataclass

import pytest

from spear_pin.errors import BadFile, SpearError
from spear_pin.model.loading import ROBOTS, load
from spear_pin.model.urdf import Transmission, read_urdf

ARM = """<?xml version="1.0"?>
<robot name="arm" xmlns:drake="http://drake.mit.edu">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 -0.1"/>
      <mass value="2.0"/>
      <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <link name="lower">
    <inertial>
      <origin xyz="0 0 -0.2"/>
      <mass value="1.0"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 1"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="5"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/>
    <child link="lower"/>
    <origin xyz="0 0 -0.3"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="10" velocity="5"/>
  </joint>
  <transmission name="shoulder_drive">
    <joint name="shoulder"/>
    <actuator name="motor">
      <mechanicalReduction>50</mechanicalReduction>
      <drake:gear_ratio value="50"/>
      <drake:rotor_inertia value="2e-5"/>
    </actuator>
  </transmission>
</robot>
"""

ELBOW_LIMIT = '<limit lower="-2" upper="2" effort="10" velocity="5"/>'
ELBOW_DRIVE = '<transmission name="t"><joint name="elbow"/><actuator name="m"/></transmission></robot>'
LOOP = (
    '<link name="a"/><link name="b"/>'
    '<joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>'
    '<joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>'
)


def edited(old, new, text=ARM):
    """The arm with every `old` replaced."""
    assert old in text
    return text.replace(old, new)


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "arm.urdf"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def refusal(path, read=read_urdf):
    """The error of reading a file, whose text must be one line that names the file."""
    with pytest.raises(BadFile) as caught:
        read(path)
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    assert text.startswith(str(path))
    assert caught.value.path == str(path)
    return caught.value


@dataclass(frozen=True)
class Fault:
    """A change that spoils the arm, what the refusal must say, and text on the line that it must point at."""

    old: str
    new: str
    says: tuple[str, ...]
    at: str | None = None


FAULTS = {
    "unclosed element": Fault('<link name="base"/>', '<link name="base">', ("not well-formed XML", "link"), "</robot>"),
    "not XML": Fault(ARM, "solid arm\nfacet normal 0 0 1\n", ("not well-formed XML",), "solid arm"),
    "empty": Fault(ARM, "", ("not well-formed XML", "empty"), ""),
    "undeclared prefix": Fault(
        ' xmlns:drake="http://drake.mit.edu"', "", ("not well-formed XML", "drake", "gear_ratio"), "<drake:gear_ratio"
    ),
    "wrong root": Fault("robot", "sdf", ("<sdf>", "<robot>"), "<sdf"),
    "default namespace": Fault(
        'name="arm"', 'name="arm" xmlns="http://a.b"', ("{http://a.b}robot", "<robot>"), "<robot"
    ),
    "nameless link": Fault('<link name="base"/>', "<link/>", ("<link>", "no name")),
    "nameless joint": Fault('<joint name="elbow" type', "<joint type", ("<joint>", "no name")),
    "link defined twice": Fault(
        '<link name="base"/>', '<link name="base"/><link name="base"/>', ("link 'base'", "2 times")
    ),
    "joint defined twice": Fault('"elbow" type', '"shoulder" type', ("joint 'shoulder'", "2 times")),
    "unknown joint type": Fault(
        '"elbow" type="revolute"',
        '"elbow" type="ball"',
        ("joint 'elbow'", "'ball'", "revolute", "fixed"),
        '"elbow" type',
    ),
    "joint without type": Fault('"elbow" type="revolute"', '"elbow"', ("joint 'elbow'", "type None"), '"elbow"'),
    "no parent": Fault('<parent link="upper"/>', "", ("<joint>", "'elbow'", "<parent>"), '"elbow" type'),
    "no child": Fault('<child link="lower"/>', "", ("<joint>", "'elbow'", "<child>"), '"elbow" type'),
    "unknown parent": Fault(
        'parent link="upper"', 'parent link="uper"', ("'elbow'", "parent", "'uper'"), '"elbow" type'
    ),
    "unknown child": Fault('child link="lower"', 'child link="lowr"', ("'elbow'", "child", "'lowr'"), '"elbow" type'),
    "two parents": Fault('child link="lower"', 'child link="upper"', ("link 'upper'", "two parent"), '"elbow" type'),
    "two roots": Fault(
        '<link name="base"/>', '<link name="base"/><link name="stray"/>', ("single tree", "base", "stray")
    ),
    "loop": Fault(
        ARM, ARM.replace('<link name="base"/>', "").replace('link="base"', 'link="lower"'), ("single tree", "loop")
    ),
    "stray link and a loop": Fault('parent link="base"', 'parent link="lower"', ("link 'upper'", "loop")),
    "loop beside the tree": Fault("</robot>", LOOP, ("link 'a'", "loop")),
    "no links": Fault(ARM, '<robot name="void"/>', ("single tree", "none")),
    "zero axis": Fault(
        f'<axis xyz="0 1 0"/>\n    {ELBOW_LIMIT}',
        f'<axis xyz="0 0 0"/>{ELBOW_LIMIT}',
        ("'elbow'", "zero axis"),
        "0 0 0",
    ),
    "axis of two numbers": Fault(
        'axis xyz="0 1 0"', 'axis xyz="0 1"', ("xyz", "<axis>", "'0 1'", "3 numbers"), '"0 1"'
    ),
    "axis without xyz": Fault('axis xyz="0 1 0"', "axis", ("xyz", "<axis>", "None", "3 numbers"), "<axis/>"),
    "axis of words": Fault('axis xyz="0 1 0"', 'axis xyz="x y z"', ("<axis>", "'x'", "finite number"), "x y z"),
    "no mass": Fault(
        '<mass value="1.0"/>', "", ("<inertial>", "'lower'", "<mass>"), '<inertial>\n      <origin xyz="0 0 -0.2"'
    ),
    "negative mass": Fault(
        'mass value="1.0"',
        'mass value="-1.0"',
        ("link 'lower'", "negative mass", "-1.0"),
        '<inertial>\n      <origin xyz="0 0 -0.2"',
    ),
    "mass not a number": Fault('mass value="1.0"', 'mass value="1,0"', ("<mass>", "'1,0'", "finite number"), "1,0"),
    "mass NaN": Fault('mass value="1.0"', 'mass value="nan"', ("<mass>", "'nan'", "finite number"), "nan"),
    "infinite mass": Fault('mass value="1.0"', 'mass value="1e999"', ("<mass>", "'1e999'", "finite number"), "1e999"),
    "mass without value": Fault('mass value="1.0"', "mass", ("<mass>", "None", "finite number"), "<mass/>"),
    "no inertia": Fault(
        '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>',
        "",
        ("'upper'", "<inertia>"),
        "<inertial>",
    ),
    "missing moment": Fault(' izz="0.01"', "", ("<inertia>", "finite number"), "<inertia ixx"),
    "negative moment": Fault('ixx="0.03"', 'ixx="-0.03"', ("link 'upper'", "positive semidefinite"), "-0.03"),
    "moments and products that contradict": Fault(
        'ixx="0.03" ixy="0"', 'ixx="0.03" ixy="0.05"', ("link 'upper'", "positive semidefinite"), "0.05"
    ),
    "indefinite with a determinant of zero": Fault(
        'ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"',
        'ixx="0.03" ixy="0.05" ixz="0" iyy="0.02" iyz="0" izz="0"',
        ("link 'upper'", "positive semidefinite"),
        "0.05",
    ),
    "indefinite by the determinant alone": Fault(
        'ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"',
        'ixx="1" ixy="-0.9" ixz="-0.9" iyy="1" iyz="-0.9" izz="1"',
        ("link 'upper'", "positive semidefinite"),
        "-0.9",
    ),
    "transmission on an unknown joint": Fault(
        '<joint name="shoulder"/>', '<joint name="sholder"/>', ("'sholder'", "valid: shoulder, elbow"), "<transmission"
    ),
    "transmission on a fixed joint": Fault(
        '"shoulder" type="revolute"', '"shoulder" type="fixed"', ("'shoulder'", "valid: elbow"), "<transmission"
    ),
    "transmission without joint": Fault(
        '<joint name="shoulder"/>', "", ("'shoulder_drive'", "<joint>"), "<transmission"
    ),
    "transmission without actuator": Fault("actuator", "motor", ("'shoulder_drive'", "<actuator>"), "<transmission"),
    "two transmissions": Fault(
        "</robot>",
        '<transmission name="again"><joint name="shoulder"/><actuator name="m"/></transmission></robot>',
        ("'shoulder'", "two transmissions"),
        'name="again"',
    ),
    "reduction and ratio that disagree": Fault(
        "<mechanicalReduction>50<",
        "<mechanicalReduction>60<",
        ("'shoulder'", "mechanicalReduction 60", "gear_ratio 50"),
        "<transmission",
    ),
    "reduction not a number": Fault(
        ">50<", ">50:1<", ("<mechanicalReduction>", "'50:1'", "finite number"), "<mechanicalReduction>"
    ),
    "empty reduction": Fault(">50<", "><", ("<mechanicalReduction>", "finite number"), "<mechanicalReduction>"),
    "ratio of zero": Fault("50", "0", ("'shoulder'", "gear ratio 0", "nonzero"), "<transmission"),
    "negative rotor inertia": Fault(
        '"2e-5"', '"-2e-5"', ("'shoulder'", "rotor inertia -2e-05", ">= 0"), "<transmission"
    ),
    "rotor inertia without value": Fault(
        'rotor_inertia value="2e-5"', "rotor_inertia", ("rotor_inertia", "None", "finite number"), "rotor_inertia"
    ),
    "document type": Fault("<robot", "<!DOCTYPE robot>\n<robot", ("document type",)),
    "entity in an attribute": Fault(
        "<robot name", '<!DOCTYPE robot [<!ENTITY one "1">]>\n<robot id="&one;" name', ("document type",)
    ),
    "parameter entity": Fault(
        "<robot", '<!DOCTYPE robot [<!ENTITY % more SYSTEM "file:///etc/passwd"> %more;]>\n<robot', ("document type",)
    ),
}


class TestRefused:
    @pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
    def test_fault(self, write, fault):
        text = edited(fault.old, fault.new)
        error = refusal(write(text))
        for words in fault.says:
            assert words in error.problem
        if fault.at is None:
            assert error.line is None
        else:
            line = text[: text.index(fault.at)].count("\n") + 1
            assert error.line == line
            assert f"{error.path}:{line}: " in str(error)

    @pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
    def test_loading_refuses_alike(self, write, fault):
        path = write(edited(fault.old, fault.new))
        assert str(refusal(path, load)) == str(refusal(path))

    def test_missing_file(self, tmp_path):
        assert "No such file" in refusal(tmp_path / "nowhere.urdf").problem

    def test_directory(self, tmp_path):
        assert "directory" in refusal(tmp_path).problem

    def test_unreadable_encoding(self, write):
        assert "not well-formed XML" in refusal(write(b'<robot name="\xff"/>')).problem

    def test_unknown_encoding(self, write):
        assert "encoding" in refusal(write('<?xml version="1.0" encoding="klingon"?><robot/>')).problem

    def test_deeply_nested(self, write):
        depth = 10_000
        error = refusal(write("<robot>" + "<a>" * depth + "</a>" * depth + "</robot>"))
        assert "not well-formed XML" in error.problem and "depth" in error.problem

    def test_line_break_in_a_name(self, write):
        text = edited('parent link="base"', 'parent link="ba&#10;se"')
        assert r"'ba\nse'" in refusal(write(text)).problem


class TestEntities:
    """Documents that would cost memory or leak a file if their entities were expanded."""

    TENFOLD = "".join(f"<!ENTITY e{n + 1} '{f'&e{n};' * 10}'>\n" for n in range(9))
    BOMB = f"<!DOCTYPE robot [\n<!ENTITY e0 'boom'>\n{TENFOLD}]>\n"

    @pytest.mark.parametrize("place", ['<robot name="arm"><note>&e9;</note>', '<robot name="&e9;">'])
    def test_bomb(self, write, place):
        error = refusal(write(f'{self.BOMB}{place}<link name="base"/></robot>'))
        assert "amplification" in error.problem or "document type" in error.problem

    @pytest.mark.parametrize("place", ['<robot name="arm">&leak;', '<robot name="&leak;">'])
    @pytest.mark.parametrize("target", ["secret", "nowhere", "/etc/passwd"])
    def test_external_entity(self, write, tmp_path, place, target):
        (tmp_path / "secret").write_text("hunter2")
        declared = f'<!DOCTYPE robot [<!ENTITY leak SYSTEM "file://{tmp_path / target}">]>'
        text = str(refusal(write(f'{declared}{place}<link name="base"/></robot>')))
        assert "hunter2" not in text and "root:" not in text

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
    @pytest.mark.parametrize(
        "start",
        [
            '<!DOCTYPE robot [<!ENTITY leak SYSTEM "file://PIPE">]><robot name="arm">&leak;',
            '<!DOCTYPE robot [<!ENTITY % leak SYSTEM "file://PIPE"> %leak;]><robot name="arm">',
            '<!DOCTYPE robot SYSTEM "file://PIPE"><robot name="arm">',
        ],
    )
    def test_external_file_is_not_even_opened(self, write, tmp_path, start):
        """Opening a pipe that nobody writes to would wait for ever."""
        pipe = tmp_path / "pipe"
        os.mkfifo(pipe)
        path = write(f'{start.replace("PIPE", str(pipe))}<link name="base"/></robot>')
        code = f"from spear_pin.model.urdf import read_urdf; read_urdf({str(path)!r})"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=20)
        assert "BadFile" in done.stderr and "document type" in done.stderr


class TestRead:
    def test_arm(self, write):
        path = write(ARM)
        urdf = read_urdf(path)
        assert (urdf.path, urdf.name) == (path, "arm")
        assert urdf.transmissions == (Transmission("shoulder", 50.0, 2e-5),)
        assert urdf.transmissions[0].reflected_inertia == pytest.approx(0.05)

    def test_path_as_text(self, write):
        path = write(ARM)
        assert read_urdf(str(path)) == read_urdf(path)

    def test_reduction_alone(self, write):
        text = edited('<drake:gear_ratio value="50"/>', "")
        assert read_urdf(write(text)).transmissions == (Transmission("shoulder", 50.0, 2e-5),)

    def test_ratio_alone(self, write):
        text = edited("<mechanicalReduction>50</mechanicalReduction>", "")
        assert read_urdf(write(text)).transmissions == (Transmission("shoulder", 50.0, 2e-5),)

    def test_motor_without_numbers(self, write):
        urdf = read_urdf(write(edited("</robot>", ELBOW_DRIVE)))
        assert urdf.transmissions[1] == Transmission("elbow", 1.0, 0.0)
        assert urdf.transmissions[1].reflected_inertia == 0.0

    def test_comments_are_dropped(self, write):
        text = edited(">50<", "> 5<!-- fifty -->0 <")
        urdf = read_urdf(write(text))
        assert urdf.transmissions[0].gear_ratio == 50.0
        assert "fifty" not in urdf.text

    def test_utf_16(self, write):
        text = edited('<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>')
        assert read_urdf(write(text.encode("utf-16"))).transmissions == read_urdf(write(ARM)).transmissions

    def test_inertia_on_the_verge(self, write):
        """A thin rod has no moment about its axis; rounding may not make it invalid."""
        text = edited('ixx="0.03" ixy="0" ixz="0" iyy="0.02"', 'ixx="0.03" ixy="0.03" ixz="0" iyy="0.03"')
        assert read_urdf(write(text)).name == "arm"

    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("spear_ii", {"hip": (60, 0.047), "knee": (15, 0.027)}),
            (
                "q_spear",
                {
                    "posterior_hip": (60, 0.094),
                    "posterior_knee": (15, 0.054),
                    "anterior_hip": (60, 0.094),
                    "anterior_knee": (15, 0.054),
                },
            ),
        ],
    )
    def test_shipped(self, name, expected):
        found = read_urdf(ROBOTS[name].path).transmissions
        assert {t.joint: t.gear_ratio for t in found} == {joint: ratio for joint, (ratio, _) in expected.items()}
        for transmission in found:
            assert transmission.reflected_inertia == pytest.approx(expected[transmission.joint][1], rel=1e-12)


class TestStricterThanTheParser:
    """What the reader lets through, Pinocchio's parser must read the same way, in silence."""

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 -0.1"/>', "0 -0.1"),
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 0 -O.1"/>', "-O.1"),
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 0 nan"/>', "nan"),
            ('<origin xyz="0 0 -0.1"/>', '<origin rpy="0 0"/>', "rpy"),
        ],
    )
    def test_inertial_is_not_lost(self, write, capfd, old, new, says):
        assert says in refusal(write(edited(old, new)), load).problem
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize("value", ["2.0 ", "2", "0.2e1", "\u0662"])
    def test_number_in_another_notation(self, write, capfd, value):
        assert load(write(edited('mass value="2.0"', f'mass value="{value}"'))).mass == load(write(ARM)).mass
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            (ELBOW_LIMIT, "", "elbow"),
            (ELBOW_LIMIT, ELBOW_LIMIT.replace(' effort="10"', ""), "effort"),
            (ELBOW_LIMIT, ELBOW_LIMIT.replace("-2", "two"), "two"),
            ('<origin xyz="0 0 -0.3"/>', '<origin xyz="0 0"/>', "0 0"),
            ('<origin xyz="0 0 -0.3"/>', '<origin rpy="0 0 x"/>', "x"),
        ],
    )
    def test_fault_is_named(self, write, capfd, old, new, says):
        assert says in refusal(write(edited(old, new)), load).problem
        assert capfd.readouterr().err == ""

    def test_nameless_robot_is_named_after_its_file(self, write, capfd):
        assert load(write(edited('<robot name="arm"', "<robot"))).name == "arm"
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize("shape", ["<visual/>", '<visual><geometry><box size="a"/></geometry></visual>'])
    def test_shapes_are_ignored_in_silence(self, write, capfd, shape):
        assert load(write(edited('<link name="base"/>', f'<link name="base">{shape}</link>'))).nv == 2
        assert capfd.readouterr().err == ""

    def test_processing_instruction(self, write, capfd):
        assert load(write(edited('<link name="base"/>', '<?editor fold?><link name="base"/>'))).nv == 2
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize(
        ("old", "new"),
        [('ixx="0.03"', 'ixx="1e150"'), ('ixy="0"', 'ixy="1e200"'), ('value="50"', 'value="1e200"')],
    )
    def test_overflow(self, write, old, new):
        text = edited("<mechanicalReduction>50</mechanicalReduction>", "")
        refusal(write(edited(old, new, text)), load)

    @pytest.mark.parametrize(("old", "new"), [("-0.2", "1e200"), ('mass value="1.0"', 'mass value="1e308"')])
    def test_mass_matrix_that_overflows(self, write, old, new):
        refusal(write(edited(old, new)), load)

    def test_line_break_among_the_valid_names(self, write):
        text = edited('joint name="elbow"', 'joint name="el&#10;bow"').replace(
            'joint name="shoulder"/', 'joint name="x"/'
        )
        assert "'x'" in refusal(write(text)).problem

    def test_line_break_in_the_path(self, tmp_path):
        with pytest.raises(BadFile) as caught:
            read_urdf(tmp_path / "a\nb.urdf")
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("path", ["a\0.urdf", "\ud800.urdf"])
    def test_impossible_path(self, path):
        with pytest.raises(SpearError):
            read_urdf(path)
