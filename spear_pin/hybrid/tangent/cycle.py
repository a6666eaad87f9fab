"""The derivative of a cycle along its record, from the section to the section.

Derivatives are taken at a fixed clock of the phase. An event happens τ later for each unit of a direction; into another
phase the clock starts anew, so that nothing else is to be done; within a phase the motion after the event is followed
back to the fixed clock. That is the saltation matrix, with what is held, schedules and parameters in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Reset, Switch
from spear_pin.hybrid.engines.structure import with_fields
from spear_pin.hybrid.rules.impact import struck_toes
from spear_pin.hybrid.rules.latching import latched
from spear_pin.hybrid.tangent.collocation import INSIDE, POINTS, Fineness, carried
from spear_pin.hybrid.tangent.derivative import BEGIN, END, SHORTEST, Derivative, Stretch, falling
from spear_pin.hybrid.tangent.dual import Dual, derivatives, duals
from spear_pin.hybrid.tangent.kinks import later, of_the_inside
from spear_pin.hybrid.tangent.points import points
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable, flat, struck

GRAZING = 1e-6  # of a guard's mean fall over its arc: it falls more slowly through zero


@dataclass
class _Now:
    """On the way: derivatives of the state, of what is held, and of the last event's time.

    Attributes:
        behind: whether those of the state are at that event, not yet at a fixed clock.
        bent: the arc before, if it ended at a kink.
    """

    dy: Array
    held: dict[str, Any]
    tau: Array
    behind: bool = False
    bent: Stretch | None = None
    durations: dict[str, Any] = field(default_factory=dict)
    steepness: float = math.inf


def differentiated(
    system: HybridSystem, recorder: Recorder, y: Array, dy: Array, seeds: Array, fineness: Fineness = INSIDE
) -> Derivative:
    """A cycle from a state on the section, with derivatives.

    Args:
        system: the system.
        recorder: runs the cycle and keeps its arcs.
        y: the state, (2 nv,).
        dy: derivatives of the state, (2 nv, c).
        seeds: of the system's numbers, (p, c).
        fineness: of panels; `ENDS` where nothing inside of arcs is asked for.

    Raises:
        NotDifferentiable: the cycle does not close, or something in it has no derivative; the text says what.
    """
    whole = _Whole(system, recorder, seeds, fineness)
    held = whole.begun(y, dy)
    arcs = recorder.cycle(y)
    now, stretches = _Now(dy, held, np.zeros(dy.shape[1])), []
    for arc in arcs:
        stretch = whole.carry(arc, now)
        stretches.append(stretch)
        whole.pass_event(stretch, now)
    return Derivative(system, recorder.end, now.dy, now.durations, stretches, whole.raw, seeds, now.steepness)


class _Whole:
    """What stays the same along a cycle: the system, its numbers, and their derivatives."""

    def __init__(self, system: HybridSystem, recorder: Recorder, seeds: Array, fineness: Fineness) -> None:
        self.system, self.recorder, self.seeds, self.fineness = system, recorder, seeds, fineness
        self.nv, self.c, self.raw = system.robot.nv, seeds.shape[1], recorder.numbers
        self.law = _dual_law(system, self.raw, seeds)

    def begun(self, y: Array, dy: Array) -> dict[str, Any]:
        """What is held where the cycle begins."""
        _, resets = self.recorder.start
        state = duals(y, dy)
        return dict(latched({}, resets, state[: self.nv], state[self.nv :], self.law))

    def carry(self, arc: Arc, now: _Now) -> Stretch:
        """Derivatives along an arc."""
        n, nv, c, domain = 2 * self.nv, self.nv, self.c, self.recorder.field(arc.domain, arc.held)
        raw = np.concatenate([self.raw, np.array(flat(arc.held), dtype=float).reshape(-1)])
        held = {name: now.held[name] for name in arc.held}
        given = np.concatenate([self.seeds, derivatives(flat(held), c)])
        t, h, y = points(arc, self.fineness)
        # directions are the state's, then those given, then the clock; at the points, at the beginning and at the end
        directions = _directions(n, c)
        every = np.zeros((len(raw), n + c + 1))
        every[:, n:-1] = given
        clocks, states = np.empty(len(t) + 2), np.empty((n, len(t) + 2))
        clocks[:-2], clocks[BEGIN], clocks[END] = t, arc.t, arc.end
        states[:, :-2], states[:, BEGIN], states[:, END] = y, arc.y, arc.after
        values, slopes = domain.at(clocks, states, raw, directions[n], directions[:n, None], every)
        for place, kink in ((BEGIN, now.bent is not None), (END, arc.event is None)):
            if kink:
                slopes.rows[:, place] = of_the_inside(slopes.rows, place)
        if now.behind:
            now.dy, now.behind = now.dy - values.slopes[:, BEGIN, None] * now.tau, False
        motion = slopes.slopes[nv:, :-2, :-1].reshape(nv, -1, POINTS, n + c).transpose(1, 2, 0, 3)
        S = carried(motion, h, now.dy)
        after = now.dy if arc.end - arc.t <= SHORTEST else S.end
        stretch = Stretch(arc, states, S, after, values, slopes, held, now.tau)
        if now.bent is not None:
            now.tau = now.bent.tau = stretch.since = later(now.bent, stretch)
        stretch.tau, now.bent = self._tau(stretch, now), None if arc.event is not None else stretch
        return stretch

    def _tau(self, stretch: Stretch, now: _Now) -> Array:
        """How much later the event that ends an arc happens."""
        arc = stretch.arc
        if arc.event is None:
            return np.zeros(self.c)
        if isinstance(arc.event, Switch):
            due = arc.event.time(arc.switches, self.law)
            return due.d + np.zeros(self.c) if isinstance(due, Dual) else np.zeros(self.c)
        i = stretch.place
        fall, change = stretch.at(END, stretch.slopes.guards[i, END])
        if stretch.at_once:
            # beside this cycle a guard on zero that falls is an event of its own, another one stays at once
            met = abs(stretch.end.guards[i]) <= arc.event.tolerance and falling(fall)
            return -change / fall if met else now.tau
        highest = np.abs(stretch.said.guards[i]).max()
        steepness = -fall * (arc.end - arc.t) / max(highest, 1e-300)
        now.steepness = min(now.steepness, steepness)
        if not steepness > GRAZING:
            raise NotDifferentiable(f"{arc.event.name} grazes: its guard falls through zero with {fall:.3g} a second")
        later: Array = -change / fall
        return later

    def pass_event(self, stretch: Stretch, now: _Now) -> None:
        """What an event does to derivatives; at the end of a phase its duration is noted."""
        arc, tau = stretch.arc, stretch.tau
        now.dy, now.tau, now.behind = stretch.dstate, tau, False
        if arc.event is None or arc.event.reset is None:
            return  # the motion goes on as it was
        reset = arc.event.reset
        now.dy = stretch.dstate + stretch.end.slopes[:, None] * tau
        state = duals(self._strike(arc, reset, now), now.dy)
        q, v = state[: self.nv], state[self.nv :]
        now.held = dict(latched(now.held, [reset], q, v, self.law))
        if reset.phase is not None:
            spent = now.durations.get(arc.domain.phase, 0.0)
            now.durations[arc.domain.phase] = spent + Dual(arc.end, tau)
            now.tau = np.zeros(self.c)
        else:
            now.tau, now.behind = tau, True

    def _strike(self, arc: Arc, reset: Reset, now: _Now) -> Array:
        """What an impact does to derivatives, and to what is held; returns the state behind it."""
        toes, y, nv = struck_toes(self.system, arc.domain, reset), arc.after, self.nv
        if not toes:
            return y
        feet, slopes = self.recorder.feet(tuple(toes)).at(y, self.raw, now.dy, self.seeds)
        change, slope, lifted = struck(feet, slopes, toes, reset.impact)
        now.held = {**now.held, **lifted}
        now.dy[nv:] += slope
        return np.concatenate([y[:nv], y[nv:] + change])


@cache
def _directions(n: int, c: int) -> Array:
    """Along each of n numbers, along c others, and along a clock: (n + 1, n + c + 1)."""
    found: Array = np.concatenate([np.eye(n, n + c + 1), np.eye(1, n + c + 1, n + c)])
    found.setflags(write=False)
    return found


def _dual_law(system: HybridSystem, raw: Array, seeds: Array) -> Any:
    """Parameters of the law, dual."""
    changes = enumerate(np.any(seeds, axis=1).tolist())

    def dual(value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(map(dual, value))
        if value is None or isinstance(value, (bool, str)):
            return value
        i, changed = next(changes)
        return Dual(float(raw[i]), seeds[i]) if changed else value

    return with_fields(system.law, {name: dual(value) for name, value in vars(system.law).items()})
