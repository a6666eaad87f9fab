"""Lets a law of hip and knee drive a leg whose file has `[reach]`: it moves sums and differences of the motors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.result import State
from spear_pin.model.robot import Robot

TRIES = 12  # configurations from which loops are closed, to find the one that hangs lowest
YIELDING = ("hip", "knee")
Law = Callable[..., Sequence[Any]]


class Seen:
    """The dynamics as a law of hip and knee sees them, for its torques on these; see `Dynamics`.

    Args:
        dyn: the dynamics.
        torques: returns the motors' torques for those on hip and knee.
    """

    def __init__(self, dyn: Dynamics, torques: Callable[[Any, Any], Sequence[Any]]) -> None:
        self._dyn, self._torques = dyn, torques

    def normal_force(self, toe: str, u: Sequence[Any]) -> Any:
        """Returns the normal force that torques on hip and knee would give, in N."""
        return self._dyn.normal_force(toe, self._torques(*u))


def drive_motors(robot: Robot, law: Law) -> Law:
    """Returns a law of hip and knee for a robot's own motors; it stays itself without `[reach]`."""
    reach, motors, seen = robot.reach, robot.actuated, show_leg_angles(robot, law)
    if reach is None:
        return law

    def driven(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
        hip, knee = seen(t, q, v, held, p, dyn, ops)
        return reach.torques(hip, knee, motors)

    return driven


def show_leg_angles(robot: Robot, function: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a law or a guard that sees the angles of hip and knee in the place of all coordinates."""
    reach, coordinates, motors = robot.reach, robot.coordinates, robot.actuated
    if reach is None:
        return function

    def seen(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        shown = Seen(dyn, lambda hip, knee: reach.torques(hip, knee, motors))
        return function(t, reach.angles(q, coordinates), reach.angles(v, coordinates), held, p, shown, ops)

    return seen


def angles(robot: Robot, values: Sequence[Any]) -> tuple[Any, Any]:
    """Returns the angles of hip and knee, or their rates, from those of all coordinates."""
    return (values[-2], values[-1]) if robot.reach is None else robot.reach.angles(values, robot.coordinates)


def pose_leg(robot: Robot, hip: float, knee: float) -> Array:
    """Returns the configuration, (nv,), with these angles of hip and knee.

    Of several it is the one whose toe is lowest, within the limits of the joints if there is one.

    Raises:
        BadValue: the loops cannot be closed with these angles.
    """
    q, reach = np.zeros(robot.nq), robot.reach
    if reach is None:
        q[robot.index("hip")], q[robot.index("knee")] = hip, knee
        return q
    found = np.linalg.lstsq(reach.rows(robot.actuated), [hip, knee], rcond=None)[0]
    q[[robot.index(motor) for motor in robot.actuated]] = found
    tied = [i for i, name in enumerate(robot.coordinates) if name not in robot.independent]
    turning, closed = [i for i in tied if robot.units[i] == "rad"], []
    for start in np.random.default_rng(0).uniform(-2.0, 2.0, (TRIES, len(tied))):
        q[tied] = start
        try:
            found = robot.closed(q)
        except BadValue:
            continue
        found[turning] = np.remainder(found[turning] + np.pi, 2.0 * np.pi) - np.pi
        closed.append(robot.closed(found))
    if not closed:
        raise BadValue("knee_touchdown", knee, "an angle at which the leg's loops can be closed")
    return min(closed, key=lambda each: (count_beyond(robot, each), float(robot.toe_position(each, robot.toes[0])[-1])))


def count_beyond(robot: Robot, q: Array) -> int:
    """Returns how many joints are beyond their limits."""
    limits = [(robot.limits[name].position, value) for name, value in zip(robot.coordinates, q, strict=True)]
    return sum(not low <= value <= high for (low, high), value in limits)


def set_down(robot: Robot, q: Array, fall: float, ground: Ground, yielding: Sequence[str] = YIELDING) -> State:
    """Returns the state (q, v) just after touchdown in a posture q, moved up or down so that its toe is on the ground.

    See `find_landing_velocity` for the arguments.
    """
    q = q.copy()
    x, z = robot.toe_position(q, robot.toes[0])
    q[robot.index("boom_z")] = ground.under(x) - z
    return q, find_landing_velocity(robot, q, fall, yielding)


def find_landing_velocity(robot: Robot, q: Array, fall: float, yielding: Sequence[str] = YIELDING) -> Array:
    """Returns the velocity, (nv,), of a robot that falls onto its toe, which is at rest.

    Args:
        robot: the robot.
        q: its configuration, (nv,).
        fall: the speed at which it falls, in m/s.
        yielding: names of the two joints that turn; with `[reach]` all with motors do.
    """
    J = robot.toe_jacobian(q, robot.toes[0])
    if robot.reach is None:
        v = np.zeros(robot.nv)
        v[robot.index("boom_z")], rows = -fall, [robot.index(joint) for joint in yielding]
        v[rows] = np.linalg.lstsq(J[:, rows], -J @ v, rcond=None)[0]
        return v
    names = robot.independent
    rates = np.zeros(len(names))
    rates[names.index("boom_z")] = -fall
    T, legs = robot.reduced(q, rates).T, [names.index(motor) for motor in robot.actuated]
    rates[legs] = np.linalg.lstsq(J @ T[:, legs], -J @ T @ rates, rcond=None)[0]
    return np.asarray(T @ rates, np.float64)
