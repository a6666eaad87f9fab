"""Rows of URDFs, and of the SRDF and TOML files beside them."""

from __future__ import annotations

import math

from tests.cases.case import Case
from tests.cases.legs import (
    FOOT,
    LINK,
    MOMENTS,
    SHANK,
    SHANK_INERTIA,
    diagonal,
    drake_gravity,
    gravity,
    hop,
    inertia,
    leg,
    limits,
    pinocchio_mass,
    pinocchio_pose,
    pinocchio_rotors,
    ratio,
    rests,
    said,
    slab,
    toe,
)

DRAKE = 'xmlns:drake="http://drake.mit.edu"'
HALF = math.sqrt(0.5)
# the shank with its own axes turned by a right angle about x, so that y of it points down
TURNED = LINK.format("shank", "0 -0.1 0", 0.3, MOMENTS.format(0.001, 0.0001, 0.001))
SOLE = FOOT.replace("0 0 -0.2", "0 -0.2 0")
TURN = f'quat_xyzw="{HALF} 0 0 {HALF}"'
QUATERNION = leg(shank=TURNED, foot=SOLE, axis="0 0 -1", head='version="1.1"', at=f'xyz="0 0 -0.2" {TURN}')
LONG = QUATERNION.replace(TURN, 'quat_xyzw="3 0 0 3"')
OF_INERTIA = leg(head='version="1.1"', shank=SHANK.replace('xyz="0 0 -0.1"', f'xyz="0 0 -0.1" {TURN}'))
# by hand, at 0.2 and -0.9 rad: each length of 0.2 m hangs at the sum of the angles above it
TOE = [-0.2 * math.sin(0.2) - 0.2 * math.sin(-0.7), -0.2 * math.cos(0.2) - 0.2 * math.cos(-0.7)]
# with the shank's moments about y and z exchanged
BOTH, ALONE = 0.003 + 0.7 * 0.01 + 0.0001 + 0.3 * 0.09, 0.0001 + 0.3 * 0.01


def quaternions() -> list[Case]:
    kind, by = "quaternions of URDF 1.1", "Pinocchio on the file"
    pose, mass = pinocchio_pose((0.2, -0.9), urdf=QUATERNION), pinocchio_mass((0.0, 0.0), urdf=OF_INERTIA)
    long, none = pinocchio_pose((0.2, -0.9), urdf=LONG), QUATERNION.replace(TURN, 'quat_xyzw="0 0 0 0"')
    earlier, both = QUATERNION.replace('version="1.1"', ""), QUATERNION.replace("quat_", 'rpy="0 0 0" quat_')
    return [
        Case("of a joint", kind, TOE, by, toe(QUATERNION), 1e-12, pose),
        Case("not of length one", kind, TOE, by, toe(LONG), 1e-12, long),
        Case("of an inertia", kind, [BOTH, ALONE], by, diagonal(OF_INERTIA), 1e-12, mass),
        Case("before 1.1", kind, "quat_xyzw in <origin> of 'knee'", "URDF 1.0 has none", said(urdf=earlier)),
        Case("beside rpy", kind, "one of them is valid", "urdfdom refuses both", said(urdf=both)),
        Case("of length zero", kind, "not all zero", "it is no rotation", said(urdf=none)),
    ]


