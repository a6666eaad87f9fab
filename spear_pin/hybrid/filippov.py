"""Motion on the switching surface between two domains, after Filippov.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch
alternates between them without end. The toe then stays on the ground without force, and each law
acts for the share that keeps it there: the limit of laws blended over an ever thinner layer of toe
speeds. A switch with a delay or hysteresis would bounce instead; that is not modelled.

At the end of such motion one law alone keeps the toe where it is, as long as its phase has just
begun. As the phase goes on it may undo that: a latched spring pulls. The laws then go on alternating,
in turns that grow from nothing; the motion is carried on beyond its end until they last.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import OPEN, Alternation, Domain, Guard, Held, HybridSystem, Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.hardware import blended
from spear_pin.hybrid.modes import choose, fitting
from spear_pin.hybrid.phases import AT_REST

Array = NDArray[np.float64]
CHATTER = "chatter"
MOST_AT_ONCE = 8  # events within a phase before it is left
ON_EDGE = 1e-6  # of a share: where a force fades to zero, the motion begins with one law's share all but whole
ENDS = (0, 1)  # which guards of `chatter` are its ends
BEYOND = (0.0, 1e-4, 1e-3, 1e-2)  # of a share: tried in turn


class Unloaded(Flow):
    """A stance's law while its toe bears nothing: the controller reckons with the toe at rest all the same."""

    def __init__(self, system: HybridSystem, grounded: Domain, airborne: Domain, held: Held) -> None:
        super().__init__(system, replace(grounded, contacts=airborne.contacts), held)
        self._at_rest = [toe for toe, mode in zip(system.robot.toes, grounded.contacts, strict=True) if mode != OPEN]


