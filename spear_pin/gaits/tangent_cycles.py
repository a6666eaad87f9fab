"""Cycles of one lane with exact derivatives, one after another as Newton's method needs them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.sensitivity.measure import DualMeasure
from spear_pin.gaits.sensitivity.measures import differentiate_measures, of_ends
from spear_pin.hybrid.arc import Record
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import LOCK, has_lanes, may_vary
from spear_pin.hybrid.newton import Lanes
from spear_pin.hybrid.parameters import left_out_at_zero, parameter, with_parameters
from spear_pin.hybrid.result import Moment, Run
from spear_pin.hybrid.shooting import Cycle, Cycles
from spear_pin.hybrid.tangent.collocation import ENDS, INSIDE
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.derivative import Derivative
from spear_pin.hybrid.tangent.record import Recorder, many
from spear_pin.hybrid.tangent.resets import attempt

SAME = 1e-14  # relative: states that differ only by rounding, as from charts, have one cycle


class MeasuredCycle(NamedTuple):
    """A cycle and what is measured of it, with derivatives."""

    cycle: Derivative
    measured: list[DualMeasure]

    @property
    def values(self) -> Cycles:
        """The cycle of one lane, without derivatives."""
        y, measured, nv = self.cycle.y[None], np.array([[each.value for each in self.measured]]), len(self.cycle.y) // 2
        durations = {phase: np.array([seconds.x]) for phase, seconds in self.cycle.durations.items()}
        order, no_words, fast = self.cycle.record.order, np.array([""], dtype=object), np.zeros(1, dtype=bool)
        return Cycles(y[:, :nv], y[:, nv:], measured, durations, no_words, fast, [order])


def differentiate_measured(
    recorder: Recorder, y: Array, start: Array, seeds: Array, weight: Array, names: Sequence[str]
) -> MeasuredCycle | None:
    """Differentiates a cycle and what is measured of it; returns None where it lacks a measure.

    See `differentiate_cycle` for the first arguments and for what is raised.

    Args:
        recorder: runs the cycle.
        y: state in which it begins, (2 nv,).
        start: derivatives of that state, (2 nv, c).
        seeds: derivatives of the system's numbers, (p, c).
        weight: derivatives of the robot's weight, (c,).
        names: names of the measures.
    """
    fineness = ENDS if of_ends(names) else INSIDE
    with LOCK:
        cycle = differentiate_cycle(recorder.system, recorder, y, start, seeds, fineness)
    known = differentiate_measures(cycle, start, weight)
    found = [known[name] for name in names if name in known]
    return MeasuredCycle(cycle, found) if len(found) == len(names) else None


@dataclass
class _Found:
    """The last cycle that was asked for, with its derivatives; None where there are none."""

    place: Any = np.nan
    cycle: MeasuredCycle | None = None
    count: int = 0


@dataclass(frozen=True)
class TangentCycles:
    """Cycles of a system whose given numbers vary: a `Cycle` of `hybrid.shooting` with its `Slopes`.

    Attributes:
        system: the system.
        vary: names of the numbers.
        measures: names of the measures.
    """

    system: HybridSystem
    vary: tuple[str, ...]
    measures: tuple[str, ...]
    _found: _Found = field(default_factory=_Found, repr=False)

    @property
    def count(self) -> int:
        """Number of cycles that were run."""
        return self._found.count

    def follow(self, moment: Moment, values: Array) -> Moment | None:
        """Returns where motion from a phase's beginning meets the section, with values of the numbers, (k,).

        Returns None where the cycle does not close or has no derivative.
        """
        nq, y = len(moment.q), np.concatenate([moment.q, moment.v])
        with LOCK:
            lap = attempt(lambda: self._recorder(values).motion(moment.phase, y, moment.held))
        return None if lap is None else Moment(lap.y[:nq], lap.y[nq:], lap.phase, lap.held)

    def record(self, q: Array, v: Array, values: Array) -> Record | None:
        """Returns the record of the cycle of one lane, or None where it does not close plainly."""
        with LOCK:
            return attempt(lambda: self._recorder(values).lap(np.concatenate([q, v])))

    def _recorder(self, values: Array) -> Recorder:
        """Returns the recorder of cycles with values of the numbers, (k,)."""
        given = {name: np.array([value]) for name, value in zip(self.vary, values.tolist(), strict=True)}
        return Recorder(self.system, many(self.system, given))

    def otherwise(self, cycle: Cycle) -> Cycle:
        """Returns cycles with derivatives where there are some, else another engine's; differences use the latter.

        Args:
            cycle: cycles of the other engine.
        """

        def cycles(lanes: Lanes, q: Array, v: Array, values: Array) -> Cycles:
            found = self.one(q[0], v[0], values[0]) if len(lanes) == 1 else None
            return cycle(lanes, q, v, values) if found is None else found

        return cycles

    def one(self, q: Array, v: Array, values: Array) -> Cycles | None:
        """Returns the cycle of one lane, or None where it has no derivatives."""
        found = self._at(q, v, values)
        return found and found.values

    def slopes(self, lanes: Lanes, q: Array, v: Array, values: Array) -> tuple[Array, Array, Array]:
        """Returns derivatives of cycles; see `hybrid.shooting.Slopes`."""
        n, rows = len(lanes), q.shape[1] + v.shape[1]
        width = rows + len(self.vary)
        after = np.full((n, rows), np.nan)
        ends, measured = np.full((n, rows, width), np.nan), np.full((n, len(self.measures), width), np.nan)
        for i in range(n):
            if (found := self._at(q[i], v[i], values[i])) is not None:
                after[i], ends[i] = found.cycle.y, found.cycle.dy
                measured[i] = np.reshape([each.derivative for each in found.measured], (-1, width))
        return after, ends, measured

    def _at(self, q: Array, v: Array, values: Array) -> MeasuredCycle | None:
        """Returns the cycle from a state, along all directions of the state and the numbers."""
        y = np.concatenate([q, v])
        place = np.concatenate([y, values])
        if not (np.abs(place - self._found.place) <= SAME * np.maximum(1.0, np.abs(place))).all():
            self._found.place, self._found.cycle = place, attempt(lambda: self._differentiated(y, values))
            self._found.count += 1
        return self._found.cycle

    def _differentiated(self, y: Array, values: Array) -> MeasuredCycle | None:
        if not (np.isfinite(y).all() and np.isfinite(values).all()):
            return None
        along = np.eye(len(y), len(y) + len(values))
        with_parameters(self.system, dict(zip(self.vary, values.tolist(), strict=True)))  # it says what is valid
        still = np.zeros(along.shape[1])  # none of the numbers changes the weight
        return differentiate_measured(self._recorder(values), y, along, self.seeds, still, self.measures)

    @cached_property
    def seeds(self) -> Array:
        """Derivatives of the system's numbers, which are linear in those that vary, (p, 2 nv + k)."""
        own = np.array([parameter(self.system, name) for name in self.vary])
        here = self._recorder(own).numbers
        columns = [self._recorder(own + unit).numbers - here for unit in np.eye(len(own))]
        still = np.zeros((len(here), 2 * self.system.robot.nv))
        return np.concatenate([still, np.array(columns).reshape(len(own), len(here)).T], axis=1)


def tangent_cycles(
    system: HybridSystem, vary: Sequence[str], measures: Sequence[str | Callable[[Run], float]]
) -> TangentCycles | None:
    """Returns cycles with derivatives, or None for a system that has none; in the plane also without heyoka."""
    names = tuple(name for name in measures if isinstance(name, str))
    known = may_vary(system, vary) if system.section_toes else has_lanes(system, vary)
    if len(names) < len(measures) or not known:
        return None
    if any(left_out_at_zero(name) and parameter(system, name) == 0.0 for name in vary):
        return None  # what is zero is not compiled
    return TangentCycles(system, tuple(vary), names)
