"""Derivatives of cycles and of gaits by Richardson's extrapolation of differences within one order of events.

Differences take values alone of what is compared with them: of states and measures of cycles, and of fixed points that
are found again. Where a step leads into another order of events, shorter ones are taken, or those of one side.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import linear_sum_assignment

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.sensitivity.sensitivity import Sensitivity
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Charts
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import chart, section
from spear_pin.hybrid.tangent.resets import NotDifferentiable

LEVELS = 4
STEPS = 2.0**-8 / 8.0 ** np.arange(6)  # of a parameter, in m, rad and their rates of a coordinate
LEAST = 1e-2  # in SI units
CLOSED = 1e-12  # of a fixed point that is found again


class Crossed(Exception):
    """A step leads into another order of events, or to where there is none."""


@dataclass(frozen=True)
class Difference:
    """A derivative by differences.

    Attributes:
        value: (n,).
        sides: (1, -1) where differences are central, the one side that has the same order of events otherwise.
    """

    value: Array
    sides: tuple[int, ...]


Agreement = Callable[[Array], float]


def order(orbit: Orbit, untold: Collection[str] = (), ties: bool = False) -> tuple[tuple[str, str], ...]:
    """Domains of a cycle, each with what ends it, kinks among them.

    Args:
        orbit: the cycle.
        untold: events that are left out, for the motion is the same without them: springs that let go of what they
            no longer move, just before toes let go of the ground.
        ties: only where the next event is in the same instant.
    """
    found, stretches = [], orbit.cycle.stretches
    for each, after in zip(stretches, [*stretches[1:], None], strict=True):
        name = "kink" if each.arc.event is None else each.arc.event.name
        left_out = name in untold and not (ties and after is not None and not after.at_once)
        if not left_out and (each.arc.event is None or each.arc.event.reset is not None):
            found.append((each.arc.domain.name, name))
    return tuple(found)


def values(orbit: Orbit) -> Array:
    """State at the end of a cycle, and its measures, durations among them."""
    return np.concatenate([orbit.cycle.y, [measure.value for measure in orbit.measures.values()]])


def columns(orbit: Orbit) -> Array:
    """The exact derivatives of `values`, (n, d + m)."""
    return np.concatenate([orbit.cycle.dy, [measure.derivative for measure in orbit.measures.values()]])


def sizes(orbit: Orbit) -> Array:
    """What a column counts: 1 for a coordinate, of a parameter its value, (d + m,)."""
    return np.concatenate([np.ones(orbit.dimension), [abs(number(orbit.system, name)) or 1.0 for name in orbit.names]])


def scales(rows: Array, size: Array, value: Array) -> Array:
    """Of each row its largest entry, columns counting their sizes, or its value if that is larger, (n,).

    At least `LEAST`: some rows are all but zero, as the rate of a joint whose angle is commanded.
    """
    return np.maximum(np.abs(rows * size).max(axis=1), np.maximum(np.abs(value), LEAST))


def beside(orbit: Orbit, column: int, step: float) -> Orbit:
    """The cycle from a state of the section by a step along one of its coordinates, or with another parameter."""
    if column < orbit.dimension:
        move = step * np.eye(orbit.dimension)[column]
        return Orbit(orbit.system, orbit.chart.state(move), ())
    name = orbit.names[column - orbit.dimension]
    value = number(orbit.system, name)
    system = with_numbers(orbit.system, {name: value + step * (abs(value) or 1.0)})
    return Orbit(system, _placed(system, orbit), ())


def again(orbit: Orbit, name: str, step: float) -> Orbit:
    """The gait with another number, by Newton's method from this one."""
    value = number(orbit.system, name)
    system, state = with_numbers(orbit.system, {name: value + step * (abs(value) or 1.0)}), orbit.state
    for _ in range(12):
        local = chart(system, state)
        there = Orbit(system, local.state(np.zeros(local.dimension)), ())
        if float(np.abs(there.displacement).max()) < CLOSED:
            return there
        move = np.linalg.solve(np.eye(there.dimension) - there.jacobian, there.displacement)
        state = there.chart.state(move)
    raise Crossed(f"no gait found {step:+.1e} of {name} away")


