"""The event-exact run of a hybrid system: integrate, find the event, reset, choose the next domain.

Integration is SciPy's DOP853, restarted at every event and at every scheduled switch of a torque.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, Guard, Held, HybridSystem, Reset
from spear_pin.hybrid.contact import plastic_impact
from spear_pin.hybrid.engines.pinocchio import Flow, flow_names
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.phases import AT_REST, ON_GROUND, SIGN, UNLOADED
from spear_pin.hybrid.trajectory import Event
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
State = tuple[Array, Array]

INSTANT = 1e-7  # s: events closer together than this count as one instant
INSTANT_EVENTS = 20  # so many in one instant are a Zeno point
CYCLE_EVENTS = 1000
MAX_STEP = 0.05  # s
STARTS_TO_SLIDE = 1e-5  # m/s²: on the cone's edge a sliding toe begins with no acceleration

REASONS = {
    "complete": "all cycles were run",
    "fall": "a part other than a toe reached the ground",
    "zeno": "events accumulate: the control laws of two phases undo each other without time passing",
    "painleve": "the slip equation has no unique solution (Painlevé's paradox)",
    "no_event": "a phase went on beyond its time limit",
    "step_size": "the integrator's step size fell to nothing",
    "evaluation_cap": "the run used up its right-hand side evaluations",
    "not_finite": "the state is no longer finite",
}
NUMERICAL = ("step_size", "evaluation_cap", "not_finite")


@dataclass(frozen=True)
class Piece:
    """One accepted integration step, or its part up to an event; times are counted from the phase's beginning."""

    begin: float
    end: float
    state: Callable[[float], Array]


@dataclass
class Segment:
    """Motion in one domain between two events; `began` is the absolute time of the phase's beginning."""

    domain: Domain
    held: Held
    cycle: int
    began: float
    pieces: list[Piece] = field(default_factory=list)


@dataclass
class Run:
    """A run in progress or finished.

    Attributes:
        state: (q, v) reached.
        held: what is held there.
        domain: the last domain.
        segments: the motion, if it was kept.
        events: what happened.
        work: energy by flow of each whole cycle.
        change: change of stored energy of each whole cycle.
        durations: seconds in each phase in the last whole cycle.
        cycles: whole cycles run.
        reason: why it ended, a key of `REASONS`.
        detail: where or on what, in words.
        evaluations: right-hand sides evaluated.
    """

    state: State
    held: Held
    domain: Domain
    segments: list[Segment] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    work: list[Array] = field(default_factory=list)
    change: list[float] = field(default_factory=list)
    durations: Mapping[str, float] = field(default_factory=dict)
    cycles: int = 0
    reason: str = ""
    detail: str = ""
    evaluations: int = 0

    @property
    def message(self) -> str:
        """The reason in a sentence."""
        return REASONS[self.reason] + (f" ({self.detail})" if self.detail else "")

    def event(self, name: str) -> Event:
        """The last event of a name.

        Raises:
            UnknownName: it did not happen.
        """
        for event in reversed(self.events):
            if event.name == name:
                return event
        raise UnknownName("event of this run", name, sorted({event.name for event in self.events}))


@dataclass(frozen=True)
class Options:
    """How a run is computed.

    Attributes:
        rtol: relative tolerance of the integrator.
        atol: absolute tolerance; None means 0.01 rtol.
        max_evaluations: cap on right-hand sides.
        keep: whether to keep the motion for sampling.
    """

    rtol: float = 1e-9
    atol: float | None = None
    max_evaluations: int = 2_000_000
    keep: bool = False

    def __post_init__(self) -> None:
        """Check the fields."""
        if not 1e-13 <= self.rtol <= 1e-2:
            raise BadValue("rtol", self.rtol, "a number from 1e-13 to 1e-2")
        if self.atol is not None and not 0 < self.atol <= 1e-2:
            raise BadValue("atol", self.atol, "a number above 0 and at most 1e-2")


