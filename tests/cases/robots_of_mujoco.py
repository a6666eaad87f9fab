"""Rows of MJCF files."""

from __future__ import annotations

import math

from tests.cases.case import Case
from tests.cases.legs import (
    SHANK_INERTIA,
    damping,
    foot,
    hop,
    inertia,
    limits,
    masses,
    mjcf,
    mujoco_damping,
    mujoco_inertia,
    mujoco_masses,
    ratio,
    said,
)

TENDON = '<tendon><fixed name="t" stiffness="9"><joint joint="knee" coef="1"/></fixed></tendon>'
LOOP = '<equality><connect name="c" body1="shank" body2="trunk" anchor="0 0 0"/></equality>'


def ground(geom: str) -> dict[str, str]:
    return {"after": f"<worldbody>{geom}</worldbody>"}


TOLD = {
    "a spring": ({"knee": 'stiffness="14"'}, "stiffness in <joint> of 'knee'"),
    "a spring of a class": ({"before": '<default><joint stiffness="14"/></default>'}, "stiffness in <joint> of 'hip'"),
    "a spring of a tendon": ({"after": TENDON}, "<fixed> 't' in <tendon>"),
    "a loop": ({"after": LOOP}, "<connect> 'c' in <equality>"),
    "a servo's gains": (
        {"actuators": '<position joint="knee" kp="30" kv="1"/>'},
        "the control law of <position> of 'knee'",
    ),
    "a muscle": ({"actuators": '<muscle joint="knee" lengthrange="0 1"/>'}, "the control law of <muscle> of 'knee'"),
    "a servo in general": (
        {"actuators": '<general joint="knee" gainprm="20" biastype="affine" biasprm="0 -20 -1"/>'},
        "biastype, biasprm in <general> of 'knee'",
    ),
    "dampers that are off": ({"before": '<option><flag damper="disable"/></option>'}, "damper in <flag>"),
    "wind": ({"before": '<option wind="1 0 0" density="1.2"/>'}, "wind, density in <option>"),
    "a step": (ground('<geom name="step" type="box" size="1 1 0.1"/>'), "the ground's shape of 'step'"),
    "ground that slopes": (ground('<geom type="plane" size="1 1 1" euler="0 9 0"/>'), "the ground's shape"),
    "ground that is low": (ground('<geom type="plane" size="1 1 1" pos="0 0 -1"/>'), "the ground's shape"),
    "friction of the ground": (
        ground('<geom name="g" type="plane" size="1 1 1" friction="0.3 0 0"/>'),
        "friction in <geom> of 'g'",
    ),
}
QUIET = {
    "gains of a class": {"before": '<default><position kp="30"/></default>'},
    "level ground": ground('<geom name="g" type="plane" size="1 1 1" quat="1 0 0 0.3" rgba="1 1 1 1"/>'),
    "a light and a camera": ground('<light pos="0 0 3"/><camera name="c" pos="0 -1 0"/>'),
    "the solver": {"before": '<option timestep="0.001" integrator="RK4" cone="elliptic"/>'},
    "gravity of a body as it is": {"before": '<compiler settotalmass="-1" boundmass="1e-12"/>'},
    "sensors": {"after": '<sensor><jointpos joint="knee"/></sensor>'},
    "what does not collide": {"after": '<contact><exclude body1="trunk" body2="shank"/></contact>'},
}
ONE = '<motor joint="hip"/><motor joint="knee" gear="24" armature="1e-5" damping="2e-5"/>'
TWO = '<motor joint="knee" gear="24" armature="1e-5"/><general joint="knee" gear="-5" armature="3e-5" damping="1e-3"/>'
SERVO = '<position joint="knee" gear="3" kp="9" armature="1e-4"/>'
OF_A_CLASS = '<default><motor armature="1e-5" gear="24"/></default>'
AT_THE_TOP = '<default class="robot"><joint armature="0.02" damping="0.3"/></default>'


