"""A floating base as a chain of six joints, in which q̇ = v: along x, y and z, then yaw, pitch and roll.

Simulation uses it: a gait of the plane can be copied into it unchanged, and no coordinate has to be normalised. It is
singular at a pitch of ±90°, which for a legged robot is a fall. Yaw turns about z, to the left; pitch about -y, nose
up, as in the plane; roll about x, to the right side.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot

BASES = "free", "chain", "fixed"
ONE_OF = "'free', 'chain' or 'fixed'"
CHAIN = ("torso_x", "torso_y", "torso_z", "yaw", "pitch", "roll")
"""Names of the six coordinates."""
JOINTS = (
    pin.JointModelPX(),
    pin.JointModelPY(),
    pin.JointModelPZ(),
    pin.JointModelRZ(),
    pin.JointModelRevoluteUnaligned(0.0, -1.0, 0.0),
    pin.JointModelRX(),
)
FREE, FREE_Q, FREE_V = "JointModelFreeFlyer", 7, 6
OF_VELOCITIES = (
    *("armature", "rotorInertia", "rotorGearRatio", "damping"),
    *(f"{end}{of}Limit" for of in ("DryFriction", "Effort", "Velocity") for end in ("lower", "upper")),
)
"""What a model has for each coordinate."""
STAY = pin.SE3(np.eye(3), np.zeros(3))


class State(NamedTuple):
    """Configuration and velocity.

    Attributes:
        q: configuration, (nq,).
        v: velocity, (nv,).
    """

    q: Array
    v: Array


def on_chain(model: pin.Model) -> pin.Model:
    """Returns the model with its floating base, which precedes all other joints, replaced by the chain.

    Raises:
        BadValue: the first joint does not float, another joint does, or a joint has a name of the chain's joints.
    """
    flying = [i for i in range(1, model.njoints) if model.joints[i].shortname() == FREE]
    if flying != [1] or model.parents[1] != 0:
        raise BadValue("base", "chain", "'fixed': the first joint of this robot is not its only floating joint")
    if taken := [name for name in CHAIN if model.existJointName(name)]:
        raise BadValue("base", "chain", f"'free': the robot has a joint {taken[0]!r}, a name that the chain uses")
    made = pin.Model()
    made.name, made.gravity = model.name, model.gravity
    made.inertias[0] = model.inertias[0]
    numbers, place = {0: 0}, model.jointPlacements[1]
    for name, joint in zip(CHAIN, JOINTS, strict=True):
        numbers[1] = made.addJoint(numbers[1] if 1 in numbers else 0, joint, place, name)
        place = STAY
    for i in range(2, model.njoints):
        parent = numbers[int(model.parents[i])]
        numbers[i] = made.addJoint(parent, model.joints[i], model.jointPlacements[i], model.names[i])
    for i in range(1, model.njoints):
        made.appendBodyToJoint(numbers[i], model.inertias[i], STAY)
    frames = {0: 0}  # names are no key: a joint and a body may have the same
    for i, frame in list(enumerate(model.frames))[1:]:
        parent, carrier = frames[int(frame.parentFrame)], numbers[frame.parentJoint]
        like = pin.Frame(frame.name, carrier, parent, frame.placement, frame.type, pin.Inertia.Zero())
        frames[i] = int(made.addFrame(like, False))
    for each in OF_VELOCITIES:
        getattr(made, each)[len(CHAIN) :] = getattr(model, each)[FREE_V:]
    for each, none in (("lowerPositionLimit", -math.inf), ("upperPositionLimit", math.inf)):
        getattr(made, each)[: len(CHAIN)] = none
        getattr(made, each)[len(CHAIN) :] = getattr(model, each)[FREE_Q:]
    for posture in model.referenceConfigurations:
        q = posture.data()
        made.referenceConfigurations[posture.key()] = np.concatenate([_angles(q), q[FREE_Q:]])
    return made


def to_chain(robot: Robot, q: ArrayLike, v: ArrayLike) -> State:
    """Converts a state with a quaternion to the chain's coordinates.

    Args:
        robot: a robot with a floating base before all other joints, such as `load("q_spear_full")`.
        q: position, quaternion (x, y, z, w), and the other joints, (nq,).
        v: velocity and angular velocity of the base in its own axes, and rates of the other joints, (nv,).

    Returns:
        the state of `load(..., base="chain")`, with roll and yaw within ±π and pitch within ±π/2.

    Raises:
        BadValue: the base does not float, the state has the wrong shape, or the pitch is ±90°.

    Example:
        >>> import pinocchio as pin
        >>> from spear_pin import load, to_chain
        >>> free = load("q_spear_full")
        >>> to_chain(free, pin.neutral(free.model), [0.0] * 18).q.shape
        (18,)
    """
    if robot.nq == robot.nv or robot.model.joints[1].shortname() != FREE:
        raise BadValue("robot", robot, 'one with a floating base in front of all other joints, load(..., base="free")')
    robot.bias(q, v)  # checks both
    q, v = np.asarray(q, dtype=float), np.asarray(v, dtype=float)
    base = _angles(q)
    turned = _turn(*base[3:])
    rates = _rates(base[4], base[5])
    if abs(math.cos(base[4])) < 1e-9:
        raise BadValue("pitch", float(base[4]), "an angle other than ±90°, where the chain is singular")
    linear, angular = turned @ v[:3], np.linalg.solve(rates, v[3:FREE_V])
    return State(np.concatenate([base, q[FREE_Q:]]), np.concatenate([linear, angular, v[FREE_V:]]))


def from_chain(robot: Robot, q: ArrayLike, v: ArrayLike) -> State:
    """Converts a state in the chain's coordinates to one with a quaternion; this inverts `to_chain`.

    Args:
        robot: a robot on a chain, `load(..., base="chain")`.
        q: the six coordinates of the chain and the other joints, (nv,).
        v: their rates, (nv,).

    Raises:
        BadValue: the base is no chain, or the state has the wrong shape.

    Example:
        >>> from spear_pin import from_chain, load
        >>> from_chain(load("q_spear_full", base="chain"), [0.0] * 18, [0.0] * 18).q[3:7].tolist()  # x, y, z, w
        [0.0, 0.0, 0.0, 1.0]
    """
    if robot.coordinates[: len(CHAIN)] != CHAIN:
        raise BadValue("robot", robot, 'one on a chain, load(..., base="chain")')
    robot.bias(q, v)  # checks both
    q, v = np.asarray(q, dtype=float), np.asarray(v, dtype=float)
    n = len(CHAIN)
    turned = _turn(*q[3:n])
    quaternion = pin.Quaternion(turned).coeffs()
    linear, angular = turned.T @ v[:3], _rates(q[4], q[5]) @ v[3:n]
    return State(np.concatenate([q[:3], quaternion, q[n:]]), np.concatenate([linear, angular, v[n:]]))


def _turn(yaw: float, pitch: float, roll: float) -> Array:
    """Returns the base's axes in the world, (3, 3)."""
    return np.asarray(pin.utils.rotate("z", yaw) @ pin.utils.rotate("y", -pitch) @ pin.utils.rotate("x", roll))


def _rates(pitch: float, roll: float) -> Array:
    """Returns the matrix from rates of yaw, pitch and roll to the base's angular velocity in its axes, (3, 3)."""
    jacobian = pin.rpy.computeRpyJacobian(np.array((roll, -pitch, 0.0)), pin.ReferenceFrame.LOCAL)
    return np.asarray(jacobian[:, ::-1] * (1.0, -1.0, 1.0))


def _angles(q: Array) -> Array:
    """Returns the chain's coordinates of a base with a quaternion, (6,)."""
    turned = pin.Quaternion(q[3:FREE_Q].reshape(4, 1)).normalized().toRotationMatrix()
    pitch = math.asin(max(-1.0, min(1.0, turned[2, 0])))
    yaw, roll = math.atan2(turned[1, 0], turned[0, 0]), math.atan2(turned[2, 1], turned[2, 2])
    return np.concatenate([q[:3], (yaw, pitch, roll)])