DRIVE = '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>{}</transmission>'
CONTROLLED = '<ros2_control name="r" type="system">{}</ros2_control>'
RATIO, ROTOR = "<mechanicalReduction>40</mechanicalReduction>", "<motorInertia>0.0002</motorInertia>"
OF_DRAKE = '<drake:gear_ratio value="40"/><drake:rotor_inertia value="0.0002"/>'
ON_KNEE, ACTUATOR = '<joint name="knee"/>', '<actuator name="m"/>'
IN_JOINT = DRIVE.format(f'<joint name="knee">{RATIO}{ROTOR}</joint>{ACTUATOR}')
IN_ACTUATOR = DRIVE.format(f'{ON_KNEE}<actuator name="m">{RATIO}{ROTOR}</actuator>')
PLACES = {
    "of the transmission": DRIVE.format(f"{ON_KNEE}{ACTUATOR}{RATIO}{ROTOR}"),
    "of the actuator": IN_ACTUATOR,
    "of its joint": IN_JOINT,
    "in ros2_control": CONTROLLED.format(IN_JOINT),
    "of two places": DRIVE.format(f'<joint name="knee">{RATIO}</joint><actuator name="m">{ROTOR}</actuator>'),
    "with Drake's names": DRIVE.format(f'{ON_KNEE}<actuator name="m">{OF_DRAKE}</actuator>'),
}
ROTOR_ALONE = DRIVE.format(f'{ON_KNEE}<actuator name="m"><motorInertia>0.00004</motorInertia></actuator>')
MOTORS = {
    "no transmission": "",
    "a transmission without a reduction": DRIVE.format(f"{ON_KNEE}{ACTUATOR}"),
    "ros2_control": CONTROLLED.format('<joint name="knee"><command_interface name="effort"/></joint>'),
    "a rotor without a reduction": ROTOR_ALONE,
}
TOML = "[motors.all]\nratio = 7.5\n"
ROTORS = '<robot name="leg"><rotor_params><joint name="knee" mass="2e-5" gear_ratio="20"/></rotor_params></robot>'
SECOND = '<joint name="knee" mass="3e-5" gear_ratio="2"/></rotor_params>'
DIFFER = ROTORS.replace("</rotor_params>", SECOND)
POSED = '<robot name="leg"><group_state name="home" group="all"><joint name="nope" value="3"/></group_state></robot>'
PASSIVE = '<robot name="leg"><passive_joint name="knee"/></robot>'


def gears() -> list[Case]:
    places, hand = "ratios and rotors in their places", "by hand: N² J"
    beside, rotors = "a TOML file's ratio beside motors without one", "rotors of an SRDF"
    reflected = SHANK_INERTIA + 40**2 * 2e-4
    other, strange = (
        DRIVE.format(f"{ON_KNEE}{ACTUATOR}{RATIO}{RATIO.replace('40', '9')}"),
        ROTORS.replace("knee", "ankle"),
    )
    both = inertia(urdf=leg(), srdf=ROTORS)
    by_pinocchio = pinocchio_rotors(urdf=leg(), srdf=ROTORS)
    return [
        *(Case(name, places, reflected, hand, inertia(urdf=leg(text, head=DRAKE))) for name, text in PLACES.items()),
        Case("that disagree", places, "disagrees with", "one of them is wrong", said(urdf=leg(other))),
        Case("a rotor alone", places, "rotors without a ratio, which is taken as 1: 'knee'", "a line",
             said(urdf=leg(ROTOR_ALONE))),
        *(Case(name, beside, 7.5, "as written", ratio(urdf=leg(text), toml=TOML)) for name, text in MOTORS.items()),
        Case("with the file's rotor", beside, SHANK_INERTIA + 7.5**2 * 4e-5, hand,
             inertia(urdf=leg(ROTOR_ALONE), toml=TOML)),
        Case("that the file says otherwise", beside, "expected 40, which the robot's file has", "what is said stays",
             said(urdf=leg(IN_ACTUATOR), toml=TOML)),
        Case("is told", beside, "says: no springs; a ratio of 7.5 at the hip and the knee", "as written",
             rests(urdf=leg(), toml=TOML)),
        Case("beside the URDF", rotors, SHANK_INERTIA + 20**2 * 2e-5, "pin.loadRotorParameters", both, 1e-12,
             by_pinocchio),
        Case("of a joint that is not there", rotors, "<rotor_params>", "a line", said(urdf=leg(), srdf=strange)),
        Case("that differ", rotors, "<rotor_params> that disagree of 'knee'", "a line",
             said(urdf=leg(), srdf=DIFFER)),
        Case("angles of what is no joint", rotors, "no joint of one degree of freedom: 'nope' in <group_state>",
             "a line", said(urdf=leg(), srdf=POSED)),
        Case("passive joints", rotors, "<passive_joint> 'knee'", "a line", said(urdf=leg(), srdf=PASSIVE)),
    ]  # fmt: skip


