"""Wrong robots, as files and as calls: each ends with one line that names the value, the place, and what is valid.

URDFs are spoiled in `test_urdf_faults`, files of every kind damaged byte by byte in `tests/wrong_calls`.
"""

from dataclasses import dataclass

import pytest

from spear_pin import load
from spear_pin.errors import BadFile
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
