"""The leg of the push test before its release: pinned, at rest on its spring, pushed down by a depth.

The source's RA, "the resting angle", has two readings: the zero of the spring, or the angle at which the leg rests on
it. They differ by the weight's share, Sᵀ G / k, about 0.2 rad.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import scipy

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.loading import load
from spear_pin.model.pinned import PinnedLeg, pin_toe
from spear_pin.model.variants import vary
from spear_pin.studies.push_test.passive_knee import PassiveKnee


@typed
@cache
def spear_ii(ratio: float | None = 15.0) -> PinnedLeg:
    """Returns SPEAR-II on its slider, with its toe pinned.

    Args:
        ratio: ratio of the knee's gearbox; None if the belt is off, without rotor.
    """
    robot = load("spear_ii", locked=["boom_x"])
    return pin_toe(vary(robot, knee_rotor=0.0) if ratio is None else vary(robot, knee_ratio=ratio))


@typed
def equilibrium(leg: PinnedLeg, knee: PassiveKnee) -> float:
    """Returns the angle at which the leg rests on its spring, in rad, without dry friction.

    Raises:
        BadValue: within the joint's limits the leg does not rest, or rests at several angles.
    """
    angles = np.linspace(*leg.span, 2001)
    torque = knee.spring_torque(angles) - leg.gravity(angles)
    stable = np.flatnonzero((torque[:-1] > 0) & (torque[1:] <= 0))
    if stable.size != 1:
        expected = f"a spring that holds the leg at one angle within {leg.span[0]:g} … {leg.span[1]:g} rad"
        raise BadValue("knee", knee, expected)

    def balance(angle: float) -> float:
        return float(knee.spring_torque(angle) - leg.gravity(angle))

    below, above = float(angles[stable[0]]), float(angles[stable[0] + 1])
    if balance(below) <= 0.0 or balance(above) > 0.0:  # at one of the two, but for rounding
        return min(below, above, key=lambda angle: abs(balance(angle)))
    return float(scipy.optimize.brentq(balance, below, above, xtol=1e-14))


@typed
def rest_at(leg: PinnedLeg, knee: PassiveKnee, rest: float) -> PassiveKnee:
    """Returns the knee whose spring's zero lets the leg rest at an angle, in rad, the second reading of RA."""
    require("stiffness", knee.stiffness, lambda k: k > 0, "a number > 0, in N·m/rad")
    return replace(knee, zero=rest + float(leg.gravity(rest)) / knee.stiffness)


@typed
def find_pushed_angle(leg: PinnedLeg, knee: PassiveKnee, depth: float) -> float:
    """Returns the knee's angle with the hip a depth, in m, below its height at rest.

    Raises:
        BadValue: the leg cannot go that deep.
    """
    rest = equilibrium(leg, knee)
    height, lowest = float(leg.hip_height(rest)), float(leg.hip_height(leg.span[1]))
    require("depth", depth, lambda d: 0 <= d <= height - lowest, f"a number >= 0, at most {height - lowest:.3f} m")
    return float(
        scipy.optimize.brentq(lambda a: float(leg.hip_height(a)) - height + depth, rest, leg.span[1], xtol=1e-14)
    )
