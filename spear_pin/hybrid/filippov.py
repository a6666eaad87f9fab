"""Motion on the switching surface between two domains, after Filippov.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch
alternates between them without end. The toe then stays on the ground without force, and each law
acts for the share that keeps it there: the limit of laws blended over an ever thinner layer of toe
speeds. A switch with a delay or hysteresis would bounce instead; that is not modelled.

At the end of such motion one law alone keeps the toe in place, as long as its phase has just begun.
Later in the phase this may change, for instance because a latched spring pulls. The laws then continue
to alternate, in turns that grow from zero; the motion is continued beyond its end until the turns last.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid import shares
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import Alternation, Crossing, Domain, Guard, Held, Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.hardware import blend_responses
from spear_pin.hybrid.modes import choose, find_fitting
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.footing import closed_toes, still
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.rules.surface import BEYOND, MOST_AT_ONCE, alternation, begins, chatter, leads_round


class Unloaded(Flow):
    """The flow of a stance whose toe bears no force, while the controller still assumes the toe at rest."""

    def __init__(self, system: HybridSystem, grounded: Domain, airborne: Domain, held: Held) -> None:
        super().__init__(system, replace(grounded, contacts=airborne.contacts, rubs=airborne.rubs), held)
        self._at_rest = [toe for toe, _ in closed_toes(system.robot.toes, grounded)]


class Sliding(Flow):
    """The flow ẏ = Σ w f over alternating laws, with shares w such that no alternating toe leaves the ground.

    Each law acts as if its phase had just begun: its held values are latched anew at every instant.

    Attributes:
        shares: share of the time that each toe's switch is closed, in the last call.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Held) -> None:
        super().__init__(system, domain, held)
        *others, (_, self._latches) = _turns(domain)
        self._turns = [(Unloaded(system, other, domain, held), resets) for other, resets in others]
        self._kept = held
        self.shares: tuple[float, ...] = ()

    def _derivative(self, t: float, y: Array) -> Array:
        nv = self._nv
        before, self.shares = self.shares, (math.nan,) * len(self.domain.alternating)
        self.hold(hold_after(self.system, self._kept, y, *self._latches))
        for flow, resets in self._turns:
            flow.hold(hold_after(self.system, self._kept, y, *resets))
        slopes = [*(flow(0.0, y) for flow, _ in self._turns), super()._derivative(0.0, y)]
        flows = [*(flow for flow, _ in self._turns), self]
        accelerations = [[flow.toe_acceleration(toe)[-1] for toe in self.domain.alternating] for flow in flows]
        if len(self.domain.alternating) == 1:
            share = shares.of_one(*(vertical for (vertical,) in accelerations))
            self.shares, weights = (share,), [share, 1.0 - share]
        else:
            self.shares = shares.of_two(np.array(accelerations), before if np.isfinite(before).all() else ())
            weights = shares.weights(*self.shares).tolist()

        def mixed(values: Iterable[Any]) -> Any:
            return sum(weight * value for weight, value in zip(weights, values, strict=True))

        self.u = [mixed(torques) for torques in zip(*(flow.u for flow in flows), strict=True)]
        self._applied = mixed(flow._applied for flow in flows)
        driven = [flow.driven for flow in flows if flow.driven is not None]
        if driven:
            self.driven = blend_responses(weights, driven)
        for toe, _ in self._closed:
            self._forces[toe] = tuple(map(mixed, zip(*(flow.force(toe) for flow in flows), strict=True)))
        if self._has_friction:
            self._holding = mixed(flow._holding for flow in flows)
            self.friction = mixed(flow.friction for flow in flows)
        derivative: Array = mixed(slopes)
        self.a = derivative[nv : 2 * nv]
        return derivative


def _turns(domain: Domain) -> list[tuple[Domain, tuple[Reset, ...]]]:
    """Returns the alternating domains, the one that `domain` is made of last, and the resets that enter each."""
    if domain.between is not None:
        return [(domain.between.grounded, domain.between.touching), (domain.between.airborne, (domain.between.leave,))]
    assert domain.crossing is not None
    surfaces, turns = domain.crossing.surfaces, []
    for toe, bears, other in shares.TURNS:
        before, after = surfaces[1 - toe][not bears], surfaces[toe][other]
        resets = *(before.touching if other else (before.leave,)), *(after.touching if bears else (after.leave,))
        turns.append((after.grounded if bears else after.airborne, resets))
    return turns


