"""Descent from the hop of least cost found so far to the nearby minimum, by exact derivatives, within its limits.

A search without derivatives crosses cliffs, where toes bounce and hops end, but stops early in valleys. Derivatives
lead down valleys to their ends, but not over cliffs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from spear_pin.errors import MissingExtra
from spear_pin.gaits.codesign.optimize_design import optimize_design
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.parameters import changed, number
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.motor import NO_MOTORS
from spear_pin.model.robot import Robot
from spear_pin.studies.payoff.best_hop import TORQUE
from spear_pin.studies.payoff.cycles import AtTouchdown, with_values
from spear_pin.studies.payoff.motors import PARTS, Motors

TOLERANCE = 1e-5  # of the gain that is still predicted, relative
LEAST = 1e-3  # of a range of stiffness: without any a spring has no derivative


def descended(
    gait: Gait, measure: str, motors: Motors | None, ranges: Mapping[str, tuple[float, float]], taut: float
) -> Gait:
    """Returns the hop at the end of the descent, with the same flight time; the given hop if there is no descent.

    Args:
        gait: a hop.
        measure: measure of `optimize_design` to minimise.
        motors: motors that drive it, if there are any.
        ranges: least and most of each chosen number.
        taut: least deflection of a spring as it releases, in rad.

    Raises:
        MissingExtra: heyoka is not installed.
    """
    system, fixed = gait.system, gait.system.spring.rest is not None
    start = replace(gait, system=changed(system, AtTouchdown())) if fixed else gait
    at_most, at_least = limits(system.robot, motors)
    if not fixed:
        at_least["deflection_knee"] = taut
    drives = NO_MOTORS if motors is None else {part: getattr(motors, part) for part in PARTS}
    keep = {"flight_time": gait.durations["flight"]}
    over = {name: _with(number(system, name), *ends) for name, ends in ranges.items() if name != TORQUE}
    if "stiffness" in over:
        low, high = over["stiffness"]
        over["stiffness"] = max(low, min(LEAST * high, system.spring.stiffness)), high
    try:
        end = optimize_design(
            start,
            measure,
            over,
            keep,
            vary=[TORQUE],
            at_most=at_most,
            at_least=at_least,
            motors=drives,
            assuming=(),
            tolerance=TOLERANCE,
        ).gait
        values = {name: number(end.system, name) for name in (*over, TORQUE)}
        return gait_beside(with_values(system, values), end.state, [TORQUE], keep)
    except MissingExtra:
        raise
    except REFUSALS:
        return gait


def limits(robot: Robot, motors: Motors | None) -> tuple[dict[str, float], dict[str, float]]:
    """Returns upper and lower bounds of measures, by the robot's file and the motors."""
    at_most, at_least = dict[str, float](), dict[str, float]()
    for part in PARTS:
        own, fastest = robot.limits[part], np.inf
        if motors is not None:
            drive, at_least[f"reserve_{part}"] = getattr(motors, part), 0.0
            fastest = (drive.motor.max_speed or np.inf) / drive.gearbox.ratio
        low, high = own.position
        upper = {
            "peak_torque": own.effort or np.inf,
            "peak_speed": min(own.velocity or np.inf, fastest),
            "greatest": high,
        }
        at_most |= {f"{name}_{part}": limit for name, limit in upper.items() if limit < UNKNOWN}
        at_least |= {f"least_{part}": low} if low > -UNKNOWN else {}
    return at_most, at_least


def _with(value: float, least: float, most: float) -> tuple[float, float]:
    return min(least, value), max(most, value)
