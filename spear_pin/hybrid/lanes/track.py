"""A lane on its own, from section to section, as long as nothing calls for a second look.

Where `journey` decides for many lanes whatever may come, this goes one cycle through what is clear at a glance: a
domain that fits, guards that rise from zero, impacts of one toe. At anything else it gives up, and the cycle is run
again by `journey`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import Domain, Guard, Reset, Switch
from spear_pin.hybrid.engines.layout import flattened
from spear_pin.hybrid.engines.single import Single
from spear_pin.hybrid.engines.taylor import KINK, TIME_LIMIT
from spear_pin.hybrid.lanes.groups import Held
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.run import AT_ONCE, INSTANT, struck_toes

Array = NDArray[np.float64]
MOVES = 1e-14  # of a guard's change within `single.AHEAD`, in its unit
EVENTS = 50  # of a cycle


@dataclass(frozen=True)
class Lap:
    """A cycle.

    Attributes:
        y: state just behind the section.
        held: what is held there.
        spent: seconds in each phase.
        observed: states at the last of the events that change nothing, by name.
        came: the last domain, and the reset by which it was left.
    """

    y: Array
    held: Held
    spent: Mapping[str, float]
    observed: Mapping[str, Array]
    came: tuple[Domain, Reset]


class Track:
    """One lane's cycles.

    Args:
        numbers: the lanes'.
        lane: which of them.
    """

    def __init__(self, numbers: Numbers, lane: int) -> None:
        self._compiled, self._system, self._nv = numbers.compilation, numbers.system, numbers.nv
        self._law, self._constants = numbers.law_of(lane), numbers.constants(lane)
        self._friction = float(numbers.friction(np.array(lane)))

    def lap(self, y: Array, held: Held) -> Lap | None:
        """The cycle from a state just behind the section, or None."""
        system = self._system
        phase, t, switches = system.section_phase, 0.0, 0
        spent, observed = dict.fromkeys(system.phases, 0.0), {}
        ready: Single | None = None
        for _ in range(EVENTS):
            parameters = np.array(self._constants + flattened(held.values()))
            domains = system.of_phase(phase) if ready is None else (ready.domain,)
            entered = self._enter(domains, t, y, held, parameters)
            if entered is None:
                return None
            ready, t, y, end = entered
            switch = ready.domain.switch
            at = math.inf if switch is None else switch.time(switches + 1, self._law)
            until = min(at, system.phase_limit)
            if t >= until:
                return None
            if end is None:
                t, y, end = ready.run(t, y, until, parameters)
            if end == KINK:
                continue
            if end >= 0 and ready.domain.guards[end].observes:
                observed[ready.domain.guards[end].name] = y
                continue
            if end >= 0:
                event: Guard | Switch | None = ready.domain.guards[end]
            else:
                event, switches = switch if end == TIME_LIMIT and until == at else None, switches + 1
            if event is None or event.reset is None:
                return None
            after = self._reset(ready.domain, event.reset, y, held, parameters)
            if after is None:
                return None
            (y, held), left, ready = after, ready.domain, None
            if event.reset.phase is not None:
                spent[phase] += t
                phase, t, switches = event.reset.phase, 0.0, 0
            if event.name == system.section:
                return Lap(y, held, spent, observed, (left, event.reset)) if sum(spent.values()) > INSTANT else None
        return None

    def _enter(
        self, domains: Iterable[Domain], t: float, y: Array, held: Held, parameters: Array
    ) -> tuple[Single, float, Array, int | None] | None:
        """The first domain that fits, with a state there, now or soon, at which its guards are positive.

        If one falls at once instead, its index comes last.
        """
        for domain in domains:
            ready = self._compiled.single(domain, held)
            here = ready.look(t, y, parameters, self._friction)
            if here.fits:
                break
        else:
            return None
        if not (here.waiting or here.bent):
            return ready, t, y, None
        there = ready.ahead(here, parameters, self._friction)
        change = [(there.guards[i] - here.guards[i], i) for i in here.waiting]
        falls = [i for by, i in change if by < 0.0]
        if here.lost or not all(abs(by) > MOVES for by, _ in change) or (falls and t <= AT_ONCE):
            return None
        if falls:
            return ready, t, y, falls[0]
        return (ready, there.t, there.y, None) if there.clear else None

    def _reset(
        self, domain: Domain, reset: Reset, y: Array, held: Held, parameters: Array
    ) -> tuple[Array, Held] | None:
        """What an event does, unless several toes strike."""
        nv = self._nv
        if reset.impact:
            toes = struck_toes(self._system, domain, reset)
            if len(toes) > 1:
                return None
            y = self._compiled.impact(toes[0])(y, parameters, self._friction)
        if reset.latch is not None:
            now = y.tolist()
            try:
                held = {**held, **reset.latch(now[:nv], now[nv:], held, self._law)}
            except ArithmeticError:
                return None
        return y, held
