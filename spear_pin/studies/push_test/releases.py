"""One release of the push test: angle, height and ground force, and where the pinned toe would pull."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.push_test.motion import RTOL, KneeMotion, move
from spear_pin.studies.push_test.passive_knee import PassiveKnee
from spear_pin.studies.push_test.rest import equilibrium, find_pushed_angle

DEPTHS = (0.05, 0.075, 0.10)  # m, of Section 4.1.3
RATE = 1000.0  # samples a second, as in Section 4.1.3


@dataclass(frozen=True)
class Release(KneeMotion):
    """One release.

    Attributes:
        t: time since the release, (n,), in s.
        height: height of the hip above the toe, (n,), in m.
        force: force of the ground on the toe, x and z, (n, 2), in N; where z is negative, the pin would have to pull.
        rest: angle of the static equilibrium without dry friction, in rad.
        lift_off: time at which the pinned leg begins to pull on the ground, in s; None if it never does.
    """

    t: Array
    height: Array
    force: Array
    rest: float
    lift_off: float | None


@typed
def release(
    leg: PinnedLeg,
    knee: PassiveKnee,
    depth: float = 0.10,
    duration: float = 1.5,
    rate: float = RATE,
    rtol: float = RTOL,
) -> Release:
    """Pushes the leg down by a depth, in m, below its rest, lets it go, and returns the release.

    Args:
        leg: the pinned leg, with its rotor.
        knee: torque law of the knee.
        depth: depth of the push, in m.
        duration: duration of the motion, in s.
        rate: samples a second.
        rtol: relative tolerance of the integration.

    Raises:
        BadValue: the leg does not rest on its spring or cannot go that deep; the duration is not positive.
    """
    require("duration", duration, lambda d: 0 < d <= 3600, "a number > 0, in s, at most an hour")
    require("rate", rate, lambda r: 1 <= r * duration <= 1e7, "samples a second, such that there are 1 to 1e7 of them")
    initial = find_pushed_angle(leg, knee, depth)
    t = np.arange(round(duration * rate) + 1) / rate
    motion = move(leg, knee, initial, t, rtol=rtol)
    force = leg.ground_force(motion.angle, motion.rate, motion.acceleration).T
    height, rest = leg.hip_height(motion.angle), equilibrium(leg, knee)
    return Release(**vars(motion), t=t, height=height, force=force, rest=rest, lift_off=_crossing(t, force[:, 1]))


def _crossing(t: Array, force: Array) -> float | None:
    """Returns when a force first becomes negative, linearly between samples."""
    below = np.flatnonzero(force < 0.0)
    if below.size == 0:
        return None
    near = slice(max(int(below[0]) - 1, 0), int(below[0]) + 1)
    return float(np.interp(0.0, -force[near], t[near]))
