"""Inputs: the numbers of a law that event feedback, a turn or a gallop may change, and how much of each counts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import parameter, unit
from spear_pin.model.scale import scale_in_space, scale_of

SHARE = 0.25  # of a number that a law does not list: the change that counts as one


class Input(NamedTuple):
    """A number of a law.

    Attributes:
        one: change that counts as one.
        most: largest change.
        torque: whether both scale with m g l of the robot; else they are the same for every robot.
    """

    one: float
    most: float
    torque: bool = False


ANGLE = Input(0.05, 0.2)  # rad


def listed(law: object) -> Mapping[str, Input]:
    """Returns the inputs that a law lists in `inputs`, for SPEAR-II or Q-SPEAR; none if it lists none."""
    found: Mapping[str, Input] = getattr(law, "inputs", {})
    return found


def inputs_of(system: HybridSystem, names: Sequence[str]) -> list[Input]:
    """Returns numbers of a system's law as inputs, for its robot.

    A number that the law does not list counts as an angle if its unit is rad, else by a share of its value.

    Raises:
        UnknownName: nothing has a number of a name.
        BadValue: a number has no value.
    """
    known, robot = listed(system.law), system.robot
    torque = 1.0
    if any(known[name].torque for name in names if name in known):
        torque = (scale_of if robot.planar else scale_in_space)(robot).torque
    found = []
    for name in names:
        value = parameter(system, name)
        one = SHARE * abs(value)
        other = ANGLE if not value or unit(system, name) == "rad" else Input(one, 2.0 * one)
        one, most, scales = known.get(name, other)
        found.append(Input(one * torque, most * torque, True) if scales else Input(one, most))
    return found
