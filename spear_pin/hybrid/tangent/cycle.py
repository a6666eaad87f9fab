"""Differentiates a cycle along its record, from section to section.

Derivatives are taken at a fixed time since the phase began. An event happens τ later per unit of a direction. If it
leads into another phase, the clock starts anew and nothing else is needed. Within a phase the motion after the event is
followed back to the fixed time. This is the saltation matrix, extended to held values, schedules and parameters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import KELLER, HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.contact import SLIP
from spear_pin.hybrid.domain import Reset, Switch
from spear_pin.hybrid.dual import NUMBERS, Dual, derivatives, duals, make_varying, value_of
from spear_pin.hybrid.engines.structure import symbols
from spear_pin.hybrid.fields import adjust_law, flatten
from spear_pin.hybrid.rules.cycles import counts_to
from spear_pin.hybrid.rules.footing import closed_toes
from spear_pin.hybrid.rules.impact import find_struck_toes
from spear_pin.hybrid.rules.jumping import apply_jump
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.strikes import Overlap, comes_to_rest, find_struck_toes_in_space, pins
from spear_pin.hybrid.tangent.collocation import INSIDE, POINTS, Fineness, carry_along
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Derivative, Stretch, is_falling
from spear_pin.hybrid.tangent.fields import ToeNumbers
from spear_pin.hybrid.tangent.kinks import later, of_the_inside
from spear_pin.hybrid.tangent.onset import find_setting_out, turn_velocities
from spear_pin.hybrid.tangent.points import points
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import (
    NotDifferentiable,
    differentiate_stop,
    differentiate_strike,
    differentiate_strike_in_space,
)
from spear_pin.model.feet import find_leading
from spear_pin.model.path import Joints

SAME = 1e-7  # SI units: by how much the state after an event may differ from that of the engine
GRAZING = 1e-6  # slope of a guard at zero, relative to its mean slope over the arc, below which it grazes


@dataclass
class _Now:
    """Present derivatives of the state, of the held values, and of the last event's time.

    Attributes:
        overlap: impacts in space that may not be over, with the derivatives of their impulses.
        behind: whether the state's derivatives are still at the last event, not yet at a fixed time.
        bent: the previous arc, if it ended at a kink.
        past: total time of the earlier phases, in s.
        after: state after the last event, (2 nv,); None where the motion goes on as it was.
        together: whether several feet in space have landed in one instant.
    """

    dy: Array
    held: dict[str, Any]
    tau: Array
    overlap: Overlap
    behind: bool = False
    bent: Stretch | None = None
    past: float = 0.0
    after: Array | None = None
    together: bool = False
    durations: dict[str, Any] = field(default_factory=dict)
    steepness: float = math.inf


def differentiate_cycle(
    system: HybridSystem, recorder: Recorder, y: Array, dy: Array, seeds: Array, fineness: Fineness = INSIDE
) -> Derivative:
    """Runs a cycle from a state on the section, and differentiates it along c directions.

    Args:
        system: the system.
        recorder: runs the cycle and keeps its arcs.
        y: the state, (2 nv,).
        dy: derivatives of the state, (2 nv, c).
        seeds: derivatives of the system's numbers, (p, c).
        fineness: how fine panels are; `ENDS` where no values inside arcs are needed.

    Raises:
        NotDifferentiable: the cycle does not close, or an event in it has no derivative; the text says which.
    """
    whole = _Whole(system, recorder, seeds, fineness)
    held = whole.begun(y, dy)
    record = recorder.lap(y)
    c, stretches = dy.shape[1], []
    now = _Now(dy, held, np.zeros(c), Overlap(system.overlap, np.zeros((3, 1 + c))))
    for arc in record.arcs:
        if now.after is not None and not np.allclose(arc.y, now.after, rtol=SAME, atol=SAME):
            raise NotDifferentiable(f"{arc.domain.name} does not begin where the event before it leads by its rule")
        stretch = whole.carry(arc, now)
        stretches.append(stretch)
        whole.pass_event(stretch, now)
    return Derivative(system, record, now.dy, now.durations, stretches, whole.raw, seeds, now.steepness, now.together)


class _Whole:
    """The data that are constant along a cycle: the system, its numbers, and their derivatives."""

    def __init__(self, system: HybridSystem, recorder: Recorder, seeds: Array, fineness: Fineness) -> None:
        self.system, self.recorder, self.seeds, self.fineness = system, recorder, seeds, fineness
        self.nv, self.c, self.raw = system.robot.nv, seeds.shape[1], recorder.numbers
        scalars = symbols(system, recorder.mechanism, {}, make_varying(self.raw, seeds))[1]
        self.law, self.springs, self.brakes = scalars.law, scalars.springs, scalars.brakes

    def begun(self, y: Array, dy: Array) -> dict[str, Any]:
        """Returns the values held at the beginning of the cycle."""
        _, resets = self.recorder.start
        state = duals(y, dy)
        clock = Clock(0.0, self.springs, self.system, self.brakes)
        return dict(latch_values({}, resets, state[: self.nv], state[self.nv :], self.law, begins=True, clock=clock))

    def carry(self, arc: Arc, now: _Now) -> Stretch:
        """Carries the derivatives along an arc."""
        n, nv, c, domain = 2 * self.nv, self.nv, self.c, self.recorder.field(arc.domain, arc.held)
        raw = np.concatenate([self.raw, flatten(arc.held.values())])
        held = {name: now.held[name] for name in arc.held}
        given = np.concatenate([self.seeds, derivatives(flatten(held.values()), c)])
        t, lengths, y = points(arc, self.fineness)
        # directions: the state's, the given ones, the clock; places: the points, the beginning, the end
        directions = _directions(n, c)
        every = np.zeros((len(raw), n + c + 1))
        every[:, n:-1] = given
        clocks, states = np.empty(len(t) + 2), np.empty((n, len(t) + 2))
        clocks[:-2], clocks[BEGIN], clocks[END] = t, arc.t, arc.end
        states[:, :-2], states[:, BEGIN], states[:, END] = y, arc.y, arc.after
        values, slopes = domain.at(clocks, states, raw, directions[n], directions[:n, None], every)
        if SLIP in arc.domain.contacts and (toes := find_setting_out(self.system, arc, y)):
            seen = values.slopes[nv:, :-2], slopes.slopes[nv:, :-2, nv:n]
            states[:, :-2] = turn_velocities(self.system, arc, toes, t, y, *seen)
            values, slopes = domain.at(clocks, states, raw, directions[n], directions[:n, None], every)
            for rows in (values.rows[..., None], slopes.rows):
                rows[:, BEGIN] = of_the_inside(rows, BEGIN)
        bends = arc.event is None and not arc.smooth
        for place, kink in ((BEGIN, now.bent is not None), (END, bends)):
            if kink:
                slopes.rows[:, place] = of_the_inside(slopes.rows, place)
        # S is carried at a fixed time since the last event: a toe that begins to slide moves the same way at first
        lag = now.tau if now.behind else np.zeros(c)
        along = slopes.slopes[nv:, :-2, :-1].copy()
        along[..., n:] += slopes.slopes[nv:, :-2, -1:] * lag
        S = carry_along(along.reshape(nv, -1, POINTS, n + c).transpose(1, 2, 0, 3), lengths, now.dy)
        stretch = Stretch(arc, states, S, lag, values, slopes, held, now.tau)
        if now.bent is not None:
            now.tau = now.bent.tau = stretch.since = later(now.bent, stretch)
        stretch.tau, now.bent = self._tau(stretch, now), stretch if bends else None
        return stretch

    def _tau(self, stretch: Stretch, now: _Now) -> Array:
        """Returns how much later the event that ends an arc happens, per unit of each direction, (c,)."""
        arc = stretch.arc
        if arc.event is None:
            return stretch.lag if arc.smooth else np.zeros(self.c)
        if isinstance(arc.event, Switch):
            due = arc.event.time(arc.switches, adjust_law(self.law, stretch.held))
            return due.d + np.zeros(self.c) if isinstance(due, Dual) else np.zeros(self.c)
        i = stretch.place
        fall, change = stretch.at(END, stretch.slopes.guards[i, END])
        if stretch.at_once:
            # near this cycle a falling guard on zero is a separate event; any other event still happens at once
            met = abs(stretch.end.guards[i]) <= arc.event.tolerance and is_falling(fall)
            return -change / fall if met else now.tau
        highest = np.abs(stretch.said.guards[i]).max()
        steepness = -fall * (arc.end - arc.t) / max(highest, 1e-300)
        now.steepness = min(now.steepness, steepness)
        if not steepness > GRAZING:
            raise NotDifferentiable(f"{arc.event.name} grazes: its guard falls through zero with {fall:.3g} a second")
        later: Array = -change / fall
        return later

    def pass_event(self, stretch: Stretch, now: _Now) -> None:
        """Applies an event to the derivatives, and records the duration of a phase that it ends."""
        arc, tau = stretch.arc, stretch.tau
        now.dy, now.tau, now.behind, now.after = stretch.dstate, tau, False, None
        if arc.smooth:  # the derivatives stay at the time at which they were
            now.dy, now.behind = stretch.last, True
        if arc.event is None or arc.event.reset is None:
            return  # the same motion continues
        reset = arc.event.reset
        now.dy = stretch.dstate + stretch.end.slopes[:, None] * tau
        now.after = self._jump(reset, self._strike(arc, reset, now), now)
        state = duals(now.after, now.dy)
        q, v = state[: self.nv], state[self.nv :]
        clock = Clock(Dual(arc.end, tau), self.springs, self.system, self.brakes)
        now.held = dict(latch_values(now.held, [reset], q, v, self.law, begins=not arc.again, clock=clock))
        if reset.phase is not None:
            phase = counts_to(arc.domain, reset, arc.again)
            now.durations[phase] = now.durations.get(phase, 0.0) + Dual(arc.end, tau)
            now.tau, now.past = np.zeros(self.c), now.past + arc.end
        else:
            now.tau, now.behind = tau, True

    def _strike(self, arc: Arc, reset: Reset, now: _Now) -> Array:
        """Applies an impact to the derivatives and to the held values; returns the state after it."""
        y, nv = arc.after, self.nv
        if self.system.robot.dimension == 3 and (reset.impact or reset.stop):
            change, slope = self._strike_in_space(arc, reset, now)
        elif (toes := find_struck_toes(self.system, arc.domain, reset)) or reset.grips:
            feet, slopes = self._feet(toes, y, now, reset.grips)
            lifted: dict[str, Any] = {}
            if pins(self.system, arc.domain, reset):
                change, slope = differentiate_stop(feet, slopes, range(len(feet.speeds)))
            else:
                leads, grips = find_leading(self.system.robot.feet, toes), bool(reset.grips)
                change, slope, lifted = differentiate_strike(feet, slopes, toes, reset.impact, leads, grips=grips)
            now.held = {**now.held, **lifted}
        else:
            return y
        now.dy[nv:] += slope
        return np.concatenate([y[:nv], y[nv:] + change])

    def _jump(self, reset: Reset, y: Array, now: _Now) -> Array:
        """Applies a jump to the derivatives; returns the state after it."""
        if reset.jump is None:
            return y
        state = duals(y, now.dy)
        q, v = apply_jump(reset, state[: self.nv], state[self.nv :], now.held, self.law, ops=NUMBERS)
        now.dy = derivatives([*q, *v], self.c)
        return np.array([value_of(each) for each in (*q, *v)])

    def _feet(
        self, toes: Sequence[str], y: Array, now: _Now, grips: tuple[Joints, ...] = ()
    ) -> tuple[ToeNumbers, ToeNumbers]:
        """Returns numbers of toes at a state, after brakes have gripped, and their derivatives."""
        return self.recorder.feet(tuple(toes), grips).at(y, self.raw, now.dy, self.seeds)

    def _strike_in_space(self, arc: Arc, reset: Reset, now: _Now) -> tuple[Array, Array]:
        """Returns the change of velocity by an impact in space, or by the end of sliding, and its derivatives."""
        robot, y, domain = self.system.robot, arc.after, arc.domain
        if reset.stop:
            grounded = [toe for toe, _ in closed_toes(robot.toes, domain)]
            feet, slopes = self._feet(grounded, y, now)
            speeds = zip(grounded, feet.speeds.reshape(-1, 3), strict=True)
            firsts = [0 if comes_to_rest(robot, domain, reset, toe, speed) else 2 for toe, speed in speeds]
            return differentiate_stop(
                feet, slopes, [row for i, k in enumerate(firsts) for row in range(3 * i + k, 3 * i + 3)]
            )
        every, _ = self._feet(robot.toes, y, now)
        normal = {
            toe: (float(height), float(speed))
            for toe, height, speed in zip(robot.toes, every.heights, every.speeds[2::3], strict=True)
        }
        toes, striking = find_struck_toes_in_space(self.system, domain, reset, normal)
        feet, slopes = self._feet(toes, y, now)
        time, separate = now.past + arc.end, self.system.impact_law == KELLER and len(toes) == 1
        before = None if separate else now.overlap.received(toes, time)
        falls = striking - {*reset.impact}
        now.together = now.together or bool(falls)
        found = differentiate_strike_in_space(feet, slopes, toes, reset.impact, falls, before)
        now.overlap.add(toes, striking, found.impulse, time)
        now.held = {**now.held, **found.held}
        return found.v, found.dv


@cache
def _directions(n: int, c: int) -> Array:
    """Returns the directions along n numbers, along c others, and along a clock, (n + 1, n + c + 1)."""
    found: Array = np.concatenate([np.eye(n, n + c + 1), np.eye(1, n + c + 1, n + c)])
    found.setflags(write=False)
    return found
