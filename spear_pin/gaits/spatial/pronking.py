"""Pronking: all four legs bear together."""

from __future__ import annotations

from spear_pin.gaits.spatial.automaton import Automaton, in_groups
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import together
from spear_pin.gaits.spatial.torques import nominal_start
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
    spring: Spring | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """The pronking automaton: that of `bounding_in_space` with all four legs as one group, and one flight.

    The section lies just before the first touchdown, all legs at their touchdown angles. The law is the bound's; as no
    other leg bears while one is in the air, its legs land from lift-off on, posterior ones by `flight_2_landing` and
    anterior ones by `flight_1_landing`, all over `flight_1_span`. Spans of stance, coefficients of swing and trailing,
    and `flight_2_span`, have no effect.

    Args:
        robot: as of `bounding_in_space`, as all that follows.
        law: parameters of the controller.
        spring: the knee springs, of one leg.
        contact: friction of level ground.
        ground: the ground, in place of `contact`.

    Raises:
        BadValue: as of `bounding_in_space`.

    Example:
        >>> from spear_pin import Gait, pronking
        >>> pronk = Gait.load("pronk").system
        >>> pronking(pronk.robot, pronk.law).section
        'touchdown'
    """
    groups = together(robot)
    return in_groups(
        "pronking",
        Automaton(robot, groups, (SECTION,), groups, law.lift_off),
        law,
        spring,
        contact,
        ground,
        build=pronking,
        guess=lambda: nominal_start(robot, law, groups[0]),
    )