def actuators() -> list[Case]:
    kind, by, mujoco = "actuators of MuJoCo", "mj_fullM of MuJoCo 4", ("mujoco",)
    right = {
        "armature": ({"actuators": ONE}, 24**2 * 1e-5),
        "two of one joint": ({"actuators": TWO}, 24**2 * 1e-5 + 25 * 3e-5),
        "of a servo": ({"actuators": SERVO}, 9 * 1e-4),
        "of a class": ({"before": OF_A_CLASS}, 24**2 * 1e-5),
        "beside the joint's own": ({"actuators": ONE, "knee": 'armature="0.003"'}, 0.003 + 24**2 * 1e-5),
    }
    rubs, top = [0.0, 24**2 * 2e-5], "a named class at the top"
    return [
        *(
            Case(
                name,
                kind,
                SHANK_INERTIA + more,
                by,
                inertia(xml=mjcf(**parts)),
                1e-12,
                mujoco_inertia(xml=mjcf(**parts)),
                mujoco,
            )
            for name, (parts, more) in right.items()
        ),
        Case(
            "damping",
            kind,
            rubs,
            "MuJoCo 4",
            damping(xml=mjcf(actuators=ONE)),
            1e-12,
            mujoco_damping(xml=mjcf(actuators=ONE)),
            mujoco,
        ),
        Case(
            "armature",
            top,
            SHANK_INERTIA + 0.02,
            "MuJoCo 3",
            inertia(xml=mjcf(before=AT_THE_TOP)),
        ),
        Case("damping", top, [0.3, 0.3], "MuJoCo 3", damping(xml=mjcf(before=AT_THE_TOP))),
        Case(
            "of MuJoCo",
            "a TOML file's ratio beside motors without one",
            7.5,
            "as written",
            ratio(xml=mjcf(), toml="[motors.all]\nratio = 7.5\n"),
        ),
        Case(
            "of MuJoCo",
            "numbers that mean no limit",
            [-math.radians(130), 1e9, 1e9, 1e9],
            "by hand",
            limits(
                xml=mjcf(
                    knee='range="-130 inf" actuatorfrcrange="-inf 1.8e308"',
                    actuators='<motor joint="knee" ctrlrange="-inf inf"/>',
                )
            ),
        ),
    ]


NO_FOOT = "the limb below 'knee' ends without a frame: name a toe"
BAR = '<geom name="bar" type="capsule" size="0.02 0.1" pos="0 0 -0.1"/>'
BOTH_WAYS = 'range="-130 130"'
HOME = '<keyframe><key name="home" qpos="0.6 -1.2"/></keyframe>'
FLOATING_HOME = '<keyframe><key name="home" qpos="0 0 0.4 1 0 0 0 0.6 1.2"/></keyframe>'
FLOATING = {"free": '<freejoint name="float"/>', "knee": BOTH_WAYS, "after": FLOATING_HOME}
# the trunk is 0.5 m above the ground, each length is 0.2 m; the knee bends to negative angles
ENDS = {
    "a site": ('<site name="foot" pos="0 0 -0.2"/>', 0.1),
    "a sphere": ('<geom name="ball" size="0.02" pos="0 0 -0.18"/>', 0.12),
    "a sphere without a name": ('<geom size="0.02" pos="0 0 -0.18"/>', 0.12),
    "the end of a capsule": ('<geom type="capsule" size="0.02" fromto="0 0 -0.2 0 0 0"/>', 0.1),
    "a body that is welded": ('<body name="foot" pos="0 0 -0.19"/>', 0.11),
}


def ends() -> list[Case]:
    kind, posture, hand = "the end of a limb", "a keyframe", "by hand"
    return [
        *(
            Case(name, kind, [height, -1], hand, foot(xml=mjcf(shank=shank)), 1e-12)
            for name, (shank, height) in ENDS.items()
        ),
        Case("none in an MJCF file", kind, NO_FOOT, "there is none", hop(xml=mjcf(shank=""))),
        Case("the middle of a bar is none", kind, NO_FOOT, hand, hop(xml=mjcf(shank=BAR))),
        Case("tells a knee's side", posture, [0.1, -1], hand, foot(xml=mjcf(knee=BOTH_WAYS, after=HOME)), 1e-12),
        Case("of a robot that floats", posture, [0.1, 1], hand, foot(xml=mjcf(**FLOATING)), 1e-12),
        Case(
            "too short",
            posture,
            "keyframe 'home' has 2 numbers in qpos; expected 9",
            "MuJoCo refuses it",
            said(xml=mjcf(**FLOATING | {"after": HOME})),
        ),
    ]


