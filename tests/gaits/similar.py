"""Robots that are another one but for their size."""

import numpy as np
import pinocchio as pin

from spear_pin import Robot

SLIDES = ("JointModelP",)  # joints of which the coordinate is a length


def similar(robot: Robot, longer: float, heavier: float | None = None) -> Robot:
    """A robot with every length and every mass times a factor, at the same gravity: limits, rotors and drag follow.

    Args:
        robot: of which it is made.
        longer: of lengths.
        heavier: of masses; None: the cube of the other, as of the same materials.
    """
    heavier = longer**3 if heavier is None else heavier
    force, time = heavier, longer**0.5
    model = robot.model.copy()
    model.inertias[0] = pin.Inertia.Zero()
    for i in range(1, model.njoints):
        model.jointPlacements[i].translation *= longer
        body = model.inertias[i]
        model.inertias[i] = pin.Inertia(body.mass * heavier, body.lever * longer, body.inertia * heavier * longer**2)
    for frame in model.frames:
        frame.placement.translation *= longer
    q, v = np.ones(model.nq), np.ones(model.nv)  # units of coordinates, and of rates but for the time: m, or rad
    for joint in model.joints[1:]:
        if joint.nv == 6 or joint.shortname().startswith(SLIDES):
            q[joint.idx_q : joint.idx_q + min(joint.nq, 3)] = v[joint.idx_v : joint.idx_v + min(joint.nv, 3)] = longer
    torque = force * longer / v
    units = {"PositionLimit": q, "VelocityLimit": v / time, "EffortLimit": torque, "DryFrictionLimit": torque}
    with np.errstate(over="ignore"):  # of joints without limits
        for end in ("lower", "upper"):
            for name, unit in units.items():
                setattr(model, end + name, unit * getattr(model, end + name))
    model.damping = torque * time / v * model.damping
    for name in ("armature", "rotorInertia"):
        setattr(model, name, torque * time**2 / v * getattr(model, name))
    return robot.with_model(model)
