"""Figures of a turn: rate and circle of the turn, and the load on adductions and friction."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.symmetry import ROLL, YAW, X, Y
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.chain import CHAIN
from spear_pin.studies.bound.in_space import summarize_in_space

LEAST_TURN = 1e-6  # rad a stride: what turns by less goes straight


@typed
def summarize_turn(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns figures of a turning gait in space, from the gait and a trajectory of it, in SI units and radians.

    Places one stride apart lie on a circle. The lateral acceleration points to its centre.

    Returns:
        - turn, rate: of the heading to the left, in rad a stride, and in rad/s.
        - speed: along that circle, in m/s.
        - radius, lateral_acceleration: of the circle, in m; speed² / radius, in m/s².
        - largest_multiplier: by modulus.
        - feedback: whether the gait has some.
        - mean_roll: over the whole strides, to the right.
        - drift: from the heading to the way, to the left, at the section.
        - all figures of `summarize_in_space` except those of a straight way: aside, heading.

    Raises:
        BadValue: the gait is not in space, its stride does not end, or it does not turn.
    """
    if gait.system.robot.coordinates[: len(CHAIN)] != CHAIN:
        raise BadValue("gait", gait.system.kind, "a gait in space")
    stride = return_map(gait.system, gait.state)
    if not stride.cycles:
        raise BadValue("gait", stride.message, "a gait whose stride ends")
    (begin, end), period = (stride.start[0], stride.state[0]), sum(stride.durations.values())
    turn = float(end[YAW] - begin[YAW])
    if abs(turn) < LEAST_TURN:
        raise BadValue("gait", turn, f"one that turns by {LEAST_TURN:g} rad a stride or more")
    dx, dy = end[[X, Y]] - begin[[X, Y]]
    radius = math.hypot(dx, dy) / (2.0 * math.sin(abs(turn) / 2.0))
    rate = turn / period
    speed = radius * abs(rate)
    others = summarize_in_space(gait, trajectory)
    for name in ("aside", "heading"):
        del others[name]
    whole = (trajectory.cycle > 0) & (trajectory.cycle <= trajectory.cycles)
    t, roll = trajectory.t[whole], trajectory.q[whole, ROLL]
    return {
        **others,
        "turn": turn,
        "rate": rate,
        "speed": speed,
        "period": period,
        "radius": radius,
        "lateral_acceleration": speed * abs(rate),
        "largest_multiplier": float(np.abs(gait.multipliers).max()),
        "feedback": feedback_of(gait.system) is not None,
        "mean_roll": float(np.trapezoid(roll, t) / np.ptp(t)) if len(t) else 0.0,
        "drift": math.atan2(dy, dx) - float(begin[YAW]) - turn / 2.0,
    }
