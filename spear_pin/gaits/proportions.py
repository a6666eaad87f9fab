"""Proportions of a leg beside SPEAR-II's: where it lands, and how size, lever and inertias scale the law."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.reaching import count_beyond, pose_leg
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, load_shipped, only_leg, scale_of, touchdown_inertia

TRIED = np.linspace(-math.pi, math.pi, 61).tolist()  # rad: angles of the knee among which the leg is longest
STEP = 1e-4  # rad: of the difference that gives the lever
FLIGHT_TIME = 0.2  # s, of SPEAR-II's hop; of another leg's by the root of its length


class Proportions(NamedTuple):
    """A leg beside SPEAR-II's.

    Attributes:
        hip: angle of the hip at which the leg lands, in rad.
        knee: the same of the knee.
        scale: size of the robot.
        torque: factor on the knee's torques.
        inertia: inertias of hip and knee as the leg lands, (2,), in kg·m²; 0 for a hip that it lacks.
    """

    hip: float
    knee: float
    scale: Scale
    torque: float
    inertia: Array


def usual_flight(robot: Robot) -> float:
    """Returns the flight time of a leg's hop that is like SPEAR-II's, in s."""
    depth = None if robot.reach is None else max(_depths(robot).values())
    return FLIGHT_TIME * scale_of(robot, depth).time


def proportions(robot: Robot, knee: float) -> Proportions:
    """Returns the proportions of a leg.

    With `[reach]` the leg is as long as its toe is ever deep. It lands folded by the same share of its length as
    SPEAR-II's, and its torques have the same force on the ground over the weight, by how fast the knee folds the leg.

    Args:
        robot: a robot with one leg, as `spear_pin.monopod` cuts it, or with `[reach]`.
        knee: angle of SPEAR-II's knee at touchdown, in rad.

    Raises:
        BadValue: the robot does not have one leg with hip and knee, or its loops close at no angle of the knee that
            folds the leg so far.
    """
    from scipy.optimize import brentq  # takes long to import

    if robot.reach is None:
        scale = scale_of(robot)
        return Proportions(only_leg(robot).lean(knee), knee, scale, scale.torque, touchdown_inertia(robot, knee))
    like = only_leg(load_shipped("spear_ii"))
    share, depth, depths = like.length(knee) / (like.thigh + like.shank), partial(_depth, robot), _depths(robot)
    stretched = max(depths, key=depths.__getitem__)
    wanted = share * depths[stretched]
    folded = next((angle for angle, found in depths.items() if angle > stretched and found <= wanted), None)
    if folded is None:
        raise BadValue("[reach]", robot.reach, f"a knee that folds the leg to {share:.2g} of its length as it grows")
    lands = float(brentq(lambda angle: depth(angle) - wanted, stretched, folded))
    scale, inertia = scale_of(robot, depths[stretched]), _inertia(robot, pose_leg(robot, 0.0, lands))
    return Proportions(0.0, lands, scale, scale.force * _slope(depth, lands) / _slope(like.length, knee), inertia)


def _depths(robot: Robot) -> dict[float, float]:
    """Returns how deep the toe is, in m, by the angle of the knee, in rad, where its loops close within its limits."""
    found = {knee: depth for knee in TRIED if not math.isnan(depth := _depth(robot, knee))}
    if not found:
        raise BadValue("[reach]", robot.reach, "angles of hip and knee at which the loops close within their limits")
    return found


def _depth(robot: Robot, knee: float) -> float:
    """Returns how deep the toe is below the slider's zero with the hip at 0, in m; NaN if its limits forbid it."""
    try:
        q = pose_leg(robot, 0.0, knee)
    except BadValue:
        return math.nan
    return math.nan if count_beyond(robot, q) else -float(robot.toe_position(q, robot.toes[0])[-1])


def _slope(length: Callable[[float], float], angle: float) -> float:
    """Returns how fast a length falls with an angle."""
    return (length(angle - STEP) - length(angle + STEP)) / (2.0 * STEP)


def _inertia(robot: Robot, q: Array) -> Array:
    """Returns the inertias of a leg with `[reach]` at its hip and its knee, (2,), with the body at rest."""
    assert robot.reach is not None
    names = robot.independent
    own = [names.index(motor) for motor in robot.actuated]
    turns = np.linalg.pinv(robot.reach.rows(robot.actuated))  # the motors' angles for one of hip, and of knee
    return np.diag(turns.T @ robot.reduced(q, np.zeros(len(names))).mass_matrix[np.ix_(own, own)] @ turns)
