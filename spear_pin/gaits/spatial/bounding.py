"""Bounding in space: the posterior legs are on the ground together, and so are the anterior legs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.spatial.automaton import Automaton, in_groups
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import Z, move_in_space, pairs_of, place_in_space
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

SECTION = "posterior_touchdown"


@typed
def bounding_in_space(
    robot: Robot,
    law: SpatialLaw,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the bounding automaton in space, in which each leg touches down and lifts off by itself.

    The section lies just before the first posterior touchdown, both posterior legs at their touchdown angles.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`, whose toes are those of its four
            legs.
        law: parameters of the controller.
        spring: the knee spring of one leg; by default 56 N·m/rad (source: Table 5.1), without damping, scaled with m g
            l for a robot of another size.
        contact: friction of level ground; by default 0.8 (assumption).
        ground: the ground, instead of `contact`.

    Raises:
        BadValue: the robot is not such a quadruped, both contact and ground are given, the ground is not level at
            height zero, the spring never releases, or the plane's law has event feedback.

    Example:
        >>> from spear_pin import Gait, SpatialLaw, bounding_in_space, load
        >>> law = SpatialLaw(Gait.load("long_stride").system.law)
        >>> bounding_in_space(load("q_spear_full", base="chain"), law).section
        'posterior_touchdown'
    """
    pairs = pairs_of(robot)
    automaton = Automaton(robot, pairs, (SECTION,), pairs[:1], law.lift_off)

    def guess() -> State:
        if not law.plane.nominal:
            expected = "the numbers of a section state; or give a state to start from"
            raise BadValue("SpatialLaw.plane.nominal", law.plane.nominal, expected)
        q = place_in_space(robot, pairs, np.array([0.0, *law.plane.nominal[:6]]))
        q[Z] -= min(robot.toe_position(q, leg.toe)[-1] for leg in pairs[0])
        return q, move_in_space(robot, pairs, np.array(law.plane.nominal[6:]))

    return in_groups("bounding_in_space", automaton, law, spring, contact, ground, build=bounding_in_space, guess=guess)