class Sliding(Flow):
    """ẏ = α f_stance + (1 - α) f_flight, α being such that the toe does not accelerate vertically.

    Each law acts as if its phase had just begun: what it holds is latched anew at every instant.

    Attributes:
        share: α of the last call.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Held) -> None:
        super().__init__(system, domain, held)
        assert domain.between is not None
        self._between = domain.between
        self._stance = Unloaded(system, domain.between.grounded, domain, held)
        self._kept = held
        self.share = math.nan

    def _derivative(self, t: float, y: Array) -> Array:
        self.share = math.nan
        nv, between, stance = self._nv, self._between, self._stance
        self.hold(latched(self.system, self._kept, y, between.leave))
        stance.hold(latched(self.system, self._kept, y, between.touch, *between.follow))
        flight_slope, stance_slope = super()._derivative(0.0, y), stance(0.0, y)
        fall, rise = self.toe_acceleration(between.toe)[1], stance.toe_acceleration(between.toe)[1]
        self.share = share = fall / (fall - rise)
        self.u = [share * s + (1.0 - share) * f for s, f in zip(stance.u, self.u, strict=True)]
        self._applied = share * np.array(stance._applied) + (1.0 - share) * np.array(self._applied)
        if self.driven is not None and stance.driven is not None:
            self.driven = blended(share, stance.driven, self.driven)
        for toe, _ in self._closed:
            pairs = zip(stance.force(toe), self.force(toe), strict=True)
            tangential, normal = (share * s + (1.0 - share) * f for s, f in pairs)
            self._forces[toe] = tangential, normal
        if self._has_friction:
            self._holding = share * stance._holding + (1.0 - share) * self._holding
            self.friction = share * stance.friction + (1.0 - share) * self.friction
        derivative: Array = share * stance_slope + (1.0 - share) * flight_slope
        self.a = derivative[nv : 2 * nv]
        return derivative


def flow_of(system: HybridSystem, domain: Domain, held: Held) -> Flow:
    """The flow of a domain."""
    return Flow(system, domain, held) if domain.between is None else Sliding(system, domain, held)


def chatter(between: Alternation, beyond: float = 0.0) -> Domain:
    """The domain of motion between two others; it ends when one of them alone can go on.

    It belongs to the airborne phase, whose other events may happen in it: the toe bears nothing and
    its spring is not engaged.

    Args:
        between: the two domains.
        beyond: how far beyond 0 and 1 the share may go.
    """
    airborne = between.airborne

    def grounded_alone(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return 1.0 - dyn.share + beyond

    def airborne_alone(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
        return dyn.share + beyond

    kept = tuple(guard for guard in airborne.guards if guard.reset is not between.touch)
    return replace(
        airborne,
        name=CHATTER,
        guards=(
            Guard(_name(airborne, between.touch), grounded_alone, between.touch, tolerance=ON_EDGE),
            Guard(_name(between.grounded, between.leave), airborne_alone, between.leave, tolerance=ON_EDGE),
            *kept,
        ),
        between=between,
    )


def sliding(system: HybridSystem, flow: Flow, guard: Guard, came: tuple[Domain, Reset], y: Array) -> Sliding | None:
    """Motion on the switching surface, if the phase that `guard` leads to would be left at once for this one again.

    Args:
        system: the system.
        flow: the present motion, left as soon as it was entered.
        guard: by which it is left.
        came: the domain before it, and the reset by which that was left.
        y: the state.
    """
    assert guard.reset is not None
    between = alternation(system, (flow.domain, came[0]), (guard.reset, came[1]))
    nq, nv = system.robot.nq, system.robot.nv
    q, v = y[:nq], y[nq : nq + nv]
    if between is None or abs(system.robot.toe_jacobian(q, between.toe)[1] @ v) > AT_REST:
        return None
    follow, left, held = _entered(system, flow.held, y, between.touch)
    if left is not between.leave or _entered(system, held, y, left)[1] is not between.touch:
        return None
    return _alternating(system, replace(between, follow=follow), flow.held, y)


def going_on(system: HybridSystem, flow: Flow, held: Held, y: Array) -> Sliding | None:
    """Motion on the same switching surface after a joint with dry friction has come to rest, or has been let go."""
    between = flow.domain.between
    return None if between is None or not flow.domain.rubs else _alternating(system, between, held, y)


def _alternating(system: HybridSystem, between: Alternation, held: Held, y: Array) -> Sliding | None:
    modes = [
        replace(between, airborne=airborne, grounded=replace(between.grounded, rubs=airborne.rubs))
        for airborne in system.of_phase(between.airborne.phase)
    ]
    for beyond in BEYOND:
        result = fitting(system, (Sliding(system, chatter(mode, beyond), held) for mode in modes), 0.0, y)
        ends = Watch(result, 0.0, y).at_once in ENDS
        result(0.0, y)
        if not ends and -beyond - ON_EDGE < result.share < 1.0 + beyond + ON_EDGE:
            return result
    return None


def _entered(system: HybridSystem, held: Held, y: Array, reset: Reset) -> tuple[tuple[Reset, ...], Reset | None, Held]:
    """What happens at once after a reset: events within the phase, the reset that leaves it, what is held then."""
    assert reset.phase is not None
    held = latched(system, held, y, reset)
    follow: list[Reset] = []
    while len(follow) < MOST_AT_ONCE:
        flow = choose(system, reset.phase, held, 0.0, y)
        index = Watch(flow, 0.0, y).at_once
        then = None if index is None else flow.domain.guards[index].reset
        if then is None or then.phase is not None:
            return tuple(follow), then, held
        follow.append(then)
        held = latched(system, held, y, then)
    return tuple(follow), None, held


def latched(system: HybridSystem, held: Held, y: Array, *resets: Reset) -> Held:
    """What is held after resets."""
    q, v = y[: system.robot.nq].tolist(), y[system.robot.nq : system.robot.nq + system.robot.nv].tolist()
    for reset in resets:
        if reset.latch is not None:
            held = {**held, **reset.latch(q, v, held, system.law)}
    return held


def alternation(system: HybridSystem, domains: Sequence[Domain], resets: Sequence[Reset]) -> Alternation | None:
    """What two domains that lead into each other make: None unless just one of them has a toe on the ground.

    Args:
        system: the system.
        domains: the two domains.
        resets: the reset by which each of them is left.
    """
    for (grounded, airborne), (leave, touch) in ((domains, resets), (domains[::-1], resets[::-1])):
        closed = [
            toe
            for toe, on, off in zip(system.robot.toes, grounded.contacts, airborne.contacts, strict=True)
            if on != OPEN and off == OPEN
        ]
        if len(closed) == 1 and airborne.between is None:
            return Alternation(grounded, airborne, touch, leave, closed[0])
    return None


def _name(domain: Domain, reset: Reset) -> str:
    return next(guard.name for guard in domain.guards if guard.reset is reset)
