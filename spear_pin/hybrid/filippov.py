"""Motion on the switching surface between two domains, after Filippov.

Where the stance law unloads the toe and the flight law presses it down, an ideal foot switch
alternates between them without end. The toe then stays on the ground without force, and each law
acts for the share that keeps it there: the limit of laws blended over an ever thinner layer of toe
speeds. A switch with a delay or hysteresis would bounce instead; that is not modelled.
"""

from __future__ import annotations

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


class Sliding(Flow):
    """ẏ = α f_stance + (1 - α) f_flight, α being such that the toe does not accelerate vertically.

    Each part acts as if its phase had just begun: what it holds is latched anew at every instant.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Held) -> None:
        super().__init__(system, domain, held)
        assert domain.between is not None
        self._between = domain.between
        grounded, airborne = self._between.grounded, self._between.airborne
        unloaded = replace(grounded, contacts=airborne.contacts)
        self._parts = (Flow(system, unloaded, held), Flow(system, airborne, held))
        self.share = 0.0

    def _derivative(self, t: float, y: Array) -> Array:
        super()._derivative(t, y)  # places the frames that guards ask for
        nv = self._nv
        q, v = y[:nv].tolist(), y[nv : 2 * nv].tolist()
        slopes, rises = [], []
        for part, reset in zip(self._parts, (self._between.touch, self._between.leave), strict=True):
            if reset.latch is not None:
                part.hold({**self.held, **reset.latch(q, v, self.held, self.system.law)})
            slopes.append(part(0.0, y))
            rises.append(part.toe_acceleration(self._between.toe)[1])
        self.share = share = rises[1] / (rises[1] - rises[0])
        stance, flight = self._parts
        self.u = [share * s + (1.0 - share) * f for s, f in zip(stance.u, flight.u, strict=True)]
        self._applied = share * np.array(stance._applied) + (1.0 - share) * np.array(flight._applied)
        derivative: Array = share * slopes[0] + (1.0 - share) * slopes[1]
        self.a = derivative[nv : 2 * nv]
        return derivative


def flow_of(system: HybridSystem, domain: Domain, held: Held) -> Flow:
    """The flow of a domain."""
    return Flow(system, domain, held) if domain.between is None else Sliding(system, domain, held)


def chatter(between: Alternation) -> Domain:
    """The domain of motion between two others; it ends when one of them alone can go on.

    It belongs to the airborne phase: the toe bears nothing and no spring is engaged.
    """
    airborne = between.airborne
    kept = tuple(guard for guard in airborne.guards if guard.reset is None)
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
