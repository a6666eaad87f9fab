"""The derivatives of a cycle along its arcs, the order of its events, and the events that coincide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc, Record
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.rules.entry import AWAY, CHANGE
from spear_pin.hybrid.tangent.collocation import Carried, rule
from spear_pin.hybrid.tangent.fields import Values

SHORTEST = 1e-9  # s: along a shorter arc derivatives do not change
BEGIN, END = -2, -1  # places behind Gauss's points


@dataclass(eq=False)
class Stretch:
    """An arc with derivatives at k places: Gauss's points of its panels in order of time, its beginning, its end.

    Attributes:
        arc: the arc.
        y: states, (2 nv, k).
        carried: derivatives of the states, at a fixed time since the event before the arc.
        lag: by how much later that event happens on the fixed clock, (c,).
        said: the domain's values at the places, (..., k).
        slopes: derivatives of those values along the state, c further directions and the clock,
            (..., k, 2 nv + c + 1).
        held: held values, dual where they have a derivative.
        since: derivative of the time at which the arc begins, (c,).
        tau: derivative of the time at which the arc ends, (c,); set last.
    """

    arc: Arc
    y: Array
    carried: Carried
    lag: Array
    said: Values
    slopes: Values
    held: Mapping[str, Any]
    since: Array
    tau: Array = field(init=False)

    @property
    def weights(self) -> Array:
        """Weights of an integral over the arc, (k,), zero at its ends."""
        return np.append(np.outer(self.carried.lengths, rule().weights), [0.0, 0.0])

    @cached_property
    def dy(self) -> Array:
        """Derivatives of the states at a fixed clock, (2 nv, k, c)."""
        begins = self.carried.begins
        moving = np.concatenate([self.carried.inside(), begins[0][:, None], self.last[:, None]], axis=1)
        return moving - self.said.slopes[..., None] * self.lag

    @property
    def dstate(self) -> Array:
        """Derivatives of the state at the arc's end, at the fixed clock, (2 nv, c)."""
        return self._dy_at(END)

    @property
    def last(self) -> Array:
        """Derivatives of the state at the arc's end, at a fixed time since the event before it, (2 nv, c)."""
        return self.carried.begins[0] if self.at_once else self.carried.end

    @cached_property
    def dsaid(self) -> Values:
        """Derivatives of the domain's values at a fixed clock, (..., k, c)."""
        n, slopes = len(self.y), self.slopes.rows
        chained = (slopes[..., :n].swapaxes(0, 1) @ self.dy.swapaxes(0, 1)).swapaxes(0, 1)
        return self.said._replace(rows=chained + slopes[..., n:-1])

    @property
    def end(self) -> Values:
        """The domain's values at the arc's end, (...)."""
        return self.said._replace(rows=self.said.rows[:, END])

    def at(self, place: int, slopes: Array) -> tuple[Any, Array]:
        """Returns rates along the motion at one end of the arc, (...), and derivatives at the fixed clock, (..., c).

        Args:
            place: `BEGIN` or `END`.
            slopes: slopes of some of the domain's values at that end, (..., 2 nv + c + 1).
        """
        n, along, dy = len(self.y), self.said.slopes[:, place], self._dy_at(place)
        return slopes[..., :n] @ along + slopes[..., -1], slopes[..., :n] @ dy + slopes[..., n:-1]

    def _dy_at(self, place: int) -> Array:
        """Returns the derivatives of the state at the beginning or the end, (2 nv, c)."""
        moving = self.carried.begins[0] if place == BEGIN else self.last
        found: Array = moving - self.said.slopes[:, place, None] * self.lag
        return found

    @cached_property
    def rates(self) -> Values:
        """Rates of the domain's values along the motion, at the beginning and at the end, (..., 2)."""
        rates = [self.at(place, self.slopes.rows[:, place])[0] for place in (BEGIN, END)]
        return self.said._replace(rows=np.stack(rates, axis=1))

    @property
    def rate(self) -> Values:
        """Rates of the domain's values at the end, (...)."""
        return self.said._replace(rows=self.rates.rows[:, END])

    @property
    def at_once(self) -> bool:
        """Tells whether the arc's event happens as the arc begins."""
        return self.arc.end - self.arc.t <= SHORTEST

    @property
    def late(self) -> bool:
        """Tells whether the arc's event happens as the arc begins, with its guard on zero only by chance."""
        event = self.arc.event
        return isinstance(event, Guard) and self.at_once and bool(self._falls[self.place])

    @property
    def place(self) -> int:
        """Index of the guard that is the arc's event."""
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
        """Tells which guards are on zero at the end, and fall."""
        tolerances = np.array([guard.tolerance for guard in self.arc.domain.guards])
        found: NDArray[np.bool_] = (np.abs(self.end.guards) <= tolerances) & is_falling(self.rate.guards)
        return found


@dataclass(frozen=True)
class Derivative:
    """A cycle with its derivatives along c directions.

    Attributes:
        system: the system.
        record: the cycle.
        dy: derivatives of the state at its end, (2 nv, c).
        durations: duration of each phase, in s, dual.
        stretches: the arcs.
        numbers: run-time parameters without the held values, (p,).
        dnumbers: their derivatives, (p, c).
        steepness: slope at zero of the guard that falls most slowly, relative to its mean slope over its arc.
        together: whether several feet in space landed in one instant.
    """

    system: HybridSystem
    record: Record
    dy: Array
    durations: Mapping[str, Any]
    stretches: Sequence[Stretch]
    numbers: Array
    dnumbers: Array
    steepness: float
    together: bool = False

    @property
    def y(self) -> Array:
        """State just after the section at the cycle's end, (2 nv,)."""
        return self.record.y

    @property
    def order(self) -> tuple[frozenset[str], ...]:
        """Names of the events that change something, in order; names of events that coincide are in one set."""
        found: list[frozenset[str]] = []
        for each in self.stretches:
            event = each.arc.event
            if event is None or event.reset is None:
                continue
            met = frozenset([event.name, *each.meets])
            found = [*found[:-1], found[-1] | met] if each.late and found else [*found, met]
        return tuple(found)

    @property
    def borders(self) -> tuple[str, ...]:
        """Names of events that coincide with another; there derivatives are one-sided, for the order that happens.

        An immediate event whose guard is far below zero coincides with none: it stays immediate near this cycle.
        """
        begins = self.stretches[:1] if self.system.section_toes else []  # there a toe touches down in any case
        late = [each for each in self.stretches if each.late and each not in begins]
        met = [each.arc.event.name for each in self.stretches if each in late or each.meets]
        return tuple(dict.fromkeys(met))


def is_falling(rate: Any) -> Any:
    """Tells whether a guard falls fast enough for engines to notice."""
    return rate * AWAY[0] < -CHANGE
