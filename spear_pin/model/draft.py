"""A robot as its file describes it: Pinocchio's model, the joints with motors, and warnings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadFile
from spear_pin.model.frames import INSIDE, POINT
from spear_pin.model.gears import Gear
from spear_pin.model.memory import check_memory
from spear_pin.model.mjcf_reading import Mjcf
from spear_pin.model.srdf_reading import read_srdf
from spear_pin.model.urdf import BASE, WORLD, Base, Urdf, untaken

MODEL = "pinocchio.Model"  # the source of what was built elsewhere
FLOATING = "JointModelFreeFlyer"


@dataclass(frozen=True)
class Draft:
    """A robot as a file, or a model, describes it.

    Attributes:
        model: the model, without gears except for the armatures of an MJCF file.
        name: name of the robot.
        place: path that errors name.
        gears: ratios and rotors that the file gives, by joint.
        motors: names of the joints with motors.
        notes: warnings, a line each.
        loops: closed loops that the file gives, by name, as tables of a TOML file.
        source: name or path from which the robot can be loaded again.
    """

    model: pin.Model
    name: str
    place: str | Path
    gears: Mapping[str, Gear]
    motors: tuple[str, ...]
    notes: tuple[str, ...]
    source: str
    loops: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


def of_urdf(urdf: Urdf, base: Base | None) -> Draft:
    """Builds the robot of a URDF, with its joints in the order of the document.

    Raises:
        BadFile: Pinocchio cannot build it, or a transmission drives a joint of several degrees of freedom.
    """
    try:
        model = pin.buildModelFromXML(urdf.text)
    except (ValueError, RuntimeError) as error:
        raise BadFile(urdf.path, f"Pinocchio cannot build it: {str(error).strip().splitlines()[0]}") from None
    check_memory(urdf.path, model.njoints - 1, model.nv)
    # numbered to keep the order of the document, as Pinocchio would sort by name
    for i, name in enumerate(model.names):
        model.names[i] = name.partition(":")[2] or name
    for frame in model.frames:
        if frame.type != pin.FrameType.BODY and frame.name != "universe":
            frame.name = frame.name.partition(":")[2]
    for joint in urdf.transmissions:
        freedoms = model.joints[model.getJointId(joint)].nv
        if freedoms != 1:
            raise BadFile(
                urdf.path, f"a transmission drives {joint!r}, which has {freedoms} degrees of freedom; expected one"
            )
    for joint, normal in urdf.normals.items():
        if model.existJointName(joint):  # unless it is held
            _turn_plane(model, model.getJointId(joint), np.array(normal))
    _forget_gears(model)
    beside = read_srdf(model, urdf.path)
    for name, q in beside.postures.items():
        model.referenceConfigurations[name] = q
    gears, notes = dict(urdf.transmissions), [*urdf.notes, *beside.notes]
    for joint, gear in beside.gears.items():
        gears[joint], differ = gears.get(joint, Gear()).completed(gear)
        if differ:
            notes.append(f"its SRDF says another {' and '.join(differ)} of {joint!r} than the URDF, whose is taken")
    if urdf.root != WORLD:
        notes += fixed_trunk(model, urdf.root, base)
    return Draft(model, urdf.name, urdf.path, gears, tuple(urdf.transmissions), tuple(notes), str(urdf.path))


def _forget_gears(model: pin.Model) -> None:
    """Removes the ratios of 1 with which Pinocchio begins."""
    model.armature, model.rotorInertia, model.rotorGearRatio = (np.zeros(model.nv) for _ in range(3))


def _turn_plane(model: pin.Model, joint: int, normal: Array) -> None:
    """Turns the plane of a planar joint, whose normal is z in Pinocchio, by the least turn; its bodies stay."""
    up, normal = np.array([0.0, 0.0, 1.0]), normal / np.linalg.norm(normal)
    axis = np.cross(up, normal)
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
    turned = pin.SE3(pin.AngleAxis(math.atan2(length, normal[2]), axis).matrix(), np.zeros(3))
    back = turned.inverse()
    model.jointPlacements[joint] = model.jointPlacements[joint] * turned
    model.inertias[joint] = back.act(model.inertias[joint])
    for child in range(joint + 1, model.njoints):
        if model.parents[child] == joint:
            model.jointPlacements[child] = back * model.jointPlacements[child]
    for frame in model.frames:
        if frame.parentJoint == joint:
            frame.placement = back * frame.placement


def of_mjcf(mjcf: Mjcf, base: Base | None) -> Draft:
    """Builds the robot of an MJCF file; its armatures are already reflected.

    Raises:
        BadFile: Pinocchio cannot build it.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / "robot.xml"
        path.write_text(mjcf.text, encoding="utf-8")
        try:
            model = pin.buildModelFromMJCF(str(path))
        except (ValueError, RuntimeError, IndexError) as error:
            problem = str(error).strip().splitlines()[-1].replace(str(path), "it")
            raise BadFile(mjcf.path, f"Pinocchio cannot build it: {problem}") from None
    check_memory(mjcf.path, model.njoints - 1, model.nv)
    model.gravity.linear = np.array(mjcf.gravity)
    _forget_gears(model)
    for name, rubbing in mjcf.rubbing.items():
        joint = model.joints[model.getJointId(name)]
        rows = slice(joint.idx_v, joint.idx_v + joint.nv)
        model.armature[rows], model.damping[rows] = rubbing.armature or 0.0, rubbing.damping
    gears, effort = {}, model.upperEffortLimit
    for drive in mjcf.drives:
        row = model.joints[model.getJointId(drive.joint)].idx_v
        gears[drive.joint] = Gear(drive.gear, armature=mjcf.rubbing[drive.joint].armature)
        effort[row] = min(effort[row], drive.effort)
    model.lowerEffortLimit = -effort
    for frame in model.frames:
        if frame.type == POINT and frame.name in mjcf.inside:
            frame.type = INSIDE
    for name, posture in mjcf.postures.items():
        model.referenceConfigurations[name] = _configuration(model, posture)
    notes = (*mjcf.notes, *fixed_trunk(model, mjcf.root, base))
    motors = tuple(drive.joint for drive in mjcf.drives)
    return Draft(model, mjcf.name, mjcf.path, gears, motors, notes, str(mjcf.path), mjcf.loops)


