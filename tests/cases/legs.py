"""Texts of a leg's files, and functions that find what is read of them, by this package and by others."""

from __future__ import annotations

import contextlib
import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin import RobotWarning, load, monopod
from spear_pin.cli import main
from spear_pin.cli.legs import rests_on
from spear_pin.errors import SpearError
from spear_pin.model.frames import frame_id

MOMENTS = '<inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/>'
LINK = '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>{}</inertial></link>'
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin {4}/><axis xyz="{5}"/>'
    "<limit {6}/></joint>"
)
HIP, KNEE = 'lower="-1.2" upper="1.4" effort="18" velocity="25"', 'lower="-2.2" upper="-0.1" effort="18" velocity="25"'
FOOT = (
    '<link name="foot"/><joint name="sole" type="fixed"><parent link="shank"/><child link="foot"/>'
    '<origin xyz="0 0 -0.2"/></joint>'
)
TRUNK = LINK.format("trunk", "0 0 0", 3, MOMENTS.format(0.03, 0.03, 0.03))
THIGH = LINK.format("thigh", "0 0 -0.1", 0.7, MOMENTS.format(0.003, 0.003, 0.0005))
SHANK = LINK.format("shank", "0 0 -0.1", 0.3, MOMENTS.format(0.001, 0.001, 0.0001))
SHANK_INERTIA = 0.001 + 0.3 * 0.1**2  # kg·m², of the shank about the knee


DRIVE_OF_KNEE = '<transmission name="t"><joint name="knee"/><actuator name="m">{}</actuator></transmission>'


def leg(
    extra: str = "", *, hip: str = HIP, knee: str = KNEE, foot: str = FOOT, shank: str = SHANK,
    at: str = 'xyz="0 0 -0.2"', axis: str = "0 1 0", kind: str = "revolute", head: str = "",
) -> str:  # fmt: skip
    """A URDF of a trunk, a thigh and a shank, with what is to be tried in it."""
    joints = JOINT.format("hip", "revolute", "trunk", "thigh", 'xyz="0 0 0"', "0 1 0", hip) + JOINT.format(
        "knee", kind, "thigh", "shank", at, axis, knee
    )
    return f'<robot name="leg" {head}>{TRUNK}{THIGH}{shank}{foot}{joints}{extra}</robot>'


def mjcf(
    *, before: str = "", knee: str = 'range="-130 -5"', shank: str = '<site name="foot" pos="0 0 -0.2"/>',
    actuators: str = '<motor joint="hip"/><motor joint="knee"/>', after: str = "", free: str = "",
) -> str:  # fmt: skip
    """The same leg for MuJoCo."""
    return f"""<mujoco model="leg">{before}<worldbody><body name="trunk" pos="0 0 0.5">{free}
    <inertial pos="0 0 0" mass="3" diaginertia="0.03 0.03 0.03"/>
    <body name="thigh"><joint name="hip" axis="0 1 0" range="-70 80"/>
    <inertial pos="0 0 -0.1" mass="0.7" diaginertia="0.003 0.003 0.0005"/>
    <body name="shank" pos="0 0 -0.2"><joint name="knee" axis="0 1 0" {knee}/>
    <inertial pos="0 0 -0.1" mass="0.3" diaginertia="0.001 0.001 0.0001"/>{shank}</body></body></body></worldbody>
    <actuator>{actuators}</actuator>{after}</mujoco>"""


def put(folder: Path, **files: str) -> Path:
    """Write files named leg.SUFFIX by their suffixes; the path of the first."""
    paths = [folder / f"leg.{suffix}" for suffix in files]
    for path, text in zip(paths, files.values(), strict=True):
        path.write_text(text, encoding="utf-8")
    return paths[0]


def robot(folder: Path, files: dict[str, str], **options: Any) -> Any:
    return load(put(folder, **files), **options)


def inertia(**files: str) -> Any:
    """The mass matrix's entry of the knee."""
    return lambda folder: robot(folder, files).mass_matrix(np.zeros(2))[1, 1]


def damping(**files: str) -> Any:
    return lambda folder: robot(folder, files).model.damping


def ratio(**files: str) -> Any:
    return lambda folder: robot(folder, files, motors="all").gear_ratio("knee")


def limits(**files: str) -> Any:
    """Position, velocity and effort of the knee, infinite ones as 1e9."""

    def find(folder: Path) -> list[float]:
        knee = robot(folder, files).limits["knee"]
        return [min(max(each, -1e9), 1e9) for each in (*knee.position, knee.velocity, knee.effort)]

    return find


