"""Integrates a single lane from section to section, as long as the cycle has only simple events.

`runner` handles every event for many lanes. This module handles only simple cases of one cycle: a domain that fits,
guards that rise from zero, toes that land and stay. In any other case it gives up, and `runner` runs the cycle again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc, Record
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brake import Brakes
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import Domain, Guard, Reset, Switch
from spear_pin.hybrid.engines.structure import shape_of
from spear_pin.hybrid.engines.taylor import AHEAD, KINK, TIME_LIMIT
from spear_pin.hybrid.engines.taylor_single import UNCLEAR, Entry, Single
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.ground import PLACE
from spear_pin.hybrid.lanes.groups import Group, Held, alone, spread_held
from spear_pin.hybrid.lanes.impacts import strike
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.lanes.reference_arc import follow
from spear_pin.hybrid.lanes.requests import Request, Requests, answer_alone
from spear_pin.hybrid.modes import find_suiting
from spear_pin.hybrid.orders import Happening, in_order, make_happening
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.rules.cycles import ALTERNATE, RETOUCH, count_crowd, counts_to, due, retouches, whole
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.impact import find_struck_toes
from spear_pin.hybrid.rules.jumping import apply_jump
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.strikes import Overlap, strike_toes
from spear_pin.model.springs import Springs

EVENTS = 50  # most events in a cycle
FEW_AT_ONCE = 4  # most events in an instant
GROUND = ("friction", *PLACE)
RISES = "a toe that comes down rises"


@dataclass(frozen=True)
class Lap(Record):
    """A cycle of one lane.

    Attributes:
        observed: state at the last event of each name that changes nothing.
        came: the last domain, and the reset by which the lane left it.
        ago: time since each toe was last on the ground, in s.
    """

    observed: Mapping[str, Array]
    came: tuple[Domain, Reset]
    ago: list[float]


class _Unclear(Exception):
    """The cycle has an event that is not simple; the text says which."""


@dataclass(slots=True)
class _Now:
    """State of a lane within its cycle, in addition to the attributes of `Lap`.

    Attributes:
        domains: domains of the phase, of which the lane enters the one that fits.
        singles: domains compiled for the held values.
        parameters: run-time parameters, the held values among them.
        t: time since the phase began, in s.
        past: total time of the earlier phases, in s.
        switches: number of scheduled events in the phase so far.
        last: time of the last event, in s.
        crowd: number of events in this instant.
        arcs: the motion so far.
        grounded: time at which each toe was last on the ground, in s.
        happened: the events so far.
        overlap: impacts in space that may not be over.
        instant: resets into other phases in this instant.
    """

    phase: str
    domains: Sequence[Domain]
    y: Array
    held: Held
    singles: dict[int, Single]
    parameters: Array
    grounded: list[float]
    spent: dict[str, float]
    overlap: Overlap
    instant: list[Reset] = field(default_factory=list)
    observed: dict[str, Array] = field(default_factory=dict)
    t: float = 0.0
    past: float = 0.0
    switches: int = 0
    last: float = -math.inf
    crowd: int = 0
    happened: list[Happening] = field(default_factory=list)
    arcs: list[Arc] = field(default_factory=list)


class LoneRunner:
    """Runs the cycles of one lane.

    Args:
        numbers: numbers of the lanes.
        lane: index of the lane.
        keep: whether arcs keep their motion.
        longest: longest step, in s; it does not bound arcs that keep their motion.
        rare: how often a domain in space is left to the reference engine before it is compiled.

    Attributes:
        why: why the last cycle that was refused was refused.
    """

    def __init__(
        self, numbers: Numbers, lane: int, *, keep: bool = False, longest: float = math.inf, rare: int = 0
    ) -> None:
        self._numbers, self._lane, self._keep, self._longest, self._rare = numbers, lane, keep, longest, rare
        self._compiled, self._system, self._nv = numbers.compilation, numbers.system, numbers.nv
        self._in_space = self._system.robot.dimension == 3
        self._law, self._constants = numbers.law_of(lane), numbers.constants(lane)
        self._parameters = np.array(self._constants)
        self._struck: dict[tuple[int, int], list[str]] = {}
        self._singles: dict[Any, dict[int, Single]] = {}  # by the shape of the held values, and the domain
        self.why = ""  # the last cycle is left to `runner`

    def lap(self, phase: str, y: Array, held: Held, ago: list[float] | None = None) -> Lap | None:
        """Runs a cycle from a state just after the section, where a phase begins; returns None if it gives up.

        Args:
            phase: the phase.
            y: the state.
            held: held values at that state.
            ago: time since each toe was last on the ground, in s; None if that is long ago.
        """
        return answer_alone(self.request_lap(phase, y, held, ago), self._longest, keep=self._keep)

    def request_lap(self, phase: str, y: Array, held: Held, ago: list[float] | None = None) -> Requests[Lap | None]:
        """Does what `lap` does, but requests the motions that are to be integrated."""
        try:
            now = self._begin(phase, y, held, ago or [math.inf] * len(self._system.robot.toes))
            for _ in range(EVENTS):
                domain, event = yield from self._next(now)
                if event is None:
                    now.domains = (domain,)
                    continue
                reset, again = self._happen(now, domain, event)
                if event.name == self._system.section and not again:
                    return self._closed(now, domain, reset)
            self.why = f"more than {EVENTS} events happen"
        except _Unclear as unclear:
            self.why = str(unclear)
        return None

    def _begin(self, phase: str, y: Array, held: Held, ago: list[float]) -> _Now:
        grounded, spent = [-seconds for seconds in ago], dict.fromkeys(self._system.phases, 0.0)
        overlap = Overlap(self._system.overlap)
        if self._in_space and min(ago, default=math.inf) < overlap.window:
            raise _Unclear("an impact of the cycle before is not over")
        return _Now(phase, self._system.of_phase(phase), y, held, *self._given(held), grounded, spent, overlap)

    def _next(self, now: _Now) -> Requests[tuple[Domain, Guard | Switch | None]]:
        """Enters a domain, integrates to its next event, and returns both; the event is None if it changes nothing."""
        begun, start = now.t, now.y
        entered = self._enter(now)
        if entered is None:
            return self._by_reference(now)
        ready, (_, now.t, now.y, end) = entered
        domain = ready.domain
        if end == UNCLEAR:
            raise _Unclear(f"two events crowd in an instant as {domain.name} begins")
        at = due(domain, now.switches, self._law, now.held)
        until = min(at, self._system.phase_limit)
        motion, steps = None, 0
        if end == NONE:
            now.t, now.y, end, motion = yield Request(ready, now.t, now.y, until, now.parameters)
            if self._seen_again(now, domain, end) and now.t - begun < AHEAD:  # by rounding it was not passed
                later = ready.moment_later(begun, start, now.parameters)
                if later is None:
                    raise _Unclear(f"two events crowd in an instant in {domain.name}")
                now.t, now.y = later
                now.t, now.y, end, motion = yield Request(ready, now.t, now.y, until, now.parameters)
            steps = 0 if motion is None else len(motion.begins)
        event = self._event(now, domain, end, until == at)
        now.arcs.append(Arc(domain, now.held, begun, start, now.t, now.y, event, now.switches, motion, steps))
        if isinstance(event, Guard) and event.observes:
            now.observed[event.name] = now.y
            return domain, None
        return domain, event

    def _by_reference(self, now: _Now) -> tuple[Domain, Guard | Switch | None]:
        """Does what `_next` does by the reference engine."""
        begun, start, last = now.t, now.y, self._system.phase_limit

        def due_in(domain: Domain) -> float:
            return min(float(due(domain, now.switches, self._law, now.held)), last)

        given = self._lane_system, now.phase, now.held, begun, start, due_in
        arc = follow(*given, keep=self._keep, longest=self._longest)
        domain = self._domains[arc.domain.key]
        now.t, now.y = arc.t, arc.y
        now.observed |= arc.observed
        event = self._event(now, domain, arc.end, arc.t < last)
        moved = Arc(domain, now.held, begun, start, now.t, now.y, event, now.switches, arc.motion, smooth=arc.smooth)
        now.arcs.append(moved)
        return domain, event

    def _seen_again(self, now: _Now, domain: Domain, end: int) -> bool:
        """Tells whether the event that ends a motion is the one that was observed as it began."""
        last = now.arcs[-1].event if now.arcs else None
        return end >= 0 and isinstance(last, Guard) and last.observes and domain.guards[end] is last

    def _event(self, now: _Now, domain: Domain, end: int, due_now: bool) -> Guard | Switch | None:
        """Returns the event that ended an arc, None where the same motion goes on."""
        if end >= 0:
            return domain.guards[end]
        if end == TIME_LIMIT and due_now:
            now.switches += 1
            return domain.switch
        if end == KINK:
            return None
        raise _Unclear(
            f"{domain.name} does not end"
            if end == TIME_LIMIT
            else f"the motion in {domain.name} diverges, or passes an event unseen"
        )

    def _happen(self, now: _Now, domain: Domain, event: Guard | Switch) -> tuple[Reset, bool]:
        """Carries out an event: impact, latch, and change of phase; tells whether toes only touch again."""
        time, reset = now.past + now.t, event.reset
        now.crowd, now.last = count_crowd(now.crowd, time - now.last), time
        if reset is None:
            raise _Unclear(f"the run ends: {event.name}")
        if now.crowd == FEW_AT_ONCE:
            raise _Unclear("events crowd in an instant")
        now.instant = now.instant if now.crowd else []
        if any(reset is each for each in now.instant):
            raise _Unclear(ALTERNATE)
        if reset.phase is not None:
            now.instant.append(reset)
        for i in domain.on_ground:
            now.grounded[i] = time
        again = bool(retouches(self._system, reset, [time - last for last in now.grounded]))
        now.arcs[-1] = now.arcs[-1]._replace(again=again)
        now.happened.append(make_happening(domain, event, reset, RETOUCH if again else event.name, time))
        if self._in_space and (reset.impact or reset.stop):
            self._strike_in_space(now, domain, reset)
        elif reset.impact or reset.grips:
            self._strike(now, domain, reset)
        if reset.jump is not None:
            self._jump(now, reset)
        if reset.holds or reset.phase is not None:
            self._latch(now, reset, not again)
        if reset.phase is not None:
            now.spent[counts_to(domain, reset, again)] += now.t
            now.phase, now.past, now.t, now.switches = reset.phase, time, 0.0, 0
        now.domains = self._system.of_phase(now.phase)
        return reset, again

    def _strike(self, now: _Now, domain: Domain, reset: Reset) -> None:
        """Applies the impact of a toe that was in the air, or of a brake, to all that take part in it."""
        key = id(domain), id(reset)
        if key not in self._struck:
            self._struck[key] = find_struck_toes(self._system, domain, reset)
        toes = self._struck[key]
        if len(toes) == 1 and not self._system.brakes:
            struck = self._compiled.impact(toes[0])(now.y, now.parameters)
            if struck is None:
                raise _Unclear(RISES)
            now.y = struck
            return
        here = Group(np.array([self._lane]), np.array([now.t]), now.y[:, None], spread_held(now.held, 1))
        after, rising = strike(self._numbers, toes, reset, here)
        if len(rising):
            raise _Unclear(RISES)
        now.y, now.held = after.y[:, 0], alone(after.held)
        now.singles, now.parameters = self._given(now.held)

    def _strike_in_space(self, now: _Now, domain: Domain, reset: Reset) -> None:
        """Applies an impact, or the end of sliding, as the reference engine does."""
        nv = self._nv
        strike = strike_toes(self._itself, domain, reset, now.y[:nv], now.y[nv:], now.overlap, now.last)
        assert strike is not None
        now.y = np.concatenate([now.y[:nv], strike.v])
        if strike.rises:
            now.held = {**now.held, **strike.rises}
            now.singles, now.parameters = self._given(now.held)

    @cached_property
    def _itself(self) -> HybridSystem:
        """The system on this lane's ground; its impacts depend on no other number in which lanes differ."""
        own = self._numbers.of_lane(self._lane).items()
        return with_parameters(self._system, {name: value for name, value in own if name in GROUND})

    @cached_property
    def _lane_system(self) -> HybridSystem:
        """The system with all numbers of this lane."""
        return with_parameters(self._system, self._numbers.of_lane(self._lane))

    @cached_property
    def _springs(self) -> Springs:
        return self._numbers.springs(self._lane)

    @cached_property
    def _brakes(self) -> Brakes:
        return self._numbers.brakes(self._lane)

    @cached_property
    def _domains(self) -> Mapping[tuple[str, str], Domain]:
        return {domain.key: domain for domain in self._system.domains}

    def _jump(self, now: _Now, reset: Reset) -> None:
        y = now.y.tolist()
        try:
            q, v = apply_jump(reset, y[: self._nv], y[self._nv :], now.held, self._law, self._system.place_of)
        except ArithmeticError:
            raise _Unclear(f"the state cannot jump into {reset.phase or now.phase}") from None
        now.y = np.array([*q, *v])

    def _latch(self, now: _Now, reset: Reset, begins: bool) -> None:
        y = now.y.tolist()
        try:
            q, v, place_of = y[: self._nv], y[self._nv :], self._system.place_of
            clock = Clock(now.t, self._springs, self._system, self._brakes)
            now.held = latch_values(now.held, [reset], q, v, self._law, place_of, begins=begins, clock=clock)
        except ArithmeticError:
            raise _Unclear(f"{reset.phase or now.phase} cannot be latched") from None
        now.singles, now.parameters = self._given(now.held)

    def _closed(self, now: _Now, domain: Domain, reset: Reset) -> Lap:
        """Returns the cycle that a reset ends."""
        if reset.phase is None or not whole(now.past):
            raise _Unclear("the cycle is of an instant")
        ago = [now.past - time for time in now.grounded]
        order = in_order(now.happened)
        return Lap(now.y, now.phase, now.held, now.spent, order, now.arcs, now.observed, (domain, reset), ago)

    def _enter(self, now: _Now) -> tuple[Single, Entry] | None:
        """Returns the domain that fits best, None where the reference engine has to find it."""
        if self._in_space:
            return self._enter_in_space(now)
        best = None
        for domain in now.domains:
            if not domain.suits(now.held):
                continue
            ready = now.singles.get(id(domain))
            if ready is None:
                ready = now.singles[id(domain)] = self._compiled.single(domain, now.held)
            entry = ready.enter(now.t, now.y, now.parameters)
            if entry is None:
                continue
            if entry.fitness == math.inf:
                return ready, entry
            if best is None or entry.fitness > best[1].fitness:
                best = ready, entry
        if best is None:
            raise _Unclear(f"{ALTERNATE}, or neither stick, slide nor leave, in {now.phase}")
        return best

    def _enter_in_space(self, now: _Now) -> tuple[Single, Entry] | None:
        """Returns the domain in which toes in the air are open, and sliding toes slide, if it fits and is not rare.

        Each of the many others would have to be compiled.
        """
        feet = self._compiled.feet(now.y, now.parameters)
        domain = next(find_suiting(self._system.robot.toes, now.domains, *feet), None)
        if domain is None:
            return None
        ready = now.singles.get(id(domain))
        if ready is None:
            if self._compiled.count_entry(domain, now.held) <= self._rare:
                return None
            ready = now.singles[id(domain)] = self._compiled.single(domain, now.held)
        entry = ready.enter(now.t, now.y, now.parameters)
        return None if entry is None or entry.fitness < math.inf or entry.event == UNCLEAR else (ready, entry)

    def _given(self, held: Held) -> tuple[dict[int, Single], Array]:
        """Returns the domains compiled so far for the held values, and the run-time parameters.

        The next call overwrites the parameters.
        """
        now, parameters = flatten(held.values()), self._parameters
        if len(parameters) != len(self._constants) + len(now):
            self._parameters = parameters = np.array(self._constants + now)
        parameters[len(self._constants) :] = now
        return self._singles.setdefault(shape_of(held), {}), parameters
