"""Lists the data that are read in a URDF, and in its SRDF."""

from __future__ import annotations

from spear_pin.model.mjcf_grammar import MJCF
from spear_pin.model.unread import Grammar

NO = ("0", "false", "")
ORIGIN, PLAIN = "xyz rpy", ""


def _table(**attributes: str) -> dict[str, frozenset[str]]:
    """Returns attributes by the paths of elements, which keywords write with two underscores for a slash."""
    return {path.replace("__", "/"): frozenset(names.split()) for path, names in attributes.items()}


URDF = Grammar(
    read=_table(
        robot="version",
        robot__link=PLAIN,
        robot__link__inertial=PLAIN,
        robot__link__inertial__origin=ORIGIN,
        robot__link__inertial__mass="value",
        robot__link__inertial__inertia="ixx ixy ixz iyy iyz izz",
        robot__link__collision="group",
        robot__link__collision__origin=f"{ORIGIN} quat_xyzw",
        robot__joint="type",
        robot__joint__origin=ORIGIN,
        robot__joint__parent="link",
        robot__joint__child="link",
        robot__joint__axis="xyz",
        robot__joint__limit="lower upper effort velocity",
        robot__joint__dynamics="damping",  # friction is Coulomb's, which does not act
        robot__transmission="type",
        robot__transmission__joint="role",
        robot__transmission__actuator="role",
        robot__ros2_control="type rw_rate is_async",
        robot__ros2_control__joint=PLAIN,
        robot__ros2_control__joint__command_interface=PLAIN,
        robot__ros2_control__transmission=PLAIN,
        robot__ros2_control__transmission__joint="role",
        robot__ros2_control__transmission__actuator="role",
        robot__gazebo="reference",
        robot__mujoco=PLAIN,
        robot__mujoco__compiler=" ".join(MJCF.still),
        robot__mujoco__option=" ".join(MJCF.still),
    ),
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
    read=_table(
        robot="version",
        robot__group_state="group",
        robot__group_state__joint="value",
        robot__virtual_joint="parent_frame child_link",
        robot__rotor_params=PLAIN,
        robot__rotor_params__joint="mass gear_ratio",
    ),
    idle=frozenset(
        (
            "group group_name end_effector chain disable_collisions disable_default_collisions enable_collisions "
            "link_sphere_approximation specified_limbs"
        ).split()
    ),
    still=frozenset(("name",)),
    usual={"virtual_joint@type": ("floating", "fixed")},  # `base` says that, and a root that stays fixed is told
)