def run(
    system: HybridSystem,
    state: State,
    cycles: int,
    options: Options,
    on_cycle: Callable[[int], object] = lambda n: None,
) -> Run:
    """Run whole cycles from a state (q, v), on the section or in the air.

    Numerical and physical failure end the run with a reason; nothing is raised for them.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
    """
    runner = _Runner(system, state, cycles, options, on_cycle)
    with np.errstate(all="ignore"):
        runner.go()
    return runner.run


class _Runner:
    """The loop's variables: time, state, phase, what is held."""

    def __init__(
        self, system: HybridSystem, state: State, cycles: int, options: Options, on_cycle: Callable[[int], object]
    ) -> None:
        if cycles < 1:
            raise BadValue("cycles", cycles, "at least 1")
        robot = system.robot
        self.system, self.options, self.wanted, self.on_cycle = system, options, cycles, on_cycle
        self.names = (*flow_names(system), "impact", "released")
        self.nw = len(flow_names(system))
        phase, held = starting_phase(system, state)
        q, v = (np.array(part, dtype=float) for part in state)
        self.y = np.concatenate([q, v, np.zeros(self.nw)])
        self.t, self.began, self.switches = 0.0, 0.0, 0  # t counts from the phase's beginning
        self.booked: dict[str, float] = defaultdict(float)
        self.spent: dict[str, float] = defaultdict(float)
        self.instant_events, self.cycle_events, self.last_event = 0, 0, -math.inf
        self.on_section = phase == system.section_phase
        domain, self.flow = self._choose(phase, held)
        self.run = Run((q, v), held, domain)
        self.energy = self._energy()
        self.atol = options.atol or 0.01 * options.rtol
        self.robot: Robot = robot

    def go(self) -> None:
        """Run to the end."""
        while not self.run.reason:
            self._segment()
        nq = self.robot.nq
        self.run.state = self.y[:nq].copy(), self.y[nq : nq + self.robot.nv].copy()
        self.run.held, self.run.domain = self.flow.held, self.flow.domain
        self.run.evaluations += self.flow.evaluations

    # one domain, from entering it to the event that ends it

    def _segment(self) -> None:
        segment = Segment(self.flow.domain, self.flow.held, self.run.cycles + self.on_section, self.began)
        if self.options.keep:
            self.run.segments.append(segment)
        watch = Watch(self.flow, self.t, self.y)
        if watch.at_once is not None:
            y = self.y
            segment.pieces.append(Piece(self.t, self.t, lambda t: y))
            self._happen(self.flow.domain.guards[watch.at_once])
            return
        limit = self.system.phase_limit
        switch = self.flow.domain.switch
        due = switch.time(self.switches + 1, self.system.law) if switch else math.inf
        bound = min(due, limit)
        if bound <= self.t:
            self._end("no_event", f"{limit:g} s in {self.flow.domain.phase}")
            return
        solver = DOP853(
            self.flow, self.t, self.y, bound, max_step=MAX_STEP, rtol=self.options.rtol, atol=self.atol
        )
        slope = solver.f
        while solver.status == "running":
            t0, y0 = solver.t, solver.y
            solver.step()
            if solver.status == "failed":
                finite = np.isfinite(solver.y).all() and np.isfinite(self.flow(t0, y0)).all()
                self._end("step_size" if finite else "not_finite", f"in {self.flow.domain.name} at t = {self._now():.6g} s")
                return
            self.t, self.y = solver.t, solver.y
            if self.run.evaluations + self.flow.evaluations > self.options.max_evaluations:
                self._end("evaluation_cap", f"{self.options.max_evaluations} in {self.flow.domain.name}")
                return
            crossings = watch.step((t0, self.t), (y0, self.y), (slope, solver.f), solver.dense_output)
            slope = solver.f
            solution = solver.dense_output() if self.options.keep or crossings else None
            for time, index in crossings:
                guard = self.flow.domain.guards[index]
                assert solution is not None
                state = solution(time)
                if guard.observes:
                    self._record(guard.name, time, state)
                    continue
                self.t, self.y = time, state
                segment.pieces.append(Piece(t0, time, solution))
                self._happen(guard)
                return
            if solution is not None:
                segment.pieces.append(Piece(t0, self.t, solution))
        if switch is not None and self.t >= due:
            self.switches += 1
            self._happen(Guard(switch.name, _never, switch.reset))
        else:
            self._end("no_event", f"{limit:g} s in {self.flow.domain.phase}")

    # an event: impact, release, latch, phase, domain

    def _happen(self, guard: Guard) -> None:
        if guard.ends is not None:
            self._record(guard.name, self.t, self.y)
            self._end(guard.ends, f"{guard.name} at t = {self._now():.6g} s")
            return
        assert guard.reset is not None
        reset, domain, nq, nv = guard.reset, self.flow.domain, self.robot.nq, self.robot.nv
        q, v = self.y[:nq], self.y[nq : nq + nv]
        before = v.copy()
        work: dict[str, float] = {}
        impulse = np.zeros((len(self.robot.toes), 2))
        if reset.release:
            work["released"] = -self._spring_energy(reset)
        for toe in reset.impact:
            mass_matrix, jacobian = self.robot.mass_matrix(q), self.robot.toe_jacobian(q, toe)
            impact = plastic_impact(mass_matrix, jacobian, v, self.system.contact.friction)
            v = impact.v
            impulse[self.robot.toes.index(toe)] = impact.impulse
            work["impact"] = work.get("impact", 0.0) - impact.loss
        self.y = np.concatenate([q, v, self.y[nq + nv :]])
        held = self.flow.held
        if reset.latch is not None:
            held = {**held, **reset.latch(q.tolist(), v.tolist(), held, self.system.law)}
        now = self._now()
        event = Event(guard.name, now, domain.name, q.copy(), before, v.copy(), impulse, work)
        self.run.events.append(event)
        for name, energy in work.items():
            self.booked[name] += energy
        if self._accumulate(now):
            self._end("zeno", f"{guard.name} in {domain.name} at t = {now:.6g} s")
            return
        phase = reset.phase or domain.phase
        if reset.phase is not None:
            self.spent[domain.phase] += self.t
            self.began, self.t, self.switches = now, 0.0, 0
        self.run.evaluations += self.flow.evaluations
        _, self.flow = self._choose(phase, held)
        if guard.name == self.system.section:
            self._close_cycle()

    def _choose(self, phase: str, held: Held) -> tuple[Domain, Flow]:
        """The domain of a phase whose contact modes are consistent with the state, and its flow."""
        fitting = []
        for domain in self.system.of_phase(phase):
            flow = Flow(self.system, domain, held)
            flow(self.t, self.y)
            motion, force = _consistent(self.system, flow)
            if motion and force:
                return domain, flow
            if motion:
                fitting.append((domain, flow))
        # No mode holds: enter the one whose guard then says why, lift-off where the toe would be pulled,
        # Painlevé's paradox where it can neither stick nor slide.
        pulled = [pair for pair in fitting if _pulled(self.system, pair[1])]
        ill_posed = [pair for pair in fitting if pair[1].ill_posed]
        return (pulled[:1] + ill_posed + fitting)[0]

    def _close_cycle(self) -> None:
        if self.on_section and sum(self.spent.values()) < INSTANT:
            return  # two crossings in one instant bound no cycle
        work = np.array([*self.y[-self.nw :], self.booked["impact"], self.booked["released"]])
        energy = self._energy()
        if self.on_section:
            self.run.work.append(work)
            self.run.change.append(energy - self.energy)
            self.run.durations = dict(self.spent)
            self.run.cycles += 1
            self.on_cycle(self.run.cycles)
            if self.run.cycles == self.wanted:
                self._end("complete", "")
        self.on_section, self.energy = True, energy
        self.booked.clear()
        self.spent.clear()
        self.cycle_events = 0
        self.y[-self.nw :] = 0.0

    # bookkeeping

    def _now(self) -> float:
        return self.began + self.t

    def _end(self, reason: str, detail: str) -> None:
        self.run.reason, self.run.detail = reason, detail

    def _record(self, name: str, time: float, y: Array) -> None:
        nq, nv = self.robot.nq, self.robot.nv
        v = y[nq : nq + nv].copy()
        none = np.zeros((len(self.robot.toes), 2))
        self.run.events.append(Event(name, self.began + time, self.flow.domain.name, y[:nq].copy(), v, v, none))

    def _accumulate(self, now: float) -> bool:
        """Whether this event is one too many in an instant or in a cycle."""
        self.instant_events = self.instant_events + 1 if now - self.last_event < INSTANT else 0
        self.cycle_events += 1
        self.last_event = now
        return self.instant_events >= INSTANT_EVENTS or self.cycle_events >= CYCLE_EVENTS

    def _energy(self) -> float:
        """Stored energy: kinetic, gravity, engaged springs."""
        robot = self.system.robot
        q, v = self.y[: robot.nq], self.y[robot.nq : robot.nq + robot.nv]
        everything = Reset(release=tuple(mount.joint for mount in self.flow.domain.mounts))
        return robot.kinetic_energy(q, v) + robot.potential_energy(q) + self._spring_energy(everything)

    def _spring_energy(self, reset: Reset) -> float:
        held, energy = self.flow.held, 0.0
        for mount in self.flow.domain.mounts:
            if mount.joint in reset.release:
                deflection = float(self.y[self.system.robot.index(mount.joint)]) - held[mount.rest]
                energy += 0.5 * mount.spring.stiffness * held[mount.taut] * deflection**2
        return energy


