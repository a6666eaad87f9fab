"""A lane on its own, from section to section, as long as nothing calls for a second look.

Where `journey` decides for many lanes whatever may come, this goes one cycle through what is clear at a glance: a
domain that fits, guards that rise from zero, impacts of one toe. At anything else it gives up, and the cycle is run
again by `journey`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import Domain, Guard, Reset, Switch
from spear_pin.hybrid.engines.layout import flattened, shape_of
from spear_pin.hybrid.engines.single import UNCLEAR, Entry, Single
from spear_pin.hybrid.engines.taylor import KINK, TIME_LIMIT
from spear_pin.hybrid.lanes.groups import Held
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.rules.cycles import crowded, due, left_at_once, retouches, whole
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.impact import struck_toes
from spear_pin.hybrid.rules.latching import latched

Array = NDArray[np.float64]
EVENTS = 50  # of a cycle
FEW_AT_ONCE = 4  # events in an instant


class Lap(NamedTuple):
    """A cycle.

    Attributes:
        y: state just behind the section.
        held: what is held there.
        spent: seconds in each phase.
        observed: states at the last of the events that change nothing, by name.
        phase: the phase that begins there.
        came: the last domain, and the reset by which it was left.
        ago: how long ago each toe was on the ground, in s.
    """

    y: Array
    held: Held
    spent: Mapping[str, float]
    observed: Mapping[str, Array]
    phase: str
    came: tuple[Domain, Reset]
    ago: list[float]


class Track:
    """One lane's cycles.

    Args:
        numbers: the lanes'.
        lane: which of them.
    """

    def __init__(self, numbers: Numbers, lane: int) -> None:
        self._compiled, self._system, self._nv = numbers.compilation, numbers.system, numbers.nv
        self._law, self._constants = numbers.law_of(lane), numbers.constants(lane)
        self._parameters = np.array(self._constants)
        self._struck: dict[tuple[int, int], list[str]] = {}
        self._singles: dict[Any, dict[int, Single]] = {}  # by the shape of what is held, and the domain
        self._phases = {phase: self._system.of_phase(phase) for phase in self._system.phases}

    def lap(self, phase: str, y: Array, held: Held, ago: list[float]) -> Lap | None:
        """The cycle from a state just behind the section, where a phase begins, or None.

        Args:
            phase: the phase.
            y: the state.
            held: what is held there.
            ago: how long ago each toe was on the ground, in s.
        """
        system = self._system
        grounded = [-seconds for seconds in ago]
        t, switches, past, last, crowd = 0.0, 0, 0.0, -math.inf, 0
        spent, observed = dict.fromkeys(system.phases, 0.0), {}
        domains, (singles, parameters) = self._phases[phase], self._given(held)
        for _ in range(EVENTS):
            entered = self._enter(domains, t, y, held, singles, parameters)
            if entered is None:
                return None
            ready, (_, t, y, end) = entered
            domain = ready.domain
            if end == UNCLEAR or (end >= 0 and left_at_once(domain.guards[end], t)):
                return None
            at = due(domain, switches, self._law)
            until = min(at, system.phase_limit)
            if end == NONE:
                t, y, end = ready.run(t, y, until, parameters)
            if end == KINK:
                domains = (domain,)
                continue
            event: Guard | Switch | None = domain.switch if end == TIME_LIMIT and until == at else None
            if end >= 0:
                event = domain.guards[end]
                if event.observes:
                    observed[event.name], domains = y, (domain,)
                    continue
            crowd = crowded(crowd, past + t - last)
            if event is None or event.reset is None or crowd == FEW_AT_ONCE:
                return None
            last, reset = past + t, event.reset
            for i in domain.on_ground:
                grounded[i] = last
            switches += end == TIME_LIMIT
            if reset.impact:
                key = id(domain), id(reset)
                if key not in self._struck:
                    self._struck[key] = struck_toes(system, domain, reset)
                toes = self._struck[key]
                if len(toes) > 1 or retouches(system, reset, [last - time for time in grounded]):
                    return None
                y = self._compiled.impact(toes[0])(y, parameters)
            if reset.latch is not None:
                now = y.tolist()
                try:
                    held = latched(held, [reset], now[: self._nv], now[self._nv :], self._law)
                except ArithmeticError:
                    return None
                singles, parameters = self._given(held)
            if reset.phase is not None:
                spent[phase] += t
                phase, past, t, switches = reset.phase, past + t, 0.0, 0
            domains = self._phases[phase]
            if event.name == system.section:
                ago = [past - time for time in grounded]
                closes = reset.phase is not None and whole(past)
                return Lap(y, held, spent, observed, phase, (domain, reset), ago) if closes else None
        return None

    def _enter(
        self, domains: Iterable[Domain], t: float, y: Array, held: Held, singles: dict[int, Single], parameters: Array
    ) -> tuple[Single, Entry] | None:
        """The domain that fits best, if one does."""
        best = None
        for domain in domains:
            ready = singles.get(id(domain))
            if ready is None:
                ready = singles[id(domain)] = self._compiled.single(domain, held)
            entry = ready.enter(t, y, parameters)
            if entry is None:
                continue
            if entry.fitness == math.inf:
                return ready, entry
            if best is None or entry.fitness > best[1].fitness:
                best = ready, entry
        return best

    def _given(self, held: Held) -> tuple[dict[int, Single], Array]:
        """Domains compiled for what is held, as far as they were asked for, and the run-time parameters.

        These are overwritten by the next call.
        """
        now, parameters = flattened(held.values()), self._parameters
        if len(parameters) != len(self._constants) + len(now):
            self._parameters = parameters = np.array(self._constants + now)
        parameters[len(self._constants) :] = now
        return self._singles.setdefault(shape_of(held), {}), parameters
