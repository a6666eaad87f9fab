"""Guards of contacts, falls and springs: what events there are, and how near to zero counts as on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from spear_pin.hybrid.contact import SIGN, SLIP, SLOW, STICK
from spear_pin.hybrid.domain import Guard, GuardValue, Mount, Reset, Rub
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.rules.footing import AT_REST, LET_GO, UNLOADED, size

ON_GROUND = 1e-8  # m: more than integration leaves of the constraint, less than any foot clearance
ON_REST = 1e-9  # rad: more than what an event's time is off by
NEAR_GROUND = 1e-6  # m: of a toe that bounces, to which integration adds up over many short contacts


def height(frame: str) -> GuardValue:
    """Distance of a frame from the ground, along its normal, in m."""
    return lambda t, q, v, held, p, dyn, ops: dyn.height(frame)


def normal_force(toe: str) -> GuardValue:
    """Normal force of a toe, in N."""
    return lambda t, q, v, held, p, dyn, ops: dyn.force(toe)[-1]


def cone_margin(toe: str, side: float) -> GuardValue:
    """μ F_z + side F_x, in N: zero where the toe begins to slide to that side, (3.18)."""
    return lambda t, q, v, held, p, dyn, ops: dyn.friction_coefficient * dyn.force(toe)[1] + side * dyn.force(toe)[0]


def circular_margin(toe: str) -> GuardValue:
    """μ F_z - |F_t|, in N: zero where the toe begins to slide in space."""
    return lambda t, q, v, held, p, dyn, ops: dyn.friction_coefficient * dyn.force(toe)[-1] - size(dyn.force(toe)[:-1])


def slip_speed(toe: str, side: float) -> GuardValue:
    """Sliding speed of a toe to one side, in m/s."""
    return lambda t, q, v, held, p, dyn, ops: side * dyn.toe_velocity(toe)[0]


def radial_speed(toe: str) -> GuardValue:
    """By how much the sliding speed of a toe in space is above that at which it is stopped, in m/s."""
    return lambda t, q, v, held, p, dyn, ops: size(dyn.toe_velocity(toe)[:-1]) - SLOW


def pivot(toe: str) -> GuardValue:
    """J_z D⁻¹ (J_z - μ J_tᵀ d)ᵀ of a slipping toe, in 1/kg: not positive means Painlevé's paradox."""
    return lambda t, q, v, held, p, dyn, ops: dyn.pivot(toe)


def unloading(toe: str) -> GuardValue:
    """Normal force of a slipping toe times its pivot, in m/s²: zero at its lift-off, not where the force has a pole."""
    return lambda t, q, v, held, p, dyn, ops: dyn.force(toe)[-1] * dyn.pivot(toe)


def rate(index: int, side: float = 1.0) -> GuardValue:
    """A coordinate's rate, times `side`."""
    return lambda t, q, v, held, p, dyn, ops: side * v[index]


def rise(toe: str) -> str:
    """Name in `held` of the speed at which a toe was lifted off by the last impact of several, in m/s."""
    return f"{toe}_rise"


def stays(toe: str) -> GuardValue:
    """Positive unless the impact by which the phase was entered lifts the toe off."""
    return lambda t, q, v, held, p, dyn, ops: 10.0 * AT_REST - held.get(rise(toe), 0.0)


def struck(toe: str) -> str:
    """Name in `held` of 1 where an impact of another toe was one of this, too."""
    return f"{toe}_struck"


def strikes_too(toe: str) -> GuardValue:
    """Positive unless the impact by which the phase was entered was one of this toe, too."""
    return lambda t, q, v, held, p, dyn, ops: 0.5 - held.get(struck(toe), 0.0)


def touchdown(toe: str, reset: Reset, name: str = "touchdown") -> Guard:
    """The toe reaches the ground from above."""
    return Guard(name, height(toe), reset, tolerance=ON_GROUND)


