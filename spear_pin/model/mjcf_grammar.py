"""Lists the data that are read in an MJCF file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from spear_pin.model.mjcf_motors import TORQUES
from spear_pin.model.unread import Grammar

TURNED = "pos quat axisangle xyaxes zaxis euler"
BODY = "mujoco/worldbody/body"
DRIVEN = "joint jointinparent gear ctrlrange ctrllimited forcerange forcelimited armature damping gainprm"
ENABLED = ("enable",)
CONTACT = ("condim", "friction", "solref", "solimp", "margin", "gap", "adhesion", "surfacevel")
# of what other actuators have by a class that they share with motors, which are none of this
SERVO = tuple("kp kv ki dampratio timeconst gaintype gainprm biastype biasprm dyntype dynprm".split())
SMALL = 1e-9  # kg, kg·m²: bounds of inertias that only keep them from being zero

MJCF = Grammar(
    read={
        "mujoco": "model",
        "mujoco/compiler": "angle autolimits balanceinertia coordinate eulerseq inertiafromgeom inertiagrouprange",
        "mujoco/option": "gravity",
        "mujoco/option/flag": "gravity",
        "mujoco/worldbody": "",
        "mujoco/worldbody/geom": f"type size fromto {TURNED}",
        "mujoco/worldbody/site": f"type size fromto {TURNED}",
        BODY: TURNED,
        f"{BODY}/inertial": f"mass diaginertia fullinertia {TURNED}",
        f"{BODY}/joint": (
            "type axis pos range limited armature damping actuatorfrcrange actuatorfrclimited "
            "ref springref frictionloss"  # the first is told in words of its own, the last where it is not zero
        ),
        f"{BODY}/freejoint": "",
        f"{BODY}/geom": f"type size fromto mass density {TURNED}",
        f"{BODY}/site": f"type size fromto {TURNED}",
        "mujoco/equality": "",
        "mujoco/tendon": "",
        "mujoco/contact": "",
        "mujoco/deformable": "",
        "mujoco/extension": "",
        "mujoco/actuator": "",
        **{f"mujoco/actuator/{tag}": DRIVEN for tag in TORQUES},
        "mujoco/keyframe": "",
        "mujoco/keyframe/key": "qpos qvel act ctrl time mpos mquat",
    },
    nested=frozenset(("body",)),
    single=frozenset((f"{BODY}/inertial",)),
    idle=frozenset("light camera visual statistic size custom asset sensor default skin exclude lengthrange".split()),
    still=frozenset(
        (
            "name class childclass group user material rgba mesh hfield contype conaffinity priority solmix fitscale "
            "fluidshape fluidcoef castshadow sleep simple fuse align "
            # softness of limits, which do not act here
            "solreflimit solimplimit solreffriction solimpfriction inheritrange lengthrange actearly "
            # of the compiler: files, and what it saves
            "assetdir meshdir texturedir strippath discardvisual convexhull usethread fitaabb conflict fusestatic "
            "alignfree savecanonical savecompiled saveinertial passthrough "
            # of the solver
            "timestep apirate impratio tolerance ls_tolerance noslip_tolerance ccd_tolerance mpr_tolerance iterations "
            "ls_iterations noslip_iterations ccd_iterations mpr_iterations sdf_iterations sdf_initpoints integrator "
            "cone jacobian solver collision magnetic o_margin o_solref o_solimp o_friction sleep_tolerance "
            "energy fwdinv sensor midphase nativeccd multiccd island eulerdamp invdiscrete autoreset refsafe "
            "warmstart filterparent diagexact ipc speculative sensornoise"
        ).split()
    ),
    usual={
        **{f"flag@{name}": ENABLED for name in ("passive", "spring", "damper", "actuation", "clampctrl")},
        **{f"flag@{name}": ENABLED for name in ("frictionloss", "limit", "constraint", "equality", "contact")},
        "flag@override": ("disable",),
        "option@density": ("0",),
        "option@viscosity": ("0",),
        "option@wind": ("0",),
        "compiler@settotalmass": ("-1",),
        "compiler@exactmeshinertia": ("true", "false"),
        "body@gravcomp": ("0",),
        "body@mocap": ("false",),
        "joint@stiffness": ("0",),
        "joint@springdamper": ("0",),
        "joint@springyield": ("0",),
        "joint@actuatorgravcomp": ("false",),
        "geom@shellinertia": ("false",),
        **{f"geom@{name}": ("0",) for name in ("margin", "gap", "adhesion", "surfacevel")},
        "general@gaintype": ("fixed",),
        **{f"general@{name}": ("none",) for name in ("biastype", "dyntype")},
        **{f"{tag}@{name}": ("0",) for tag in TORQUES for name in ("biasprm", "delay", "nsample")},
    },
)


def without_effect(tag: str, said: Mapping[str, str]) -> dict[str, str]:
    """Leaves out attributes without effect: contact of elements that touch nothing, small bounds of inertias.

    Args:
        tag: tag of the element.
        said: its attributes, with those of its class.
    """
    idle: Any = ()
    if tag == "geom" and said.get("contype") == said.get("conaffinity") == "0":
        idle = CONTACT
    if tag == "motor":
        idle = SERVO
    if tag == "compiler":
        idle = [name for name in ("boundmass", "boundinertia") if _small(said.get(name, "0"))]
    return {name: value for name, value in said.items() if name not in idle}


def _small(text: str) -> bool:
    try:
        return abs(float(text)) <= SMALL
    except ValueError:
        return False
