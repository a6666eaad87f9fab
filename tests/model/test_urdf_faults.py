"""URDFs that are refused, fault by fault: how the refusal reads, and the line that it points at."""

from dataclasses import dataclass

import pytest

from spear_pin.model.loading import load
from tests.model.planar_arm import ARM, ELBOW_LIMIT, edited, refusal

LOOP = (
    '<link name="a"/><link name="b"/>'
    '<joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>'
    '<joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint></robot>'
)


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
    "wrong root": Fault("robot", "sdf", ("<sdf>", "<robot>"), "<sdf"),
    "default namespace": Fault(
        'name="arm"', 'name="arm" xmlns="http://a.b"', ("{http://a.b}robot", "<robot>"), "<robot"
    ),
    "nameless link": Fault('<link name="base"/>', "<link/>", ("<link>", "no name")),
    "nameless joint": Fault('<joint name="elbow" type', "<joint type", ("<joint>", "no name")),
    "link defined twice": Fault(
        '<link name="base"/>', '<link name="base"/><link name="base"/>', ("link 'base'", "2 times")
    ),
    "joint called as the world": Fault('"elbow" type', '"universe" type', ("joint", "universe", "Pinocchio's name")),
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
    "axis without xyz": Fault('axis xyz="0 1 0"', "axis", ("<axis> of 'shoulder' has no xyz", "a number"), "<axis/>"),
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
    "mass without value": Fault('mass value="1.0"', "mass", ("<mass> of 'lower' has no value", "a number"), "<mass/>"),
    "no inertia": Fault(
        '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>',
        "",
        ("'upper'", "<inertia>"),
        "<inertial>",
    ),
    "missing moment": Fault(' izz="0.01"', "", ("<inertia> of 'upper' has no izz", "a number"), "<inertia ixx"),
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
    "two inertials": Fault(
        '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>',
        '<inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>\n<inertial id="second">',
        ("link 'upper'", "2 <inertial>", "one is valid"),
        "second",
    ),
    "negative effort": Fault(
        'upper="1" effort="10"', 'upper="1" effort="-5"', ("'shoulder'", "effort -5", ">= 0"), 'effort="-5"'
    ),
    "negative velocity": Fault(
        ELBOW_LIMIT, ELBOW_LIMIT.replace('"5"', '"-5"'), ("'elbow'", "velocity -5", ">= 0"), 'velocity="-5"'
    ),
    "negative damping": Fault(
        ELBOW_LIMIT, f'{ELBOW_LIMIT}<dynamics damping="-0.1"/>', ("'elbow'", "damping -0.1", ">= 0"), 'damping="-0.1"'
    ),
    "negative friction": Fault(
        ELBOW_LIMIT,
        f'{ELBOW_LIMIT}<dynamics friction="-0.2"/>',
        ("'elbow'", "friction -0.2", ">= 0"),
        'friction="-0.2"',
    ),
    "reduction and ratio that disagree": Fault(
        "<mechanicalReduction>50<",
        "<mechanicalReduction>60<",
        ("'shoulder'", "mechanicalReduction 60", "gear_ratio 50"),
        "<actuator",
    ),
    "ratio of zero": Fault("50", "0", ("'shoulder'", "gear ratio 0", "another than 0"), "<transmission"),
    "negative rotor inertia": Fault(
        '"2e-5"', '"-2e-5"', ("'shoulder'", "rotor inertia -2e-05", ">= 0"), "<transmission"
    ),
    "rotor inertia without value": Fault(
        'rotor_inertia value="2e-5"', "rotor_inertia", ("rotor_inertia", "no value", "finite number"), "rotor_inertia"
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