AXES = {
    "y": ('<axis xyz="0 1 0"/>', [0.0, -19.62, -0.2 * 19.62]),
    "-y, not of length one": ('<axis xyz="0 -4 0"/>', [0.0, 19.62, 0.2 * 19.62]),
    "z": ('<axis xyz="0 0 1"/>', [0.0, 0.0, 0.0]),
    "none, which is x": ("", [-19.62, 0.0, 0.0]),
}
DAMPED = '<axis xyz="0 1 0"/><dynamics damping="0.4"/>'


def planes() -> list[Case]:
    kind, by = "planar joints", "by hand, and Drake"
    return [
        *(
            Case(name, kind, right, by, gravity(slab(axis)), 1e-12, drake_gravity(slab(axis)), ("pydrake",))
            for name, (axis, right) in AXES.items()
        ),
        Case("damping", kind, "damping in <dynamics> of 'glide'", "a line", said(urdf=slab(DAMPED))),
    ]


MOST, FLOAT = "1.7976931348623157e308", "3.4028235e38"
WITHOUT_END = {
    "the largest double": (f"-{MOST}", MOST, MOST, MOST),
    "the largest float": (f"-{FLOAT}", FLOAT, FLOAT, FLOAT),
    "inf": ("-inf", "inf", "inf", "inf"),
    "Infinity, and -1": ("-Infinity", "+Infinity", "-1", "-1.0"),
    "more than a double": ("-1e999", "1e999", "1e999", "-1"),
}
LIMIT = 'lower="{}" upper="{}" effort="{}" velocity="{}"'
EXCHANGED = leg(knee=LIMIT.format(2.2, 0.1, 18, 25))
NO_ROOM = leg(knee=LIMIT.format(0.3, 0.3, 18, 25))


HALVES = {  # what a limit says, position, velocity and effort, and the line
    "no lower": ('upper="-0.05"', [-1e9, -0.05, 25.0, 18.0], "joint 'knee' says no lower limit: it has none"),
    "no upper": ('lower="-1"', [-1.0, 1e9, 25.0, 18.0], "joint 'knee' says no upper limit: it has none"),
    "upper -inf": ('lower="-1" upper="-inf"', [-1.0, 1e9, 25.0, 18.0], "joint 'knee' has the upper limit -inf: it has"),
    "lower 1e999": ('lower="1e999" upper="2"', [-1e9, 2.0, 25.0, 18.0], "joint 'knee' has the lower limit inf: it has"),
}
FLOATING_LIMIT = '<axis xyz="0 1 0"/><limit lower="0" upper="1" effort="3" velocity="2"/>'
ENDLESS = "lower, upper (a continuous joint has no limits) in <limit> of 'knee'"
LOST = {
    "of a planar joint": (slab(FLOATING_LIMIT), "upper, effort, velocity in <limit> of 'glide'"),
    "of a floating joint": (slab(FLOATING_LIMIT).replace("planar", "floating"), "upper, effort, velocity in <limit>"),
    "of a continuous joint": (leg(kind="continuous", knee=LIMIT.format(-1, 1, 18, 25)), ENDLESS),
}
MISSING = {
    "an effort": (leg(knee='lower="-1" upper="1" velocity="2"'), "<limit> of 'knee' has no effort; expected a number"),
    "a moment": (leg(shank=SHANK.replace("izz", "izx")), "<inertia> of 'shank' has no izz; expected a number"),
    "a ratio other than 0": (
        leg(DRIVE.format(f'{ON_KNEE}<actuator name="m">{RATIO}</actuator>').replace("40", "0")),
        "joint 'knee': gear ratio 0; expected another than 0",
    ),
}


