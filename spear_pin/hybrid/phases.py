"""Domains of a phase with toes on the ground: sticking, and slipping either way, with their guards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

from spear_pin.hybrid.contact import OPEN, STICK, WAYS
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.rules.guards import bounce_guards, contact_guards, lifted_off
from spear_pin.hybrid.rules.guards import fall as fall
from spear_pin.hybrid.rules.guards import height as height
from spear_pin.hybrid.rules.guards import rate as rate
from spear_pin.hybrid.rules.guards import spring_switches as spring_switches
from spear_pin.hybrid.rules.guards import touchdown as touchdown


def contact_domains(
    domain: Domain,
    toes: Sequence[str],
    lift_off: Reset | Mapping[str, Reset],
    first: tuple[Guard, ...] = (),
    ways: Sequence[str] = WAYS[2],
    *,
    bounces: bool = False,
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
        ways: modes in which a toe may slide: in the plane either way, in space along a direction of its own.
        bounces: whether a toe whose force falls to zero stays in its phase, in the air, until it is clear of the
            ground: its lift-off is that then.
    """
    modes = (STICK, *ways, OPEN) if bounces else (STICK, *ways)
    choices = [modes if mode == STICK else (mode,) for mode in domain.contacts]
    closed = [toe for toe, mode in zip(toes, domain.contacts, strict=True) if mode == STICK]
    leave = {toe: _lift_off(toe, lift_off) for toe in closed}
    lifted = [lifted_off(toe, *leave[toe]) for toe in closed if len(closed) > 1 and not bounces]
    unloads = {toe: (f"{_leg(toe)}_unloads", Reset()) if bounces else leave[toe] for toe in closed}
    domains = []
    for contacts in product(*choices):
        guards: list[Guard] = []
        for toe, mode in zip(toes, contacts, strict=True):
            if toe in closed:
                own = bounce_guards(toe, _leg(toe), *leave[toe]) if mode == OPEN else []
                guards += own or contact_guards(toe, mode, *unloads[toe], ways)
        others = [
            mode if len(closed) == 1 else f"{_leg(toe)} {mode}"
            for toe, mode in zip(toes, contacts, strict=True)
            if toe in closed and mode != STICK
        ]
        name, every = " ".join([domain.name, *others]), (*lifted, *first, *guards, *domain.guards)
        bouncing = tuple(closed) if bounces else ()
        domains.append(replace(domain, name=name, contacts=contacts, guards=every, bouncing=bouncing))
    return tuple(domains)


def _leg(toe: str) -> str:
    return toe.removesuffix("_toe")


def _lift_off(toe: str, lift_off: Reset | Mapping[str, Reset]) -> tuple[str, Reset]:
    """Name and reset of a toe's lift-off."""
    return ("lift_off", lift_off) if isinstance(lift_off, Reset) else (f"{_leg(toe)}_lift_off", lift_off[toe])
