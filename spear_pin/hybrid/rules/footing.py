"""Modes of contact and of dry friction: decides which domain of a phase fits a state."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from spear_pin.hybrid.contact import OPEN, SIGN, SLIPS, STICK
from spear_pin.hybrid.domain import Domain, Rub
from spear_pin.hybrid.dynamics import FLOATS, Dynamics, Operations
from spear_pin.hybrid.rules.scalars import first, where
from spear_pin.model.feet import find_leading
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import Lever, lever_along
from spear_pin.model.scalars import vanishes

AT_REST = 1e-7  # m/s
LIFTS = 10.0 * AT_REST  # m/s: a toe that the impact of another lifts off more slowly stays on the ground
UNLOADED = 1e-5  # N: near Painlevé's paradox rounding is amplified a hundredfold and more
LET_GO = 1e-9  # N, N·m: margin of dry friction, which is often almost exhausted where a robot comes to rest
STARTS_TO_SLIDE = 1e-3  # m/s²: on the cone's edge a sliding toe begins with no acceleration
BORE = 1e-3  # N: well above the rest of a force that fades to zero

# fitness of a domain whose modes the forces do not keep; a domain that fits has a greater one, see `fitness`
LEAVES, SOME_LEAVE, ILL_POSED, MOVES, TURNS = -1.0, -2.0, -3.0, -4.0, -5.0
UNFIT = -math.inf


class Footing(NamedTuple):
    """Numbers of a toe on the ground that decide its mode, as scalars of any kind.

    Attributes:
        speed: sliding speed, in m/s: along the mode's direction if the toe slides; if it sticks, forward in the plane
            and the modulus in space.
        tangential: force along the ground, in N; in space its modulus. If the toe rests, it is that on its foot, on all
            toes of its body that are on the ground.
        normal: force out of the ground, in N.
        grip: μ times the normal force, in N; if the toe rests, times that on its foot.
        acceleration: acceleration of a sliding toe along the mode's direction, in m/s².
        pivot: pivot of a sliding toe, in 1/kg; not positive means Painlevé's paradox.
    """

    speed: Any
    tangential: Any
    normal: Any
    grip: Any
    acceleration: Any = 0.0
    pivot: Any = 1.0


class Rubbing(NamedTuple):
    """Numbers of a joint with dry friction that decide its mode, as scalars of any kind.

    Attributes:
        rate: rate of the joint, in m/s or rad/s.
        acceleration: acceleration of the joint, in m/s² or rad/s².
        holding: force that holds the joint at rest, in N or N·m; 0 while it moves.
        most: Coulomb's force, the most that holds it, in N or N·m.
    """

    rate: Any
    acceleration: Any
    holding: Any
    most: Any


def closed_toes(toes: Sequence[str], domain: Domain) -> list[tuple[str, str]]:
    """Returns the toes on the ground, with their modes."""
    return [(toe, mode) for toe, mode in zip(toes, domain.contacts, strict=True) if mode != OPEN]


class Bound:
    """The rows that bind toes at rest, in the order of the toes.

    The row along the ground is left out for a guided toe, which moves up and down only, and for a toe whose body has
    another one on the ground before it: both move along the ground alike. Their force along the ground is found for the
    first of them.

    Args:
        robot: the robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._dimension, self._guided, self._feet = robot.dimension, robot.guided, robot.feet
        self._all_bind = not robot.guided and all(len(foot) == 1 for foot in robot.feet.values())

    def first(self, toes: Sequence[str]) -> list[int]:
        """Returns of each toe, if it rests with those before it on the ground, the first of its rows that binds it."""
        if self._all_bind:
            return [0] * len(toes)
        leads = enumerate(zip(toes, find_leading(self._feet, toes), strict=True))
        return [self._dimension - 1 if toe in self._guided or lead < i else 0 for i, (toe, lead) in leads]

    def force(self, begin: int, multipliers: Sequence[Any], row: int) -> tuple[tuple[Any, ...], int]:
        """Returns the force on a toe whose rows begin at one, along the ground and normal to it, and the next row.

        Args:
            begin: the first of its rows, by `first`.
            multipliers: multipliers of all rows.
            row: index of its first multiplier.
        """
        end = row + self._dimension - begin
        return (*begin * (0.0,), *multipliers[row:end]), end

    def forces(self, toes: Sequence[str], multipliers: Sequence[Any]) -> dict[str, tuple[Any, ...]]:
        """Returns the forces on toes, whose rows come first."""
        found, row = dict[str, tuple[Any, ...]](), 0
        for toe, begin in zip(toes, self.first(toes), strict=True):
            found[toe], row = self.force(begin, multipliers, row)
        return found


