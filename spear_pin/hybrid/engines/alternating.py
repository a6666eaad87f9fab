"""Closed-loop motion on the switching surface between two domains, for scalars of any kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.engines.structure import Scalars
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.fields import adjust_law
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.shares import of_one
from spear_pin.model.mechanism import Mechanism


class Alternating:
    """Motion on the switching surface between two domains, as `filippov.Sliding`.

    Both laws act as if their phase had just begun, so that what they hold is latched anew at every instant. What does
    not depend on the laws is as in the flight. For the arguments see `Motion`; `domain` is that of the alternation.

    Raises:
        TypeError: a latch branches on a value, which symbols do not have.
    """

    def __init__(
        self,
        system: HybridSystem,
        domain: Domain,
        mechanism: Mechanism,
        q: Sequence[Any],
        v: Sequence[Any],
        held: Mapping[str, Any],
        numbers: Scalars,
        ops: Any,
    ) -> None:
        between = domain.between
        assert between is not None

        unloaded = replace(between.grounded, contacts=between.airborne.contacts, rubs=between.airborne.rubs)
        bearing = [toe for toe, _ in closed_toes(system.robot.toes, between.grounded)]
        clock = Clock(0.0, numbers.springs, system, numbers.brakes)
        sides = [between.leave], between.touching
        leaves, touches = (latch_values(held, resets, q, v, numbers.law, clock=clock) for resets in sides)
        self._flight = Motion(system, between.airborne, mechanism, 0.0, q, v, leaves, numbers, ops)
        self._stance = Motion(system, unloaded, mechanism, 0.0, q, v, touches, numbers, ops, bearing)
        self._domain = domain
        self._arguments: tuple[Any, ...] = 0.0, q, v, leaves, adjust_law(numbers.law, leaves), self, ops
        fall, rise = (motion.toe_acceleration(between.toe)[1] for motion in (self._flight, self._stance))
        self._share = share = of_one(rise, fall)
        self.shares = (share,)
        self.a = self._blend(self._stance.a, self._flight.a)
        self.u = self._blend(self._stance.u, self._flight.u)

    @cached_property
    def guards(self) -> list[Any]:
        """Values of the domain's guards."""
        return [guard.value(*self._arguments) for guard in self._domain.guards]

    def __getattr__(self, name: str) -> Any:
        return getattr(self._flight, name)

    def toe_acceleration(self, toe: str) -> tuple[Any, ...]:
        """Returns the acceleration of a toe, along the ground and normal to it, in m/s²."""
        return tuple(self._blend(self._stance.toe_acceleration(toe), self._flight.toe_acceleration(toe)))

    def force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on a toe, along the ground and normal to it, in N."""
        return tuple(self._blend(self._stance.force(toe), self._flight.force(toe)))

    def foot_force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on all toes of a toe's body, along the ground and normal to it, in N."""
        return tuple(self._blend(self._stance.foot_force(toe), self._flight.foot_force(toe)))

    def _blend(self, stance: Sequence[Any], flight: Sequence[Any]) -> list[Any]:
        return [self._share * s + (1.0 - self._share) * f for s, f in zip(stance, flight, strict=True)]
