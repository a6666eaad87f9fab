"""Feet of several toes, as heel and toe: which toes are on one body, and which of them leads along the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue

SAME = 1e-6  # m: toes of one body that are closer are one point


def feet_of(model: pin.Model, ids: Mapping[str, int]) -> dict[str, tuple[str, ...]]:
    """Returns for each toe all toes of its body, in their order.

    Args:
        model: the robot's model.
        ids: index of each toe's frame.

    Raises:
        BadValue: two toes of one body are the same point.
    """
    frames = {toe: model.frames[index] for toe, index in ids.items()}
    found = dict[str, tuple[str, ...]]()
    for toe, frame in frames.items():
        others = [other for other, its in frames.items() if its.parentJoint == frame.parentJoint]
        for other in others[: others.index(toe)]:
            if np.linalg.norm(frame.placement.translation - frames[other].placement.translation) < SAME:
                raise BadValue("toes", list(ids), f"points apart; {other!r} and {toe!r} are one point")
        found[toe] = tuple(others)
    return found


def find_leading(feet: Mapping[str, tuple[str, ...]], toes: Sequence[str]) -> list[int]:
    """Returns for each of some toes the index among them of the first one on its body."""
    return [next(i for i, other in enumerate(toes) if other in feet[toe]) for toe in toes]