def bounds() -> list[Case]:
    kind, swapped, open_ends = "numbers that mean no limit", "lower limits above upper ones", [-1e9, 1e9, 1e9, 1e9]
    half, lost = "one limit alone", "limits of joints that have none"
    missing = "numbers that are missing"
    told = "joint 'knee' has the lower limit 2.2 above the upper one, 0.1"
    return [
        *(
            Case(name, kind, open_ends, "by hand", limits(urdf=leg(knee=LIMIT.format(*numbers))))
            for name, numbers in WITHOUT_END.items()
        ),
        Case("effort alone", kind, [-1e9, 1e9, 1e9, 18.0], "by hand",
             limits(urdf=leg(kind="continuous", knee='effort="18"'))),
        Case("other negative efforts", kind, "has the effort -3; expected", "they mean nothing",
             said(urdf=leg(knee=LIMIT.format(-1, 1, -3, 4)))),
        Case("exchanged", swapped, [0.1, 2.2, 25.0, 18.0], "by hand", limits(urdf=EXCHANGED)),
        Case("told", swapped, told, "a line", said(urdf=EXCHANGED)),
        *(Case(name, half, ends, "by hand", limits(urdf=leg(knee=f'{text} effort="18" velocity="25"')))
          for name, (text, ends, _) in HALVES.items()),
        *(Case(f"told: {name}", half, line, "a line", said(urdf=leg(knee=f'{text} effort="18" velocity="25"')))
          for name, (text, _, line) in HALVES.items()),
        *(Case(name, lost, line, "a line", said(urdf=text)) for name, (text, line) in LOST.items()),
        *(Case(name, missing, line, "it is missing", said(urdf=text)) for name, (text, line) in MISSING.items()),
        Case("alike", swapped, "joint 'knee' has the limits 0.3 and 0.3, which leave it no room", "a line",
             said(urdf=NO_ROOM)),
    ]  # fmt: skip