@dataclass(frozen=True)
class Differences:
    """Derivatives of a function of orbits beside one, along one direction.

    Attributes:
        orbit: the one.
        beside: the orbit so far away.
        function: what is differentiated, (n,).
        agree: by how much it misses what is compared, the smaller the better.
        enough: what is not looked at any closer.
        untold: events that need not be in the same order.
        steps: that are tried.
    """

    orbit: Orbit
    beside: Callable[[float], Orbit]
    function: Callable[[Orbit], Array]
    agree: Agreement
    enough: float
    untold: Collection[str] = ()
    steps: Sequence[float] = tuple(STEPS)

    def best(self) -> tuple[Difference, float]:
        """The difference that agrees best of those with steps of several lengths, and by how much it misses.

        Raises:
            Crossed: another order of events is nearer than the shortest step, on both sides.
        """
        found = self._tried((1, -1))
        if not any(missed <= self.enough for _, missed in found):
            # events less than 1e-10 s apart, which are one instant to the engines, are crossed by short central steps
            found += [*self._tried((1,)), *self._tried((-1,))]
        if found:
            return min(found, key=lambda each: each[1])
        raise Crossed("another order of events is too near on both sides")

    def _tried(self, sides: tuple[int, ...]) -> list[tuple[Difference, float]]:
        found: list[tuple[Difference, float]] = []
        for step in self.steps:
            try:
                value = self._central(step) if len(sides) == 2 else self._sided(step * sides[0])
            except (Crossed, NotDifferentiable, BadValue):
                continue
            found.append((Difference(value, sides), self.agree(value)))
            if found[-1][1] <= self.enough:
                break
        return found

    @cached_property
    def _order(self) -> tuple[tuple[str, str], ...]:
        return order(self.orbit, self.untold)

    @cached_property
    def _here(self) -> Array:
        return self.function(self.orbit)

    def _at(self, steps: Array) -> Array:
        """Values at steps, all of them in one order, in which what need not be told may happen or not."""
        orbits = [self.beside(float(step)) for step in steps]
        fine = {order(each, self.untold, ties=True) for each in orbits}
        if len(fine) > 1 or order(orbits[0], self.untold) != self._order:
            raise Crossed("another order of events")
        return np.array([self.function(each) for each in orbits])

    def _central(self, step: float) -> Array:
        h = step / 2.0 ** np.arange(LEVELS)
        found = self._at(np.concatenate([h, -h]))
        return _extrapolated((found[:LEVELS] - found[LEVELS:]) / (2.0 * h[:, None]), 4.0)

    def _sided(self, step: float) -> Array:
        h = step / 2.0 ** np.arange(LEVELS + 2)
        return _extrapolated((self._at(h) - self._here) / h[:, None], 2.0)


def compared(
    orbit: Orbit, enough: float, untold: Collection[str] = (), chosen: Sequence[int] | None = None
) -> Mapping[int, tuple[Array, tuple[int, ...]]]:
    """Errors of a cycle's exact derivatives, of each row's scale, (n,), by column, with the sides of the differences.

    Columns that no difference can be compared with are left out.
    """
    rows, size = columns(orbit), sizes(orbit)
    scale, found = scales(rows, size, values(orbit)), {}
    for j in range(rows.shape[1]) if chosen is None else chosen:

        def errors(value: Array, j: int = j) -> Array:
            return np.asarray(np.abs(rows[:, j] * size[j] - value) / scale)

        differences = Differences(
            orbit, lambda h, j=j: beside(orbit, j, h), values, lambda value: float(errors(value).max()), enough, untold
        )
        try:
            best, _ = differences.best()
        except Crossed:
            continue
        found[j] = errors(best.value), best.sides
    return found


def compared_gaits(
    orbit: Orbit, table: Sensitivity, enough: float, untold: Collection[str] = ()
) -> Mapping[str, tuple[Array, Array, tuple[int, ...]]]:
    """Errors of derivatives along the branch of gaits, by parameter, against gaits that are found again.

    Of the state and the measures, (n,), and of the multipliers, (d,), each of its row's scale; and the sides of the
    differences. Where the package gives none of the multipliers they are NaN. Parameters that no difference can be
    compared with are left out.
    """
    measured, d = list(orbit.measures), orbit.dimension
    own = np.concatenate([table.state, [table.derivatives[name] for name in measured]])
    rows = np.concatenate([own, table.multiplier_derivatives.real, table.multiplier_derivatives.imag])
    size = np.array([abs(number(orbit.system, name)) or 1.0 for name in table.parameters])

    def whole(there: Orbit) -> Array:
        eigenvalues = np.linalg.eigvals(there.jacobian)
        near = eigenvalues[linear_sum_assignment(np.abs(table.multipliers[:, None] - eigenvalues))[1]]
        state = np.concatenate(there.chart.state(np.zeros(d)))
        return np.concatenate([state, values(there)[len(state) :], near.real, near.imag])

    scale, found = scales(np.nan_to_num(rows), size, whole(orbit)), {}
    moduli = np.tile(np.maximum(np.abs(table.multipliers), LEAST), 2)
    scale[-2 * d :] = np.maximum(scale[-2 * d :], moduli)
    for j, name in enumerate(table.parameters):

        def errors(value: Array, j: int = j) -> Array:
            return np.asarray(np.abs(rows[:, j] * size[j] - value) / scale)

        differences = Differences(
            orbit,
            lambda h, name=name: again(orbit, name, h),
            whole,
            lambda value: float(np.nan_to_num(errors(value)).max()),
            enough,
            untold,
        )
        try:
            best, _ = differences.best()
        except Crossed:
            continue
        off = errors(best.value)
        found[name] = off[: -2 * d], np.maximum(off[-2 * d : -d], off[-d:]), best.sides
    return found


def _placed(system: HybridSystem, orbit: Orbit) -> State:
    """The nearest state on the section of another system, on which the same toes slide."""
    here = orbit.chart.lane
    assert isinstance(here, Charts)
    there = section(system).charts(here.q, here.v, here.slides)
    q, v = there.states(np.zeros((1, there.dimension)))
    return q[0], v[0]


def _extrapolated(table: Array, factor: float) -> Array:
    for power in range(1, len(table)):
        table = (factor**power * table[1:] - table[:-1]) / (factor**power - 1.0)
    return table[0]