def _configuration(model: pin.Model, posture: Mapping[str, tuple[float, ...]]) -> Array:
    """Returns a configuration, (nq,), from MuJoCo's coordinates by joint, whose quaternions begin with the scalar."""
    q = np.array(pin.neutral(model))
    for name, values in posture.items():
        joint = model.joints[model.getJointId(name)]
        if len(values) == 1:
            place: tuple[float, ...] = values if joint.nq == 1 else (math.cos(values[0]), math.sin(values[0]))
        else:
            turn = np.array(values[-4:])
            length = float(np.linalg.norm(turn))
            w, x, y, z = turn / length if length > 0.0 else (1.0, 0.0, 0.0, 0.0)
            place = (*values[:-4], x, y, z, w)
        q[joint.idx_q : joint.idx_q + joint.nq] = place
    return q


def of_model(model: pin.Model, base: Base | None) -> Draft:
    """Makes a draft of a robot that was built elsewhere; the model is copied.

    Raises:
        BadFile: Pinocchio's data for it take too much memory.
    """
    check_memory(MODEL, model.njoints - 1, model.nv)
    flying = [i for i in range(1, model.njoints) if model.parents[i] == 0 and model.joints[i].shortname() == FLOATING]
    if base == "fixed" and flying:
        made = pin.buildReducedModel(model, flying, pin.neutral(model))
    elif base == "free" and not flying:
        made = _on_floating_joint(model)
    else:
        made = model.copy()
    return Draft(made, model.name or "robot", MODEL, {}, (), tuple(fixed_trunk(made, "universe", base)), MODEL)


def fixed_trunk(model: pin.Model, root: str, base: Base | None) -> list[str]:
    """Returns a warning about a root that has inertia and does not move, unless `base` asks for that."""
    mass = float(model.inertias[0].mass)
    if base is not None or mass <= 0.0:
        return []
    return [
        f'its root {root!r}, of {mass:.4g} kg, stays fixed: base="free" lets it float, base="fixed" says it is meant'
    ]


def _on_floating_joint(model: pin.Model) -> pin.Model:
    """Returns the model with its universe on a floating joint."""
    name = untaken(BASE, list(model.names))
    made, origin = pin.Model(), pin.SE3(np.eye(3), np.zeros(3))
    made.name, made.gravity = model.name, model.gravity
    frame = made.addJointFrame(made.addJoint(0, pin.JointModelFreeFlyer(), origin, name))
    floating = pin.appendModel(made, model, frame, origin)
    for each in ("armature", "rotorInertia", "rotorGearRatio"):  # Pinocchio does not copy these
        setattr(floating, each, np.concatenate([np.zeros(made.nv), getattr(model, each)]))
    for posture in model.referenceConfigurations:
        placed = np.concatenate([pin.neutral(made), posture.data()])
        floating.referenceConfigurations[posture.key()] = placed
    return floating
