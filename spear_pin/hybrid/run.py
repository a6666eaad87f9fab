"""The event-exact run of a hybrid system: integrate, find the event, reset, choose the next domain.

Integration is restarted at every event and at every scheduled switch of a torque.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.filippov import going_on, sliding
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.integration import DUE, KNOT, accuracy, integrated
from spear_pin.hybrid.modes import choose, resuming_phase, starting_phase, torn
from spear_pin.hybrid.resting import resting
from spear_pin.hybrid.result import BOOKED, Moment, Options, Piece, Run, Segment, State
from spear_pin.hybrid.rules import cycles as rules
from spear_pin.hybrid.rules.entry import GLIMPSES, NONE, ahead
from spear_pin.hybrid.rules.latching import latched
from spear_pin.hybrid.stored import in_inductances, in_mechanism, in_springs
from spear_pin.hybrid.strikes import Overlap, struck
from spear_pin.hybrid.trajectory import Event

NOTHING = 1e-12  # J: a spring that was latched in this instant


def run(
    system: HybridSystem,
    state: State | Moment,
    cycles: int,
    options: Options,
    on_cycle: Callable[[int], object] = lambda n: None,
    on_segment: Callable[[Segment], object] | None = None,
) -> Run:
    """Run whole cycles from a state (q, v), on the section or in the air, or from a moment of another run.

    Numerical and physical failure end the run with a reason; nothing is raised for them.

    Args:
        system: robot, law and ground.
        state: (q, v), or a moment of another run.
        cycles: number of whole cycles; of a system without a section none closes, and it runs until it ends.
        options: how it is computed.
        on_cycle: told the number of cycles after each of them.
        on_segment: takes each segment when it is over; without it a motion that is kept is in the result.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
        BadFunction: there is a mistake in a law, a guard, a latch, a spring or a ground of one's own.
    """
    runner = _Runner(system, state, cycles, options, on_cycle)
    kept = runner.run.segments.append if options.keep else lambda segment: None
    with np.errstate(all="ignore"):
        runner.go(on_segment or kept)
    return runner.run


class _Runner:
    """The loop's variables: time, state, phase, what is held."""

    def __init__(
        self,
        system: HybridSystem,
        state: State | Moment,
        cycles: int,
        options: Options,
        on_cycle: Callable[[int], object],
    ) -> None:
        if not cycles >= 1 or cycles % 1:
            raise BadValue("cycles", cycles, "a whole number, at least 1")
        self.robot = system.robot
        self.system, self.options, self.wanted, self.on_cycle = system, options, cycles, on_cycle
        self.nw = len(flow_names(system))
        if isinstance(state, Moment):
            (phase, held), begun, pair = resuming_phase(system, state), state.t, (state.q, state.v)
        else:
            (phase, held), begun, pair = starting_phase(system, state), 0.0, state
        q, v = (np.array(part, dtype=float) for part in pair)
        self.nx = len(system.hardware.names) if system.hardware is not None else 0
        self.y = np.concatenate([q, v, np.zeros(self.nx + self.nw)])
        self.t, self.began, self.switches = begun, -begun, 0  # t counts from the phase's beginning
        self.booked: dict[str, float] = defaultdict(float)
        self.spent: dict[str, float] = defaultdict(float)
        self.came: tuple[Domain, Reset] | None = None  # from where the present phase was entered
        self.grounded = np.full(len(self.robot.toes), -np.inf)  # when each toe was last on the ground
        self.overlap = Overlap(system.overlap)
        self.instant_events, self.cycle_events, self.last_event = 0, 0, -math.inf
        self.instant: list[Reset] = []  # into other phases, of the present instant
        self.tried: list[Domain] = []  # motion of toes at rest that began in it
        self.on_section = bool(system.section) and phase in system.section_phases and begun == 0.0
        self.flow = choose(system, phase, held, self.t, self.y)
        self.run = Run((q, v), (q, v), held, self.flow.domain)
        self.energy, self.inductive = self._energy(), in_inductances(self.system, self.y)
        self.accuracy = accuracy(options, system.hardware)

    def go(self, on_segment: Callable[[Segment], object]) -> None:
        """Run to the end."""
        while not self.run.reason:
            segment = Segment(self.flow.domain, self.flow.held, self.run.cycles + self.on_section, self.began)
            self._segment(segment)
            on_segment(segment)
        nq = self.robot.nq
        self.run.state = self.y[:nq].copy(), self.y[nq : nq + self.robot.nv].copy()
        self.run.held, self.run.domain = self.flow.held, self.flow.domain
        self.run.evaluations += self.flow.evaluations

    # one domain, from entering it to the event that ends it

    def _segment(self, segment: Segment) -> None:
        watch = Watch(self.flow, self.t, self.y)
        if watch.at_once != NONE:
            y = self.y
            segment.pieces.append(Piece(self.t, self.t, lambda times: np.tile(y[:, None], len(times))))
            segment.ended = self.flow.domain.guards[watch.at_once]
            self._leave(segment.ended)
            return
        until = min(rules.due(self.flow.domain, self.switches, self.system.law), self.system.phase_limit)
        if until <= self.t:
            self._overdue()
        elif watch.undefined or not np.isfinite(self.flow(self.t, self.y)).all():
            self._break_off("not_finite")
        else:
            event = self._move(segment, watch, until)
            if event is not None:
                segment.ended = event
                self._happen(event)

    def _leave(self, guard: Guard) -> None:
        """An event as soon as the domain is entered, which may be the begin of motion on a switching surface."""
        chatter = self._chatter(guard)
        if chatter is None:
            self._happen(guard)
        else:
            self._enter(chatter.domain.phase, self.flow.domain.spent_in)
            self._move_to(chatter)

    def _move(self, segment: Segment, watch: Watch, until: float) -> Guard | None:
        """Integrate up to the first event, which is returned, or the scheduled one.

        None where motion breaks off, or only passes a knot of a spring's curve, from which it is integrated anew.
        """
        keep, most = self.options.keep, self.options.max_evaluations - self.run.evaluations
        motion = integrated(self.flow, watch, self.t, self.y, until, self.accuracy, keep=keep, most=most)
        self.t, self.y = motion.t, motion.y
        segment.pieces += motion.pieces
        for observed in motion.observed:
            self._record(*observed)
        if motion.why == "evaluation_cap":
            self._end(motion.why, f"{self.options.max_evaluations} in {self.flow.domain.name}")
        elif motion.why == DUE:
            return self._scheduled()
        elif motion.why and motion.why != KNOT:
            self._break_off(motion.why)
        return motion.event

    def _scheduled(self) -> Guard | None:
        """What is due now, as an event."""
        switch = self.flow.domain.switch
        if switch is None or self.t < rules.due(self.flow.domain, self.switches, self.system.law):
            self._overdue()
            return None
        self.switches += 1
        return Guard(switch.name, _never, switch.reset)

    # an event: impact, release, latch, phase, domain

    def _happen(self, guard: Guard) -> None:
        if guard.ends is not None:
            self._record(guard.name, self.t, self.y)
            self._end(guard.ends, f"{guard.name} at t = {self._now():.6g} s")
            return
        assert guard.reset is not None
        reset, domain, now = guard.reset, self.flow.domain, self._now()
        self.grounded[domain.on_ground] = now
        again = bool(rules.retouches(self.system, reset, now - self.grounded))
        try:
            held = self._reset(rules.RETOUCH if again else guard.name, reset)
        except _Undefined:
            self._end("not_finite", f"what {guard.name} does at t = {now:.6g} s")
            return
        reason = self._too_many(now)
        if reason:
            among = dict.fromkeys(event.domain for event in self.run.events[-rules.INSTANT_EVENTS :])
            self._end(reason, f"{guard.name} in {domain.name} at t = {now:.6g} s, among {', '.join(among)}")
            return
        if reset.phase is not None:
            self._enter(reset.phase, rules.counts_to(domain, reset, again))
            self.came = domain, reset
            self.instant.append(reset)
        self._choose(reset, reset.phase or domain.phase, held)
        if guard.name == self.system.section and not again:
            self._close_cycle()

    def _reset(self, name: str, reset: Reset) -> Held:
        """Reset the state at an event, record and book it; returns what is held then.

        Raises:
            _Undefined: its impact, or what it latches, has no value.
        """
        nq, nv, held = self.robot.nq, self.robot.nv, self.flow.held
        q, v = self.y[:nq], self.y[nq : nq + nv]
        before, impulse = v.copy(), np.zeros((len(self.robot.toes), self.robot.dimension))
        work: dict[str, float] = {}
        if reset.release:
            work["released"] = -in_springs(self.system, self.flow.domain, held, self.y, reset.release)
        try:
            strike = struck(self.system, self.flow.domain, reset, q, v, self.overlap, self._now())
        except ArithmeticError:
            raise _Undefined from None
        if strike is not None:
            v, impulse, work["impact"] = strike.v, strike.impulse, strike.work
            held = {**held, **strike.rises}
        self.y = np.concatenate([q, v, self.y[nq + nv :]])
        try:
            held = latched(held, [reset], q.tolist(), v.tolist(), self.system.law, self.system.place_of)
        except ArithmeticError:
            raise _Undefined from None
        domain = self.flow.domain.name
        self.run.events.append(Event(name, self._now(), domain, q.copy(), before, v.copy(), impulse, work))
        for flow, energy in work.items():
            self.booked[flow] += energy
        return held

    def _choose(self, reset: Reset, phase: str, held: Held) -> None:
        """Go on in the domain that fits after an event, on switching surfaces if it was within a phase on them."""
        stays = None if reset.phase is not None else going_on(self.system, self.flow, held, self.y)
        flow = stays or choose(self.system, phase, held, self.t, self.y)
        if reset == Reset():
            for toe in torn(self.flow, flow, self.t, self.y):
                self._record(f"painleve:{toe}", self.t, self.y)
        self._move_to(flow)

    def _enter(self, phase: str, spent_in: str) -> None:
        """Begin a phase: its clock and its switches start anew; the time since the last began counts to `spent_in`."""
        self.spent[spent_in] += self.t
        self.began, self.t, self.switches = self._now(), 0.0, 0

    def _move_to(self, flow: Flow) -> None:
        self.run.evaluations += self.flow.evaluations
        self.grounded[self.flow.domain.on_ground] = self._now()
        self.flow = flow

    def _chatter(self, guard: Guard) -> Flow | None:
        """Motion on a switching surface, where this phase is left as soon as entered for one that would be too.

        Where phases follow each other round and round in an instant, on all surfaces that there are.
        """
        if self.came is None or guard.reset is None or not rules.left_at_once(guard, self.t):
            return None
        found: Flow | None = None
        if guard.reset.phase == self.came[0].phase:
            found = sliding(self.system, self.flow, guard, self.came, self.y)
        again = any(reset is guard.reset for reset in self.instant) or self.came[0].crossing is not None
        return self._resting() if found is None and again else found

    def _resting(self) -> Flow | None:
        """Motion in which toes at rest alternate that has not ended in this instant already."""
        found = resting(self.system, self.flow, self.y, self.tried)
        if found is None or self._loses(found.domain):
            return None
        self.tried.append(found.domain)
        return found

    def _break_off(self, reason: str) -> None:
        """End the run, unless what cannot go on is motion of two toes, whose shares may cease to exist.

        Raises:
            BadFunction: a function of one's own has no value.
        """
        for h in GLIMPSES:  # a function may have no value just ahead, where steps fell to nothing before it
            if self.flow.own.fault is None and reason == "step_size":
                ahead(self.flow, self.t, self.y, h)
        if self.flow.own.fault is not None:
            raise self.flow.own.fault
        if self.flow.domain.crossing is None:
            self._end(reason, self._where())
            return
        ended = self.flow.domain
        self.tried = [ended]
        found = self._resting()
        if found is None:
            self._happen(ended.guards[0])  # both toes bear, if they can
            self.tried.append(ended)
        else:
            self._enter(found.domain.phase, self.flow.domain.spent_in)
            self._move_to(found)

    def _loses(self, domain: Domain) -> bool:
        """Whether springs that are not engaged in a domain still store something."""
        engaged = {mount.joint for mount in domain.mounts}
        let_go = {mount.joint for mount in self.flow.domain.mounts} - engaged
        return in_springs(self.system, self.flow.domain, self.flow.held, self.y, let_go) > NOTHING

    def _close_cycle(self) -> None:
        if self.on_section and not rules.whole(sum(self.spent.values())):
            return
        work = np.array([*self.y[-self.nw :], *(self.booked[name] for name in BOOKED)])
        energy = self._energy()
        if self.on_section:
            self.run.work.append(work)
            self.run.change.append(energy - self.energy)
            self.run.stored.append(in_inductances(self.system, self.y) - self.inductive)
            self.run.durations = dict(self.spent)
            self.run.cycles += 1
            self.on_cycle(self.run.cycles)
            if self.run.cycles == self.wanted:
                self._end("complete", "")
        self.on_section, self.energy, self.inductive = True, energy, in_inductances(self.system, self.y)
        self.booked.clear()
        self.spent.clear()
        self.cycle_events = 0
        self.y[-self.nw :] = 0.0

    # bookkeeping

    def _now(self) -> float:
        return self.began + self.t

    def _where(self) -> str:
        return f"in {self.flow.domain.name} at t = {self._now():.6g} s"

    def _end(self, reason: str, detail: str) -> None:
        self.run.reason, self.run.detail = reason, detail

    def _overdue(self) -> None:
        domain = self.flow.domain
        held = any(rub.sign == 0 for rub in domain.rubs)
        self._end("stuck" if held else "no_event", f"{self.system.phase_limit:g} s in {domain.phase}")

    def _record(self, name: str, time: float, y: Array) -> None:
        nq, nv = self.robot.nq, self.robot.nv
        v = y[nq : nq + nv].copy()
        none = np.zeros((len(self.robot.toes), self.robot.dimension))
        self.run.events.append(Event(name, self.began + time, self.flow.domain.name, y[:nq].copy(), v, v, none))

    def _too_many(self, now: float) -> str:
        """Why the run ends, if this event is one too many in an instant or in a cycle."""
        self.instant_events = rules.crowded(self.instant_events, now - self.last_event)
        if not self.instant_events:
            self.instant, self.tried = [], []
        self.cycle_events += 1
        self.last_event = now
        return rules.too_many(self.instant_events, self.cycle_events)

    def _energy(self) -> float:
        return in_mechanism(self.system, self.flow.domain, self.flow.held, self.y)


class _Undefined(Exception):
    """An event does what has no value."""


def _never(*_: Any) -> float:
    return 1.0
