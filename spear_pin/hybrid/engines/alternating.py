"""Closed-loop motion on the switching surface between two domains, for scalars of any kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.engines.structure import Scalars
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.fields import adjusted
from spear_pin.hybrid.rules.latching import latched
from spear_pin.model.mechanism import Mechanism


class Alternating:
    """Motion on the switching surface between two domains, as `filippov.Sliding`.

    Both laws act as if their phase had just begun, so that what they hold is latched anew at every instant.

    Args:
        system: the system.
        domain: the domain of the alternating motion.
        mechanism: the robot's dynamics.
        q: configuration.
        v: velocity.
        held: held values.
        numbers: the system's numbers.
        ops: elementary functions, and `solve`.

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

        unloaded = replace(between.grounded, contacts=between.airborne.contacts)
        bearing = [toe for toe, mode in zip(system.robot.toes, between.grounded.contacts, strict=True) if mode != OPEN]
        leaves, touches = (latched(held, resets, q, v, numbers.law) for resets in ([between.leave], between.touching))
        self._flight = Motion(system, between.airborne, mechanism, 0.0, q, v, leaves, numbers, ops)
        self._stance = Motion(system, unloaded, mechanism, 0.0, q, v, touches, numbers, ops, bearing)
        self._domain = domain
        self._arguments: tuple[Any, ...] = 0.0, q, v, leaves, adjusted(numbers.law, leaves), self, ops
        fall, rise = (motion.toe_acceleration(between.toe)[1] for motion in (self._flight, self._stance))
        self._share = share = fall / (fall - rise)
        self.shares = (share,)
        self.a = self._blend(self._stance.a, self._flight.a)
        self.u = self._blend(self._stance.u, self._flight.u)

    @cached_property
    def guards(self) -> list[Any]:
        """Values of the domain's guards."""
        return [guard.value(*self._arguments) for guard in self._domain.guards]

    @property
    def friction_coefficient(self) -> Any:
        """μ of the ground."""
        return self._flight.friction_coefficient

    def height(self, frame: str) -> Any:
        """Returns the distance of a frame from the ground, along its normal, in m."""
        return self._flight.height(frame)

    def direction(self, toe: str) -> tuple[Any, ...]:
        """Raises an error, since this engine has no toes in space."""
        raise NotImplementedError

    def toe_velocity(self, toe: str) -> tuple[Any, Any]:
        """Returns the velocity of a toe, along the ground and normal to it, in m/s."""
        return self._flight.toe_velocity(toe)

    def toe_acceleration(self, toe: str) -> tuple[Any, Any]:
        """Returns the acceleration of a toe, along the ground and normal to it, in m/s²."""
        x, z = self._blend(self._stance.toe_acceleration(toe), self._flight.toe_acceleration(toe))
        return x, z

    def force(self, toe: str) -> tuple[Any, Any]:
        """Returns the ground force on a toe, along the ground and normal to it, in N."""
        x, z = self._blend(self._stance.force(toe), self._flight.force(toe))
        return x, z

    def pivot(self, toe: str) -> Any:
        """Returns the effective inverse mass of the normal force of a slipping toe, in 1/kg."""
        return self._flight.pivot(toe)

    def _blend(self, stance: Sequence[Any], flight: Sequence[Any]) -> list[Any]:
        return [self._share * s + (1.0 - self._share) * f for s, f in zip(stance, flight, strict=True)]