def said(**files: str) -> Any:
    """What loading says, or the error."""

    def find(folder: Path) -> str:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                robot(folder, files, base="fixed", motors="all")
            except SpearError as error:
                return str(error)
        return "; ".join(str(each.message) for each in caught if issubclass(each.category, RobotWarning)) or "nothing"

    return find


def hop(words: str = "", **files: str) -> Any:
    """What `spear hop` says of a leg, whether it hops or not."""

    def find(folder: Path) -> str:
        path, out, err = put(folder, **files), io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            main(["hop", "--robot", str(path), "--out", str(folder), *words.split()])
        return out.getvalue() + err.getvalue()

    return find


def foot(**files: str) -> Any:
    """Height of the toe that is found, every joint at zero, and the side of the knee."""

    def find(folder: Path) -> Any:
        made = robot(folder, files, base="fixed", motors="all")
        (found,) = made.legs
        data = made.model.createData()
        pin.framesForwardKinematics(made.model, data, np.zeros(2))
        return [data.oMf[frame_id(made.model, found.toe)].translation[2], found.side]

    return find


def pinocchio_pose(q: tuple[float, float], **files: str) -> Any:
    def find(folder: Path) -> Any:
        model = pin.buildModelFromUrdf(str(put(folder, **files)))
        data = model.createData()
        pin.framesForwardKinematics(model, data, np.array(q))
        return data.oMf[model.getFrameId("foot")].translation[[0, 2]]

    return find


def pinocchio_mass(q: tuple[float, float], **files: str) -> Any:
    def find(folder: Path) -> Any:
        model = pin.buildModelFromUrdf(str(put(folder, **files)))
        return pin.crba(model, model.createData(), np.array(q)).diagonal()

    return find


def pinocchio_rotors(**files: str) -> Any:
    def find(folder: Path) -> Any:
        model = pin.buildModelFromUrdf(str(put(folder, **files)))
        pin.loadRotorParameters(model, str(folder / "leg.srdf"))
        return pin.crba(model, model.createData(), np.zeros(2))[1, 1]

    return find


def mujoco_model(folder: Path, files: dict[str, str]) -> Any:
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(put(folder, **files)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return mujoco, model, data


def masses(**files: str) -> Any:
    """The mass matrix's entries of the hip and the knee."""
    return lambda folder: robot(folder, files).mass_matrix(np.zeros(2)).diagonal()


def mujoco_masses(**files: str) -> Any:
    def find(folder: Path) -> Any:
        mujoco, model, data = mujoco_model(folder, files)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        return full.diagonal()

    return find


def mujoco_inertia(**files: str) -> Any:
    def find(folder: Path) -> Any:
        mujoco, model, data = mujoco_model(folder, files)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        return full[1, 1]

    return find


def mujoco_damping(**files: str) -> Any:
    """Torque against a rate of 1 rad/s of each joint."""

    def find(folder: Path) -> Any:
        mujoco, model, data = mujoco_model(folder, files)
        data.qvel[:] = 1.0
        mujoco.mj_forward(model, data)
        return -data.qfrc_damper

    return find


def drake_gravity(joint: str) -> Any:
    """What gravity asks of the joint's plane, with every joint at zero."""

    def find(folder: Path) -> Any:
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import MultibodyPlant

        plant = MultibodyPlant(0.0)
        Parser(plant).AddModels(str(put(folder, urdf=joint)))
        plant.Finalize()
        return -plant.CalcGravityGeneralizedForces(plant.CreateDefaultContext())

    return find


def gravity(text: str) -> Any:
    def find(folder: Path) -> Any:
        made = robot(folder, {"urdf": text})
        return made.gravity(pin.neutral(made.model))

    return find


def slab(axis: str) -> str:
    """A body of 2 kg on a planar joint."""
    link = LINK.format("slab", "0.2 0 0.1", 2, MOMENTS.format(0.03, 0.04, 0.05))
    return (
        f'<robot name="slab"><link name="world"/>{link}'
        f'<joint name="glide" type="planar"><parent link="world"/><child link="slab"/>{axis}</joint></robot>'
    )


def toe(text: str) -> Any:
    def find(folder: Path) -> Any:
        made = robot(folder, {"urdf": text}, toes=["foot"])
        return made.toe_position(np.array([0.2, -0.9]), "foot")

    return find


def diagonal(text: str) -> Any:
    return lambda folder: robot(folder, {"urdf": text}).mass_matrix(np.zeros(2)).diagonal()


def rests(**files: str) -> Any:
    """What a hop of the leg is said to rest on."""

    def find(folder: Path) -> str:
        made = robot(folder, files, base="fixed", motors="all")
        return "; ".join(line for _, line in rests_on(monopod(made, made.legs[0])))

    return find
