"""Domains of a phase with toes on the ground: sticking, and slipping either way, with their guards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from spear_pin.hybrid.automaton import Domain, Guard, GuardValue, Mount, Reset
from spear_pin.hybrid.contact import OPEN, SIGN, SLIP_BACKWARD, SLIP_FORWARD, STICK
from spear_pin.hybrid.rules.footing import AT_REST, UNLOADED

ON_GROUND = 1e-8  # m: more than integration leaves of the constraint, less than any foot clearance
ON_REST = 1e-9  # rad: more than what an event's time is off by


def height(frame: str) -> GuardValue:
    """Height of a frame above the ground, in m."""
    return lambda t, q, v, held, p, dyn, ops: dyn.height(frame)


def normal_force(toe: str) -> GuardValue:
    """F_z of a toe, in N."""
    return lambda t, q, v, held, p, dyn, ops: dyn.force(toe)[1]


def cone_margin(toe: str, side: float) -> GuardValue:
    """μ F_z + side F_x, in N: zero where the toe begins to slide to that side, (3.18)."""
    return lambda t, q, v, held, p, dyn, ops: dyn.friction_coefficient * dyn.force(toe)[1] + side * dyn.force(toe)[0]


def slip_speed(toe: str, side: float) -> GuardValue:
    """Sliding speed of a toe to one side, in m/s."""
    return lambda t, q, v, held, p, dyn, ops: side * dyn.toe_velocity(toe)[0]


def pivot(toe: str) -> GuardValue:
    """J_z D⁻¹ (J_z - μ s J_x)ᵀ of a slipping toe, in 1/kg: not positive means Painlevé's paradox."""
    return lambda t, q, v, held, p, dyn, ops: dyn.pivot(toe)


def rate(index: int, side: float = 1.0) -> GuardValue:
    """A coordinate's rate, times `side`."""
    return lambda t, q, v, held, p, dyn, ops: side * v[index]


def rise(toe: str) -> str:
    """Name in `held` of the speed at which a toe was lifted off by the last impact of several, in m/s."""
    return f"{toe}_rise"


def stays(toe: str) -> GuardValue:
    """Positive unless the impact by which the phase was entered lifts the toe off."""
    return lambda t, q, v, held, p, dyn, ops: 10.0 * AT_REST - held.get(rise(toe), 0.0)


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

    def deflection(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return (2.0 * held[mount.taut] - 1.0) * mount.side * (q[index] - held[mount.rest])

    toggle = Reset(latch=lambda q, v, held, p: {mount.taut: 1.0 - held[mount.taut]})
    return (Guard("spring_switch", deflection, toggle, tolerance=ON_REST),)


def contact_domains(
    domain: Domain,
    toes: Sequence[str],
    lift_off: Reset | Mapping[str, Reset],
    first: tuple[Guard, ...] = (),
) -> tuple[Domain, ...]:
    """The domains of a phase in which the toes marked "stick" in `domain` are on the ground.

    Sticking comes first, then every combination with slip; each gets the guards of its contacts
    ahead of its own: lift-off, slip, stick, and the end of the slip equation's validity. A toe that
    the impact on entering lifts off, while another stays, leaves by its lift-off at once.

    Args:
        domain: the phase with its toes sticking.
        toes: names of the robot's toes.
        lift_off: what happens when a toe's normal force falls to zero; by toe if it depends on the
            toe, and then the event of "front_toe" is named "front_lift_off".
        first: guards that win a tie with those of the contacts.
    """
    choices = [(STICK, SLIP_FORWARD, SLIP_BACKWARD) if mode == STICK else (OPEN,) for mode in domain.contacts]
    closed = [toe for toe, mode in zip(toes, domain.contacts, strict=True) if mode != OPEN]
    leave = {toe: _lift_off(toe, lift_off) for toe in closed}
    lifted = [replace(leave[toe], value=stays(toe), tolerance=AT_REST) for toe in closed if len(closed) > 1]
    domains = []
    for contacts in product(*choices):
        guards: list[Guard] = []
        for toe, mode in zip(toes, contacts, strict=True):
            guards += _guards(toe, mode, leave[toe]) if mode != OPEN else []
        slips = [
            mode if len(closed) == 1 else f"{_leg(toe)} {mode}"
            for toe, mode in zip(toes, contacts, strict=True)
            if mode in SIGN
        ]
        name = " ".join([domain.name, *slips])
        domains.append(replace(domain, name=name, contacts=contacts, guards=(*lifted, *first, *guards, *domain.guards)))
    return tuple(domains)


def _leg(toe: str) -> str:
    return toe.removesuffix("_toe")


def _lift_off(toe: str, lift_off: Reset | Mapping[str, Reset]) -> Guard:
    if isinstance(lift_off, Reset):
        return Guard("lift_off", normal_force(toe), lift_off, tolerance=UNLOADED)
    return Guard(f"{_leg(toe)}_lift_off", normal_force(toe), lift_off[toe], tolerance=UNLOADED)


def _guards(toe: str, mode: str, leave: Guard) -> list[Guard]:
    if mode == STICK:
        margins = [cone_margin(toe, side) for side in SIGN.values()]
        return [leave, *(Guard("slip", margin, Reset(), tolerance=UNLOADED) for margin in margins)]
    ill_posed = Guard("painleve", pivot(toe), ends="painleve")
    return [ill_posed, leave, Guard("stick", slip_speed(toe, SIGN[mode]), Reset(), tolerance=AT_REST)]
