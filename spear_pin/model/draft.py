"""A robot as its file has it: Pinocchio's model, the joints with motors, and what there is to say about it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadFile
from spear_pin.model.group_states import add_postures
from spear_pin.model.memory import check_memory
from spear_pin.model.mjcf_reading import Mjcf
from spear_pin.model.urdf import BASE, WORLD, Base, Urdf

MODEL = "pinocchio.Model"  # the source of what was built elsewhere
FLOATING = "JointModelFreeFlyer"


@dataclass(frozen=True)
class Draft:
    """A robot as a file, or a model, describes it.

    Attributes:
        model: with armature, rotors and gear ratios set.
        name: of the robot.
        place: what errors name, a path.
        motors: names of the joints that have one.
        notes: what there is to warn of, a line each.
        source: what the robot is loaded from again.
    """

    model: pin.Model
    name: str
    place: str | Path
    motors: tuple[str, ...]
    notes: tuple[str, ...]
    source: str


def of_urdf(urdf: Urdf, base: Base | None) -> Draft:
    """The robot of a URDF, its joints in the order of the document.

    Raises:
        BadFile: Pinocchio cannot build it, or a transmission drives a joint of several degrees of freedom.
    """
    try:
        model = pin.buildModelFromXML(urdf.text)
    except (ValueError, RuntimeError) as error:
        raise BadFile(urdf.path, f"Pinocchio cannot build it: {str(error).strip().splitlines()[0]}") from None
    check_memory(urdf.path, model.njoints - 1, model.nv)
    # numbered to keep the order of the document, in which Pinocchio would sort by name
    for i, name in enumerate(model.names):
        model.names[i] = name.partition(":")[2] or name
    for frame in model.frames:
        if frame.type != pin.FrameType.BODY and frame.name != "universe":
            frame.name = frame.name.partition(":")[2]
    armature = np.zeros(model.nv)
    rotor_inertia, gear_ratio = np.zeros(model.nv), np.zeros(model.nv)
    for transmission in urdf.transmissions:
        joint = model.joints[model.getJointId(transmission.joint)]
        if joint.nv != 1:
            problem = f"a transmission drives {transmission.joint!r}, a joint of {joint.nv} degrees of freedom"
            raise BadFile(urdf.path, problem)
        armature[joint.idx_v] = transmission.reflected_inertia
        rotor_inertia[joint.idx_v] = transmission.rotor_inertia
        gear_ratio[joint.idx_v] = transmission.gear_ratio
    # only the armature enters the dynamics; the other two are kept for those who read them
    model.armature, model.rotorInertia, model.rotorGearRatio = armature, rotor_inertia, gear_ratio
    notes = (*urdf.notes, *add_postures(model, urdf.path))
    notes = notes if urdf.root == WORLD else (*notes, *fixed_trunk(model, urdf.root, base))
    motors = tuple(transmission.joint for transmission in urdf.transmissions)
    return Draft(model, urdf.name, urdf.path, motors, notes, str(urdf.path))


def of_mjcf(mjcf: Mjcf, base: Base | None) -> Draft:
    """The robot of an MJCF file; its armatures are reflected already.

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
    armature, damping = np.zeros(model.nv), np.zeros(model.nv)
    for name, (inertia, drag) in mjcf.rubbing.items():
        joint = model.joints[model.getJointId(name)]
        rows = slice(joint.idx_v, joint.idx_v + joint.nv)
        armature[rows], damping[rows] = inertia, drag
    model.armature, model.damping = armature, damping
    rotor_inertia, gear_ratio = np.zeros(model.nv), np.zeros(model.nv)
    effort = np.array(model.upperEffortLimit)
    for drive in mjcf.drives:
        row = model.joints[model.getJointId(drive.joint)].idx_v
        gear_ratio[row], rotor_inertia[row] = drive.gear, armature[row] / drive.gear**2
        effort[row] = min(effort[row], drive.effort)
    model.rotorInertia, model.rotorGearRatio = rotor_inertia, gear_ratio
    model.upperEffortLimit, model.lowerEffortLimit = effort, -effort
    notes = (*mjcf.notes, *fixed_trunk(model, mjcf.root, base))
    return Draft(model, mjcf.name, mjcf.path, tuple(drive.joint for drive in mjcf.drives), notes, str(mjcf.path))


def of_model(model: pin.Model, base: Base | None) -> Draft:
    """A robot that was built elsewhere; the model is copied.

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
    return Draft(made, model.name or "robot", MODEL, (), tuple(fixed_trunk(made, "universe", base)), MODEL)


def fixed_trunk(model: pin.Model, root: str, base: Base | None) -> list[str]:
    """Warning of a root that has inertia and does not move, unless that was asked for."""
    mass = float(model.inertias[0].mass)
    if base is not None or mass <= 0.0:
        return []
    return [
        f'its root {root!r}, of {mass:.4g} kg, stays fixed: base="free" lets it float, base="fixed" says it is meant'
    ]


def _on_floating_joint(model: pin.Model) -> pin.Model:
    """The model, its universe on a floating joint."""
    name = BASE
    while model.existJointName(name):
        name += "_"
    made, origin = pin.Model(), pin.SE3(np.eye(3), np.zeros(3))
    made.name, made.gravity = model.name, model.gravity
    frame = made.addJointFrame(made.addJoint(0, pin.JointModelFreeFlyer(), origin, name))
    floating = pin.appendModel(made, model, frame, origin)
    for each in ("armature", "rotorInertia", "rotorGearRatio"):  # which Pinocchio leaves behind
        setattr(floating, each, np.concatenate([np.zeros(made.nv), getattr(model, each)]))
    for posture in model.referenceConfigurations:
        placed = np.concatenate([pin.neutral(made), posture.data()])
        floating.referenceConfigurations[posture.key()] = placed
    return floating
