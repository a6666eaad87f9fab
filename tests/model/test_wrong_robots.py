"""Wrong robots, as files and as calls: each ends with one line that names the value, the place, and what is valid.

URDFs are spoiled in `test_urdf_faults`, files of every kind damaged byte by byte in `tests/wrong_calls`.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

from spear_pin import SpearError, load, monopod, sagittal
from spear_pin.errors import BadFile, UnknownName
from spear_pin.model.frames import frame_id
from spear_pin.model.legs import find_legs
from tests.cli.calls import refused
from tests.model.legged import quadruped
from tests.model.queries import refusal

INERTIAL = '<inertial pos="0 0 -0.1" mass="1" diaginertia="0.1 0.2 0.25"/>'
GEOM = '<geom type="capsule" size="0.02 0.1"/>'
LEG = f"""<mujoco model="leg">
<compiler angle="radian"/>
<worldbody>
<body name="thigh">
<joint name="hip" axis="0 1 0"/>
{INERTIAL}
<body name="shank" pos="0 0 -0.3">
<joint name="knee" axis="0 1 0" range="-2 2"/>
{GEOM}
</body>
</body>
</worldbody>
<actuator>
<motor joint="hip"/>
<motor joint="knee" gear="5" ctrlrange="-1 1"/>
</actuator>
</mujoco>
"""


@dataclass(frozen=True)
class Spoiled:
    """A change that spoils the leg, and what the refusal says; the change stands in the line that it names."""

    old: str
    new: str
    says: tuple[str, ...]


MJCF = {
    "inertial without place": Spoiled(INERTIAL, '<inertial mass="1"/>', ("body 'thigh'", "no pos")),
    "inertial without mass": Spoiled(INERTIAL, '<inertial pos="0 0 0"/>', ("body 'thigh'", "no mass")),
    "inertial without inertia": Spoiled(
        GEOM, '<inertial pos="0 0 0.1" mass="1"/>', ("body 'shank'", "no inertia", "diaginertia or fullinertia")
    ),
    "two inertias": Spoiled(
        INERTIAL,
        INERTIAL.replace("/>", ' fullinertia="1 1 1 0 0 0"/>'),
        ("body 'thigh'", "diaginertia and fullinertia", "valid"),
    ),
    "turned full inertia": Spoiled(
        INERTIAL,
        '<inertial pos="0 0 0" quat="1 1 0 0" mass="1" fullinertia="1 1 1 0 0 0"/>',
        ("body 'thigh'", "fullinertia and quat", "valid"),
    ),
    "two inertials": Spoiled(
        GEOM, 2 * '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>', ("body 'shank'", "2 <inertial>", "one")
    ),
    "inertia of no body": Spoiled(
        'diaginertia="0.1', 'diaginertia="0.01', ("body 'thigh'", "0.25 > 0.21 kg·m²", "repair=True")
    ),
    "negative moment": Spoiled('diaginertia="0.1', 'diaginertia="-0.1', ("body 'thigh'", "-0.1 kg·m²", "repair=True")),
    "quaternion of zeros": Spoiled(
        '<body name="shank"', '<body quat="0 0 0 0" name="shank"', ("quat of <body> 'shank'", "'0 0 0 0'", "direction")
    ),
    "inertia turned by zeros": Spoiled(
        "<inertial", '<inertial quat="0 0 0 0"', ("quat of <inertial> of 'thigh'", "'0 0 0 0'", "direction")
    ),
    "zaxis of zeros": Spoiled(
        '<body name="shank"', '<body zaxis="0 0 0" name="shank"', ("zaxis", "'shank'", "'0 0 0'")
    ),
    "axes that are parallel": Spoiled(
        '<body name="shank"', '<body xyaxes="1 0 0 2 0 0" name="shank"', ("xyaxes", "'shank'", "two directions")
    ),
    "axis and angle without axis": Spoiled(
        '<body name="shank"', '<body axisangle="0 0 0 1" name="shank"', ("axisangle", "'shank'", "'0 0 0 1'")
    ),
    "turned twice": Spoiled(
        '<body name="shank"', '<body quat="1 0 0 0" euler="1 0 0" name="shank"', ("'shank'", "quat and euler", "one of")
    ),
    "axis of zeros": Spoiled('axis="0 1 0" range', 'axis="0 0 0" range', ("joint 'knee'", "'0 0 0'", "a direction")),
    "negative armature": Spoiled('name="knee"', 'name="knee" armature="-1"', ("joint 'knee'", "armature -1", ">= 0")),
    "negative damping": Spoiled('name="knee"', 'name="knee" damping="-0.2"', ("'knee'", "damping -0.2", ">= 0")),
    "negative friction": Spoiled('name="knee"', 'name="knee" frictionloss="-3"', ("'knee'", "frictionloss -3", ">= 0")),
    "limited without limits": Spoiled(
        'range="-2 2"', 'limited="true" range="2 -2"', ("joint 'knee'", "'2 -2'", "the lower one first")
    ),
    "unknown type of joint": Spoiled('name="knee"', 'name="knee" type="screw"', ("'knee'", "'screw'", "slide, hinge")),
    "free joint inside": Spoiled(
        '<body name="shank" pos="0 0 -0.3">',
        '<body name="shank" pos="0 0 -0.3"><freejoint/>',
        ("body 'shank'", "free joint", "first body"),
    ),
    "free joint beside another": Spoiled('<body name="thigh">', '<body name="thigh"><freejoint/>', ("'thigh'", "free")),
    "geom without size": Spoiled(' size="0.02 0.1"', "", ("<geom> of 'shank'", "size ''", "2 numbers > 0", "capsule")),
    "geom of one size": Spoiled("0.02 0.1", "0.02", ("<geom> of 'shank'", "size '0.02'", "2 numbers > 0", "capsule")),
    "geom of negative size": Spoiled("0.02 0.1", "0.02 -0.1", ("<geom> of 'shank'", "'0.02 -0.1'", "> 0")),
    "geom between one point": Spoiled(
        "<geom", '<geom fromto="0 0 1 0 0 1"', ("<geom> of 'shank'", "'0 0 1 0 0 1'", "two points apart")
    ),
    "unknown type of geom": Spoiled('"capsule"', '"cone"', ("<geom> of 'shank'", "'cone'", "valid: sphere, capsule")),
    "negative mass of a geom": Spoiled("<geom", '<geom mass="-1"', ("<geom> of 'shank'", "mass -1", ">= 0")),
    "negative density": Spoiled("<geom", '<geom density="-1"', ("<geom> of 'shank'", "density -1", ">= 0")),
    "motor of no joint": Spoiled('joint="hip"', 'joint="hop"', ("<motor>", "'hop'", "valid: hip, knee")),
    "motor of no class": Spoiled('joint="hip"', 'joint="hip" class="big"', ("class 'big'",)),
    "range of one number": Spoiled('ctrlrange="-1 1"', 'ctrlrange="1"', ("ctrlrange of <motor>", "'1'", "2 numbers")),
}


@pytest.mark.parametrize("spoiled", MJCF.values(), ids=MJCF)
def test_spoiled_mjcf(tmp_path, spoiled):
    path = tmp_path / "leg.xml"
    assert LEG.count(spoiled.old) == 1
    path.write_text(LEG.replace(spoiled.old, spoiled.new))
    error = refusal(BadFile, lambda: load(path))
    for words in spoiled.says:
        assert words in error.problem
    line = LEG[: LEG.index(spoiled.old)].count("\n") + 1
    assert str(error).startswith(f"{path}:{line}: ")


@dataclass(frozen=True)
class Robots:
    """Files of quadrupeds, and one that is loaded.

    Attributes:
        file: writes the quadruped, its legs made so, with texts replaced; its path.
        dog: the quadruped.
    """

    file: Callable
    dog: object

    def changed(self, joint, old, new):
        """The quadruped with a text replaced, the first after the name of a joint."""
        return load(self.file(after=(f'<joint name="{joint}"', old, new)))


@pytest.fixture
def robots(tmp_path):
    def file(after=None, **of_leg):
        text = quadruped(**of_leg)
        if after:
            start = text.index(after[0])
            assert after[1] in text[start:]
            text = text[:start] + text[start:].replace(after[1], after[2], 1)
        path = tmp_path / "dog.urdf"
        path.write_text(text)
        return path

    return Robots(file, load(file()))


OPEN = {"knee_limits": (-2.7, 2.7)}
FEET = ("FL", "FR"), ("HL", "HR")
# what is called with the robots, and what is said
CALLS = {
    "a toe that is no frame": (
        lambda r: load(r.file(), toes=["FL_hoof"]),
        ("frame 'FL_hoof'", "nearest of", "FL_foot"),
    ),
    "a toe that is the world": (lambda r: load(r.file(), toes=["universe"]), ("frame 'universe'", "nearest of")),
    "a motor of no joint": (lambda r: load(r.file(), motors=["FL_knee"]), ("joint 'FL_knee'", "valid", "FL_bend")),
    "a motor of the base": (lambda r: load(r.file(), motors=["base"]), ("motors", "'base'", "one degree of freedom")),
    "a lock of no joint": (lambda r: load(r.file(), locked=["FL_knee"]), ("joint 'FL_knee'", "valid", "FL_bend")),
    "a base that is no word": (lambda r: load(r.file(), base="floating"), ("base", "'floating'", "'free', 'chain'")),
    "a base that rails carry": (lambda r: load("spear_ii", base="free"), ("root 'world'", "leave base out")),
    "a negative rotor": (
        lambda r: load(r.file(after=("FL_bend_drive", 'inertia value="0.0001"', 'inertia value="-1e-4"'))),
        ("dog.urdf:1: ", "'FL_bend'", "rotor inertia -0.0001", ">= 0"),
    ),
    "legs to a toe that is no frame": (lambda r: find_legs(r.dog, toes=["hoof"]), ("'hoof'", "nearest of", "FL_foot")),
    "legs to the trunk": (lambda r: find_legs(r.dog, toes=["trunk"]), ("toes", "'trunk'", "below a knee and a hip")),
    "a side of no leg": (lambda r: find_legs(r.dog, sides={"LF": 1}), ("leg 'LF'", "valid: FL, FR, HL, HR")),
    "a side of zero": (lambda r: find_legs(r.dog, sides={"FL": 0}), ("sides is 0", "+1 or -1")),
    "no such leg": (lambda r: monopod(r.dog, "LF"), ("leg 'LF'", "valid: FL, FR, HL, HR")),
    "a leg of another robot": (
        lambda r: monopod(r.dog, load("spear_ii").legs[0]),
        ("joint of leg 'leg'", "'hip'", "valid", "FL_pitch"),
    ),
    "a leg to no toe": (
        lambda r: monopod(r.dog, replace(r.dog.legs[0], toe="hoof")),
        ("'hoof'", "nearest of", "FL_foot"),
    ),
    "a leg of another side": (lambda r: replace(r.dog.legs[0], side=2), ("side of leg 'FL'", "2", "-1, 0 or 1")),
    "a leg of no length": (lambda r: replace(r.dog.legs[0], thigh=0.0), ("thigh of leg 'FL'", "0.0", "> 0, in m")),
    "a leg with an ankle": (
        lambda r: monopod(load(r.file(ankle=True)), "FL"),
        ("leg is 'FL'", "FL_sole", "locked"),
    ),
    "a knee of unknown side": (lambda r: monopod(load(r.file(**OPEN)), "FL"), ("leg is 'FL'", "find_legs", "sides")),
    "a negative body": (lambda r: monopod(r.dog, "FL", body=-1.0), ("body is -1.0", "'share'", ">= 0, in kg")),
    "a body that is no number": (lambda r: monopod(r.dog, "FL", body=math.nan), ("body is nan", ">= 0, in kg")),
    "a lock of no joint of the monopod": (
        lambda r: monopod(r.dog, "FL", locked=["boom"]),
        ("joint 'boom'", "valid: boom_x, boom_z, hip, knee"),
    ),
    "a plane of a monopod": (lambda r: sagittal(load("spear_ii")), ("four legs", "found: leg", "`--leg leg`")),
    "one pair": (lambda r: sagittal(r.dog, FEET[:1]), ("pairs", "'FL', 'FR'", "two pairs")),
    "pairs that are texts": (lambda r: sagittal(r.dog, ["FL", "FR"]), ("pairs is ['FL', 'FR']", "two pairs")),
    "pairs across": (
        lambda r: sagittal(r.dog, [("FL", "HR"), ("HL", "FR")]),
        ("pairs", "'FL', 'HR'", "one pair behind the other"),
    ),
    "pairs of one side": (lambda r: sagittal(r.dog, [("FL", "HL"), ("FR", "HR")]), ("pairs", "behind the other")),
    "a pair with a leg of no name": (lambda r: sagittal(r.dog, [FEET[0], ("HL", "RR")]), ("'RR'", "valid: FL")),
    "a pair of different lengths": (
        lambda r: sagittal(r.changed("FR_bend", "-0.19", "-0.22")),
        ("thighs of FL and FR", "0.19", "0.22", "5%"),
    ),
    "a pair with one motor": (
        lambda r: sagittal(load(r.file(), motors=["FL_bend"])),
        ("'FL_bend'", "both joints of a pair", "FR_bend has none"),
    ),
    "a pair without common angles": (
        lambda r: sagittal(r.changed("FR_bend", 'lower="-2.5" upper="0.1"', 'lower="0.2" upper="2.5"')),
        ("FL_bend and FR_bend", "0.2", "overlap"),
    ),
}


@pytest.mark.parametrize(("call", "says"), CALLS.values(), ids=CALLS)
def test_wrong_call(robots, call, says):
    with pytest.raises(SpearError) as caught:
        call(robots)
    text = str(caught.value)
    assert len(text.splitlines()) == 1
    for words in says:
        assert words in text


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("--robot {dog} --leg LF", "unknown leg 'LF'; valid: FL, FR, HL, HR"),
        ("--robot {dog} --bends 0", "--bends is 0; expected 1 or -1"),
        ("--robot {dog} --body -2", "--body is -2.0; expected a finite number >= 0, in kg"),
        ("--robot {dog}.gone", "dog.urdf.gone: cannot be read: No such file"),
        ("--robot {leg}", "leg.xml:5: joint 'hip' has the axis '0 0 0'; expected a direction"),
        ("--robot {ankle}", "a leg of hip and knee only; lock FL_sole by `locked`, of load or a TOML file"),
        ("--robot solo99", "unknown robot 'solo99'; "),
    ],
    ids=["leg", "side", "body", "no file", "MJCF", "ankle", "name"],
)
def test_wrong_robot_to_hop(capsys, tmp_path, words, says):
    files = {name: tmp_path / f"{name}.urdf" for name in ("dog", "ankle")}
    files["dog"].write_text(quadruped())
    files["ankle"].write_text(quadruped(ankle=True))
    files["leg"] = tmp_path / "leg.xml"
    files["leg"].write_text(re.sub('axis="[^"]*"', 'axis="0 0 0"', LEG))
    assert says in refused(capsys, "hop", *words.format(**files).split())


@pytest.mark.parametrize("name", ["\udcff", "", None, 3])
def test_a_name_that_is_no_text_in_utf_8_is_unknown(robots, name):
    with pytest.raises(UnknownName, match="unknown frame"):
        frame_id(robots.dog.model, name)
