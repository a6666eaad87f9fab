"""Toes at rest on the ground that no phase leaves at rest: decides which of them bear, alternate or leave."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Alternation, Crossing, Domain, Guard, Held
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.filippov import Sliding, enter_resets, find_alternating, hold_after
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.rules.start import rests
from spear_pin.hybrid.rules.surface import BEYOND

BEARS, ALTERNATES, LEAVES = range(3)


def find_resting(system: HybridSystem, flow: Flow, y: Array, tried: Sequence[Domain] = ()) -> Sliding | None:
    """Finds a motion in which toes at rest on the ground alternate, for any sequence of phases.

    Each toe's switch acts by itself: a bearing toe keeps it closed, a leaving toe keeps it open, any other toe
    alternates. It takes the consistent motion with the most toes bearing, then with the fewest leaving.

    Args:
        system: the system.
        flow: the present motion.
        y: the state.
        tried: motions that have already ended in this instant.
    """
    q, v = y[: system.robot.nq], y[system.robot.nq : system.robot.nq + system.robot.nv]
    feet = {toe: system.ground.foot(system.robot, q, toe) for toe in system.robot.toes}
    toes = [toe for toe, (height, jacobian) in feet.items() if rests(height, jacobian[-1] @ v)]
    choices = product((BEARS, ALTERNATES, LEAVES), repeat=len(toes))
    ordered = sorted(choices, key=lambda kinds: (-kinds.count(BEARS), kinds.count(LEAVES)))
    for far, kinds in product((BEYOND[:1], BEYOND[1:]), ordered):
        try:
            found = _motion(system, flow, y, dict(zip(toes, kinds, strict=True)), far)
        except KeyError:  # a leg that has never borne has latched no values
            continue
        if found is not None and not any(_alike(found.domain, domain) for domain in tried):
            return found
    return None


def _alike(one: Domain, other: Domain) -> bool:
    """Tells whether the same toes alternate and bear in two motions."""
    bears = ([mode != OPEN for mode in domain.contacts] for domain in (one, other))
    return one.alternating == other.alternating and next(bears) == next(bears)


def _motion(system: HybridSystem, flow: Flow, y: Array, kinds: dict[str, int], far: Sequence[float]) -> Sliding | None:
    held, bearing = flow.held, {toe for toe, kind in kinds.items() if kind == BEARS}
    for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True):
        if toe in bearing and mode == OPEN:
            surface = _surface(system, held, y, toe, bearing - {toe})
            if surface is None:
                return None
            held = hold_after(system, held, y, *surface.touching)
    between = _between(system, held, y, [toe for toe, kind in kinds.items() if kind == ALTERNATES], bearing)
    found = None if between is None else find_alternating(system, between, held, y, far)
    if found is None:
        return None
    index = Watch(found, 0.0, y).at_once
    found(0.0, y)  # so that it has latched the present values a moment ahead
    then = None if index == NONE else found.domain.guards[index]
    return found if then is None or not then.leaves or then.ends == "overload" else None


def _between(
    system: HybridSystem, held: Held, y: Array, toes: list[str], bearing: set[str]
) -> Alternation | Crossing | None:
    """Returns the alternation of one toe, or the crossing of two, while others bear."""
    if len(toes) == 1:
        return _surface(system, held, y, toes[0], bearing)
    if len(toes) != 2:
        return None
    first, second = toes
    alone = [_surface(system, held, y, toe, bearing) for toe in toes]
    if alone[0] is None or alone[1] is None:
        return None
    beside = [
        _surface(system, hold_after(system, held, y, *surface.touching), y, toe, bearing | {surface.toe})
        for toe, surface in ((first, alone[1]), (second, alone[0]))
    ]
    if beside[0] is None or beside[1] is None:
        return None
    return Crossing((first, second), ((alone[0], beside[0]), (alone[1], beside[1])))


def _surface(system: HybridSystem, held: Held, y: Array, toe: str, bearing: set[str]) -> Alternation | None:
    """Returns the alternation of a toe between two phases that lead into each other, while others bear."""
    for on, leave in _with(system, bearing | {toe}):
        for off, touch in _with(system, bearing):
            leaves, touches = leave.reset, touch.reset
            assert leaves is not None and touches is not None
            if leaves.phase == off and touches.phase == on and touches.impact == (toe,):
                grounded, airborne = system.of_phase(on)[0], system.of_phase(off)[0]
                follow = enter_resets(system, held, y, touches)[0]
                return Alternation(grounded, airborne, touches, leaves, toe, follow)
    return None


def _with(system: HybridSystem, bearing: set[str]) -> Iterator[tuple[str, Guard]]:
    """Yields the phases in which exactly these toes are on the ground, and the events that leave them."""
    for phase in system.phases:
        domain = system.of_phase(phase)[0]
        closed = {toe for toe, _ in closed_toes(system.robot.toes, domain)}
        if closed == bearing:
            yield from ((phase, guard) for guard in domain.guards if guard.leaves and guard.reset is not None)
