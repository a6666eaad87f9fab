"""Limits of a robot's joints, as its file gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

UNKNOWN = 1e6  # rad/s, N·m: files that know no limit name a number beyond this, or 0


@dataclass(frozen=True)
class Limits:
    """Limits of one joint that turns or slides; what its file does not limit is infinite.

    Many files say 0 for an effort or a velocity that nobody knew.

    Attributes:
        position: the least and the largest, in rad or m.
        velocity: the largest, either way, in rad/s or m/s.
        effort: the largest, either way, in N·m or N.
    """

    position: tuple[float, float] = (-np.inf, np.inf)
    velocity: float = np.inf
    effort: float = np.inf


def limits_of(model: pin.Model) -> dict[str, Limits]:
    """Limits of each joint of one degree of freedom, by its name, in the order of the model."""
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


def _open(limit: float) -> float:
    """A limit, infinite where it is the largest number there is, which models that are built by hand have."""
    return float(limit) if abs(limit) < np.finfo(float).max else math.copysign(math.inf, limit)
