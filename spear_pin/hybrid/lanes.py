"""Lanes on their way from event to event, in groups that are in the same domain.

Where a lane meets something rare (a choice of modes that none fits, an event as soon as a phase is entered, motion on a
switching surface) the reference engine runs it again from the beginning of its cycle: what is rare is slow, never
different.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import OPEN, Alternation, Domain, Guard, HybridSystem, Reset
from spear_pin.hybrid.contact import joint_impact, routh
from spear_pin.hybrid.engines import layout, taylor
from spear_pin.hybrid.engines.layout import Structure
from spear_pin.hybrid.engines.symbolic import with_fields
from spear_pin.hybrid.engines.taylor import FAILED, KINK, TIME_LIMIT, Compiled, Point
from spear_pin.hybrid.filippov import BEYOND, ENDS, MOST_AT_ONCE, ON_EDGE, alternation, chatter
from spear_pin.hybrid.lane_groups import (
    Flags,
    Group,
    Indices,
    along,
    collected,
    keeps,
    leaves,
    merged,
    moves,
    spread,
    stacked,
    take,
)
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.phases import AT_REST, ON_GROUND, rise
from spear_pin.hybrid.record import REASONS, Options
from spear_pin.hybrid.run import AT_ONCE, CYCLE_EVENTS, INSTANT, run, struck_toes
from spear_pin.model.planar import Planar

Array = NDArray[np.float64]
Came = tuple[Domain, Reset]  # from where a phase was entered
GLIMPSES = (1e-6, 1e-7, 1e-8, 1e-5, 1e-4)  # s: in one of them guards on zero become positive and no other falls
BENT = 1e-9  # what changes sign at a kink is on zero within this, in its unit
CHANGE = 1e-14  # of a guard's value, in its unit: less is rounding
CROWD = 10  # events in an instant, of a lane that is then left to the reference engine, as may be a Zeno point
FINER = 1000.0  # times the reference engine's tolerance is what the Taylor engine integrates with


class Lanes:
    """The lanes of a chunk on their way from event to event."""

    def __init__(
        self,
        system: HybridSystem,
        q: Array,
        v: Array,
        cycles: int,
        options: Options,
        given: Mapping[str, Array],
        observing: bool,
    ) -> None:
        n, self.nv = len(q), system.robot.nv
        self.system, self.options, self.wanted, self.given = system, options, cycles, given
        self.planar = Planar(system.robot)
        self.robot = layout.robot_numbers(system, self.planar)
        parts = (system.spring, "stiffness"), (system.spring, "damping"), (system.contact, "friction")
        self.others = [given.get(name, getattr(part, name)) for part, name in parts]
        self.start = np.concatenate([q.T, v.T])  # of the present cycle
        self.end = self.start.copy()
        self.began, self.switches = np.zeros(n), np.zeros(n, np.int64)
        self.events, self.crowd, self.last = np.zeros(n, np.int64), np.zeros(n, np.int64), np.full(n, -np.inf)
        self.cycles, self.on_section = np.zeros(n, np.int64), np.zeros(n, bool)
        self.spent = {phase: np.zeros(n) for phase in system.phases}
        self.durations = {phase: np.full(n, np.nan) for phase in system.phases}
        self.reason, self.message = np.full(n, "", dtype=object), np.full(n, "", dtype=object)
        self.repeated = np.zeros(n, bool)
        self.queue: dict[Any, tuple[Compiled, list[Group]]] = {}
        self.built: dict[Any, tuple[Domain, Compiled]] = {}
        seen = {guard.name for domain in system.domains for guard in domain.guards if guard.observes and observing}
        self.observing, self.observed = observing, {name: np.full(self.start.shape, np.nan) for name in sorted(seen)}

    def go(self) -> None:
        """Run to the end of every lane."""
        with np.errstate(all="ignore"):
            self.begin()
            while self.queue:
                # the fullest first, so that groups fill up
                key = max(self.queue, key=lambda key: sum(len(group.lanes) for group in self.queue[key][1]))
                domain, groups = self.queue.pop(key)
                self.advance(domain, merged(groups))
            for lane in np.flatnonzero(self.repeated):
                self.repeat(int(lane))

    def begin(self) -> None:
        """Sort the lanes into the phases where they begin."""
        system, n = self.system, self.start.shape[1]
        flight, lands = system.landing
        stance = system.section_phase
        terms = self.planar.terms(list(self.start[: self.nv]), list(self.start[self.nv :]), np)
        heights = np.array([np.broadcast_to(terms.positions[toe][1], n) for toe in system.robot.toes])
        below = (heights < -ON_GROUND).any(axis=0)
        for lane in np.flatnonzero(below):
            self.finish(np.array([lane]), "below_ground", f"at {heights[:, lane].min():.3g} m")
        contacts = system.of_phase(stance)[0].contacts
        closed = [i for i, mode in enumerate(contacts) if mode != OPEN]
        sinking = [abs(along(terms.jacobians[system.robot.toes[i]][1], self.start[self.nv :])) for i in closed]
        rests = (heights[closed] <= ON_GROUND).all(axis=0) & (np.array(sinking) <= 10 * AT_REST).all(axis=0)
        for phase, chosen in ((stance, rests & ~below), (flight, ~rests & ~below)):
            lanes = np.flatnonzero(chosen)
            if not len(lanes):
                continue
            group = Group(lanes, np.zeros(len(lanes)), self.start[:, lanes].copy(), {})
            group = self.latch(group, system.reset_into(flight))
            if phase == stance:
                group = self.latch(group, lands)
            self.on_section[lanes] = phase == stance
            self.enter(phase, group)

    def enter(self, phase: str, group: Group, came: Came | None = None) -> None:
        """Begin a phase, or go on with it after an event within it."""
        for ready, part, point in self.choose(phase, group):
            self.watch(ready, part, point, came)

    def choose(self, phase: str, group: Group) -> Iterator[tuple[Compiled, Group, Point]]:
        """The domain of a phase that fits each lane, as `modes.fitting` finds it, evaluated there.

        Where none does, it is the first in which the toes that cannot stay would have to be held down: they leave.
        """
        for rule in (keeps, leaves):
            for domain in self.system.of_phase(phase):
                if not len(group.lanes):
                    return
                ready = self.compiled(domain, group)
                point = ready.at(group.t, group.y, self.parameters(group))
                fits = moves(ready, point) & rule(ready, point, self.friction(group.lanes))
                if fits.any():
                    yield ready, group.take(fits), point.take(fits)
                group = group.take(~fits)
        self.give_up(group.lanes)

    def at_once(self, ready: Compiled, group: Group, point: Point) -> tuple[Indices, Flags]:
        """Of each lane the guard that is an event on entering a domain, or -1, and whether something is on zero.

        As `events.Watch`: one that is on zero is an event if it falls from there.
        """
        tolerances = np.array([guard.tolerance for guard in ready.domain.guards])[:, None]
        changes_it = np.array([not guard.observes for guard in ready.domain.guards])[:, None]
        waiting = (point.guards <= tolerances) & changes_it
        on_zero = waiting.any(axis=0) | (np.abs(point.kinks) <= BENT).any(axis=0)
        found = np.full(len(group.lanes), -1)
        if not on_zero.any():
            return found, on_zero
        some, now = group.take(on_zero), point.guards[:, on_zero]
        change = np.zeros_like(now)
        for h in (1e-7, 1e-6, 1e-5):
            change = np.where(np.abs(change) <= CHANGE, self.ahead(ready, some, h)[1].guards - now, change)
            if (np.abs(change) > CHANGE)[waiting[:, on_zero]].all():
                break
        leaving = np.array([guard.leaves for guard in ready.domain.guards])[:, None]
        falls = waiting[:, on_zero] & ((now < -tolerances) | (change < -CHANGE) | (leaving & (change <= CHANGE)))
        found[on_zero] = np.where(falls.any(axis=0), falls.argmax(axis=0), -1)
        return found, on_zero

    def watch(self, ready: Compiled, group: Group, point: Point, came: Came | None) -> None:
        """Let happen what happens as soon as a domain is entered, and queue the rest."""
        domain = ready.domain
        defined = np.isfinite(point.guards).all(axis=0) & np.isfinite(group.y).all(axis=0)
        self.give_up(group.lanes[~defined])
        group, point = group.take(defined), point.take(defined)
        first, on_zero = self.at_once(ready, group, point)
        if not on_zero.all():
            self.put(ready, group.take(~on_zero))
        for index in np.unique(first[first >= 0]):
            part, reset = group.take(first == index), domain.guards[index].reset
            parts: tuple[Group, ...]
            if came is not None and reset is not None and reset.phase == came[0].phase:
                just = part.t <= AT_ONCE
                parts = part.take(~just), self.slide(domain, reset, came, part.take(just))
            else:
                parts = (part,)
            for each in parts:
                if len(each.lanes):
                    self.happen(domain, int(index), each)
        self.rise(ready, group.take(on_zero & (first < 0)))

    def slide(self, domain: Domain, reset: Reset, came: Came, group: Group) -> Group:
        """Put lanes into motion on the switching surface, as `filippov.sliding`; returns those that do not slide.

        Args:
            domain: that they are in, having just entered it.
            reset: by which they would leave it at once.
            came: the domain before, and the reset by which they left that.
            group: the lanes.
        """
        between = alternation(self.system, (domain, came[0]), (reset, came[1]))
        if between is None:
            return group
        q, v = group.y[: self.nv], group.y[self.nv :]
        sinking = along(self.planar.terms(list(q), list(v), np).jacobians[between.toe][1], v)
        stays = np.abs(np.broadcast_to(sinking, len(group.lanes))) <= AT_REST
        rest, group = [group.take(~stays)], group.take(stays)
        for left, follow, held in self.entered(between.touch, group):
            if left is not between.leave:
                rest.append(group.take(np.isin(group.lanes, held.lanes)))
                continue
            for again, _, then in self.entered(left, held):
                part = group.take(np.isin(group.lanes, then.lanes))
                rest.append(
                    part if again is not between.touch else self.begin_sliding(replace(between, follow=follow), part)
                )
        return merged([each for each in rest if len(each.lanes)] or rest[:1])

    def entered(
        self, reset: Reset, group: Group, follow: tuple[Reset, ...] = ()
    ) -> Iterator[tuple[Reset | None, tuple[Reset, ...], Group]]:
        """What would happen at once after a reset: the reset that leaves its phase, those before it, what is held."""
        assert reset.phase is not None
        yield from self._following(reset.phase, self.latch(replace(group, t=0.0 * group.t), reset), follow)

    def _following(
        self, phase: str, group: Group, follow: tuple[Reset, ...]
    ) -> Iterator[tuple[Reset | None, tuple[Reset, ...], Group]]:
        if not len(group.lanes):
            return
        for ready, part, point in self.choose(phase, group):
            first, _ = self.at_once(ready, part, point)
            for index in np.unique(first):
                own = part.take(first == index)
                then = None if index < 0 else ready.domain.guards[index].reset
                if then is None or then.phase is not None or len(follow) == MOST_AT_ONCE:
                    yield then, follow, own
                else:
                    yield from self._following(phase, self.latch(own, then), (*follow, then))

    def begin_sliding(self, between: Alternation, group: Group) -> Group:
        """Put lanes into motion between two domains; returns those whose laws' shares do not allow it."""
        for beyond in BEYOND:
            if not len(group.lanes):
                break
            domain = chatter(between, beyond)
            try:
                ready = self.compiled(domain, group)
            except TypeError:  # a latch branches on a value
                self.give_up(group.lanes)
                return group.take(np.zeros(len(group.lanes), bool))
            still = replace(group, t=0.0 * group.t)
            point = ready.at(still.t, still.y, self.parameters(still))
            first, _ = self.at_once(ready, still, point)
            share = 1.0 + beyond - point.guards[0]
            slides = ~np.isin(first, ENDS) & (share > -beyond - ON_EDGE) & (share < 1.0 + beyond + ON_EDGE)
            sliding = still.take(slides)
            if len(sliding.lanes):
                phase = between.airborne.phase
                self.leave_phase(phase, group.take(slides))
                self.watch(ready, sliding, point.take(slides), None)
            group = group.take(~slides)
        return group

    def rise(self, ready: Compiled, group: Group) -> None:
        """Go on until no guard is on zero."""
        changes_it = np.array([not guard.observes for guard in ready.domain.guards])[:, None]
        for h in GLIMPSES:
            if not len(group.lanes):
                return
            y, point = self.ahead(ready, group, h)
            clear = ((point.guards > 0.0) | ~changes_it).all(axis=0) & (np.abs(point.kinks) > 0.0).all(axis=0)
            if clear.any():
                risen = Group(group.lanes, group.t + h, y, group.held)
                self.put(ready, risen.take(clear))
            group = group.take(~clear)
        self.give_up(group.lanes)

    def ahead(self, ready: Compiled, group: Group, h: float) -> tuple[Array, Point]:
        """One Runge-Kutta step, and the domain evaluated after it."""
        parameters = self.parameters(group)

        def slope(c: float, k: Array) -> Array:
            return ready.at(group.t + c * h, group.y + c * h * k, parameters).slopes

        k1 = slope(0.0, np.zeros_like(group.y))
        k2 = slope(0.5, k1)
        k3 = slope(0.5, k2)
        k4 = slope(1.0, k3)
        y = group.y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        return y, ready.at(group.t + h, y, parameters)

    def put(self, ready: Compiled, group: Group) -> None:
        """Queue lanes to be integrated."""
        self.queue.setdefault(id(ready), (ready, []))[1].append(group)

    def advance(self, ready: Compiled, group: Group) -> None:
        """Integrate up to the next event, and let it happen."""
        domain, limit = ready.domain, self.system.phase_limit
        until = np.full(len(group.lanes), limit)
        if domain.switch is not None:
            for n in np.unique(self.switches[group.lanes]):
                chosen = self.switches[group.lanes] == n
                law = self.law_of(group.lanes[chosen])
                until[chosen] = np.minimum(domain.switch.time(int(n) + 1, law), limit)
        late = until <= group.t
        self.give_up(group.lanes[late])
        group, until = group.take(~late), until[~late]
        t, y, ends = ready.run(group.t, group.y, until, self.parameters(group))
        group = Group(group.lanes, t, y, group.held)
        for end in np.unique(ends):
            part = group.take(ends == end)
            if end == FAILED:
                self.give_up(part.lanes)
            elif end == TIME_LIMIT:
                over = until[ends == end] >= limit
                self.finish(part.lanes[over], "no_event", f"{limit:g} s in {domain.phase}")
                self.switches[part.lanes] += 1
                if not over.all():
                    self.happen(domain, -1, part.take(~over))
            elif end == KINK or domain.guards[end].observes:
                if end != KINK:
                    self.observed[domain.guards[end].name][:, part.lanes] = part.y
                part = self.count(part)
                self.watch(ready, part, ready.at(part.t, part.y, self.parameters(part)), None)
            else:
                self.happen(domain, int(end), part)

    def happen(self, domain: Domain, index: int, group: Group) -> None:
        """An event of a domain, a guard's or with -1 the scheduled one: impact, latch, phase, domain."""
        guard = domain.guards[index] if index >= 0 else domain.switch
        assert guard is not None
        ends, reset = (guard.ends, guard.reset) if isinstance(guard, Guard) else (None, guard.reset)
        if ends is not None:
            for lane, t in zip(group.lanes, group.t, strict=True):
                self.finish(np.array([lane]), ends, f"{guard.name} at t = {self.began[lane] + t:.6g} s")
            return
        assert reset is not None
        group = self.count(group)
        struck = struck_toes(self.system, domain, reset)
        if struck:
            group.y[self.nv :] = self.strike(struck, group)
        group = self.latch(group, reset)
        if reset.phase is not None:
            self.leave_phase(domain.phase, group)
            group.t = np.zeros(len(group.lanes))
        if guard.name == self.system.section:
            group = self.close_cycle(group)
        if len(group.lanes):
            self.enter(reset.phase or domain.phase, group, None if reset.phase is None else (domain, reset))

    def leave_phase(self, phase: str, group: Group) -> None:
        """Count the time spent in a phase."""
        self.spent[phase][group.lanes] += group.t
        self.began[group.lanes] += group.t
        self.switches[group.lanes] = 0

    def strike(self, toes: list[str], group: Group) -> Array:
        """Velocities after an impact on some toes."""
        q, v = group.y[: self.nv], group.y[self.nv :]
        n, terms = len(group.lanes), self.planar.terms(list(q), list(v), np)
        D = stacked(terms.mass_matrix, n)
        J = np.concatenate([stacked(terms.jacobians[toe], n) for toe in toes], axis=1)
        friction = self.friction(group.lanes)
        if len(toes) > 1:
            each = zip(D, J, v.T, np.broadcast_to(friction, n), strict=True)
            impacts = [joint_impact(*numbers[:3], float(numbers[3])) for numbers in each]
            raise_to = [(J[i] @ impact.v)[1::2] * impact.leaves for i, impact in enumerate(impacts)]
            group.held.update(
                {rise(toe): np.array(speeds) for toe, speeds in zip(toes, zip(*raise_to, strict=True), strict=True)}
            )
            return np.array([impact.v for impact in impacts]).T
        response = np.linalg.solve(D, J.transpose(0, 2, 1))
        before = (J @ v.T[:, :, None])[:, :, 0].T
        impulse, _ = routh((J @ response).transpose(1, 2, 0), before, friction)
        return np.asarray(v + (response @ impulse.T[:, :, None])[:, :, 0].T)

    def latch(self, group: Group, reset: Reset) -> Group:
        """What an event latches: for all lanes at once if the latch is plain arithmetic, else lane by lane."""
        if reset.latch is None or not len(group.lanes):
            return group
        n, q, v = len(group.lanes), group.y[: self.nv], group.y[self.nv :]
        try:
            new = reset.latch(list(q), list(v), group.held, self.law_of(group.lanes))
            held = {**group.held, **{name: spread(value, n) for name, value in new.items()}}
        except (TypeError, ValueError):
            each = []
            for i in range(n):
                own = {name: take(value, i) for name, value in group.held.items()}
                law = with_fields(self.system.law, {name: float(x[group.lanes[i]]) for name, x in self.given.items()})
                each.append(reset.latch(q[:, i].tolist(), v[:, i].tolist(), own, law))
            held = {**group.held, **{name: collected([one[name] for one in each]) for name in each[0]}}
        return Group(group.lanes, group.t, group.y, held)

    def close_cycle(self, group: Group) -> Group:
        """The section is crossed; returns the lanes that go on."""
        lanes, counts = group.lanes, self.on_section[group.lanes]
        instant = counts & (sum(spent[lanes] for spent in self.spent.values()) < INSTANT)
        self.give_up(lanes[instant])
        self.cycles[lanes[counts & ~instant]] += 1
        for phase, spent in self.spent.items():
            self.durations[phase][lanes[counts]] = spent[lanes[counts]]
            spent[lanes] = 0.0
        self.on_section[lanes], self.events[lanes] = True, 0
        self.start[:, lanes] = group.y
        done = self.cycles[lanes] == self.wanted
        self.end[:, lanes] = group.y
        self.finish(lanes[done & ~instant], "complete", "")
        return group.take(~done & ~instant)

    def repeat(self, lane: int) -> None:
        """Run a lane again by the reference engine from where its cycle began."""
        nq = self.system.robot.nq
        done = int(self.cycles[lane])
        system = with_parameters(self.system, {name: float(values[lane]) for name, values in self.given.items()})
        state = self.start[:nq, lane].copy(), self.start[nq:, lane].copy()
        result = run(system, state, self.wanted - done, self.options)
        self.cycles[lane] = done + result.cycles
        self.end[:, lane] = np.concatenate(result.state if result.reason == "complete" else state)
        self.reason[lane], self.message[lane] = result.reason, result.message
        for name, states in self.observed.items():
            last = [event for event in result.events if event.name == name][-1:]
            states[:, lane] = np.concatenate([last[0].q, last[0].v]) if last else np.nan
        if result.cycles:
            for phase in self.durations:
                self.durations[phase][lane] = result.durations.get(phase, 0.0)

    # bookkeeping

    def compiled(self, domain: Domain, group: Group) -> Compiled:
        """The domain, compiled for what the group holds."""
        key = id(domain), layout.shape_of(group.held)
        if key not in self.built:
            tol = self.options.rtol / FINER
            # kept with the domain, so that its identity stays its own
            structure = Structure(self.system, domain, group.held, self.planar)
            self.built[key] = domain, taylor.compiled(structure, tol, self.observing)
        return self.built[key][1]

    def parameters(self, group: Group) -> Array:
        """Run-time parameters of a group, (p, n)."""
        others = [value[group.lanes] if isinstance(value, np.ndarray) else value for value in self.others]
        law = self.law_of(group.lanes)
        return layout.parameters(law, others, self.robot, group.held, len(group.lanes))

    def law_of(self, lanes: Indices) -> Any:
        """Parameters of the law in some lanes."""
        return with_fields(self.system.law, {name: values[lanes] for name, values in self.given.items()})

    def friction(self, lanes: Indices) -> Any:
        """The ground's friction under some lanes."""
        value = self.others[2]
        return value[lanes] if isinstance(value, np.ndarray) else value

    def count(self, group: Group) -> Group:
        """Count an event; returns those lanes that have not had too many in an instant or a cycle."""
        lanes = group.lanes
        now = self.began[lanes] + group.t
        self.crowd[lanes] = np.where(now - self.last[lanes] < INSTANT, self.crowd[lanes] + 1, 0)
        self.events[lanes] += 1
        self.last[lanes] = now
        many = (self.crowd[lanes] >= CROWD) | (self.events[lanes] >= CYCLE_EVENTS)
        self.give_up(lanes[many])
        return group.take(~many)

    def give_up(self, lanes: Indices) -> None:
        """Leave lanes to the reference engine."""
        self.repeated[lanes] = True

    def finish(self, lanes: Indices, reason: str, detail: str) -> None:
        """Some lanes end."""
        self.reason[lanes] = reason
        self.message[lanes] = REASONS[reason] + (f" ({detail})" if detail else "")
