"""Runs a hybrid system event-exactly: integrates, finds the event, resets, chooses the next domain.

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
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import GRIPS, SLIPS, Domain, Guard, Held, Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.filippov import continue_sliding, find_sliding
from spear_pin.hybrid.flow_names import IMPACT, booked_flows, flow_names, released_flows
from spear_pin.hybrid.integration import DUE, KNOT, Motion, accuracy, integrate_motion
from spear_pin.hybrid.modes import choose, find_torn, resuming_phase, starting_phase
from spear_pin.hybrid.resting import find_resting
from spear_pin.hybrid.result import Moment, Options, Piece, Run, Segment, State
from spear_pin.hybrid.rules import cycles as rules
from spear_pin.hybrid.rules.entry import GLIMPSES, NONE, ahead
from spear_pin.hybrid.rules.jumping import apply_jump
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.sampled import Loop
from spear_pin.hybrid.stored import in_inductances, in_mechanism, in_springs
from spear_pin.hybrid.strikes import Overlap, strike_toes
from spear_pin.hybrid.trajectory import Event

NOTHING = 1e-12  # J: energy of a spring that was latched in this instant


def run(
    system: HybridSystem,
    state: State | Moment,
    cycles: int,
    options: Options,
    on_cycle: Callable[[int], object] = lambda n: None,
    on_segment: Callable[[Segment], object] | None = None,
    integrate: Callable[..., Motion] = integrate_motion,
) -> Run:
    """Runs whole cycles from a state (q, v), on the section or in the air, or from a moment of another run.

    Numerical and physical failures end the run with a reason, and raise no exception.

    Args:
        system: robot, law and ground.
        state: (q, v), or a moment of another run.
        cycles: number of whole cycles; a system without a section closes none, and runs until it ends.
        options: options for the computation.
        on_cycle: called with the number of cycles after each cycle.
        on_segment: called with each segment when it is over; without it the result has the motion, if it is kept.
        integrate: integrates the motion in a domain, as `integrate_motion` does.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
        BadFunction: there is a mistake in a user's law, guard, latch, spring or ground.
    """
    runner = _Runner(system, state, cycles, options, on_cycle, integrate)
    kept = runner.run.segments.append if options.keep else lambda segment: None
    with np.errstate(all="ignore"):
        runner.go(on_segment or kept)
    return runner.run


class _Runner:
    """The variables of the loop: time, state, phase, held values."""

    def __init__(
        self,
        system: HybridSystem,
        state: State | Moment,
        cycles: int,
        options: Options,
        on_cycle: Callable[[int], object],
        integrate: Callable[..., Motion],
    ) -> None:
        if not cycles >= 1 or cycles % 1:
            raise BadValue("cycles", cycles, "a whole number, at least 1")
        self.loop = None if options.sample_time is None else Loop(system, options.sample_time, options.latency)
        system = system if self.loop is None else self.loop.system
        self.robot = system.robot
        self.system, self.options, self.wanted, self.on_cycle = system, options, cycles, on_cycle
        self.integrate = integrate
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
        self.came: tuple[Domain, Reset] | None = None  # the domain and reset that led into the phase
        self.grounded = np.full(len(self.robot.toes), -np.inf)  # time at which each toe was last on the ground
        self.overlap = Overlap(system.overlap)
        self.instant_events, self.cycle_events, self.last_event = 0, 0, -math.inf
        self.instant: list[Reset] = []  # resets into other phases in the present instant
        self.tried: list[Domain] = []  # motions of toes at rest that began in this instant
        self.on_section = bool(system.section) and phase in system.section_phases and begun == 0.0
        held = held if self.loop is None else self.loop.begin(phase, held, self.t, self.y)
        self.flow = choose(system, phase, held, self.t, self.y)
        self.run = Run((q, v), (q, v), held, self.flow.domain)
        self.energy, self.inductive = self._energy(), in_inductances(self.system, self.y)
        self.accuracy = accuracy(options, system.hardware)

    def go(self, on_segment: Callable[[Segment], object]) -> None:
        """Runs to the end."""
        while not self.run.reason:
            segment = Segment(self.flow.domain, self.flow.held, self.run.cycles + self.on_section, self.began)
            self._segment(segment)
            on_segment(segment)
        nq = self.robot.nq
        self.run.state = self.y[:nq].copy(), self.y[nq : nq + self.robot.nv].copy()
        self.run.held, self.run.domain = self.flow.held, self.flow.domain
        self.run.evaluations += self.flow.evaluations

    # one domain, from its entry to the event that ends it

    def _segment(self, segment: Segment) -> None:
        if self.loop is not None and self.loop.is_due(self._now()):
            held = self.loop.passed(self._now(), self.flow.domain, self.flow.held, self.t, self.y)
            if held is not self.flow.held:
                self._choose(Reset(), self.flow.domain.phase, held)
            return
        watch = Watch(self.flow, self.t, self.y)
        if watch.at_once != NONE:
            y = self.y
            segment.pieces.append(Piece(self.t, self.t, lambda times: np.tile(y[:, None], len(times))))
            segment.ended = self.flow.domain.guards[watch.at_once]
            self._leave(segment.ended)
            return
        until = min(
            rules.due(self.flow.domain, self.switches, self.system.law, self.flow.held),
            self.system.phase_limit,
            math.inf if self.loop is None else self.loop.next - self.began,
        )
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
        """Carries out an event on entering the domain, which may begin motion on a switching surface."""
        chatter = self._chatter(guard)
        if chatter is None:
            self._happen(guard)
        else:
            self._enter(chatter.domain.phase, self.flow.domain.spent_in)
            self._move_to(chatter)

    def _move(self, segment: Segment, watch: Watch, until: float) -> Guard | None:
        """Integrates up to the first event, or the scheduled one, and returns it.

        Returns None if the motion breaks off, or only passes a knot of a spring's curve, where integration restarts.
        """
        keep, most = self.options.keep, self.options.max_evaluations - self.run.evaluations
        motion = self.integrate(self.flow, watch, self.t, self.y, until, self.accuracy, keep=keep, most=most)
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
        """Returns the scheduled event that is due now."""
        switch = self.flow.domain.switch
        if switch is None or self.t < rules.due(self.flow.domain, self.switches, self.system.law, self.flow.held):
            if self.loop is None or not self.loop.is_due(self._now()):
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
            held = self._reset(rules.RETOUCH if again else guard.name, reset, begins=not again)
        except ArithmeticError:
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

    def _reset(self, name: str, reset: Reset, *, begins: bool) -> Held:
        """Resets the state at an event, records the event and books its energy; returns the values held after it.

        A toe that only touches again begins no cycle.

        Raises:
            ArithmeticError: its impact, or its latch, has no value.
        """
        nq, nv, held = self.robot.nq, self.robot.nv, self.flow.held
        q, v = self.y[:nq], self.y[nq : nq + nv]
        if self.robot.closure is not None:
            q, v = self.robot.closure.projected(q, v)
            if not np.isfinite(q).all():
                raise ArithmeticError("loops cannot be closed")
        before, impulse = v.copy(), np.zeros((len(self.robot.toes), self.robot.dimension))
        work: dict[str, float] = {}
        system, domain = self.system, self.flow.domain
        for flow, names in released_flows(system, domain, reset.release).items():
            work[flow] = -in_springs(system, domain, held, self.y, names)
        strike = strike_toes(system, domain, reset, q, v, self.overlap, self._now())
        if strike is not None:
            v, impulse, work[IMPACT] = strike.v, strike.impulse, strike.work
            held = {**held, **strike.rises}
        self.y = np.concatenate([q, v, self.y[nq + nv :]])
        if reset.jump is not None:
            kept = {mount.name for mount in domain.mounts} - {*reset.release}
            was = in_mechanism(system, domain, held, self.y, kept)
            q, v = map(np.array, apply_jump(reset, q.tolist(), v.tolist(), held, system.law, system.place_of))
            self.y[: nq + nv] = *q, *v
            work[IMPACT] = work.get(IMPACT, 0.0) + in_mechanism(system, domain, held, self.y, kept) - was
        clock, old = Clock(self.t, system.springs, system), held
        held = latch_values(
            held, [reset], q.tolist(), v.tolist(), system.law, system.place_of, begins=begins, clock=clock
        )
        # a clutch that begins or stops slipping loses nothing in that instant
        switched = {edge.mount.name for edge in reset.edges if edge.kind not in (SLIPS, GRIPS)}
        for flow, names in released_flows(system, domain, switched).items():
            stored = [in_springs(system, domain, each, self.y, names) for each in (held, old)]
            if stored[0] != stored[1]:
                work[flow] = work.get(flow, 0.0) + stored[0] - stored[1]
        self.run.events.append(Event(name, self._now(), domain.name, q.copy(), before, v.copy(), impulse, work))
        for flow, energy in work.items():
            self.booked[flow] += energy
        return held

    def _choose(self, reset: Reset, phase: str, held: Held) -> None:
        """Continues after an event in the domain that fits, or on switching surfaces if it was on them before."""
        stays = None if reset.phase is not None else continue_sliding(self.system, self.flow, held, self.y)
        flow = stays or choose(self.system, phase, held, self.t, self.y)
        if reset == Reset():
            for toe in find_torn(self.flow, flow, self.t, self.y):
                self._record(f"painleve:{toe}", self.t, self.y)
        self._move_to(flow)

    def _enter(self, phase: str, spent_in: str) -> None:
        """Begins a phase with new clock and switches; the time since the last phase began counts to `spent_in`."""
        self.spent[spent_in] += self.t
        self.began, self.t, self.switches = self._now(), 0.0, 0

    def _move_to(self, flow: Flow) -> None:
        self.run.evaluations += self.flow.evaluations
        self.grounded[self.flow.domain.on_ground] = self._now()
        self.flow = flow

    def _chatter(self, guard: Guard) -> Flow | None:
        """Finds the motion on a switching surface, if this phase and the next are both left as soon as entered.

        If phases repeat in a cycle within an instant, it is motion on all their surfaces.
        """
        if self.came is None or guard.reset is None or not rules.left_at_once(guard, self.t):
            return None
        found: Flow | None = None
        if guard.reset.phase == self.came[0].phase:
            found = find_sliding(self.system, self.flow, guard, self.came, self.y)
        again = any(reset is guard.reset for reset in self.instant) or self.came[0].crossing is not None
        return self._resting() if found is None and again else found

    def _resting(self) -> Flow | None:
        """Finds a motion in which toes at rest alternate, and which has not already ended in this instant."""
        found = find_resting(self.system, self.flow, self.y, self.tried)
        if found is None or self._loses(found.domain):
            return None
        self.tried.append(found.domain)
        return found

    def _break_off(self, reason: str) -> None:
        """Ends the run, unless the motion is that of two alternating toes, whose shares may cease to exist.

        Raises:
            BadFunction: a user function has no value.
        """
        for h in GLIMPSES:  # a function may have no value just ahead, so that steps shrank to zero before it
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
        """Tells whether springs that are not engaged in a domain still store energy."""
        let_go = {mount.name for mount in self.flow.domain.mounts} - {mount.name for mount in domain.mounts}
        return in_springs(self.system, self.flow.domain, self.flow.held, self.y, let_go) > NOTHING

    def _close_cycle(self) -> None:
        if self.on_section and not rules.whole(sum(self.spent.values())):
            return
        work = np.array([*self.y[-self.nw :], *(self.booked[name] for name in booked_flows(self.system))])
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
        """Returns why the run ends, if this event is one too many in an instant or in a cycle."""
        self.instant_events = rules.count_crowd(self.instant_events, now - self.last_event)
        if not self.instant_events:
            self.instant, self.tried = [], []
        self.cycle_events += 1
        self.last_event = now
        return rules.too_many(self.instant_events, self.cycle_events)

    def _energy(self) -> float:
        return in_mechanism(self.system, self.flow.domain, self.flow.held, self.y)


def _never(*_: Any) -> float:
    return 1.0