SIMPLE = '<transmission name="t"><plugin>transmission_interface/SimpleTransmission</plugin>'
COMMAND = '<joint name="knee"><command_interface name="effort"><param name="min">-5</param></command_interface></joint>'
LOOP = '<gazebo><joint name="rod" type="revolute"><parent>a</parent></joint></gazebo>'
NESTED = '<gazebo reference="knee"><axis><dynamics><spring_stiffness>14</spring_stiffness></dynamics></axis></gazebo>'
CAPITALS = '<Transmission name="t">{}</Transmission>'
RUBBER = (
    '<link name="pad"><collision><origin xyz="0 0 0"/><geometry><sphere radius="1"/></geometry>'
    '<drake:proximity_properties><drake:mu_dynamic value="0.2"/></drake:proximity_properties></collision></link>'
    '<joint name="glued" type="fixed"><parent link="shank"/><child link="pad"/></joint>'
)
OF_SHANK = '<gazebo reference="shank">{}</gazebo>'
TOLD = {
    "springs of Gazebo": (
        '<gazebo reference="knee"><springStiffness>14</springStiffness></gazebo>',
        "<springStiffness> in <gazebo> of 'knee'",
    ),
    "a spring of Gazebo, nested": (NESTED, "<axis> in <gazebo> of 'knee'"),
    "a loop of Gazebo": (LOOP, "<joint> 'rod' in <gazebo>"),
    "loop_joint": ('<loop_joint name="rod"><link1 link="a"/></loop_joint>', "<loop_joint> 'rod'"),
    "a constraint of Drake": ('<drake:ball_constraint><x v="1"/></drake:ball_constraint>', "<drake:ball_constraint>"),
    "a bushing of Drake": ("<drake:linear_bushing_rpy><a/></drake:linear_bushing_rpy>", "<drake:linear_bushing_rpy>"),
    "a joint of another space": ('<drake:joint name="extra" type="screw"/>', "<drake:joint> 'extra'"),
    "a prefix not declared": ("<mine:spring value='3'/>", "<mine:spring>"),
    "gravity that is off": (OF_SHANK.format("<gravity>0</gravity>"), "<gravity> in <gazebo> of 'shank'"),
    "friction of a foot": (OF_SHANK.format("<mu1>0.3</mu1><kp>9</kp>"), "<mu1>, <kp> in <gazebo> of 'shank'"),
    "friction of a foot in Drake": (RUBBER, "<drake:proximity_properties> in <collision> of 'pad'"),
    "an unknown element": ('<force_element name="push"/>', "<force_element> 'push'"),
    "a tag in capitals": (CAPITALS.format(RATIO), "<Transmission> 't'"),
    "a file to include": (
        '<xi:include href="a.xml" xmlns:xi="http://www.w3.org/2001/XInclude"/>', "<xi:include>"
    ),
    "a robot in a robot": ("<robot><joint name='rod'/></robot>", "<robot>"),
    "a link in a link": ('<link name="pad"><link name="q"/></link>', "<link> 'q' in <link> of 'pad'"),
    "gazebo in gazebo": ('<gazebo><gazebo reference="knee"/></gazebo>', "<gazebo> 'knee' in <gazebo>"),
    "gravity for MuJoCo": ('<mujoco><option gravity="0 0 -3.7"/></mujoco>', "gravity in <option>"),
    "angles for MuJoCo": ('<mujoco><compiler angle="degree"/></mujoco>', "angle in <compiler>"),
    "parameters of a controlled joint": (
        CONTROLLED.format('<joint name="knee"><param name="k">14</param></joint>'), "<param> 'k' in <joint> of 'knee'"
    ),
    "parameters of a command": (
        CONTROLLED.format(COMMAND), "<param> 'min' in <command_interface> of 'knee'"
    ),
    "many of a kind": (
        "".join(f'<spring name="s{i}"/>' for i in range(9)), "<spring> 's0', 's1', 's2', 's3' and 5 more"
    ),
}  # fmt: skip
IN_JOINT_TOLD = {
    "stiffness": ('<dynamics damping="0" stiffness="14"/>', "stiffness in <dynamics> of 'knee'"),
    "spring_stiffness": ('<dynamics spring_stiffness="14"/>', "spring_stiffness in <dynamics> of 'knee'"),
    "Coulomb's friction": ('<dynamics friction="0.4"/>', "friction in <dynamics> of 'knee'"),
    "mimic": ('<mimic joint="hip" multiplier="2"/>', "<mimic> in <joint> of 'knee'"),
    "a safety controller": ('<safety_controller k_velocity="3"/>', "<safety_controller> in <joint> of 'knee'"),
    "a joint in a joint": ('<joint name="x"><limit lower="1"/></joint>', "<joint> 'x' in <joint> of 'knee'"),
    "a second limit": ('<limit lower="0" upper="1"/>', "a second <limit> in <joint> of 'knee'"),
    "a rotor of no motor": ("<motorInertia>0.1</motorInertia>", "<motorInertia> in <joint> of 'knee'"),
}
QUIET = {
    "files for MuJoCo": '<mujoco><compiler meshdir="m" discardvisual="false" strippath="false"/></mujoco>',
    "what is a simple transmission": CONTROLLED.format(
        SIMPLE + f'<joint name="knee" role="joint1">{RATIO}</joint>{ACTUATOR}</transmission>'
    ),
    "colours": '<material name="grey"><color rgba="1 1 1 1"/></material>',
    "colours of Gazebo": '<gazebo reference="knee"><material>Gazebo/Grey</material></gazebo>',
    "sensors": OF_SHANK.format('<sensor name="s" type="imu"/>'),
    "springs of no stiffness": '<gazebo reference="knee"><springStiffness>0.0</springStiffness></gazebo>',
    "how another program integrates": OF_SHANK.format("<implicitSpringDamper>1</implicitSpringDamper>"),
}


def unread() -> list[Case]:
    kind, inside, tree = "what a URDF says beside", "what a URDF says of a joint", "links that form no tree"
    apart = leg(head=DRAKE).replace('<joint name="knee"', '<drake:joint name="knee"')
    apart = apart.replace("</joint></robot>", "</drake:joint></robot>")
    no_foot = "the limb below 'knee' ends without a frame: name a toe"
    return [
        *(Case(name, kind, line, "a line", said(urdf=leg(text, head=DRAKE if "<drake" in text else "")))
          for name, (text, line) in TOLD.items()),
        *(Case(name, inside, line, "a line", said(urdf=leg().replace("</joint></robot>", f"{text}</joint></robot>")))
          for name, (text, line) in IN_JOINT_TOLD.items()),
        *(Case(name, "what changes no motion", "nothing", "no line", said(urdf=leg(text)))
          for name, text in QUIET.items()),
        Case("a joint of another space", tree, "not taken over: <drake:joint> 'knee'", "named", said(urdf=apart)),
        Case("none in a URDF", "the end of a limb", no_foot, "there is none", hop(urdf=leg(foot=""))),
    ]  # fmt: skip


CASES = (*quaternions(), *gears(), *planes(), *bounds(), *unread())
