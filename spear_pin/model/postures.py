"""Configurations to start from: a robot standing on the ground."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot

NEWTON = 20  # steps, of which a few are enough


def home(robot: Robot) -> Array:
    """Returns the configuration, (nq,), with every joint at zero, and the lowest toe on the ground if possible.

    That is possible if a joint can lift the robot. Closed loops move joints away from zero as little as they can.
    """
    q = pin.neutral(robot.model)
    whole = q if robot.closure is None else robot.closure.closed(q)
    return put_on_ground(robot, whole if np.isfinite(whole).all() else q)


def put_on_ground(robot: Robot, q: Array) -> Array:
    """Lifts or lowers a configuration, (nq,), until its lowest toe is at height zero.

    It stays unchanged if the robot has no toes, or no coordinate that moves them all straight up. A robot that goes
    round a post is tilted by the coordinate that lifts its first toe most.
    """
    if not robot.toes:
        return q
    if robot.post is not None:
        return _tilted(robot, q)
    jacobians = np.array([robot.toe_jacobian(q, toe) for toe in robot.toes])
    up = np.eye(jacobians.shape[1])[-1]
    lifting = np.flatnonzero(np.abs(jacobians - up[None, :, None]).max(axis=(0, 1)) < 1e-12)
    if not len(lifting):
        return q
    height = min(float(robot.toe_position(q, toe)[-1]) for toe in robot.toes)
    return np.asarray(pin.integrate(robot.model, q, -height * np.eye(robot.nv)[lifting[0]]))


def _tilted(robot: Robot, q: Array) -> Array:
    """Puts the first toe of a configuration, (nq,), on the ground by Newton's method over one coordinate."""
    row = int(np.abs(robot.toe_jacobian(q, robot.toes[0])[-1]).argmax())
    for _ in range(NEWTON):
        height, slope = robot.toe_position(q, robot.toes[0])[-1], robot.toe_jacobian(q, robot.toes[0])[-1, row]
        q = np.asarray(pin.integrate(robot.model, q, -height / slope * np.eye(robot.nv)[row]))
    return q


def check_configuration(robot: Robot, name: str, q: ArrayLike) -> Array:
    """Returns a configuration, (nq,), as float64.

    Raises:
        BadValue: the configuration has the wrong length or is not finite.
    """
    values = np.asarray(q, dtype=np.float64)
    if values.shape != (robot.nq,) or not np.isfinite(values).all():
        raise BadValue(f"posture {name!r}", q, f"{robot.nq} finite numbers")
    return values