def starting_phase(system: HybridSystem, state: Any) -> tuple[str, Held]:
    """The phase in which a state lies, and what is held there as if the phase had just begun.

    A toe on the ground and not moving vertically is in the phase that follows the section; else
    the robot is in the air.

    Raises:
        BadValue: the state has the wrong shape, is not finite, or has a toe below the ground.
    """
    robot = system.robot
    if not (isinstance(state, (tuple, list)) and len(state) == 2):
        raise BadValue("state", state, "a pair (q, v)")
    q, v = np.asarray(state[0], dtype=float), np.asarray(state[1], dtype=float)
    heights = {toe: robot.toe_position(q, toe)[1] for toe in robot.toes}
    robot.bias(q, v)  # checks v as well
    for toe, height in heights.items():
        if height < -ON_GROUND:
            raise BadValue(f"height of {toe}", height, "at or above the ground, at 0 m")
    stance = system.section_phase
    closed = [toe for toe, mode in zip(robot.toes, system.of_phase(stance)[0].contacts, strict=True) if mode != OPEN]
    rests = all(heights[toe] <= ON_GROUND and abs(robot.toe_jacobian(q, toe)[1] @ v) <= 10 * AT_REST for toe in closed)
    flight = next((d.phase for d in system.domains if all(mode == OPEN for mode in d.contacts)), stance)
    held: Held = {}
    for phase in (flight, stance):
        latch = system.reset_into(phase).latch
        if latch is not None:
            held = {**held, **latch(q.tolist(), v.tolist(), held, system.law)}
    return (stance if rests else flight), held


