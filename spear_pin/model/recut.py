"""Cuts a robot out of another as it was cut before; only this module knows the kinds of cuts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from spear_pin.model.legs import Leg
from spear_pin.model.monopod import monopod
from spear_pin.model.robot import Robot
from spear_pin.model.sagittal import sagittal

LIKE = {"monopod": "spear_ii", "sagittal": "q_spear"}
"""Kinds of cuts, and the shipped robot whose coordinates and signs each has."""


def recut(
    kind: str, robot: Robot, legs: Sequence[Sequence[Leg]], body: float | None = None, locked: Iterable[str] = ()
) -> Robot:
    """Cuts a part out of a robot.

    Args:
        kind: one of `LIKE`.
        robot: the robot out of which the part is cut.
        legs: legs of the robot that are cut out, one or a pair for each leg of the cut.
        body: mass on the slider of a monopod, in kg.
        locked: joints of the monopod that are held at zero.
    """
    if kind == "monopod":
        ((leg,),) = legs
        return monopod(robot, leg, "share" if body is None else body, locked)
    return sagittal(robot, legs)
