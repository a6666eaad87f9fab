"""Modes of contact and of dry friction: which domain of a phase fits a state."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from spear_pin.hybrid.contact import OPEN, SLIPS, STICK
from spear_pin.hybrid.domain import Domain, Rub
from spear_pin.hybrid.dynamics import Dynamics
from spear_pin.hybrid.rules.scalars import first, where

AT_REST = 1e-7  # m/s
UNLOADED = 1e-5  # N: near Painlevé's paradox rounding is amplified a hundredfold and more
LET_GO = 1e-9  # N, N·m: of dry friction; where a robot comes to rest its friction often is all but exhausted
STARTS_TO_SLIDE = 1e-3  # m/s²: on the cone's edge a sliding toe begins with no acceleration
BORE = 1e-3  # N: well above what is left of a force that fades to nothing

# fitness of a domain whose modes the forces do not keep; one that fits is above all of them, see `fitness`
LEAVES, SOME_LEAVE, ILL_POSED, MOVES, TURNS = -1.0, -2.0, -3.0, -4.0, -5.0
UNFIT = -math.inf


class Footing(NamedTuple):
    """Numbers of a toe on the ground by which its mode is told, scalars of any kind.

    Attributes:
        speed: of its sliding, along the mode's direction if it slides, in m/s; if it sticks forward, in space its size.
        tangential: force along the ground, in N; in space its size.
        normal: force out of the ground, in N.
        grip: μ times the normal force, in N.
        acceleration: along the mode's direction, in m/s²; of a sliding toe.
        pivot: of a sliding toe, in 1/kg; not positive means Painlevé's paradox.
    """

    speed: Any
    tangential: Any
    normal: Any
    grip: Any
    acceleration: Any = 0.0
    pivot: Any = 1.0


class Rubbing(NamedTuple):
    """Numbers of a joint with dry friction by which its mode is told, scalars of any kind.

    Attributes:
        rate: of the joint, in m/s or rad/s.
        acceleration: in m/s² or rad/s².
        holding: force that holds it at rest, in N or N·m; 0 where it moves.
    """

    rate: Any
    acceleration: Any
    holding: Any = 0.0


def closed_toes(toes: Sequence[str], domain: Domain) -> list[tuple[str, str]]:
    """The toes on the ground, with their modes."""
    return [(toe, mode) for toe, mode in zip(toes, domain.contacts, strict=True) if mode != OPEN]


def footing(dynamics: Dynamics, toe: str, mode: str) -> Footing:
    """A toe's footing in a mode."""
    *tangential, normal = dynamics.force(toe)
    velocity, grip = dynamics.toe_velocity(toe)[:-1], dynamics.friction_coefficient * normal
    if mode == STICK:
        return Footing(size(velocity), size(tangential), normal, grip)
    way = dynamics.direction(toe, mode)
    acceleration, pivot = dynamics.toe_acceleration(toe)[:-1], dynamics.pivot(toe)
    return Footing(along(way, velocity), size(tangential), normal, grip, along(way, acceleration), pivot)


def size(tangential: Sequence[Any]) -> Any:
    """Size of what is along the ground: in the plane, where that is one number, with its sign."""
    return tangential[0] if len(tangential) == 1 else math.hypot(*tangential)


def along(way: Iterable[Any], tangential: Iterable[Any]) -> Any:
    """Part along a unit vector of what is along the ground."""
    first, *others = (one * other for one, other in zip(way, tangential, strict=True))
    return sum(others, first)


def still(speed: Any) -> Any:
    """Whether a toe is at rest along a direction in which it moves at a speed, in m/s."""
    return abs(speed) <= AT_REST


def rate_fits(rub: Rub, rate: Any) -> Any:
    """Whether a joint's rate fits a mode of its dry friction."""
    return abs(rate) <= AT_REST if rub.sign == 0 else rub.sign * rate >= -AT_REST


def fitness(feet: Sequence[tuple[str, Sequence[Any]]], joints: Sequence[tuple[Rub, Rubbing]] = ()) -> Any:
    """How well a domain fits a state: of those of a phase the one that fits best is taken, of equals the first.

    Where its modes fit and the forces keep them, it is the least acceleration, in m/s², at which a toe begins to slide,
    infinite if none does: with next to no force on a toe both ways may pass, and the one that pushes it off better is
    taken. Else it is why they do not, whose guard then is an event at once: `LEAVES` where all toes that cannot stay
    would have to be held down, `SOME_LEAVE` where some of them would, `ILL_POSED` at Painlevé's paradox, `MOVES` where
    a toe moves as its mode says and its force is outside, `TURNS` where a joint's dry friction does not hold, `UNFIT`
    where velocities do not fit.

    Args:
        feet: mode of each toe on the ground, and its footing or the numbers of one in their order.
        joints: mode and numbers of each joint with dry friction.

    Returns:
        a number, or an array (n,) where footings are arrays.
    """
    fits, posed, keeps, leaves, some, holds, push = True, True, True, True, False, True, math.inf
    for mode, (speed, tangential, normal, grip, acceleration, pivot) in feet:
        if mode == STICK:
            fits = fits & (abs(speed) <= AT_REST)
            stays = abs(tangential) < grip - UNLOADED  # on the cone's edge it is about to slide
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
            holds = holds & (abs(joint.holding) < rub.force - LET_GO)
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


def torn_off(mode: str, bore: Any, next_mode: str, bears: Any) -> Any:
    """Whether a toe that stuck and bore has to leave because the slip that would begin is a Painlevé paradox.

    On the cone's edge, the force that lets the toe stick is the one of slip to that side as well. Where that has no
    positive pivot, the force only grows with the toe's acceleration into the ground: beyond the edge such slip would
    turn back at once. Slip to the other side would pull at the toe. Lifting off is all that is consistent: without
    force the toe accelerates upward.

    Args:
        mode: of the toe in the motion that ends.
        bore: its normal force there, in N.
        next_mode: in the motion that fits best.
        bears: its normal force there, in N.
    """
    return (mode == STICK and next_mode in SLIPS) & (bore > BORE) & (bears <= 0.0)
