"""Motion on the switching surface between two domains, after Filippov.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch
alternates between them without end. The toe then stays on the ground without force, and each law
acts for the share that keeps it there: the limit of laws blended over an ever thinner layer of toe
speeds. A switch with a delay or hysteresis would bounce instead; that is not modelled.
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

Array = NDArray[np.float64]
CHATTER = "chatter"
ON_EDGE = 1e-6  # of a share: where a force fades to zero, the motion begins with one law's share all but whole


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
        self.hold(self._latched(between.leave, y))
        stance.hold(self._latched(between.touch, y))
        flight_slope, stance_slope = super()._derivative(0.0, y), stance(0.0, y)
        rise, fall = self.toe_acceleration(between.toe)[1], stance.toe_acceleration(between.toe)[1]
        self.share = share = rise / (rise - fall)
        self.u = [share * s + (1.0 - share) * f for s, f in zip(stance.u, self.u, strict=True)]
        self._applied = share * np.array(stance._applied) + (1.0 - share) * np.array(self._applied)
        for toe, _ in self._closed:
            pairs = zip(stance.force(toe), self.force(toe), strict=True)
            tangential, normal = (share * s + (1.0 - share) * f for s, f in pairs)
            self._forces[toe] = tangential, normal
        derivative: Array = share * stance_slope + (1.0 - share) * flight_slope
        self.a = derivative[nv : 2 * nv]
        return derivative

    def _latched(self, reset: Reset, y: Array) -> Held:
        if reset.latch is None:
            return self._kept
        q, v = y[: self._nv].tolist(), y[self._nv : 2 * self._nv].tolist()
        return {**self._kept, **reset.latch(q, v, self._kept, self.system.law)}


def flow_of(system: HybridSystem, domain: Domain, held: Held) -> Flow:
    """The flow of a domain."""
    return Flow(system, domain, held) if domain.between is None else Sliding(system, domain, held)


def chatter(between: Alternation) -> Domain:
    """The domain of motion between two others; it ends when one of them alone can go on.

    It belongs to the airborne phase, whose other events may happen in it: the toe bears nothing and
    its spring is not engaged.
    """
    airborne = between.airborne
    kept = tuple(guard for guard in airborne.guards if guard.reset is not between.touch)
    return replace(
        airborne,
        name=CHATTER,
        guards=(
            Guard(_name(airborne, between.touch), _grounded_alone, between.touch, tolerance=ON_EDGE),
            Guard(_name(between.grounded, between.leave), _airborne_alone, between.leave, tolerance=ON_EDGE),
            *kept,
        ),
        between=between,
    )


def _grounded_alone(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
    return 1.0 - dyn.share


def _airborne_alone(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Any, ops: Any) -> Any:
    return dyn.share


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
