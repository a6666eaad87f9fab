"""The derivative of a cycle along its record, from the section to the section.

Derivatives are taken at a fixed clock of the phase. An event happens τ later for each unit of a direction; into another
phase the clock starts anew, so that nothing else is to be done; within a phase the motion after the event is followed
back to the fixed clock. That is the saltation matrix, with what is held, schedules and parameters in it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Reset, Switch
from spear_pin.hybrid.engines.structure import with_fields
from spear_pin.hybrid.rules.impact import struck_toes
from spear_pin.hybrid.rules.latching import latched
from spear_pin.hybrid.tangent.collocation import POINTS, TAIL, carried, roughness, rule
from spear_pin.hybrid.tangent.dual import Dual, value_of
from spear_pin.hybrid.tangent.fields import Values
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable, derivatives, duals, flat, struck

Array = NDArray[np.float64]
MOST_PANELS = 64  # of an arc, which has as many as its motion needs
SHORTEST = 1e-9  # s: there is nothing to be carried along a shorter arc
EARLY = 4  # points that do not count yet where panels are long
GRAZING = 1e-6  # of a guard's mean fall over its arc: it falls more slowly through zero


@dataclass(frozen=True)
class Stretch:
    """An arc with derivatives at Gauss's points of its panels, in rising time.

    Attributes:
        arc: the arc.
        t: clock of the phase, (k,).
        weights: of an integral over the arc, (k,).
        y: states, (2 nv, k).
        dy: their derivatives, (2 nv, k, c).
        values: what the domain says there.
        derivatives: of that, (..., k, c).
        since: derivative of the time at which it begins, (c,).
        tau: of the time at which it ends, (c,).
        state: at its end, just before the event, (2 nv,).
        dstate: its derivatives at the fixed clock, (2 nv, c).
        end: what the domain says there.
        dend: derivatives of that at the fixed clock.
        rate: rates of that along the motion.
    """

    arc: Arc
    t: Array
    weights: Array
    y: Array
    dy: Array
    values: Values
    derivatives: Values
    since: Array
    tau: Array
    state: Array
    dstate: Array
    end: Values
    dend: Values
    rate: Values


@dataclass(frozen=True)
class Derivative:
    """A cycle with its derivatives along c directions.

    Attributes:
        system: the system.
        y: state just behind the section, (2 nv,).
        dy: its derivatives, (2 nv, c).
        durations: of each phase, in s, dual.
        stretches: the arcs.
        steepness: of the guard that falls most slowly through zero, in its mean fall over its arc.
    """

    system: HybridSystem
    y: Array
    dy: Array
    durations: Mapping[str, Any]
    stretches: Sequence[Stretch]
    steepness: float

    @property
    def order(self) -> tuple[str, ...]:
        """Names of the events that change something, in order."""
        events = [each.arc.event for each in self.stretches]
        return tuple(event.name for event in events if event is not None and event.reset is not None)

    @property
    def borders(self) -> tuple[str, ...]:
        """Names of events that meet another: derivatives are of the order that happens, and one-sided.

        An event at once whose guard is far below zero meets none: it stays at once beside this cycle.
        """
        found = []
        for each in self.stretches:
            arc = each.arc
            if isinstance(arc.event, Guard) and arc.end - arc.t <= SHORTEST:
                i = next(k for k, guard in enumerate(arc.domain.guards) if guard is arc.event)
                found += [arc.event.name] * bool(abs(each.end.guards[i]) <= arc.event.tolerance)
        return tuple(found)


@dataclass
class _Now:
    """On the way: derivatives of the state, of what is held, and of the last event's time.

    Attributes:
        behind: whether those of the state are at that event, not yet at a fixed clock.
    """

    dy: Array
    held: dict[str, Any]
    tau: Array
    behind: bool = False
    durations: dict[str, Any] = field(default_factory=dict)
    steepness: float = math.inf


def differentiated(system: HybridSystem, recorder: Recorder, y: Array, dy: Array, seeds: Array) -> Derivative:
    """A cycle from a state on the section, with derivatives.

    Args:
        system: the system.
        recorder: runs the cycle and keeps its arcs.
        y: the state, (2 nv,).
        dy: derivatives of the state, (2 nv, c).
        seeds: of the system's numbers, (p, c).

    Raises:
        NotDifferentiable: the cycle does not close, or something in it has no derivative; the text says what.
    """
    whole = _Whole(system, recorder, seeds)
    held = whole.begun(y, dy)
    arcs = recorder.cycle(y)
    now, stretches = _Now(dy, held, np.zeros(dy.shape[1])), []
    for arc in arcs:
        stretch = whole.carry(arc, now)
        stretches.append(stretch)
        whole.pass_event(stretch, now)
    return Derivative(system, recorder.end, now.dy, now.durations, stretches, now.steepness)


class _Whole:
    """What stays the same along a cycle: the system, its numbers, and their derivatives."""

    def __init__(self, system: HybridSystem, recorder: Recorder, seeds: Array) -> None:
        self.system, self.recorder, self.seeds = system, recorder, seeds
        self.nv, self.c, self.raw = system.robot.nv, seeds.shape[1], recorder.numbers
        self.law = _dual_law(system, self.raw, seeds)

    def begun(self, y: Array, dy: Array) -> dict[str, Any]:
        """What is held where the cycle begins."""
        _, resets = self.recorder.start
        state = duals(y, dy)
        return dict(latched({}, resets, state[: self.nv], state[self.nv :], self.law))

    def carry(self, arc: Arc, now: _Now) -> Stretch:
        """Derivatives along an arc."""
        n, nv, field_ = 2 * self.nv, self.nv, self.recorder.field(arc.domain, arc.held)
        raw = np.concatenate([self.raw, np.array(flat(arc.held), dtype=float).reshape(-1)])
        given = np.concatenate([self.seeds, derivatives(flat({name: now.held[name] for name in arc.held}), self.c)])
        t, weights, h, y = self._points(arc)
        panels = len(t) // POINTS
        # the state's directions, the clock's, then those given; at the points, at the beginning and at the end
        every = np.concatenate([np.zeros((len(raw), n + 1)), given], axis=1)
        clock = np.eye(1, n + 1 + self.c, n)
        points, states = np.concatenate([t, [arc.t, arc.end]]), np.column_stack([y, arc.y, arc.after])
        along = np.repeat(np.eye(n, n + 1 + self.c)[:, None], len(points), axis=1)
        values, slopes = field_.at(points, states, raw, clock, along, every)
        if now.behind:
            now.dy, now.behind = now.dy - values.slopes[:, -2, None] * now.tau, False
        motion = np.moveaxis(slopes.slopes[nv:, :-2], 0, 1).reshape(panels, POINTS, nv, -1)
        S, after = carried(motion[..., :n], motion[..., n + 1 :], h, now.dy)
        if arc.end - arc.t <= SHORTEST:
            after = now.dy
        dy = S.reshape(len(t), n, self.c)
        inside, end = Values(*(each[:, :-2] for each in values)), Values(*(each[:, -1] for each in values))
        last = [each[:, -1] for each in slopes]
        chained = Values(*(each[:, :-2, :n].swapaxes(0, 1) @ dy for each in slopes))
        chained = Values(
            *(part.swapaxes(0, 1) + each[:, :-2, n + 1 :] for part, each in zip(chained, slopes, strict=True))
        )
        dend = Values(*(each[:, :n] @ after + each[:, n + 1 :] for each in last))
        rate = Values(*(each[:, :n] @ end.slopes + each[:, n] for each in last))
        tau = self._tau(arc, end, dend, rate, inside, now)
        dy = np.moveaxis(dy, 0, 1)
        return Stretch(arc, t, weights, y, dy, inside, chained, now.tau, tau, arc.after, after, end, dend, rate)

    def _points(self, arc: Arc) -> tuple[Array, Array, float, Array]:
        """Clocks, weights, length of a panel, and states at the points of as many panels as are needed."""
        gauss, length = rule(), max(arc.end - arc.t, 0.0)
        panels = 1
        while panels <= MOST_PANELS:
            h = length / panels
            t = (arc.t + h * (np.arange(panels)[:, None] + gauss.nodes)).ravel()
            y = self.recorder.states(arc, t) if length > SHORTEST else np.tile(arc.y[:, None], (1, len(t)))
            if length <= SHORTEST or (left := roughness(y.T.reshape(panels, POINTS, -1))) <= TAIL:
                return t, np.tile(h * gauss.weights, panels), h, y
            # shorter by a factor, coefficients fall by that to the power of the points, at first of fewer
            panels = max(panels + 1, math.ceil(panels * (left / TAIL) ** (1.0 / (POINTS - EARLY))))
        raise NotDifferentiable(f"the motion in {arc.domain.name} is not smooth over {length:.3g} s")

    def _tau(self, arc: Arc, end: Values, dend: Values, rate: Values, values: Values, now: _Now) -> Array:
        """How much later the event that ends an arc happens."""
        if arc.event is None:
            return np.zeros(self.c)
        if isinstance(arc.event, Switch):
            due = arc.event.time(arc.switches, self.law)
            return due.d + np.zeros(self.c) if isinstance(due, Dual) else np.zeros(self.c)
        if arc.end - arc.t <= SHORTEST:  # at once
            return now.tau
        i = next(k for k, guard in enumerate(arc.domain.guards) if guard is arc.event)
        fall, highest = rate.guards[i], np.abs(values.guards[i]).max()
        steepness = -fall * (arc.end - arc.t) / max(highest, 1e-300)
        now.steepness = min(now.steepness, steepness)
        if not steepness > GRAZING:
            raise NotDifferentiable(f"{arc.event.name} grazes: its guard falls through zero with {fall:.3g} a second")
        later: Array = -dend.guards[i] / fall
        return later

    def pass_event(self, stretch: Stretch, now: _Now) -> None:
        """What an event does to derivatives; at the end of a phase its duration is noted."""
        arc, tau = stretch.arc, stretch.tau
        now.dy, now.tau, now.behind = stretch.dstate, tau, False
        if arc.event is None or arc.event.reset is None:
            return  # the motion goes on as it was
        reset = arc.event.reset
        state = duals(arc.after, stretch.dstate + stretch.end.slopes[:, None] * tau)
        state = self._strike(arc.domain, reset, state, now)
        q, v = state[: self.nv], state[self.nv :]
        now.held = dict(latched(now.held, [reset], q, v, self.law))
        now.dy = derivatives(state, self.c)
        if reset.phase is not None:
            spent = now.durations.get(arc.domain.phase, 0.0)
            now.durations[arc.domain.phase] = spent + Dual(arc.end, tau)
            now.tau = np.zeros(self.c)
        else:
            now.tau, now.behind = tau, True

    def _strike(self, domain: Domain, reset: Reset, state: list[Any], now: _Now) -> list[Any]:
        toes = struck_toes(self.system, domain, reset)
        if not toes:
            return state
        y = np.array([value_of(x) for x in state])
        feet = self.recorder.feet(tuple(toes)).at(y, self.raw, derivatives(state, self.c), self.seeds)
        v, lifted = struck(feet, toes, state[self.nv :])
        now.held = {**now.held, **lifted}
        return [*state[: self.nv], *v]


def _dual_law(system: HybridSystem, raw: Array, seeds: Array) -> Any:
    """Parameters of the law, dual."""
    place = iter(range(len(raw)))

    def dual(value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(map(dual, value))
        if value is None or isinstance(value, (bool, str)):
            return value
        i = next(place)
        return Dual(float(raw[i]), seeds[i]) if seeds[i].any() else value

    return with_fields(system.law, {name: dual(value) for name, value in vars(system.law).items()})
