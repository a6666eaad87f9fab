"""Trotting and pacing: diagonal, or lateral, pairs of legs stand; the halves of a stride are mirror images."""

from __future__ import annotations

from collections.abc import Mapping

from spear_pin.gaits.spatial.automaton import Automaton, in_groups
from spear_pin.gaits.spatial.legs import Groups, sides_of
from spear_pin.gaits.spatial.trot_law import TrotLaw
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.section import section
from spear_pin.hybrid.symmetry import head_state, measure_asymmetry, mirror_of
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

SECTION, LATERAL, HALFWAY = "diagonal_touchdown", "lateral_touchdown", "halfway"
ALIKE = 1e-9  # limit of `measure_asymmetry` for a robot whose strides consist of halves


@typed
def trotting(
    robot: Robot,
    law: TrotLaw,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the trotting automaton: that of `bounding_in_space` with diagonal pairs, and flights between stances.

    See there for the arguments. A cycle is half a stride. The section lies just before the first touchdown of a pair.
    Where that is the pair of the posterior right leg, the state is seen in the mirror. So a gait is a fixed point, and
    the multipliers of a whole stride are the squares of the gait's. If left and right of the robot are not quite mirror
    images, `measure_asymmetry`, a cycle is a whole stride.

    Raises:
        BadValue: the robot is not such a quadruped, or another argument is not valid; see `bounding_in_space`.

    Example:
        >>> from spear_pin import Gait, trotting
        >>> trot = Gait.load("trot").system
        >>> trotting(trot.robot, trot.law).section
        'diagonal_touchdown'
    """
    automaton = _in_halves(robot, law, sides_of(robot, across=True), SECTION)
    return in_groups("trotting", automaton, law, spring, contact, ground, build=trotting)


@typed
def pacing(
    robot: Robot,
    law: TrotLaw,
    spring: Spring | Mapping[str, Spring] | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """Returns the pacing automaton: that of `trotting` with the legs of a side as a pair; see there for the arguments.

    Raises:
        BadValue: the robot is not such a quadruped, or another argument is not valid; see `bounding_in_space`.

    Example:
        >>> from spear_pin import Gait, pacing
        >>> pace = Gait.load("pace").system
        >>> pacing(pace.robot, pace.law).section
        'lateral_touchdown'
    """
    automaton = _in_halves(robot, law, sides_of(robot, across=False), LATERAL)
    return in_groups("pacing", automaton, law, spring, contact, ground, build=pacing)


def halfway(system: HybridSystem, cycle: Run) -> State:
    """Returns the state between the halves of a stride, seen in the mirror, (q, v), headed.

    Args:
        system: system of a trot or a pace.
        cycle: a complete cycle of the system.
    """
    if system.mirrored_toes:
        (q,), (v,) = section(system).seen(*(part[None] for part in cycle.state))
        return q, v
    event, mirror = cycle.event(HALFWAY), mirror_of(system.robot)
    q, v = head_state(event.q, event.v_before)
    return mirror(q), mirror(v)


def _in_halves(robot: Robot, law: TrotLaw, pairs: Groups, section: str) -> Automaton:
    """Returns the automaton of strides whose halves are mirror images, as far as those of the robot are."""
    sections = (section, section if measure_asymmetry(robot) <= ALIKE else HALFWAY)
    return Automaton(robot, pairs, sections, pairs[::-1], law.lift_off)