BALL = '<site name="foot" pos="0 0 -0.2"/><geom size="0.05" pos="0 0 -0.1" mass="{}" group="{}"/>'
COUNTED = '<compiler inertiafromgeom="true" inertiagrouprange="0 2"/>'
SAID = [0.003 + 0.7 * 0.01 + 0.001 + 0.3 * 0.09, SHANK_INERTIA]  # at the hip and the knee, by each <inertial>
WEIGHED = [0.003 + 0.7 * 0.01 + 0.4 * 0.5 * 0.05**2 + 0.5 * 0.09, 0.4 * 0.5 * 0.05**2 + 0.5 * 0.01]  # by the ball
MASSES = {
    "bodies without geoms": (BALL.format(0.5, 0), WEIGHED),
    "geoms without mass": (BALL.format(0, 0), SAID),
    "geoms of other groups": (BALL.format(0.5, 3), SAID),
    "geoms of two groups": (BALL.format(0.5, 0) + BALL.format(9, 4).replace("foot", "other"), WEIGHED),
}


def weights() -> list[Case]:
    kind, by = "inertias beside geoms", "mj_fullM of MuJoCo 4"
    return [
        Case(name, kind, right, by, masses(xml=text), 1e-12, mujoco_masses(xml=text), ("mujoco",))
        for name, (shank, right) in MASSES.items()
        for text in [mjcf(before=COUNTED, shank=shank)]
    ]


FREE_TO_TURN = 'range="-140 -3" limited="false" actuatorfrcrange="-4 4" actuatorfrclimited="false"'
STRICT = '<compiler autolimits="false"/><default><joint limited="true"/></default>'
DRIVEN = '<motor joint="knee" gear="-6" ctrlrange="{}" {}/>'
BALL_JOINT = '<body name="tail"><joint name="tail" type="ball" range="0 60"/><geom size="0.1"/></body>'
RANGES = {
    "limited is false": ({"knee": FREE_TO_TURN}, [-1e9, 1e9, 1e9, 1e9]),
    "the smaller side of a joint": ({"knee": 'actuatorfrcrange="-5 8"'}, [-1e9, 1e9, 1e9, 5.0]),
    "the smaller side of an actuator": (
        {"knee": "", "actuators": DRIVEN.format("-2 3", "")},
        [-1e9, 1e9, 1e9, 12.0],
    ),
    "forces of one sign": ({"knee": "", "actuators": DRIVEN.format("0 3", "")}, [-1e9, 1e9, 1e9, 18.0]),
    "ctrllimited is false": (
        {"knee": "", "actuators": DRIVEN.format("-2 3", 'ctrllimited="false"')},
        [-1e9, 1e9, 1e9, 1e9],
    ),
}
NEITHER = 'expected {}="true" or'
TOLD_OF_RANGES = {
    "a joint's sides": ({"knee": 'actuatorfrcrange="-5 8"'}, "the larger side of actuatorfrcrange of 'knee'"),
    "an actuator's sides": ({"actuators": DRIVEN.format("-2 3", "")}, "the larger side of ctrlrange of 'knee'"),
    "one sign": ({"actuators": DRIVEN.format("-3 0", "")}, "the sign of ctrlrange of 'knee'"),
    "a ball joint's": ({"shank": BALL_JOINT}, "range in <joint> of 'tail'"),
    "a range alone": ({"before": '<compiler autolimits="false"/>'}, NEITHER.format("limited")),
    "a range of force alone": (
        {"before": STRICT, "knee": 'range="-9 -3" actuatorfrcrange="-1 1"'},
        NEITHER.format("actuatorfrclimited"),
    ),
    "a range of control alone": (
        {"before": STRICT, "knee": 'range="-9 -3"', "actuators": DRIVEN.format("-1 1", "")},
        NEITHER.format("ctrllimited"),
    ),
    "an actuator without a name": (
        {"actuators": '<motor joint="knee"/><velocity joint="knee"/>'},
        "each joint of 'velocity of knee'",
    ),
}


def ranges() -> list[Case]:
    kind = "ranges of MuJoCo"
    return [
        *(Case(name, kind, right, "by hand", limits(xml=mjcf(**parts))) for name, (parts, right) in RANGES.items()),
        *(
            Case(f"told: {name}", kind, line, "a line", said(xml=mjcf(**parts)))
            for name, (parts, line) in TOLD_OF_RANGES.items()
        ),
    ]


CASES = (
    *(
        Case(name, "what an MJCF file says beside", line, "a line", said(xml=mjcf(**parts)))
        for name, (parts, line) in TOLD.items()
    ),
    *(
        Case(f"{name}, in MJCF", "what changes no motion", "nothing", "no line", said(xml=mjcf(**parts)))
        for name, parts in QUIET.items()
    ),
    *actuators(),
    *ends(),
    *weights(),
    *ranges(),
)
