"""Knees of a hop: a spring that never releases rests where the law lets the knee land."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.parameters import changed, rebuilt, with_numbers
from spear_pin.model.spring import Spring
from spear_pin.studies.payoff.grid import FIXED


@dataclass(frozen=True)
class AtTouchdown:
    """A change that puts the rest of a fixed spring at the angle where the law lets the knee land."""

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with such a spring."""
        return replace(system, domains=tuple(map(self._domain, system.domains)))

    def _domain(self, domain: Domain) -> Domain:
        return replace(domain, guards=tuple(map(self._guard, domain.guards)))

    def _guard(self, guard: Guard) -> Guard:
        return guard if guard.reset is None else replace(guard, reset=self._reset(guard.reset))

    def _reset(self, reset: Reset) -> Reset:
        latch = reset.latch
        if latch is None or reset.phase != "stance":
            return reset

        def landed(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
            return {**latch(q, v, held, p), "knee_touchdown": p.knee_touchdown}

        return replace(reset, latch=landed)


def tied(system: HybridSystem) -> HybridSystem:
    """Returns the system whose fixed spring, if it has one, moves with the law's angle of touchdown."""
    return system if system.spring.rest is None else changed(system, AtTouchdown())


def with_values(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns the system with other numbers; a spring that never releases rests where the knee lands."""
    other = with_numbers(system, values)
    if other.spring.rest is None:
        return other
    return rebuilt(other, spring=replace(other.spring, rest=other.law.knee_touchdown))


def with_knee(system: HybridSystem, kind: str, stiffness: float) -> HybridSystem:
    """Returns the system with another knee: a virtual spring replaces the part that the new spring lacks.

    The damper stays, without a spring too, because it belongs to the knee.

    Args:
        system: the hop of a leg.
        kind: one of `KINDS` of `grid`.
        stiffness: stiffness of its spring, in N·m/rad. It acts both ways, see `released`.
    """
    law, spring, fixed = system.law, system.spring, kind == FIXED
    law = replace(law, virtual_stiffness=max(law.virtual_stiffness + spring.stiffness - stiffness, 0.0))
    rest = law.knee_touchdown if fixed else None
    own = Spring(stiffness=stiffness, damping=spring.damping, rest=rest, unilateral=False)
    return rebuilt(system, law=law, spring=own)


def released(system: HybridSystem) -> HybridSystem:
    """Returns the system whose spring, unless it is fixed, is let go where it would push."""
    if system.spring.rest is not None:
        return system
    return rebuilt(system, spring=replace(system.spring, unilateral=True))
