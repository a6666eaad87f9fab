"""Limits of a robot's joints, as its file gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

UNKNOWN = 1e6  # rad/s, N·m: files without a known limit give a number beyond this, or 0


@dataclass(frozen=True)
class Limits:
    """Limits of one joint that turns or slides; a missing limit is infinite.

    Many files have 0 for an unknown effort or velocity.

    Attributes:
        position: least and largest position, in rad or m.
        velocity: largest speed in either direction, in rad/s or m/s.
        effort: largest effort in either direction, in N·m or N.
    """

    position: tuple[float, float] = (-np.inf, np.inf)
    velocity: float = np.inf
    effort: float = np.inf


def limits_of(model: pin.Model) -> dict[str, Limits]:
    """Returns the limits of each joint of one degree of freedom, by its name, in the order of the model."""
    found = {}
    for name, joint in list(zip(model.names, model.joints, strict=True))[1:]:
        if joint.nv == 1:
            row, place = joint.idx_v, joint.idx_q
            position = model.lowerPositionLimit[place], model.upperPositionLimit[place]
            bounded = joint.nq == 1 and position[0] < position[1]  # a joint without end has a cosine and a sine
            found[name] = Limits(
                (_open(position[0]), _open(position[1])) if bounded else Limits.position,
                _open(model.upperVelocityLimit[row]),
                _open(model.upperEffortLimit[row]),
            )
    return found


def order_limits(model: pin.Model) -> list[str]:
    """Exchanges the limits of joints whose lower limit is above the upper one.

    Args:
        model: the model, which is changed.

    Returns:
        a line for each such joint, and for each joint whose limits leave it no room and are therefore ignored.
    """
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    notes = []
    for name, joint in list(zip(model.names, model.joints, strict=True))[1:]:
        place = joint.idx_q
        if not joint.nv == joint.nq == 1:
            continue
        for side, ends, none in (("lower", lower, -np.inf), ("upper", upper, np.inf)):
            if _open(ends[place]) == -none:
                notes.append(f"joint {name!r} has the {side} limit {-none:g}: it has none on that side")
                ends[place] = none
        if lower[place] > upper[place]:
            both = f"the lower limit {lower[place]:g} above the upper one, {upper[place]:g}"
            notes.append(f"joint {name!r} has {both}: exchanged")
            lower[place], upper[place] = upper[place], lower[place]
        elif lower[place] == upper[place] != 0.0:
            both = f"{lower[place]:g} and {upper[place]:g}"
            notes.append(f"joint {name!r} has the limits {both}, which leave it no room: it is not limited")
    return notes


def _open(limit: float) -> float:
    """Returns a limit, infinite if it is the largest number, as in models that are built by hand."""
    return float(limit) if abs(limit) < np.finfo(float).max else math.copysign(math.inf, limit)