def of_foot(robot: Robot, toe: str, forces: Mapping[str, Sequence[Any]]) -> tuple[Any, ...]:
    """Returns the force on all toes of a toe's body that are on the ground, along the ground and normal to it.

    Args:
        robot: the robot.
        toe: the toe.
        forces: the force on each toe on the ground, as `Bound` finds it.
    """
    if len(robot.feet[toe]) == 1:
        return tuple(forces[toe])
    one, *others = (forces[each] for each in robot.feet[toe] if each in forces)
    return tuple(sum(parts[1:], parts[0]) for parts in zip(one, *others, strict=True))


def shared(robot: Robot, toe: str, forces: Mapping[str, Sequence[Any]]) -> tuple[Any, ...]:
    """Returns the force on a toe; along the ground toes of one body share it as they share the normal force.

    The equations of a rigid body give only the sum. With these shares each toe is in its cone if the sum is.
    """
    foot = robot.feet[toe]
    if len(foot) == 1 or sum(each in forces for each in foot) == 1:
        return tuple(forces[toe])
    *tangential, whole = of_foot(robot, toe, forces)
    if vanishes(whole):
        return tuple(forces[toe])
    share = forces[toe][-1] / whole
    return *(share * each for each in tangential), forces[toe][-1]


def make_footing(dynamics: Dynamics, toe: str, mode: str, ops: Operations = FLOATS) -> Footing:
    """Returns a toe's footing in a mode."""
    *tangential, normal = dynamics.force(toe)
    velocity, grip = dynamics.toe_velocity(toe)[:-1], dynamics.friction_coefficient * normal
    if mode == STICK:
        *tangential, whole = dynamics.foot_force(toe)
        return Footing(size(velocity, ops), size(tangential, ops), normal, dynamics.friction_coefficient * whole)
    way = (SIGN[mode],) if mode in SIGN else dynamics.direction(toe)
    acceleration, pivot = dynamics.toe_acceleration(toe)[:-1], dynamics.pivot(toe)
    return Footing(along(way, velocity), size(tangential, ops), normal, grip, along(way, acceleration), pivot)


def make_rubbing(dynamics: Any, rub: Rub) -> Rubbing:
    """Returns the numbers of a joint with dry friction, by an engine's motion in a mode of it."""
    lever = lever_along(rub.along, dynamics.system.robot)
    holding = 0.0 if rub.sign else dynamics.holding(rub.joint)
    return Rubbing(rate_along(lever, dynamics.v), rate_along(lever, dynamics.a), holding, dynamics.most(rub.joint))


def rate_along(lever: Lever, rates: Any) -> Any:
    """Returns the rate of a path, or its acceleration, by those of the coordinates."""
    (first, weight), *others = lever
    return sum((other * rates[i] for i, other in others), weight * rates[first])


def size(tangential: Sequence[Any], ops: Operations = FLOATS) -> Any:
    """Returns the modulus of a vector along the ground; in the plane, where it is one number, with its sign."""
    x, *across = tangential
    return ops.sqrt(sum((y * y for y in across), x * x)) if across else x


