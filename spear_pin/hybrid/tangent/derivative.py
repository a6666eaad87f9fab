"""A cycle's derivatives along its arcs, in what order its events come, and which of them meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.rules.entry import AWAY, CHANGE
from spear_pin.hybrid.tangent.collocation import Carried, rule
from spear_pin.hybrid.tangent.fields import Values

SHORTEST = 1e-9  # s: there is nothing to be carried along a shorter arc
BEGIN, END = -2, -1  # places behind Gauss's points


@dataclass(eq=False)
class Stretch:
    """An arc with derivatives at k places: Gauss's points of its panels in rising time, its beginning and its end.

    Attributes:
        arc: the arc.
        y: states, (2 nv, k).
        carried: their derivatives.
        dstate: derivatives of the state at its end, at the fixed clock, (2 nv, c).
        said: what the domain says there, (..., k).
        slopes: derivatives of that along the state, directions beside and the clock, (..., k, 2 nv + c + 1).
        held: what is held, dual where it has a derivative.
        since: derivative of the time at which it begins, (c,).
        tau: of the time at which it ends, (c,), of which the cycle says what it is once it knows the rest.
    """

    arc: Arc
    y: Array
    carried: Carried
    dstate: Array
    said: Values
    slopes: Values
    held: Mapping[str, Any]
    since: Array
    tau: Array = field(init=False)

    @property
    def weights(self) -> Array:
        """Of an integral over the arc, (k,), zero at its ends."""
        return np.append(np.tile(self.carried.h * rule().weights, len(self.carried.K)), [0.0, 0.0])

    @property
    def state(self) -> Array:
        """At its end, just before the event, (2 nv,)."""
        return self.arc.after

    @cached_property
    def dy(self) -> Array:
        """Derivatives of the states at a fixed clock, (2 nv, k, c)."""
        ends = np.stack([self._dy_at(BEGIN), self._dy_at(END)], axis=1)
        return np.concatenate([self.carried.inside(), ends], axis=1)

    @cached_property
    def dsaid(self) -> Values:
        """Derivatives of what the domain says at a fixed clock, (..., k, c)."""
        n, slopes = len(self.y), self.slopes.rows
        chained = (slopes[..., :n].swapaxes(0, 1) @ self.dy.swapaxes(0, 1)).swapaxes(0, 1)
        return self.said._replace(rows=chained + slopes[..., n:-1])

    @property
    def end(self) -> Values:
        """What the domain says at the end, (...)."""
        return self.said._replace(rows=self.said.rows[:, END])

    def at(self, place: int, slopes: Array) -> tuple[Any, Array]:
        """Rates along the motion at the beginning or the end, (...), and derivatives at the fixed clock, (..., c).

        Args:
            place: `BEGIN` or `END`.
            slopes: of something that the domain says there, (..., 2 nv + c + 1).
        """
        n, along, dy = len(self.y), self.said.slopes[:, place], self._dy_at(place)
        return slopes[..., :n] @ along + slopes[..., -1], slopes[..., :n] @ dy + slopes[..., n:-1]

    def _dy_at(self, place: int) -> Array:
        """Derivatives of the state at the beginning or the end, (2 nv, c)."""
        begins: Array = self.carried.begins[0]
        return begins if place == BEGIN else self.dstate

    @cached_property
    def rates(self) -> Values:
        """Rates of what the domain says along the motion, at the beginning and at the end, (..., 2)."""
        rates = [self.at(place, self.slopes.rows[:, place])[0] for place in (BEGIN, END)]
        return self.said._replace(rows=np.stack(rates, axis=1))

    @property
    def rate(self) -> Values:
        """Those at the end, (...)."""
        return self.said._replace(rows=self.rates.rows[:, END])

    @property
    def at_once(self) -> bool:
        """Whether its event happens as it begins."""
        return self.arc.end - self.arc.t <= SHORTEST

    @property
    def late(self) -> bool:
        """Whether its event happens as it begins, though nothing but chance brings its guard to zero there."""
        event = self.arc.event
        return isinstance(event, Guard) and self.at_once and bool(self._falls[self.place])

    @property
    def place(self) -> int:
        """Which of the guards is its event."""
        return next(i for i, guard in enumerate(self.arc.domain.guards) if guard is self.arc.event)

    @property
    def meets(self) -> tuple[str, ...]:
        """Names of other events whose guards fall through zero in the same instant."""
        guards, event = self.arc.domain.guards, self.arc.event
        if event is None or event.reset is None:
            return ()
        now = self._falls & (np.abs(self.end.guards) <= SHORTEST * np.abs(self.rate.guards))
        others = [i for i, guard in enumerate(guards) if guard.reset is not None and guard is not event]
        return tuple(guards[i].name for i in others if now[i])

    @property
    def _falls(self) -> NDArray[np.bool_]:
        """Which guards are on zero at the end, and fall."""
        tolerances = np.array([guard.tolerance for guard in self.arc.domain.guards])
        found: NDArray[np.bool_] = (np.abs(self.end.guards) <= tolerances) & falling(self.rate.guards)
        return found


@dataclass(frozen=True)
class Derivative:
    """A cycle with its derivatives along c directions.

    Attributes:
        system: the system.
        y: state just behind the section, (2 nv,).
        dy: its derivatives, (2 nv, c).
        durations: of each phase, in s, dual.
        stretches: the arcs.
        numbers: run-time parameters without what is held, (p,).
        dnumbers: their derivatives, (p, c).
        steepness: of the guard that falls most slowly through zero, in its mean fall over its arc.
    """

    system: HybridSystem
    y: Array
    dy: Array
    durations: Mapping[str, Any]
    stretches: Sequence[Stretch]
    numbers: Array
    dnumbers: Array
    steepness: float

    @property
    def order(self) -> tuple[frozenset[str], ...]:
        """Names of the events that change something, in order; of those that meet, together."""
        found: list[frozenset[str]] = []
        for each in self.stretches:
            event = each.arc.event
            if event is None or event.reset is None:
                continue
            met = frozenset([event.name, *each.meets])
            found = [*found[:-1], found[-1] | met] if each.late else [*found, met]
        return tuple(found)

    @property
    def borders(self) -> tuple[str, ...]:
        """Names of events that meet another: derivatives are of the order that happens, and one-sided.

        An event at once whose guard is far below zero meets none: it stays at once beside this cycle.
        """
        met = [each.arc.event.name for each in self.stretches if each.late or each.meets]
        return tuple(dict.fromkeys(met))


def falling(rate: Any) -> Any:
    """Whether a guard falls as fast as engines see."""
    return rate * AWAY[0] < -CHANGE