def flow_of(system: HybridSystem, domain: Domain, held: Held) -> Flow:
    """Returns the flow of a domain."""
    return Sliding(system, domain, held) if domain.alternating else Flow(system, domain, held)


def find_sliding(
    system: HybridSystem, flow: Flow, guard: Guard, came: tuple[Domain, Reset], y: Array
) -> Sliding | None:
    """Finds the motion on the switching surface, if the phase that `guard` leads to would lead back at once.

    Args:
        system: the system.
        flow: the present motion, which is left as soon as it was entered.
        guard: the guard by which it is left.
        came: the domain before it, and the reset by which that domain was left.
        y: the state.
    """
    assert guard.reset is not None
    between = alternation(system, (flow.domain, came[0]), (guard.reset, came[1]))
    if between is None or not _rest(system, [between.toe], y):
        return None
    follow, left, held = enter_resets(system, flow.held, y, between.touch)
    again = None if left is None else enter_resets(system, held, y, left)[1]
    if not leads_round(between, left, again):
        return None
    return find_alternating(system, replace(between, follow=follow), flow.held, y)


def continue_sliding(system: HybridSystem, flow: Flow, held: Held, y: Array) -> Sliding | None:
    """Finds the motion on the same switching surfaces after an event within the phase, such as slip of another toe.

    There is none where the event lifted one of the toes.
    """
    between = flow.domain.crossing or flow.domain.between
    if between is None or not _rest(system, flow.domain.alternating, y):
        return None
    return find_alternating(system, between, held, y)


def _rest(system: HybridSystem, toes: Iterable[str], y: Array) -> bool:
    """Tells whether toes on the ground neither rise nor sink."""
    nq, nv = system.robot.nq, system.robot.nv
    q, v = y[:nq], y[nq : nq + nv]
    return all(still(system.ground.foot(system.robot, q, toe)[1][-1] @ v) for toe in toes)


def find_alternating(
    system: HybridSystem, between: Alternation | Crossing, held: Held, y: Array, far: Sequence[float] = BEYOND
) -> Sliding | None:
    """Finds the motion between domains, if their laws' shares allow it or, tried in turn, are not `far` beyond."""
    for beyond in far:
        flows = (Sliding(system, chatter(mode, beyond), held) for mode in _modes(system, between, held))
        result = find_fitting(system, flows, 0.0, y)
        event = Watch(result, 0.0, y).at_once
        result(0.0, y)
        if begins(event, result.shares, beyond):
            return result
    return None


def _modes(system: HybridSystem, between: Alternation | Crossing, held: Held) -> Iterator[Alternation | Crossing]:
    """Yields alternations or crossings like this one, with every mode of the other contacts and of dry friction."""
    first = between if isinstance(between, Alternation) else between.surfaces[0][0]
    modes = (domain for domain in system.of_phase(first.airborne.phase) if domain.suits(held))
    if isinstance(between, Alternation):
        for airborne in modes:
            yield replace(between, airborne=airborne)
        return
    (alone, beside), others = between.surfaces
    for airborne in modes:
        yield replace(between, surfaces=((replace(alone, airborne=airborne), beside), others))


def enter_resets(
    system: HybridSystem, held: Held, y: Array, reset: Reset
) -> tuple[tuple[Reset, ...], Reset | None, Held]:
    """Returns the resets that follow a reset at once, within the phase and out of it, and the values held then."""
    assert reset.phase is not None
    held = hold_after(system, held, y, reset)
    follow: list[Reset] = []
    while len(follow) < MOST_AT_ONCE:
        flow = choose(system, reset.phase, held, 0.0, y)
        index = Watch(flow, 0.0, y).at_once
        then = None if index == NONE else flow.domain.guards[index].reset
        if then is None or then.phase is not None:
            return tuple(follow), then, held
        follow.append(then)
        held = hold_after(system, held, y, then)
    return tuple(follow), None, held


def hold_after(system: HybridSystem, held: Held, y: Array, *resets: Reset) -> Held:
    """Returns the values held after resets at a state."""
    nq, nv = system.robot.nq, system.robot.nv
    q, v, clock = y[:nq].tolist(), y[nq : nq + nv].tolist(), Clock(0.0, system.springs, system)
    return latch_values(held, resets, q, v, system.law, system.place_of, clock=clock)