def _consistent(system: HybridSystem, flow: Flow) -> tuple[bool, bool]:
    """Whether a domain's contact modes fit the toes' sliding, and whether its forces keep them there."""
    motion, force = True, True
    friction = system.contact.friction
    for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True):
        if mode == OPEN:
            continue
        sliding = flow.toe_velocity(toe)[0]
        tangential, normal = flow.force(toe)
        force = force and normal > 0.0 and not flow.ill_posed
        if mode == STICK:
            motion = motion and abs(sliding) <= AT_REST
            # on the cone's edge, within the slip guard's tolerance, it is about to slide
            force = force and abs(tangential) < friction * normal - UNLOADED
        elif abs(sliding) > AT_REST:
            motion = motion and sliding * SIGN[mode] > 0.0
        else:
            force = force and flow.toe_acceleration(toe)[0] * SIGN[mode] > -STARTS_TO_SLIDE
    return motion, force


def _pulled(system: HybridSystem, flow: Flow) -> bool:
    """Whether some toe on the ground would have to be held down."""
    closed = [toe for toe, mode in zip(system.robot.toes, flow.domain.contacts, strict=True) if mode != OPEN]
    return not flow.ill_posed and any(flow.force(toe)[1] <= 0.0 for toe in closed)


def _never(*_: Any) -> float:
    return 1.0
