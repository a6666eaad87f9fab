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
from spear_pin.hybrid.domain import Domain, Reset, Switch
from spear_pin.hybrid.engines.structure import Structure, with_fields
from spear_pin.hybrid.rules.impact import struck_toes
from spear_pin.hybrid.rules.latching import latched
from spear_pin.hybrid.tangent.collocation import POINTS, carried, rule, smooth
from spear_pin.hybrid.tangent.dual import Dual, value_of
from spear_pin.hybrid.tangent.fields import TangentField, Values, tangent_feet, tangent_field
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable, derivatives, duals, flat, struck
from spear_pin.hybrid.tangent.seeds import numbers

Array = NDArray[np.float64]
PANELS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32)  # of an arc, as many as its motion needs
SHORTEST = 1e-9  # s: there is nothing to be carried along a shorter arc
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
        tau: derivative of its end's time, (c,); that of its beginning `since`.
        end: the same at its end, just before the event: state, slopes, guards, torques, forces.
        dend: derivatives of that, at the fixed clock.
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


@dataclass
class _Now:
    """On the way: derivatives of the state at a fixed clock, of what is held, and of the last event's time."""

    dy: Array
    held: dict[str, Any]
    tau: Array
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
    phase, arcs = recorder.cycle(y)
    now, stretches = _Now(dy, held, np.zeros(dy.shape[1])), []
    for arc, following in zip(arcs, [*arcs[1:], None], strict=True):
        stretch = whole.carry(arc, now)
        stretches.append(stretch)
        whole.pass_event(stretch, following, now)
    return Derivative(system, recorder.end, now.dy, now.durations, stretches, now.steepness)


class _Whole:
    """What stays the same along a cycle: the system, its numbers, and their derivatives."""

    def __init__(self, system: HybridSystem, recorder: Recorder, seeds: Array) -> None:
        self.system, self.recorder, self.seeds = system, recorder, seeds
        self.nv, self.c, self.planar = system.robot.nv, seeds.shape[1], recorder.planar
        self.raw = numbers(system)
        self.law = _dual_law(system, self.raw, seeds)

    def begun(self, y: Array, dy: Array) -> dict[str, Any]:
        """What is held where the cycle begins."""
        _, resets = self.recorder.start(y)
        state = duals(y, dy)
        return dict(latched({}, resets, state[: self.nv], state[self.nv :], self.law))

    def carry(self, arc: Arc, now: _Now) -> Stretch:
        """Derivatives along an arc."""
        domain = tangent_field(Structure(self.system, arc.domain, arc.held, self.planar))
        held = flat(arc.held)
        raw = np.concatenate([self.raw, np.array(held, dtype=float).reshape(-1)])
        given = np.concatenate([self.seeds, derivatives(flat({name: now.held[name] for name in arc.held}), self.c)])
        t, weights, h, y = self._points(arc)
        panels, n, identity = len(t) // POINTS, 2 * self.nv, np.zeros((2 * self.nv, 2 * self.nv + self.c))
        identity[:, :n] = np.eye(n)
        directions = np.concatenate([np.zeros((len(raw), n)), given], axis=1)
        wide = np.repeat(identity[:, None, :], len(t), axis=1)
        values, slopes = domain.at(t, y, raw, 0.0, wide, directions)
        field_ = np.moveaxis(slopes.slopes, 0, 1).reshape(panels, POINTS, n, n + self.c)
        S, after = carried(field_[..., :n], field_[..., n:], h, now.dy)
        dy = np.moveaxis(S.reshape(len(t), n, self.c), 0, 1)
        chained = Values(*(np.einsum("imn,nmc->imc", each[..., :n], dy) + each[..., n:] for each in slopes))
        if arc.end - arc.t <= SHORTEST:
            after = now.dy
        end, dend, rate = self._end(domain, arc, raw, given, after)
        tau = self._tau(arc, end, dend, rate, values, now)
        return Stretch(arc, t, weights, y, dy, values, chained, now.tau, tau, arc.after, after, end, dend, rate)

    def _points(self, arc: Arc) -> tuple[Array, Array, float, Array]:
        """Clocks, weights, length of a panel, and states at the points of as many panels as are needed."""
        gauss, length = rule(), max(arc.end - arc.t, 0.0)
        for panels in PANELS:
            h = length / panels
            t = (arc.t + h * (np.arange(panels)[:, None] + gauss.nodes)).ravel()
            y = self.recorder.states(arc, t) if length > SHORTEST else np.tile(arc.y[:, None], (1, len(t)))
            if length <= SHORTEST or smooth(y.T.reshape(panels, POINTS, -1)):
                return t, np.tile(h * gauss.weights, panels), h, y
        raise NotDifferentiable(f"the motion in {arc.domain.name} is not smooth over {length:.3g} s")

    def _end(
        self, domain: TangentField, arc: Arc, raw: Array, given: Array, dy: Array
    ) -> tuple[Values, Values, Values]:
        """The domain at an arc's end: values, derivatives at the fixed clock, and rates along the motion."""
        t, y = np.array([arc.end]), arc.after[:, None]
        still = np.concatenate([given, np.zeros((len(raw), 1))], axis=1)
        values, _ = domain.at(t, y, raw, 0.0, np.zeros((len(y), 1, 1)), np.zeros((len(raw), 1)))
        moving = np.concatenate([dy, values.slopes], axis=1)[:, None, :]
        clock = np.concatenate([np.zeros(self.c), [1.0]])[None]
        _, slopes = domain.at(t, y, raw, clock, moving, still)
        return (
            Values(*(each[:, 0] for each in values)),
            Values(*(each[:, 0, :-1] for each in slopes)),
            Values(*(each[:, 0, -1] for each in slopes)),
        )

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

    def pass_event(self, stretch: Stretch, following: Arc | None, now: _Now) -> None:
        """What an event does to derivatives; at the end of a phase its duration is noted."""
        arc, tau = stretch.arc, stretch.tau
        now.dy = stretch.dstate
        if arc.event is None or arc.event.reset is None:
            now.tau = tau
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
        elif following is not None:
            now.tau = tau
            now.dy = now.dy - self._slopes(following)[:, None] * tau

    def _slopes(self, arc: Arc) -> Array:
        """The motion where an arc begins."""
        domain = tangent_field(Structure(self.system, arc.domain, arc.held, self.planar))
        raw = np.concatenate([self.raw, np.array(flat(arc.held), dtype=float).reshape(-1)])
        none = np.zeros((len(arc.y), 1, 1)), np.zeros((len(raw), 1))
        values, _ = domain.at(np.array([arc.t]), arc.y[:, None], raw, 0.0, *none)
        slopes: Array = values.slopes[:, 0]
        return slopes

    def _strike(self, domain: Domain, reset: Reset, state: list[Any], now: _Now) -> list[Any]:
        toes = struck_toes(self.system, domain, reset)
        if not toes:
            return state
        one = Structure(self.system, self.system.domains[0], {}, self.planar)
        y = np.array([value_of(x) for x in state])
        feet = tangent_feet(one, tuple(toes)).at(y, self.raw, derivatives(state, self.c), self.seeds)
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
