"""Inputs: the numbers of a law that event feedback, a turn or a gallop may change, and how much of each counts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from spear_pin.errors import BadValue
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


def list_inputs(law: object) -> Mapping[str, Input]:
    """Returns the inputs that a law lists in `inputs`, for SPEAR-II or Q-SPEAR; none if it lists none."""
    found: Mapping[str, Input] = getattr(law, "inputs", {})
    return found


def inputs_of(system: HybridSystem, names: Sequence[str]) -> list[Input]:
    """Returns numbers of a system's law as inputs, for its robot.

    A number that the law does not list counts as an angle if its unit is rad, else by a share of its value.

    Raises:
        UnknownName: nothing has a number of a name.
        BadValue: a number has no value, or the law does not list it and it is zero.
    """
    known, robot = list_inputs(system.law), system.robot
    torque = 1.0
    if any(known[name].torque for name in names if name in known):
        torque = (scale_of if robot.planar else scale_in_space)(robot).torque
    found = []
    for name in names:
        share = SHARE * abs(parameter(system, name))
        other = ANGLE if unit(system, name) == "rad" else Input(share, 2.0 * share)
        one, most, scales = known.get(name, other)
        if not one:
            raise BadValue(name, one, "a number other than zero, or one that the law lists in `inputs`")
        found.append(Input(one * torque, most * torque, True) if scales else Input(one, most))
    return found