def along(way: Iterable[Any], tangential: Iterable[Any]) -> Any:
    """Returns the component of a vector along the ground in the direction of a unit vector."""
    first, *others = (one * other for one, other in zip(way, tangential, strict=True))
    return sum(others, first)


def still(speed: Any) -> Any:
    """Tells whether a toe with this speed along a direction, in m/s, counts as at rest."""
    return abs(speed) <= AT_REST


def rate_fits(rub: Rub, rate: Any) -> Any:
    """Tells whether a joint's rate fits a mode of its dry friction."""
    return abs(rate) <= AT_REST if rub.sign == 0 else rub.sign * rate >= -AT_REST


def fitness(feet: Iterable[tuple[str, Sequence[Any]]], joints: Iterable[tuple[Rub, Rubbing]] = ()) -> Any:
    """Returns how well a domain fits a state; of a phase's domains the fittest is taken, of equal ones the first.

    If the domain's modes fit and the forces keep them, the fitness is the least acceleration, in m/s², at which a toe
    begins to slide, infinite if none does. With almost no force on a toe both directions may be consistent, and the one
    that accelerates it more is taken. Else the fitness is the cause, whose guard then is an immediate event: `LEAVES`
    if all toes that cannot stay would have to be held down, `SOME_LEAVE` if some of them would, `ILL_POSED` at
    Painlevé's paradox, `MOVES` if a toe moves according to its mode but its force is outside the cone, `TURNS` if a
    joint's dry friction does not hold, `UNFIT` if velocities do not fit.

    Args:
        feet: mode of each toe on the ground, and its footing or the numbers of a footing in their order.
        joints: mode and numbers of each joint with dry friction.

    Returns:
        a number, or an array (n,) where footings are arrays.
    """
    fits, posed, keeps, leaves, some, holds, push = True, True, True, True, False, True, math.inf
    for mode, (speed, tangential, normal, grip, acceleration, pivot) in feet:
        if mode == STICK:
            fits = fits & (abs(speed) <= AT_REST)
            stays = abs(tangential) < grip - UNLOADED  # on the cone's edge the toe is about to slide
        else:
            fits = fits & (speed >= -AT_REST)
            posed = posed & (pivot > 0.0)
            stays = (acceleration > -STARTS_TO_SLIDE) | (speed > AT_REST)
            push = where((speed <= AT_REST) & (acceleration < push), acceleration, push)
        pulled, stays = normal <= 0.0, stays & (normal > 0.0)
        keeps, leaves, some = keeps & stays, leaves & (stays | pulled), some | pulled
    for rub, joint in joints:
        fits = fits & rate_fits(rub, joint.rate)
        if rub.sign == 0:
            holds = holds & (abs(joint.holding) < joint.most - LET_GO)
        else:
            goes_on = (abs(joint.rate) > AT_REST) | (rub.sign * joint.acceleration > -STARTS_TO_SLIDE)
            holds = holds & goes_on
    reasons = (
        (fits & posed & keeps & holds, push),
        (fits ^ True, UNFIT),
        (holds ^ True, TURNS),
        (posed ^ True, ILL_POSED),
    )
    return first((*reasons, (leaves, LEAVES), (some, SOME_LEAVE)), MOVES)


def is_torn_off(mode: str, bore: Any, next_mode: str, bears: Any) -> Any:
    """Tells whether a toe that stuck and bore has to leave because the slip that would begin is a Painlevé paradox.

    Then only lift-off is consistent: without force the toe accelerates upward. On the cone's edge, sticking and slip to
    that side have the same force. If the pivot of this slip is not positive, the force grows with the toe's
    acceleration into the ground, and beyond the edge the slip would reverse at once. Slip to the other side would pull
    at the toe.

    Args:
        mode: mode of the toe in the motion that ends.
        bore: its normal force in the motion that ends, in N.
        next_mode: its mode in the motion that fits best.
        bears: its normal force in the motion that fits best, in N.
    """
    return (mode == STICK and next_mode in SLIPS) & (bore > BORE) & (bears <= 0.0)
