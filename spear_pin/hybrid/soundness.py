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
    """What is held, saying of a name that is not what is."""

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
            where = f" of {name!r} in domain {domain.name!r}"
            if reset is not None and ends is not None:
                raise BadValue(f"ends{where}", ends, "None for an event with a reset: a run either goes on or ends")
            if ends is not None:
                _known(f"reason{where}", [ends], REASONS)
            if reset is not None:
                _check_reset(system, domain, reset, where)
    _check_rests(system)
    if system.section:
        assert system.landing


def _check_domain(system: HybridSystem, domain: Domain) -> None:
    where, toes = f" of domain {domain.name!r}", system.robot.toes
    if len(domain.contacts) != len(toes):
        raise BadValue(f"contacts{where}", domain.contacts, f"{len(toes)}, one for each of {', '.join(toes)}")
    _known(f"contact{where}", domain.contacts, CONTACTS)
    _known(f"joint of a spring{where}", [mount.joint for mount in domain.mounts], system.robot.coordinates)
    _known(f"joint of dry friction{where}", [rub.joint for rub in domain.rubs], system.robot.coordinates)


def _events(domain: Domain) -> Iterator[tuple[str, Reset | None, str | None]]:
    for guard in domain.guards:
        yield guard.name, guard.reset, guard.ends
    if domain.switch is not None:
        yield domain.switch.name, domain.switch.reset, None


def _check_reset(system: HybridSystem, domain: Domain, reset: Reset, where: str) -> None:
    if reset.phase is not None:
        _known(f"phase entered by the reset{where}", [reset.phase], system.phases)
    _known(f"toe that strikes by the reset{where}", reset.impact, system.robot.toes)
    _known(f"joint whose spring the reset{where} releases", reset.release, [mount.joint for mount in domain.mounts])


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
            _known(f"name of what holds the spring of {mount.joint} in {domain.name!r}", [mount.rest, mount.taut], held)


def _known(kind: str, names: Sequence[str], valid: Any) -> None:
    for name in names:
        if name not in valid:
            raise UnknownName(kind, name, dict.fromkeys(valid))
