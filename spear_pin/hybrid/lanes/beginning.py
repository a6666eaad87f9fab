"""Where lanes begin: on the section, in the air before it, or nowhere."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.lanes.groups import Flags, Group
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.rules.guards import ON_GROUND
from spear_pin.hybrid.rules.start import STATE_AT_REST, below_ground, rests


class Beginning(NamedTuple):
    """How lanes begin.

    Attributes:
        lowest: height of the lowest toe above the ground, in m, (n,).
        below: whether that is below the ground, (n,).
        torn: whether a loop is open, (n,).
        standing: whether the state is on the section, (n,); if not, it is in the air.
    """

    lowest: Array
    below: Flags
    torn: Flags
    standing: Flags


def find_beginning(numbers: Numbers, y: Array) -> Beginning:
    """Finds out how lanes begin.

    Args:
        numbers: numbers of the lanes.
        y: their states, (2 nv, n).

    Raises:
        BadFunction: there is a mistake in the ground's function.
        NotSymbolic: the ground does not take symbols.
    """
    system, nv, n = numbers.system, numbers.nv, y.shape[1]
    toes, closure = system.robot.toes, system.robot.closure
    for toe in toes if n and not system.ground.plane else ():
        system.ground.foot(system.robot, y[:nv, 0], toe)  # a call with numbers reveals a mistake
    heights, velocities = numbers.compilation.feet(y, numbers.parameters(Group(np.arange(n), np.zeros(n), y, {})))
    torn = np.array([closure is not None and not all(closure.holds(one[:nv], one[nv:])) for one in y.T], bool)
    if system.section_toes:
        standing: Flags = np.any(heights[[toe in system.section_toes for toe in toes]] <= ON_GROUND, axis=0)
    else:
        resting = rests(heights, velocities[:, -1], STATE_AT_REST)
        standing = np.all(resting[list(system.of_phase(system.section_phase)[0].on_ground)], axis=0)
    below: Flags = np.any(below_ground(heights), axis=0)
    return Beginning(heights.min(axis=0, initial=np.inf), below, torn, standing)