def fall(frames: Sequence[str]) -> tuple[Guard, ...]:
    """The run ends when one of these frames reaches the ground."""
    return tuple(Guard(f"fall:{frame}", height(frame), ends="fall", tolerance=ON_GROUND) for frame in frames)


def spring_switches(mount: Mount, index: int) -> tuple[Guard, ...]:
    """A unilateral spring goes slack, or taut again, when the joint passes the latched angle."""
    if not mount.spring.unilateral:
        return ()

    side, rest, taut = mount.side, mount.rest, mount.taut  # not its numbers: a guard that sees others is another

    def deflection(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return (2.0 * held[taut] - 1.0) * side * (q[index] - held[rest])

    toggle = Reset(latch=lambda q, v, held, p: {taut: 1.0 - held[taut]})
    return (Guard("spring_switch", deflection, toggle, tolerance=ON_REST),)


def to_spare(rub: Rub, side: float) -> GuardValue:
    """Margin of dry friction over that which holds the joint, towards one side, in N or N·m."""

    def spare(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return rub.force - side * dyn.holding(rub.joint)  # which the reference engine has

    return spare


def contact_guards(toe: str, mode: str, name: str, lift_off: Reset, ways: Sequence[str]) -> list[Guard]:
    """Events of a toe on the ground: lift-off, slip or stick, and the end of the slip equation's validity.

    Args:
        toe: the toe.
        mode: its mode of contact.
        name: of its lift-off.
        lift_off: what happens then.
        ways: modes in which it may slide.
    """
    leave = Guard(name, normal_force(toe), lift_off, tolerance=UNLOADED)
    if mode == STICK:
        margins = [circular_margin(toe) if way == SLIP else cone_margin(toe, SIGN[way]) for way in ways]
        return [leave, *(Guard("slip", margin, Reset(), tolerance=UNLOADED) for margin in margins)]
    ill_posed = Guard("painleve", pivot(toe), ends="painleve")
    if mode == SLIP:  # in what little is left of its speed it would turn ever faster
        stop = Guard("stick", radial_speed(toe), Reset(stop=(toe,)), patience=math.inf)
        leave = Guard(name, unloading(toe), lift_off, tolerance=UNLOADED)
    else:
        stop = Guard("stick", slip_speed(toe, SIGN[mode]), Reset(), tolerance=AT_REST)
    return [ill_posed, leave, stop]


def bounce_guards(toe: str, leg: str, clear: float, name: str, lift_off: Reset) -> list[Guard]:
    """Events of a toe in the air whose leg bears: it strikes again, or is clear of the ground, which is its lift-off.

    Args:
        toe: the toe.
        leg: name of its leg.
        clear: height at which it has lifted off, in m.
        name: of its lift-off.
        lift_off: what happens then.
    """

    def near(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return clear - dyn.height(toe)

    strikes = Guard(f"{leg}_bounces", height(toe), Reset(impact=(toe,)), tolerance=NEAR_GROUND, patience=NEAR_GROUND)
    return [strikes, Guard(name, near, lift_off)]


def struck_together(toe: str, name: str, reset: Reset) -> Guard:
    """Touchdown at once of a toe that reached the ground at the same instant as the one that the phase begins with."""
    return Guard(name, strikes_too(toe), reset)


def lifted_off(toe: str, name: str, lift_off: Reset) -> Guard:
    """Lift-off at once of a toe that the impact by which the phase is entered lifts off, while another stays."""
    return Guard(name, stays(toe), lift_off, tolerance=AT_REST)


def rubbing_guards(rub: Rub, index: int) -> tuple[Guard, ...]:
    """Events of dry friction: a joint that moves comes to rest; one that is held is let go to either side.

    Args:
        rub: mode of the joint.
        index: of its coordinate.
    """
    if rub.sign:
        return (Guard(f"rest:{rub.joint}", rate(index, rub.sign), Reset(), tolerance=AT_REST),)
    return tuple(Guard(f"let_go:{rub.joint}", to_spare(rub, side), Reset(), tolerance=LET_GO) for side in (1.0, -1.0))
