"""Lanes on their way from event to event, in groups that are in the same domain.

Where a lane meets something rare (a choice of modes that none fits, an event as soon as a phase is entered, motion on a
switching surface) the reference engine runs it again from the beginning of its cycle: what is rare is slow, never
different.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import OPEN, Domain, Guard, HybridSystem, Reset
from spear_pin.hybrid.contact import joint_impact, routh
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.symbolic import with_fields
from spear_pin.hybrid.engines.taylor import FAILED, TIME_LIMIT, Compiled
from spear_pin.hybrid.lane_groups import (
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
from spear_pin.hybrid.run import AT_ONCE, INSTANT, run, struck_toes
from spear_pin.model.planar import Planar

Array = NDArray[np.float64]
GLIMPSES = (1e-6, 1e-5, 1e-4)  # s: in the first of them guards on zero have to become positive
CHANGE = 1e-14  # of a guard's value, in its unit: less is rounding
EVENTS = 40  # of a cycle; one with more is left to the reference engine
FINER = 100.0  # times the reference engine's tolerance is what the Taylor engine integrates with


class Lanes:
    """The lanes of a chunk on their way from event to event."""

    def __init__(
        self, system: HybridSystem, q: Array, v: Array, cycles: int, options: Options, given: Mapping[str, Array]
    ) -> None:
        n, self.nv = len(q), system.robot.nv
        self.system, self.options, self.wanted, self.given = system, options, cycles, given
        self.planar = Planar(system.robot)
        parts = (system.spring, "stiffness"), (system.spring, "damping"), (system.contact, "friction")
        self.others = [given.get(name, getattr(part, name)) for part, name in parts]
        self.start = np.concatenate([q.T, v.T])  # of the present cycle
        self.end = self.start.copy()
        self.began, self.switches, self.events = np.zeros(n), np.zeros(n, np.int64), np.zeros(n, np.int64)
        self.cycles, self.on_section = np.zeros(n, np.int64), np.zeros(n, bool)
        self.spent = {phase: np.zeros(n) for phase in system.phases}
        self.durations = {phase: np.full(n, np.nan) for phase in system.phases}
        self.reason, self.message = np.full(n, "", dtype=object), np.full(n, "", dtype=object)
        self.repeated = np.zeros(n, bool)
        self.queue: dict[Any, tuple[Compiled, list[Group]]] = {}

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

    def enter(self, phase: str, group: Group) -> None:
        """Find the domain of a phase that fits each lane, as `modes.fitting` does.

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
                    self.watch(ready, group.take(fits), point.guards[:, fits])
                group = group.take(~fits)
        self.give_up(group.lanes)

    def watch(self, ready: Compiled, group: Group, guards: Array) -> None:
        """See which guards are on zero where a domain is entered, as `events.Watch` does."""
        domain = ready.domain
        tolerances = np.array([guard.tolerance for guard in domain.guards])[:, None]
        changes_it = np.array([not guard.observes for guard in domain.guards])[:, None]
        defined = np.isfinite(guards).all(axis=0) & np.isfinite(group.y).all(axis=0)
        self.give_up(group.lanes[~defined])
        waiting = (guards <= tolerances) & changes_it & defined
        quiet = ~waiting.any(axis=0) & defined
        if quiet.any():
            self.put(ready, group.take(quiet))
        if quiet.all() or not (some := waiting.any(axis=0)).any():
            return
        group, guards, waiting = group.take(some), guards[:, some], waiting[:, some]
        change, falls = np.zeros_like(guards), waiting & (guards < -tolerances)
        for h in (1e-7, 1e-6, 1e-5):
            ahead = self.ahead(ready, group, h)[1]
            change = np.where(np.abs(change) <= CHANGE, ahead - guards, change)
        at_once = falls | (waiting & ~(change > 0.0))
        happening = at_once.any(axis=0)
        first = at_once.argmax(axis=0)
        for index in np.unique(first[happening]):
            chosen = happening & (first == index)
            # as soon as the phase is entered, it may be motion on the switching surface
            lasting = chosen & (group.t > AT_ONCE)
            self.give_up(group.lanes[chosen & ~lasting])
            if lasting.any():
                self.happen(domain, int(index), group.take(lasting))
        self.rise(ready, group.take(~happening), changes_it)

    def rise(self, ready: Compiled, group: Group, changes_it: NDArray[np.bool_]) -> None:
        """Go on until no guard is on zero."""
        for h in GLIMPSES:
            if not len(group.lanes):
                return
            y, guards = self.ahead(ready, group, h)
            clear = ((guards > 0.0) | ~changes_it).all(axis=0)
            if clear.any():
                risen = Group(group.lanes, group.t + h, y, group.held)
                self.put(ready, risen.take(clear))
            group = group.take(~clear)
        self.give_up(group.lanes)

    def ahead(self, ready: Compiled, group: Group, h: float) -> tuple[Array, Array]:
        """One Runge-Kutta step, and the guards after it."""
        parameters = self.parameters(group)

        def slope(c: float, k: Array) -> Array:
            return ready.at(group.t + c * h, group.y + c * h * k, parameters).slopes

        k1 = slope(0.0, np.zeros_like(group.y))
        k2 = slope(0.5, k1)
        k3 = slope(0.5, k2)
        k4 = slope(1.0, k3)
        y = group.y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        return y, ready.at(group.t + h, y, parameters).guards

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
        self.events[group.lanes] += 1
        many = self.events[group.lanes] > EVENTS
        self.give_up(group.lanes[many])
        group = group.take(~many)
        struck = struck_toes(self.system, domain, reset)
        if struck:
            group.y[self.nv :] = self.strike(struck, group)
        group = self.latch(group, reset)
        if reset.phase is not None:
            self.spent[domain.phase][group.lanes] += group.t
            self.began[group.lanes] += group.t
            self.switches[group.lanes] = 0
            group.t = np.zeros(len(group.lanes))
        if guard.name == self.system.section:
            group = self.close_cycle(group)
        if len(group.lanes):
            self.enter(reset.phase or domain.phase, group)

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
        if result.cycles:
            for phase in self.durations:
                self.durations[phase][lane] = result.durations.get(phase, 0.0)

    # bookkeeping

    def compiled(self, domain: Domain, group: Group) -> Compiled:
        """The domain, compiled for what the group holds."""
        return taylor.compiled(self.system, domain, group.held, self.options.rtol / FINER)

    def parameters(self, group: Group) -> Array:
        """Run-time parameters of a group, (p, n)."""
        others = [value[group.lanes] if isinstance(value, np.ndarray) else value for value in self.others]
        law = self.law_of(group.lanes)
        return taylor.parameters(self.system, law, others, group.held, len(group.lanes))

    def law_of(self, lanes: Indices) -> Any:
        """Parameters of the law in some lanes."""
        return with_fields(self.system.law, {name: values[lanes] for name, values in self.given.items()})

    def friction(self, lanes: Indices) -> Any:
        """The ground's friction under some lanes."""
        value = self.others[2]
        return value[lanes] if isinstance(value, np.ndarray) else value

    def give_up(self, lanes: Indices) -> None:
        """Leave lanes to the reference engine."""
        self.repeated[lanes] = True

    def finish(self, lanes: Indices, reason: str, detail: str) -> None:
        """Some lanes end."""
        self.reason[lanes] = reason
        self.message[lanes] = REASONS[reason] + (f" ({detail})" if detail else "")
