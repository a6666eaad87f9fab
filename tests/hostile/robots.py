"""URDF, MJCF, SRDF and TOML: XML and TOML that grow as they are read, robots without end, numbers that are none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from tests.hostile.case import Hostile, put, sparse
from tests.wrong_calls.files import FORMATS

WHOLE = {name: whole for _, name, whole, *_ in FORMATS}
Text = Callable[[], bytes | str]
LEG = (
    '<link name="base"/><link name="shank"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
    ' iyz="0"/></inertial></link><joint name="knee" type="revolute"><parent link="base"/><child link="shank"/>'
    '<axis xyz="0 1 0"/><limit effort="1" velocity="1" lower="-1" upper="1"/></joint>'
)


def urdf(inside: str = "", before: str = "") -> str:
    """A leg of one joint, with more in it, and before it."""
    return f'{before}<robot name="leg">{LEG}{inside}</robot>'


def chain(count: int) -> str:
    """A chain of so many links."""
    inertial = LEG[LEG.index("<inertial>") : LEG.index("</inertial>") + 11]
    links = "".join(f'<link name="l{i}">{inertial}</link>' for i in range(count))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/><axis xyz="0 1 0"/></joint>'
        for i in range(1, count)
    )
    return f'<robot name="chain">{links}{joints}</robot>'


def changed(old: str, new: str) -> Text:
    """The leg with something else in it."""
    assert old in LEG
    return lambda: urdf().replace(old, new, 1)


LAUGHS = "<!ENTITY a0 'ha'>" + "".join(f"<!ENTITY a{i} '{10 * f'&a{i - 1};'}'>" for i in range(1, 12))
BIG = "x" * 1_000_000
URDF: Mapping[str, Text] = {
    "a billion laughs": lambda: urdf("&a11;", f"<!DOCTYPE robot [{LAUGHS}]>"),
    "a billion laughs in a name": lambda: f'<!DOCTYPE robot [{LAUGHS}]><robot name="&a11;">{LEG}</robot>',
    "a long entity many times": lambda: urdf("&a;" * 100_000, f'<!DOCTYPE robot [<!ENTITY a "{"x" * 100_000}">]>'),
    "an entity of itself": lambda: urdf("&a;", "<!DOCTYPE robot [<!ENTITY a '&a;'>]>"),
    "an entity of the disk": lambda: urdf("&a;", "<!DOCTYPE robot [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>"),
    "an entity of a device": lambda: urdf("&a;", "<!DOCTYPE robot [<!ENTITY a SYSTEM 'file:///dev/zero'>]>"),
    "an entity of the network": lambda: urdf("&a;", "<!DOCTYPE robot [<!ENTITY a SYSTEM 'http://127.0.0.1:9/'>]>"),
    "a parameter entity": lambda: urdf("", "<!DOCTYPE robot [<!ENTITY % a SYSTEM 'file:///etc/passwd'>%a;]>"),
    "a DTD of the disk": lambda: urdf("", "<!DOCTYPE robot SYSTEM '/etc/passwd'>"),
    "an XInclude": lambda: urdf(
        '<x:include xmlns:x="http://www.w3.org/2001/XInclude" href="/etc/passwd" parse="text"/>'
    ),
    "a style sheet": lambda: urdf("", "<?xml-stylesheet href='http://127.0.0.1:9/'?>"),
    "elements 100,000 deep": lambda: urdf("<a>" * 100_000 + "</a>" * 100_000),
    "elements 200 deep": lambda: urdf("<a>" * 200 + "</a>" * 200),
    "elements without ends": lambda: "<robot>" + "<a>" * 100_000,
    "100,000 attributes": lambda: urdf("<a " + " ".join(f'a{i}=""' for i in range(100_000)) + "/>"),
    "an attribute of 10 MB": lambda: urdf(f'<a b="{10 * BIG}"/>'),
    "a text of 15 MB": lambda: urdf(f"<a>{15 * BIG}</a>"),
    "a comment of 15 MB": lambda: urdf(f"<!--{15 * BIG}-->"),
    "a million comments": lambda: urdf("<!---->" * 1_000_000),
    "100,000 namespaces": lambda: urdf("<a " + " ".join(f'xmlns:a{i}="b"' for i in range(100_000)) + "/>"),
    "a name of 1 MB": lambda: urdf(f'<link name="{BIG}"/>'),
    "a tag of 1 MB": lambda: urdf(f"<{BIG}/>"),
    "100,000 links": lambda: urdf("".join(f'<link name="l{i}"/>' for i in range(100_000))),
    "100,000 empty joints": lambda: urdf('<joint name="a"/>' * 100_000),
    "a million empty elements": lambda: urdf("<a/>" * 1_000_000),
    "a chain of 400 links": lambda: chain(400),
    "a chain of 3000 links": lambda: chain(3000),
    "a link that is its own parent": changed('parent link="base"', 'parent link="shank"'),
    "links in a circle": lambda: urdf(
        '<joint name="back" type="fixed"><parent link="shank"/><child link="base"/></joint>'
    ),
    "a child of two": lambda: urdf('<joint name="b" type="fixed"><parent link="base"/><child link="shank"/></joint>'),
    "two roots": lambda: urdf('<link name="other"/>'),
    "50,000 transmissions": lambda: urdf(
        '<transmission name="t"><type>a</type><joint name="knee"/><actuator name="m"/></transmission>' * 50_000
    ),
    "50,000 blocks for Gazebo": lambda: urdf('<gazebo reference="knee"><a/></gazebo>' * 50_000),
    "20,000 materials": lambda: urdf("".join(f'<material name="m{i}"/>' for i in range(20_000))),
    "a joint that mimics itself": changed("<axis", '<mimic joint="knee" multiplier="1e308"/><axis'),
    "a mass of 1e308": changed('mass value="1"', 'mass value="1e308"'),
    "a mass of 1e-320": changed('mass value="1"', 'mass value="1e-320"'),
    "a mass of nan": changed('mass value="1"', 'mass value="nan"'),
    "a mass of a million digits": changed('mass value="1"', f'mass value="{"9" * 1_000_000}"'),
    "a mass in hexadecimals": changed('mass value="1"', 'mass value="0x10"'),
    "a mass in other digits": changed('mass value="1"', 'mass value="٣"'),
    "a mass of an escape": changed('mass value="1"', 'mass value="&#155;31m"'),
    "an inertia of inf": changed('ixx="1"', 'ixx="inf"'),
    "an inertia that is not possible": changed('ixx="1"', 'ixx="-1"'),
    "an axis of 1e-300": changed("0 1 0", "0 1e-300 0"),
    "an axis of 10,000 numbers": changed("0 1 0", "1 " * 10_000),
    "limits of 1e308": changed('lower="-1" upper="1"', 'lower="-1e308" upper="1e308"'),
    "limits of nan": changed('lower="-1"', 'lower="nan"'),
    "an angle of 1e300": changed("<axis", '<origin rpy="1e300 0 0"/><axis'),
    "a place of 1e30": changed("<axis", '<origin xyz="1e30 0 0"/><axis'),
    "a type of joint with an escape": changed("revolute", "&#x9b;31m"),
    "UTF-8 that is none": lambda: urdf("<a>").encode() + b"\xff\xfe\xfa</a>",
    "UTF-8 that is too long": lambda: urdf().encode().replace(b"leg", b"\xc0\xae\xc0\xae"),
    "UTF-7": lambda: b'<?xml version="1.0" encoding="UTF-7"?>+ADw-robot/+AD4-',
    "EBCDIC": lambda: '<?xml version="1.0" encoding="cp037"?>'.encode("cp037") + urdf().encode("cp037"),
    "UTF-32": lambda: urdf().encode("utf-32"),
    "an encoding that there is none of": lambda: urdf("", '<?xml version="1.0" encoding="&#x1b;"?>'),
    "zeros inside": lambda: urdf("\0" * 1000),
    "an escape, which XML has not": lambda: urdf('<link name="\x1b]0;title\x07"/>'),
    "a colour of nan": lambda: urdf(
        '<link name="a"><visual><material><color rgba="nan 1e308 x 1"/></material></visual></link>'
    ),
}
MJCF: Mapping[str, Text] = {
    "that includes itself": lambda: '<mujoco><include file="a.xml"/></mujoco>',
    "that includes itself 1000 times": lambda: "<mujoco>" + '<include file="a.xml"/>' * 1000 + "</mujoco>",
    "that includes a device": lambda: '<mujoco><include file="/dev/zero"/></mujoco>',
    "that includes a file of the disk": lambda: '<mujoco><include file="../../../../../../etc/passwd"/></mujoco>',
    "a billion laughs": lambda: f"<!DOCTYPE m [{LAUGHS}]><mujoco>&a11;</mujoco>",
    "defaults 200 deep": lambda: "<mujoco>" + '<default class="a">' * 200 + "</default>" * 200 + "</mujoco>",
    "defaults 20,000 wide": lambda: (
        "<mujoco><default>" + "".join(f'<default class="c{i}"/>' for i in range(20_000)) + "</default></mujoco>"
    ),
    "bodies 230 deep": lambda: "<mujoco><worldbody>" + "<body>" * 230 + "</body>" * 230 + "</worldbody></mujoco>",
    "bodies 5000 deep": lambda: "<mujoco><worldbody>" + "<body>" * 5000 + "</body>" * 5000 + "</worldbody></mujoco>",
    "20,000 bodies": lambda: "<mujoco><worldbody>" + "<body/>" * 20_000 + "</worldbody></mujoco>",
    "50,000 geoms": lambda: _mjcf("<geom size='1'/>" * 50_000),
    "a billion copies": lambda: _mjcf(
        "", "<replicate count='1000000000' offset='1 0 0'><body><geom size='1'/></body></replicate>"
    ),
    "a composite of 10^12": lambda: _mjcf("<composite type='particle' count='10000 10000 10000'/>"),
    "a height field of 10^10": lambda: _mjcf(
        "", "", "<asset><hfield name='h' nrow='100000' ncol='100000' size='1 1 1 1'/></asset>"
    ),
    "a texture of 10^10": lambda: _mjcf(
        "", "", "<asset><texture name='t' type='2d' builtin='flat' width='100000' height='100000'/></asset>"
    ),
    "a mesh of 10 MB in a word": lambda: _mjcf(
        "", "", f"<asset><mesh name='m' vertex='{'1 2 3 ' * 1_500_000}'/></asset>"
    ),
    "a key of a million numbers": lambda: _mjcf("", "", f"<keyframe><key qpos='{'1 ' * 1_000_000}'/></keyframe>"),
    "an order of angles that is none": lambda: _mjcf("", "", "<compiler eulerseq='&#x9b;zz'/>"),
    "a mass of 1e308": lambda: _mjcf("<geom size='1' mass='1e308'/>"),
    "a density of nan": lambda: _mjcf("<geom size='1' density='nan'/>"),
    "a size of 1e200": lambda: _mjcf("<geom size='1e200'/>"),
    "a size of -1": lambda: _mjcf("<geom size='-1'/>"),
    "a quaternion of zeros": lambda: _mjcf("<geom size='1' quat='0 0 0 0'/>"),
    "a joint of an escape": lambda: _mjcf("<joint type='&#x202e;'/>"),
    "gears of 1e308": lambda: _mjcf(
        "<geom size='1'/><joint name='j'/>", "", "<actuator><motor joint='j' gear='1e308'/></actuator>"
    ),
    "10,000 motors of one joint": lambda: _mjcf(
        "<geom size='1'/><joint name='j'/>", "", "<actuator>" + "<motor joint='j'/>" * 10_000 + "</actuator>"
    ),
    "a bomb in an attribute's class": lambda: _mjcf("<geom class='" + "a/" * 100_000 + "'/>"),
}
DEEP_TOML = "a = " + "[" * 100_000
TOML: Mapping[str, Text] = {
    "arrays 100,000 deep": lambda: DEEP_TOML,
    "tables 100,000 deep": lambda: "a = " + "{a = " * 100_000,
    "a key of 100,000 parts": lambda: ".".join(["a"] * 100_000) + " = 1",
    "a table of 100,000 parts": lambda: "[" + ".".join(["a"] * 100_000) + "]",
    "100,000 keys": lambda: "".join(f"a{i} = 1\n" for i in range(80_000)),
    "100,000 tables": lambda: "".join(f"[legs.a{i}]\n" for i in range(50_000)),
    "a whole number of 900,000 digits": lambda: "post = " + "9" * 900_000,
    "a number of 900,000 digits": lambda: "post = 0." + "9" * 900_000,
    "a text of 900 kB": lambda: f'post = "{"x" * 900_000}"',
    "2 MB": lambda: "# " + 2 * BIG,
    "a spring of 50,000 points": lambda: f"urdf = 'b.urdf'\n[springs.knee]\ntable = [{'[0, 0], ' * 50_000}]",
    "nan": lambda: "urdf = 'b.urdf'\n[springs.knee]\nstiffness = nan",
    "inf": lambda: "urdf = 'b.urdf'\n[springs.knee]\nstiffness = inf",
    "a date": lambda: "post = 1979-05-27T07:32:00Z",
    "its own robot": lambda: "urdf = 'a.toml'",
    "a robot of the disk": lambda: "urdf = '../../../../../../etc/passwd'",
    "a robot that is a device": lambda: "urdf = '/dev/zero'",
    "a robot with a zero in its name": lambda: 'urdf = "a\\u0000.urdf"',
    "a robot with an escape in its name": lambda: 'urdf = "a\\u001b]0;title\\u0007.urdf"',
    "a robot of the network": lambda: "urdf = 'http://127.0.0.1:9/a.urdf'",
    "toes with escapes": lambda: 'urdf = "b.urdf"\ntoes = ["\\u001b]0;title\\u0007", "\\u202e", "\\n\\n"]',
    "joints with escapes": lambda: 'urdf = "b.urdf"\nlocked = ["\\u009b31m"]',
    "motors with escapes": lambda: 'urdf = "b.urdf"\n[motors."\\u001b[2J"]\nratio = 3',
    "keys with escapes": lambda: '"\\u001b]0;title\\u0007" = 1',
    "legs with escapes": lambda: 'urdf = "b.urdf"\n[legs."\\u200b"]\nknee = "\\u2066"',
    "an escape": lambda: "post = '\x1b'",
    "UTF-16": lambda: "post = 'a'".encode("utf-16"),
    "UTF-8 that is none": lambda: b"post = '\xff'",
    "noise": lambda: bytes(range(256)) * 100,
}
SRDF: Mapping[str, Text] = {
    "a billion laughs beside it": lambda: f"<!DOCTYPE robot [{LAUGHS}]><robot name='leg'>&a11;</robot>",
    "states with escapes beside it": lambda: (
        "<robot name='leg'><group_state name='&#x9b;' group='a'>"
        "<joint name='&#x202e;' value='1'/></group_state></robot>"
    ),
    "states of nan beside it": lambda: (
        "<robot name='leg'><group_state name='a' group='a'><joint name='knee' value='nan'/></group_state></robot>"
    ),
    "20,000 states beside it": lambda: (
        "<robot name='leg'>"
        + "<group_state name='a' group='a'><joint name='knee' value='1'/></group_state>" * 20_000
        + "</robot>"
    ),
}


def _mjcf(body: str, world: str = "", more: str = "") -> str:
    leg = "<body name='thigh'><joint name='hip' type='hinge' axis='0 1 0'/><geom size='0.1'/>"
    return f"<mujoco>{more}<worldbody>{leg}<body>{body}</body></body>{world}</worldbody></mujoco>"


def cases() -> Iterator[Hostile]:
    """Every robot."""
    for what, content in URDF.items():
        yield Hostile(("dynamics", "a.urdf"), put("a.urdf", content), f"URDF: {what}")
    for what, content in MJCF.items():
        yield Hostile(("dynamics", "a.xml"), put("a.xml", content), f"MJCF: {what}")
    for what, content in TOML.items():
        yield Hostile(("dynamics", "a.toml"), _with_robot("a.toml", content), f"TOML: {what}")
    for what, content in SRDF.items():
        yield Hostile(("dynamics", "b.urdf", "--json"), _with_robot("b.srdf", content), f"SRDF: {what}")
    for name, first in (("a.urdf", b"<robot>"), ("a.xml", b"<mujoco>"), ("a.toml", b"a = 1\n#")):
        yield Hostile(("dynamics", name), sparse(name, first), f"{name} of 100 GB")


def _with_robot(name: str, content: Text):
    def write(folder):
        put("b.urdf", urdf)(folder)
        put(name, content)(folder)

    return write
