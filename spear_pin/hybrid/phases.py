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
from spear_pin.hybrid.rules.guards import toggle as toggle
from spear_pin.hybrid.rules.guards import touchdown as touchdown


def contact_domains(
    domain: Domain,
    toes: Sequence[str],
    lift_off: Reset | Mapping[str, Reset],
    first: tuple[Guard, ...] = (),
    ways: Sequence[str] = WAYS[2],
    *,
    clear: float | None = None,
) -> tuple[Domain, ...]:
    """Makes the domains of a phase in which the toes marked "stick" in `domain` are on the ground.

    Sticking comes first, then every combination with slip. Each domain gets the guards of its contacts
    before its own: lift-off, slip, stick, and the end of the slip equation's validity. If the impact on
    entering lifts a toe off while another stays, that toe leaves by its lift-off immediately.

    Args:
        domain: the phase with its toes sticking.
        toes: names of the robot's toes.
        lift_off: reset when a toe's normal force falls to zero. If it depends on the toe it is a mapping by toe, and
            the event of "front_toe" is named "front_lift_off".
        first: guards that win a tie with the guards of the contacts.
        ways: modes in which a toe may slide: in the plane either way, in space along its own direction.
        clear: height, in m, up to which a toe whose force fell to zero bounces: it stays in its phase, and lifts off
            when it gets higher. Without `clear` a toe lifts off when its force ends.
    """
    modes = (STICK, *ways) if clear is None else (STICK, *ways, OPEN)
    choices = [modes if mode == STICK else (mode,) for mode in domain.contacts]
    closed = [toe for toe, mode in zip(toes, domain.contacts, strict=True) if mode == STICK]
    leave = {toe: _lift_off(toe, lift_off) for toe in closed}
    lifted = [lifted_off(toe, *leave[toe]) for toe in closed if len(closed) > 1 and clear is None]
    unloads = {toe: leave[toe] if clear is None else (f"{_leg(toe)}_unloads", Reset()) for toe in closed}
    domains = []
    for contacts in product(*choices):
        guards: list[Guard] = []
        for toe, mode in zip(toes, contacts, strict=True):
            if toe in closed:
                if clear is not None and mode == OPEN:
                    guards += bounce_guards(toe, _leg(toe), clear, *leave[toe])
                else:
                    guards += contact_guards(toe, mode, *unloads[toe], ways)
        others = [
            mode if len(closed) == 1 else f"{_leg(toe)} {mode}"
            for toe, mode in zip(toes, contacts, strict=True)
            if toe in closed and mode != STICK
        ]
        name, every = " ".join([domain.name, *others]), (*lifted, *first, *guards, *domain.guards)
        bouncing = () if clear is None else tuple(closed)
        domains.append(replace(domain, name=name, contacts=contacts, guards=every, bouncing=bouncing))
    return tuple(domains)


def _leg(toe: str) -> str:
    return toe.removesuffix("_toe")


def _lift_off(toe: str, lift_off: Reset | Mapping[str, Reset]) -> tuple[str, Reset]:
    """Returns name and reset of a toe's lift-off."""
    return ("lift_off", lift_off) if isinstance(lift_off, Reset) else (f"{_leg(toe)}_lift_off", lift_off[toe])
