"""Pronking: all four legs are on the ground together."""

from __future__ import annotations

from collections.abc import Mapping

from spear_pin.gaits.spatial.automaton import Automaton, in_groups
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import together
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.ground import Ground
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

SECTION = "touchdown"


@typed
def pronking(
    robot: Robot,
    law: SpatialLaw,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the pronking automaton: that of `bounding_in_space` with all legs as one group, and one flight.

    See there for the arguments. The section lies just before the first touchdown, with all legs at their touchdown
    angles. The law is the bound's. No other group is on the ground while a leg is in the air, so legs move to their
    touchdown angles from lift-off on: posterior legs by `flight_2_landing` and anterior legs by `flight_1_landing`, all
    over `flight_1_span`. Spans of stance, coefficients of swing and trailing, and `flight_2_span` have no effect.

    Raises:
        BadValue: the robot is not such a quadruped, or another argument is not valid; see `bounding_in_space`.

    Example:
        >>> from spear_pin import Gait, pronking
        >>> pronk = Gait.load("pronk").system
        >>> pronking(pronk.robot, pronk.law).section
        'touchdown'
    """
    groups = together(robot)
    automaton = Automaton(robot, groups, (SECTION,), groups, law.lift_off)
    return in_groups("pronking", automaton, law, spring, contact, ground, build=pronking)
