"""Whether an automaton hangs together: every name in it is one that there is. Asked when it is made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.contact import CONTACTS
from spear_pin.hybrid.reasons import REASONS

if TYPE_CHECKING:
    from spear_pin.hybrid.automaton import Domain, HybridSystem, Reset


class Latched(dict[str, Any]):
    """Values that are held; another name is refused with the names that there are."""

    def __missing__(self, name: str) -> Any:
        raise UnknownName("name of what is held", name, self)


def check(system: HybridSystem) -> None:
    """Refuse a system that names what is not there.

    Its contacts are modes, one for each toe; springs and friction are on joints; events lead into phases, strike toes,
    release springs that are engaged and end for known reasons; springs rest where a latch puts them; and the section
    is the event that ends a flight.

    Raises:
        UnknownName: of all this, one that is not; it lists the valid ones.
        BadValue: contacts are not one for each toe, or an event both resets and ends.
    """
    for domain in system.domains:
        _check_domain(system, domain)
        for name, reset, ends in _events(domain):
            place = name, domain.name
            if reset is not None and ends is not None:
                expected = "None for an event with a reset: a run either goes on or ends"
                raise BadValue("ends of {!r} in domain {!r}".format(*place), ends, expected)
            if ends is not None:
                _known("reason of {!r} in domain {!r}", place, [ends], REASONS)
            if reset is not None:
                _check_reset(system, domain, reset, place)
    _check_rests(system)
    if system.section:
        _ = system.landing  # which says what is valid


def _check_domain(system: HybridSystem, domain: Domain) -> None:
    toes, place = system.robot.toes, (domain.name,)
    if len(domain.contacts) != len(toes):
        expected = f"{len(toes)}, one for each of {', '.join(toes)}"
        raise BadValue(f"contacts of domain {domain.name!r}", domain.contacts, expected)
    _known("contact of domain {!r}", place, domain.contacts, CONTACTS)
    joints = system.robot.coordinates
    _known("joint of a spring of domain {!r}", place, [mount.joint for mount in domain.mounts], joints)
    _known("joint of dry friction of domain {!r}", place, [rub.joint for rub in domain.rubs], joints)


def _events(domain: Domain) -> Iterator[tuple[str, Reset | None, str | None]]:
    for guard in domain.guards:
        yield guard.name, guard.reset, guard.ends
    if domain.switch is not None:
        yield domain.switch.name, domain.switch.reset, None


def _check_reset(system: HybridSystem, domain: Domain, reset: Reset, place: tuple[str, ...]) -> None:
    if reset.phase is not None:
        _known("phase entered by the reset of {!r} in domain {!r}", place, [reset.phase], system.phases)
    _known("toe that strikes by the reset of {!r} in domain {!r}", place, reset.impact, system.robot.toes)
    engaged = [mount.joint for mount in domain.mounts]
    _known("joint whose spring is released by the reset of {!r} in domain {!r}", place, reset.release, engaged)


def _check_rests(system: HybridSystem) -> None:
    """Whether springs rest, and pull, as something latches; latches that cannot be asked are left alone."""
    wanted = {name for domain in system.domains for mount in domain.mounts for name in (mount.rest, mount.taut)}
    if not wanted:
        return
    latches = [reset.latch for domain in system.domains for _, reset, _ in _events(domain) if reset and reset.latch]
    held = Latched()
    waiting = list({id(latch): latch for latch in latches}.values())
    try:
        q, v = (list(map(float, part)) for part in system.guess())
        while waiting:
            asked, waiting, missing = waiting, [], None
            for latch in asked:
                try:
                    held.update(latch(q, v, held, system.law))
                except UnknownName as error:
                    waiting.append(latch)
                    missing = error
            if missing is not None and len(waiting) == len(asked):
                break
    except Exception:  # whatever a function not ours raises at a state at which a run need not ask it
        return
    if waiting and missing is not None:
        raise missing
    for domain in system.domains:
        for mount in domain.mounts:
            place = mount.joint, domain.name
            _known("name of what holds the spring of {!r} in domain {!r}", place, [mount.rest, mount.taut], held)


def _known(kind: str, place: tuple[str, ...], names: Sequence[str], valid: Any) -> None:
    for name in names:
        if name not in valid:
            raise UnknownName(kind.format(*place), name, dict.fromkeys(valid))
