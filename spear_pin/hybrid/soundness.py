"""Checks that an automaton is consistent when it is made: every name in it must exist."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue, UnknownName, list_names
from spear_pin.hybrid.contact import CONTACTS, OPEN, PINNED, SIGN
from spear_pin.hybrid.domain import Domain, Held, Latch, Mount, Reset
from spear_pin.hybrid.reasons import REASONS
from spear_pin.model.path import Path
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import find_spanned
from spear_pin.model.round_feet import parts_of


class Latched(dict[str, Any]):
    """Held values; an unknown name is refused with a list of the known names."""

    def __missing__(self, name: str) -> Any:
        raise UnknownName("latched value", name, self)


class _Missing(Exception):
    """Raised for a name without a value, as long as others may still be latched."""


class _Probe(Latched):
    """Held values; whoever asks for an unknown name is to wait."""

    def __missing__(self, name: str) -> Any:
        raise _Missing(name)


def check(
    robot: Robot,
    domains: Sequence[Domain],
    law: Any,
    guess: Callable[[], tuple[Any, Any]],
    springs: Collection[str],
) -> None:
    """Checks that every name in the domains exists.

    Contacts must be modes, one for each toe. Paths of springs and friction must be on joints. Events must lead into
    phases, strike toes, release engaged springs and end for known reasons. Where springs rest must be latched.

    Args:
        robot: the robot.
        domains: domains of all phases.
        law: parameters of the control law.
        guess: returns a state (q, v) at which latches can be called.
        springs: names of the system's springs.

    Raises:
        UnknownName: one of these names does not exist; the message lists the valid ones.
        BadValue: contacts are not one for each toe, or an event both resets and ends.
    """
    phases = {domain.phase: domain.contacts for domain in reversed(domains)}  # with the contacts of its first domain
    for domain in domains:
        _check_domain(robot, domain, springs)
        for name, reset, ends in _events(domain):
            place = name, domain.name
            if reset is not None and ends is not None:
                expected = "None for an event with a reset: a run either goes on or ends"
                raise BadValue("ends of {!r} in domain {!r}".format(*place), ends, expected)
            if ends is not None:
                _known("reason of {!r} in domain {!r}", place, [ends], REASONS)
            if reset is not None:
                _check_reset(robot, domain, reset, phases, place)
                _check_pinned(reset, phases, place)
    _check_rests(domains, law, guess, {parts_of(toe): (0.0, 0.0) for toe in robot.arcs})


def _check_domain(robot: Robot, domain: Domain, springs: Collection[str]) -> None:
    toes, place = robot.toes, (domain.name,)
    if len(domain.contacts) != len(toes):
        expected = f"{len(toes)}, one for each of {', '.join(toes)}" if toes else "none, as the robot has no toes"
        raise BadValue(f"contacts of domain {domain.name!r}", domain.contacts, expected)
    _known("contact of domain {!r}", place, domain.contacts, CONTACTS)
    _check_feet(robot, domain)
    names = [mount.name for mount in domain.mounts]
    if twice := next((name for name in names if names.count(name) > 1), ""):
        raise BadValue(f"springs of domain {domain.name!r}", names, f"each name once, and not {twice!r} again")
    _known("spring of a mount of domain {!r}", place, [mount.of for mount in domain.mounts if mount.of], springs)
    for mount in domain.mounts:
        if not springs:
            raise BadValue("HybridSystem.springs", springs, f"the spring of the mount {mount.name!r}, by name")
        _check_path(f"the spring {mount.name!r}", mount.along, robot, domain)
        if mount.spring.hysteresis and mount.way is None:
            what = f"way of the spring {mount.name!r} of domain {domain.name!r}"
            raise BadValue(what, None, "the name of a held value, as the spring has hysteresis")
    for rub in domain.rubs:
        _check_path("dry friction", rub.along, robot, domain)


def _check_feet(robot: Robot, domain: Domain) -> None:
    """Refuses toes of one body on the ground that bind the same motion: in space, a third one, or if it cannot turn."""
    for foot in {*robot.feet.values()}:
        closed = [toe for toe, mode in zip(robot.toes, domain.contacts, strict=True) if toe in foot and mode != OPEN]
        if len(closed) < 2:
            continue
        flat = f"contacts of domain {domain.name!r}", domain.contacts
        if robot.dimension == 3 or len(closed) > 2:
            most = "one toe of a body in space" if robot.dimension == 3 else "two toes of a body"
            raise BadValue(*flat, f"at most {most} on the ground, not {list_names(closed)}")
        q = pin.integrate(robot.model, pin.neutral(robot.model), np.linspace(0.3, 0.7, robot.nv))
        if np.linalg.matrix_rank(np.concatenate([robot.toe_jacobian(q, toe) for toe in closed])) < 3:
            raise BadValue(
                *flat, f"one of {list_names(closed)} on the ground, as both bind less than x, z and turn of a body"
            )


def moves_as_one(robot: Robot, domain: Domain) -> bool:
    """Tells whether toes of one body that are on the ground all rest or all slide to the same side."""
    ways = {toe: SIGN.get(mode, 0.0) for toe, mode in zip(robot.toes, domain.contacts, strict=False) if mode != OPEN}
    return all(len({ways[toe] for toe in foot if toe in ways}) < 2 for foot in robot.feet.values())


def _check_path(name: str, path: Path, robot: Robot, domain: Domain) -> None:
    try:
        find_spanned(path, robot)
    except UnknownName as error:
        raise UnknownName(f"{error.kind} of {name} of domain {domain.name!r}", error.value, error.valid) from None


def _events(domain: Domain) -> Iterator[tuple[str, Reset | None, str | None]]:
    for guard in domain.guards:
        yield guard.name, guard.reset, guard.ends
    if domain.switch is not None:
        yield domain.switch.name, domain.switch.reset, None


def _check_reset(robot: Robot, domain: Domain, reset: Reset, phases: Iterable[str], place: tuple[str, ...]) -> None:
    if reset.phase is not None:
        _known("phase entered by the reset of {!r} in domain {!r}", place, [reset.phase], phases)
    _known("toe that strikes by the reset of {!r} in domain {!r}", place, reset.impact, robot.toes)
    engaged = [mount.name for mount in domain.mounts]
    _known("spring that is released by the reset of {!r} in domain {!r}", place, reset.release, engaged)


def _check_pinned(reset: Reset, phases: Mapping[str, Sequence[str]], place: tuple[str, ...]) -> None:
    """Refuses an impact that pins some toes, and leaves others to friction."""
    after = phases.get(reset.phase or "", ())
    closed = {mode for mode in after if mode != OPEN}
    if reset.impact and PINNED in closed and len(closed) > 1:
        what = "contacts of phase {!r}, which the reset of {!r} in domain {!r} enters by an impact"
        raise BadValue(what.format(reset.phase, *place), after, "all toes on the ground pinned, or none")


def _check_rests(domains: Sequence[Domain], law: Any, guess: Callable[[], tuple[Any, Any]], known: Held) -> None:
    """Checks that some reset latches every rest angle and taut value; skips latches that cannot be called."""
    if not any(domain.mounts for domain in domains):
        return
    resets = [reset for domain in domains for _, reset, _ in _events(domain) if reset]
    latches = [reset.latch for reset in resets if reset.latch]
    mounts = [edge.mount for reset in resets for edge in reset.edges]
    switched = {**known, **{name: 0.0 for mount in mounts for name in _names_held(mount)}}
    try:
        q, v = (list(map(float, part)) for part in guess())
        held, missing = _held(list({id(latch): latch for latch in latches}.values()), q, v, law, switched)
    except Exception:  # a user function may raise anything at a state that a run need not reach
        return
    if missing is not None:
        raise UnknownName("latched value", missing, held)
    for domain in domains:
        for mount in domain.mounts:
            place = mount.name, domain.name
            _known("latched value of the spring {!r} in domain {!r}", place, _names_held(mount), held)


def _names_held(mount: Mount) -> list[str]:
    """Returns the names of the held values of a spring."""
    names = mount.rest, mount.taut, mount.on, mount.tooth, mount.slips, mount.way
    return [name for name in names if isinstance(name, str)]


def _held(
    latches: Sequence[Latch], q: list[float], v: list[float], law: Any, known: Held
) -> tuple[Latched, str | None]:
    """Calls each latch once the values that it reads are held; returns the held values, and the last missing name."""
    held, waiting = _Probe(known), latches
    while True:
        asked, waiting, missing = waiting, list[Latch](), None
        for latch in asked:
            try:
                held.update(latch(q, v, held, law))
            except _Missing as error:
                waiting, missing = [*waiting, latch], error.args[0]
        if len(waiting) in (0, len(asked)):
            return held, missing


def _known(kind: str, place: tuple[str, ...], names: Sequence[str], valid: Any) -> None:
    for name in names:
        if name not in valid:
            raise UnknownName(kind.format(*place), name, dict.fromkeys(valid))
