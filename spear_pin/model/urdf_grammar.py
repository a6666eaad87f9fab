"""Lists the data that are read in a URDF, and in its SRDF."""

from __future__ import annotations

from spear_pin.model.mjcf_grammar import MJCF
from spear_pin.model.unread import Grammar

NO = ("0", "false", "")
ORIGIN, PLAIN = "xyz rpy", ""

URDF = Grammar(
    read={
        "robot": "version",
        "robot/link": PLAIN,
        "robot/link/inertial": PLAIN,
        "robot/link/inertial/origin": ORIGIN,
        "robot/link/inertial/mass": "value",
        "robot/link/inertial/inertia": "ixx ixy ixz iyy iyz izz",
        "robot/link/collision": "group",
        "robot/link/collision/origin": f"{ORIGIN} quat_xyzw",
        "robot/joint": "type",
        "robot/joint/origin": ORIGIN,
        "robot/joint/parent": "link",
        "robot/joint/child": "link",
        "robot/joint/axis": "xyz",
        "robot/joint/limit": "lower upper effort velocity",
        "robot/joint/dynamics": "damping",  # friction is Coulomb's, which does not act
        "robot/transmission": "type",
        "robot/transmission/joint": "role",
        "robot/transmission/actuator": "role",
        "robot/ros2_control": "type rw_rate is_async",
        "robot/ros2_control/joint": PLAIN,
        "robot/ros2_control/joint/command_interface": PLAIN,
        "robot/ros2_control/transmission": PLAIN,
        "robot/ros2_control/transmission/joint": "role",
        "robot/ros2_control/transmission/actuator": "role",
        "robot/gazebo": "reference",
        "robot/mujoco": PLAIN,
        "robot/mujoco/compiler": " ".join(MJCF.still),
        "robot/mujoco/option": " ".join(MJCF.still),
    },
    kinds=frozenset(("command_interface", "state_interface")),
    single=frozenset(
        f"robot/{path}"
        for path in (
            "link/inertial/origin link/inertial/mass link/inertial/inertia "
            "joint/origin joint/parent joint/child joint/axis joint/limit joint/dynamics"
        ).split()
    ),
    idle=frozenset(
        (
            # how it looks, and what it collides with: contact is at the toes, with the ground
            "visual geometry material self_collide selfCollide selfCollision collision_checking verbose "
            "drake:collision_filter_group drake:diffuse_map "
            # sensors, and what is measured
            "sensor state_interface calibration laserRetro provideFeedback "
            # how it is driven by hardware, or integrated by another program
            "hardware hardwareInterface type implicitSpringDamper disableFixedJointLumping preserveFixedJoint frame "
            "role"
        ).split()
    ),
    still=frozenset(("name", "id", "dont_collapse")),
    usual={
        "dynamics@friction": NO,
        "dynamics@stiffness": NO,
        "dynamics@spring_stiffness": NO,
        "dynamics@spring_reference": NO,
        "springStiffness": ("0",),
        "springReference": ("0",),
        "turnGravityOff": ("0", "false"),
        "static": ("0", "false"),
        "gravity": ("1", "true"),
        "offset": ("0",),
        "damping": NO,
        "plugin": ("transmission_interface/simpletransmission",),
        "option@gravity": ("0 0 -9.81",),
        "compiler@angle": ("radian",),
        "compiler@balanceinertia": NO,
    },
)
SRDF = Grammar(
    read={
        "robot": "version",
        "robot/group_state": "group",
        "robot/group_state/joint": "value",
        "robot/virtual_joint": "parent_frame child_link",
        "robot/rotor_params": PLAIN,
        "robot/rotor_params/joint": "mass gear_ratio",
    },
    idle=frozenset(
        (
            "group group_name end_effector chain disable_collisions disable_default_collisions enable_collisions "
            "link_sphere_approximation specified_limbs"
        ).split()
    ),
    still=frozenset(("name",)),
    usual={"virtual_joint@type": ("floating", "fixed")},  # `base` says that, and a root that stays fixed is told
)
