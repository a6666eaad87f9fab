"""Prepares a model: holds joints, checks that every moving joint has inertia, and adds the wanted motors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, UnknownName, list_names
from spear_pin.model.frames import joint_id

LINK = " (link)"  # after a link's name while joints are held
FLOATING = 6  # velocities of a floating joint
SINGULAR = 1e-12  # least eigenvalue of a mass matrix whose diagonal is 1
REMEDY = "give its links an <inertial>"
MENDED = 1e-4  # kg·m² or kg, the armature added to a joint that moves no inertia


class CannotFloat(BadFile):
    """A root that shall float, but has no inertia."""

    def __init__(self, path: str | Path, root: str) -> None:
        self.root = root
        problem = f"its root {root!r} has no inertia, so it cannot float"
        super().__init__(path, f"{problem} (base='free', or a quadruped's trunk): leave base out, or {REMEDY}")


def drivable(model: pin.Model) -> list[str]:
    """Returns the names of the joints that can have a motor: those of one degree of freedom."""
    return [name for name, joint in list(zip(model.names, model.joints, strict=True))[1:] if joint.nv == 1]


def hold(model: pin.Model, joints: Sequence[str]) -> pin.Model:
    """Returns a model with some joints held at zero.

    Raises:
        UnknownName: there is no such joint; the text lists the valid ones.
    """
    ids = [joint_id(model, joint) for joint in joints]
    if not ids:
        return model
    whole, alike = model.copy(), {*model.names}
    for frame in whole.frames:  # Pinocchio does not tell a joint from a link of its name
        if frame.type == pin.FrameType.BODY and frame.name in alike:
            frame.name += LINK
    held = pin.buildReducedModel(whole, ids, pin.neutral(model))
    for frame in held.frames:
        frame.name = frame.name.removesuffix(LINK)
    return held


def with_motors(
    model: pin.Model, wanted: Sequence[str], locked: Sequence[str] = ()
) -> tuple[pin.Model, tuple[str, ...]]:
    """Gives every joint that shall have a motor a gear ratio; returns the model, and the joints in its order.

    Args:
        model: the model, which is changed.
        wanted: names of joints, or "all" for each joint that can have a motor.
        locked: names of joints that may be wanted, but do not exist any more.

    Raises:
        UnknownName: there is no such joint.
        BadValue: the joint has several degrees of freedom.
    """
    valid = drivable(model)
    wanted = valid if wanted == "all" else wanted
    for joint in wanted:
        if joint not in valid and joint not in locked:
            if joint in list(model.names)[1:]:
                raise BadValue("motors", joint, f"joints of one degree of freedom: {list_names(valid) or 'none'}")
            raise UnknownName("joint", joint, valid)
    actuated = tuple(joint for joint in valid if joint in wanted)
    for joint in actuated:
        row = model.joints[model.getJointId(joint)].idx_v
        if not model.rotorGearRatio[row]:  # no source gives a ratio
            model.rotorGearRatio[row], model.rotorInertia[row] = 1.0, model.armature[row]
    return model, actuated


def check_floating(path: str | Path, model: pin.Model) -> None:
    """Refuses a root that shall float and has no inertia, unless other inertia makes up for it.

    Raises:
        CannotFloat: the mass matrix is singular, and the link on a floating joint at the root has no mass.
    """
    roots = [i for i in range(1, model.njoints) if model.parents[i] == 0 and model.joints[i].nv == FLOATING]
    massless = next((index for index in roots if not model.inertias[index].mass), None)
    if massless is not None and _fault(path, model):
        links = (f.name for f in model.frames if f.parentJoint == massless and f.type == pin.FrameType.BODY)
        raise CannotFloat(path, next(links, ""))


def with_inertia(path: str | Path, model: pin.Model, repair: bool) -> tuple[pin.Model, list[str]]:
    """Returns the model if its mass matrix is positive definite, and the repairs that made it so.

    Args:
        path: path that errors name.
        model: the model, which is changed by repairs.
        repair: whether to give joints that move no inertia of their own an armature.

    Raises:
        BadFile: a joint moves no inertia, or two joints move the same, so that the mass matrix is singular; or it is
            not finite.
    """
    notes: list[str] = []
    while fault := _fault(path, model):
        joint, problem = fault
        if joint is None or len(notes) == model.nv:
            raise BadFile(path, f"{problem}: {REMEDY}")
        if not repair:
            raise BadFile(path, f"{problem}: {REMEDY} (repair=True mends it)")
        model.armature[model.joints[model.getJointId(joint)].idx_v] += MENDED
        where = "" if repr(joint) in problem else f" on joint {joint!r}"
        notes.append(f"{problem}: mended by an armature of {MENDED:g} kg·m² (kg, if it slides){where}")
    return model, notes


def _fault(path: str | Path, model: pin.Model) -> tuple[str | None, str] | None:
    """Finds the cause of a singular mass matrix: the joint that an armature would repair, if any, and the problem."""
    data = pin.Data(model)
    rng = np.random.default_rng(0)
    for _ in range(3):
        mass_matrix = pin.crba(model, data, pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv)))
        if not np.isfinite(mass_matrix).all():
            raise BadFile(path, "the mass matrix is not finite: some <inertial> has numbers that are far too large")
        diagonal = np.diag(mass_matrix)
        for index in range(1, model.njoints):
            name, joint = model.names[index], model.joints[index]
            if diagonal[joint.idx_v : joint.idx_v + joint.nv].min() <= 0.0:
                problem = f"joint {name!r} moves no inertia"
                return name if joint.nv == 1 else None, problem
        if model.nv:
            values, vectors = np.linalg.eigh(mass_matrix / np.sqrt(np.outer(diagonal, diagonal)))
            if values[0] < SINGULAR:
                return _outermost(model, vectors[:, 0]), "the mass matrix is singular"
    return None


def _outermost(model: pin.Model, motion: Array) -> str | None:
    """Returns the last joint of one degree of freedom that takes part in a motion."""
    moving = np.abs(motion) > 0.1 * np.abs(motion).max()
    names = [name for name in drivable(model) if moving[model.joints[model.getJointId(name)].idx_v]]
    return names[-1] if names else None
