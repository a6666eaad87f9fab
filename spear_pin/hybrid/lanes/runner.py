"""Integrates many states (lanes) from event to event.

In rare cases (no choice of modes fits, too many events in an instant) the reference engine runs the lane again from the
beginning of its cycle. Rare cases are slower, but their results are the same.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, Reset, Switch
from spear_pin.hybrid.engines.structure import shape_of
from spear_pin.hybrid.engines.taylor import FAILED, KINK, TIME_LIMIT, Code, Point, Ready
from spear_pin.hybrid.lanes.beginning import find_beginning
from spear_pin.hybrid.lanes.groups import Flags, Group, Indices, alone, finite, merge_groups, spread_held
from spear_pin.hybrid.lanes.impacts import strike
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.lanes.modes import away, choose, find_sinking, first_event
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.lanes.requests import Requests, answer_alone, answer_together
from spear_pin.hybrid.lanes.sliding import Came, slide
from spear_pin.hybrid.orders import Happening, Order, in_order, make_happening, order_of
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.reasons import REASONS
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.cycles import (
    CYCLE_EVENTS,
    RETOUCH,
    count_crowd,
    counts_to,
    due,
    left_at_once,
    retouches,
    whole,
)
from spear_pin.hybrid.rules.impact import find_struck_toes
from spear_pin.hybrid.rules.start import start
from spear_pin.hybrid.run import run

FEW = 16  # most lanes of the plane for which it is faster if each meets its events by itself
PATIENCE = 3  # cycles that a lane's lone runner may refuse before it is no longer tried
RARE = 8  # entries of a domain in space by the reference engine: compiling takes as long as some dozens of them
CROWD = 10  # events in an instant after which the reference engine takes over, as it may be a Zeno point


class Lanes:
    """Runs the lanes of a chunk, and keeps their results.

    Groups wait in two queues: groups that enter a phase, sorted by the domain they left, and groups to be integrated
    in a domain.
    """

    def __init__(
        self,
        system: HybridSystem,
        q: Array,
        v: Array,
        cycles: int,
        options: Options,
        given: Mapping[str, Array],
        code: Code,
    ) -> None:
        n, self.nv = len(q), system.robot.nv
        self.system, self.options, self.wanted = system, options, cycles
        self._longest, self._unrolled = options.max_step or math.inf, code.unrolled
        self.numbers = Numbers(system, given, code)
        # where the reference engine can begin: the last state on the section that defines all else, the cycles before
        self.start, self.before = np.concatenate([q.T, v.T]), np.zeros(n, np.int64)
        self.end = self.start.copy()
        lands = system.landing[1]
        # the reset after which the later motion depends on the state alone: a phase begins and latches all it holds
        self._fresh = lands if lands.phase is not None else None
        self.began, self.switches = np.zeros(n), np.zeros(n, np.int64)
        self.events, self.crowd, self.last = np.zeros(n, np.int64), np.zeros(n, np.int64), np.full(n, -np.inf)
        self.grounded = np.full((len(system.robot.toes), n), -np.inf)  # when each toe was last on the ground
        self.resets, self._bits = np.zeros(n, np.int64), dict[int, int]()  # into other phases, in this instant
        self.refused = np.zeros(n, np.int64)
        self.cycles, self.on_section = np.zeros(n, np.int64), np.zeros(n, bool)
        self.spent = {phase: np.zeros(n) for phase in system.phases}
        self.durations = {phase: np.full(n, np.nan) for phase in system.phases}
        self.reason, self.message = np.full(n, "", dtype=object), np.full(n, "", dtype=object)
        self.repeated = np.zeros(n, bool)
        domains = system.domains if code.observing else ()
        seen = {guard.name for domain in domains for guard in domain.guards if guard.observes}
        self.observed = {name: np.full(self.start.shape, np.nan) for name in sorted(seen)}
        longest = self._longest
        self._in_space = system.robot.dimension == 3  # where impacts may overlap, which each lane has for itself
        alone = n if n <= FEW or self._in_space else 0
        self._lone = [LoneRunner(self.numbers, lane, longest=longest, rare=RARE) for lane in range(alone)]
        self.orders: list[Order] = [()] * n  # order of events in the last whole cycle
        self._happened: list[list[Happening]] = [[] for _ in self._lone]  # events of the present cycle
        self._alone: list[tuple[str, Group, Came | None]] = []
        self._entering: dict[Any, tuple[str, Came | None, list[Group]]] = {}
        self._flying: dict[int, tuple[Ready, list[Group]]] = {}

    def go(self) -> None:
        """Runs every lane to its end."""
        with np.errstate(all="ignore"):
            self.begin()
            while self._alone or self._entering or self._flying:
                self.go_rounds()
                while self._entering:
                    phase, came, groups = self._entering.pop(next(iter(self._entering)))
                    self.enter(phase, merge_groups(groups), came)
                if self._flying:
                    # the fullest first, so that groups fill up
                    key = max(self._flying, key=lambda key: sum(map(len, self._flying[key][1])))
                    ready, groups = self._flying.pop(key)
                    self.advance(ready, merge_groups(groups))
            for lane in np.flatnonzero(self.repeated):
                self.repeat(int(lane))

    def begin(self) -> None:
        """Sorts the lanes into the phases where they begin."""
        lowest, below, torn, standing = find_beginning(self.numbers, self.start)
        for lane in np.flatnonzero(below):
            self.finish(np.array([lane]), "below_ground", f"at {lowest[lane]:.3g} m")
        self.finish(np.flatnonzero(torn & ~below), "open_loop", "")
        for stands, chosen in ((True, standing), (False, ~standing)):
            lanes = np.flatnonzero(chosen & ~below & ~torn)
            if not len(lanes):
                continue
            group = Group(lanes, np.zeros(len(lanes)), self.start[:, lanes].copy(), {})
            phase, resets = start(self.system, stands)
            for reset in resets:
                group = self.numbers.latch(group, reset, begins=stands)
            self.on_section[lanes] = stands
            self.go_on(phase, group, None)

    def go_on(self, phase: str, group: Group, came: Came | None) -> None:
        """Starts the next cycle of lanes.

        Each meets its events by itself if they are few, if a phase begins, and if that has not failed too often.
        """
        lanes = group.lanes
        single = bool(self._lone) & self.on_section[lanes] & (self.refused[lanes] < PATIENCE) & (group.t == 0.0)
        self._alone += [(phase, group.take([i]), came) for i in np.flatnonzero(single)]
        if not single.all():
            self.put(phase, group.take(~single), came)

    def go_rounds(self) -> None:
        """Runs cycles of lanes that meet their events by themselves; side by side if code for that compiles quickly."""
        rounds = [self.go_round(*each) for each in self._alone]
        self._alone = []
        if len(self._lone) > 1 and not self._unrolled:
            answer_together(rounds, self._longest)
        else:
            for each in rounds:
                answer_alone(each, self._longest)

    def go_round(self, phase: str, group: Group, came: Came | None) -> Requests[None]:
        """Runs the cycles of one lane as long as its lone runner accepts them."""
        lane, n, y, held = int(group.lanes[0]), 0, group.y[:, 0], alone(group.held)
        spent: Mapping[str, float] = {}
        start, fresh, began = y, 0, float(self.began[lane])
        wanted = self.wanted - int(self.cycles[lane])
        ago = (self.began[lane] - self.grounded[:, lane]).tolist()
        while n < wanted and (lap := (yield from self._lone[lane].request_lap(phase, y, held, ago))) is not None:
            ago, self.orders[lane] = lap.ago, lap.order
            n, y, held, spent, phase, came = n + 1, lap.y, lap.held, lap.spent, lap.phase, lap.came
            if came[1] is self._fresh:
                start, fresh = y, n
            began += sum(spent.values())
            for name in self.observed.keys() & lap.observed.keys():  # the reference engine observes unasked
                self.observed[name][:, lane] = lap.observed[name]
        if n:
            if fresh:
                self.start[:, lane], self.before[lane] = start, self.cycles[lane] + fresh
            self.began[lane] = began
            self.grounded[:, lane] = began - np.array(ago)
            self.end[:, lane] = y
            self.cycles[lane] += n
            for name, seconds in spent.items():
                self.durations[name][lane] = seconds
        if self.cycles[lane] == self.wanted:
            self.finish(group.lanes, "complete", "")
        elif self._in_space:
            self.give_up(group)  # most impacts there are only known to lone lanes
        else:
            self.refused[lane] += 1
            self.put(phase, Group(group.lanes, np.zeros(1), y[:, None].copy(), spread_held(held, 1)), came)

    def put(self, phase: str, group: Group, came: Came | None) -> None:
        """Queues lanes to enter a phase, or to continue it after an event within it."""
        key = phase, shape_of(group.held), None if came is None else (id(came[0]), id(came[1]))
        self._entering.setdefault(key, (phase, came, []))[2].append(group)

    def fly(self, ready: Ready, group: Group) -> None:
        """Queues lanes to be integrated in a domain."""
        self._flying.setdefault(id(ready), (ready, []))[1].append(group)

    def enter(self, phase: str, group: Group, came: Came | None) -> None:
        """Finds the domain of a phase that each lane enters."""
        chosen, left = choose(self.numbers, phase, group)
        self.give_up(left)
        for ready, part, point in chosen:
            self.watch(ready, part, point, came)

    def watch(self, ready: Ready, group: Group, point: Point, came: Came | None) -> None:
        """Carries out the events that happen on entering a domain, and queues the other lanes for integration."""
        domain = ready.domain
        clear = np.isfinite(point.guards).all(axis=0) & np.isfinite(group.y).all(axis=0)
        clear &= ~find_sinking(self.numbers, ready, group, point)
        self.give_up(group.take(~clear))
        group, point = group.take(clear), point.take(clear)
        first, on_zero = first_event(self.numbers, ready, group, point)
        if not on_zero.all():
            self.fly(ready, group.take(~on_zero))
        for index in np.unique(first[first >= 0]).tolist():
            part, reset = group.take(first == index), domain.guards[index].reset
            if came is not None and reset is not None and reset.phase == came[0].phase:
                just = left_at_once(domain.guards[index], part.t)
                self.happen(domain, index, part.take(~just))
                part = self.slide(ready, index, came, part.take(just))
            self.happen(domain, index, part)
        self.fly_away(ready, group.take(on_zero & (first < 0)))

    def fly_away(self, ready: Ready, group: Group) -> None:
        """Queues lanes to be integrated from a moment later, where no guard is zero any more."""
        gone, left = away(self.numbers, ready, group)
        self.give_up(left)
        for each in gone:
            self.fly(ready, each)

    def slide(self, ready: Ready, index: int, came: Came, group: Group) -> Group:
        """Moves lanes that would leave a phase at once by a guard onto the switching surface; returns the others."""
        reset = ready.domain.guards[index].reset
        assert reset is not None
        try:
            sliding, rest = slide(self.numbers, ready.domain, reset, came, group)
        except TypeError:
            self.give_up(group)
            return group.take(np.zeros(len(group), bool))
        for surface, part, point in sliding:
            self.leave(ready.domain.spent_in, group.take(np.isin(group.lanes, part.lanes)))
            self.watch(surface, part, point, None)
        return rest

    def advance(self, ready: Ready, group: Group) -> None:
        """Integrates up to the next event, and carries it out."""
        until = self.until(ready.domain, group)
        late = until <= group.t
        self.give_up(group.take(late))
        group, until = group.take(~late), until[~late]
        t, y, ends = ready.run(group.t, group.y, until, self.numbers.parameters(group), self._longest)
        group = replace(group, t=t, y=y)
        for end in np.unique(ends).tolist():
            part = group.take(ends == end)
            if end == FAILED:
                self.give_up(part)
            elif end == TIME_LIMIT:
                self.time_over(ready.domain, part, until[ends == end] >= self.system.phase_limit)
            elif end == KINK or ready.domain.guards[end].observes:
                self.pass_by(ready, part, end)
            else:
                self.happen(ready.domain, end, part)

    def until(self, domain: Domain, group: Group) -> Array:
        """Returns the time of the phase up to which each lane is integrated.

        That is the time of the scheduled event, or the limit of a phase.
        """
        until = np.full(len(group), self.system.phase_limit)
        switches = self.switches[group.lanes]
        for n in np.unique(switches):
            chosen = switches == n
            until[chosen] = np.minimum(
                due(domain, int(n), self.numbers.law(group.lanes[chosen]), group.take(chosen).held), until[chosen]
            )
        return until

    def time_over(self, domain: Domain, group: Group, over: Flags) -> None:
        """Carries out the scheduled event, and ends lanes whose phase has exceeded its limit."""
        self.finish(group.lanes[over], "no_event", f"{self.system.phase_limit:g} s in {domain.phase}")
        self.switches[group.lanes] += 1
        if not over.all():
            self.happen(domain, -1, group.take(~over))

    def pass_by(self, ready: Ready, group: Group, end: int) -> None:
        """Continues after a kink, or after a guard that is only observed."""
        if end != KINK:
            self.observed[ready.domain.guards[end].name][:, group.lanes] = group.y
        group = self.count(group)
        again = (self.crowd[group.lanes] > 0) & (end != KINK)  # by rounding it was not passed
        self.fly_away(ready, group.take(again))
        group = group.take(~again)
        self.watch(ready, group, self.numbers.at(ready, group), None)

    def happen(self, domain: Domain, index: int, group: Group) -> None:
        """Carries out an event of a domain: impact, latch, and change of phase; index -1 is the scheduled event."""
        guard = domain.guards[index] if index >= 0 else domain.switch
        assert guard is not None
        ends, reset = (guard.ends, guard.reset) if isinstance(guard, Guard) else (None, guard.reset)
        if ends is not None:
            for lane, t in zip(group.lanes, group.t, strict=True):
                self.finish(np.array([lane]), ends, f"{guard.name} at t = {self.began[lane] + t:.6g} s")
            return
        assert reset is not None
        if domain.alternating and reset.phase is None and {*domain.contacts} != {OPEN}:
            self.give_up(group)  # while one toe alternates on, another may slip, or its spring may slacken
            return
        now = self.began[group.lanes] + group.t
        self.grounded[np.array(domain.on_ground, int)[:, None], group.lanes] = now
        touching = np.broadcast_to(retouches(self.system, reset, now - self.grounded[:, group.lanes]), len(group))
        for again in np.unique(touching):
            self.carry_out(domain, guard, reset, group.take(touching == again), bool(again))

    def carry_out(self, domain: Domain, guard: Guard | Switch, reset: Reset, group: Group, again: bool) -> None:
        """Carries out an event; `again` tells whether toes only touch again."""
        group = self.count(group)
        if reset.phase is not None:
            group = self.new(reset, group)
        if self._lone:
            name = RETOUCH if again else guard.name
            for lane, t in zip(group.lanes, group.t, strict=True):
                self._happened[lane].append(make_happening(domain, guard, reset, name, self.began[lane] + t))
        struck = find_struck_toes(self.system, domain, reset)
        if self._in_space and (struck or reset.stop):  # only lone lanes know of other impacts
            self.give_up(group)
            return
        if (struck or reset.grips) and len(group):
            group, rising = strike(self.numbers, struck, reset, group)
            self.give_up(rising)
        if reset.jump is not None:
            group, left = self.numbers.jump(group, reset)
            self.give_up(left)
        group = self.numbers.latch(group, reset, begins=not again)
        latched = finite(group.held, len(group))
        self.give_up(group.take(~latched))
        group = group.take(latched)
        if reset.phase is not None:
            self.leave(counts_to(domain, reset, again), group)
            group = replace(group, t=np.zeros(len(group)))
        if guard.name == self.system.section and not again:
            group = self.close_cycle(group, reset)
            self.go_on(reset.phase or domain.phase, group, (domain, reset))
        elif len(group):
            self.put(reset.phase or domain.phase, group, None if reset.phase is None else (domain, reset))

    def leave(self, phase: str, group: Group) -> None:
        """Adds up the time spent in a phase."""
        self.spent[phase][group.lanes] += group.t
        self.began[group.lanes] += group.t
        self.switches[group.lanes] = 0

    def close_cycle(self, group: Group, reset: Reset) -> Group:
        """Completes a cycle of lanes that cross the section; returns the lanes that continue."""
        lanes, counts = group.lanes, self.on_section[group.lanes]
        instant = counts & ~whole(np.sum([spent[lanes] for spent in self.spent.values()], axis=0))
        self.give_up(group.take(instant))
        self.cycles[lanes[counts & ~instant]] += 1
        for phase, spent in self.spent.items():
            self.durations[phase][lanes[counts]] = spent[lanes[counts]]
            spent[lanes] = 0.0
        self.on_section[lanes], self.events[lanes] = True, 0
        if self._lone:
            for lane in lanes:
                self.orders[lane], self._happened[lane] = in_order(self._happened[lane]), []
        if reset is self._fresh:
            self.start[:, lanes], self.before[lanes] = group.y, self.cycles[lanes]
        done = self.cycles[lanes] == self.wanted
        self.end[:, lanes] = group.y
        self.finish(lanes[done & ~instant], "complete", "")
        return group.take(~done & ~instant)

    def repeat(self, lane: int) -> None:
        """Runs a lane again by the reference engine from where its present cycle, or an earlier one, began."""
        nq, before = self.system.robot.nq, int(self.before[lane])
        system = with_parameters(self.system, self.numbers.of_lane(lane))
        state = self.start[:nq, lane].copy(), self.start[nq:, lane].copy()
        result = run(system, state, self.wanted - before, self.options)
        self.cycles[lane] = before + result.cycles
        crossings = [(event.q, event.v) for event in result.events if event.name == system.section]
        self.end[:, lane] = np.concatenate([state, *crossings][-1])
        self.reason[lane], self.message[lane] = result.reason, result.message
        self.orders[lane] = order_of(self.system, result)
        for name, states in self.observed.items():
            last = [event for event in result.events if event.name == name][-1:]
            if last or not before:
                states[:, lane] = np.concatenate([last[0].q, last[0].v]) if last else np.nan
        if result.cycles:
            for phase in self.durations:
                self.durations[phase][lane] = result.durations.get(phase, 0.0)

    # bookkeeping

    def count(self, group: Group) -> Group:
        """Counts an event; returns the lanes that have not had too many events in an instant or a cycle."""
        lanes = group.lanes
        now = self.began[lanes] + group.t
        self.crowd[lanes] = count_crowd(self.crowd[lanes], now - self.last[lanes])
        self.events[lanes] += 1
        self.last[lanes] = now
        many = (self.crowd[lanes] >= CROWD) | (self.events[lanes] >= CYCLE_EVENTS)
        self.give_up(group.take(many))
        return group.take(~many)

    def new(self, reset: Reset, group: Group) -> Group:
        """Returns the lanes that have not had this reset into another phase in the present instant."""
        lanes, bit = group.lanes, 1 << self._bits.setdefault(id(reset), len(self._bits))
        self.resets[lanes] = np.where(self.crowd[lanes] > 0, self.resets[lanes], 0)
        again = self.resets[lanes] & bit != 0
        self.resets[lanes] |= bit
        self.give_up(group.take(again))
        return group.take(~again)

    def give_up(self, group: Group) -> None:
        """Leaves lanes to the reference engine."""
        self.repeated[group.lanes] = True

    def finish(self, lanes: Indices, reason: str, detail: str) -> None:
        """Ends some lanes with a reason."""
        self.reason[lanes] = reason
        self.message[lanes] = REASONS[reason] + (f" ({detail})" if detail else "")
