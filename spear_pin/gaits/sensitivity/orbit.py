"""Derivative of the return map about a fixed point on its section; parameters move the section as well."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.sensitivity.drives import DrivenJoints, check_gears
from spear_pin.gaits.sensitivity.margins import margins
from spear_pin.gaits.sensitivity.measure import DualMeasure
from spear_pin.gaits.sensitivity.measures import Measures, differentiate_measures
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import check_equations
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import chart
from spear_pin.hybrid.tangent.derivative import Derivative
from spear_pin.hybrid.tangent.section import columns, cycle_on_section, on_section
from spear_pin.hybrid.tangent.seeds import Seeds, seeds
from spear_pin.model.motor import NO_MOTORS, Drive, Motor

CLOSED = 1e-6  # largest displacement of the return map at a fixed point


@dataclass(frozen=True)
class Orbit:
    """A cycle from a state on the section, with derivatives along the section and along parameters.

    Attributes:
        system: the system.
        state: (q, v) on the section.
        names: names of the parameters.
        motors: motors whose heat, or drives whose electricity, is measured, by the names of their joints.
    """

    system: HybridSystem
    state: State
    names: tuple[str, ...]
    motors: Mapping[str, Motor | Drive] = field(default_factory=dict)

    @cached_property
    def chart(self) -> Chart:
        """The chart of the section about the state."""
        return chart(self.system, self.state)

    @property
    def dimension(self) -> int:
        """Number of coordinates of the section."""
        return self.chart.dimension

    @cached_property
    def start(self) -> Array:
        """Derivatives of the state in which the cycle begins by ξ and by the parameters, (2 nv, d + m)."""
        return on_section(self.system, self.chart, self.seeds)

    @cached_property
    def _seeds(self) -> Seeds:
        return seeds(self.system, self.names)

    @cached_property
    def seeds(self) -> Array:
        """Derivatives of the system's numbers by ξ, which are zero, and by the parameters, (p, d + m)."""
        return np.pad(self._seeds.numbers, ((0, 0), (self.dimension, 0)))

    @cached_property
    def cycle(self) -> Derivative:
        """The cycle with its derivatives.

        Raises:
            NotDifferentiable: the cycle has no derivative; the text says why.
        """
        return cycle_on_section(self.system, self.chart, self.seeds)

    @cached_property
    def columns(self) -> Array:
        """Derivatives of ξ after the cycle, (d, d + m)."""
        return columns(self.system, self.chart, self.cycle)

    @property
    def jacobian(self) -> Array:
        """The return map's Jacobian, (d, d)."""
        return self.columns[:, : self.dimension]

    @property
    def displacement(self) -> Array:
        """ξ after the cycle that began at ξ = 0, (d,)."""
        nv = self.system.robot.nv
        return self.chart.coordinates((self.cycle.y[:nv], self.cycle.y[nv:]))

    @cached_property
    def measures(self) -> Measures:
        """All measures, with derivatives by ξ and by the parameters.

        Raises:
            BadValue: when a measure is read, if a motor's resistance or torque constant is not known.
        """
        driven = DrivenJoints(self.system, self.motors, self.names, self.dimension)
        return differentiate_measures(self.cycle, self.start, np.pad(self._seeds.weight, (self.dimension, 0)), driven)

    @cached_property
    def margins(self) -> dict[str, DualMeasure]:
        """Margin of each event from happening otherwise, with derivatives by ξ and by the parameters."""
        return margins(self.cycle)

    def margins_before(self, event: str) -> dict[str, DualMeasure]:
        """Returns the same, of motion before an event."""
        return margins(self.cycle, event)

    @property
    def slides(self) -> NDArray[np.bool_]:
        """Which toes of the section slide as the cycle begins, (k,)."""
        return self.chart.lane.slides

    @property
    def slide_after(self) -> NDArray[np.bool_]:
        """Which toes of the section slide as the cycle ends, (k,)."""
        nv, y = self.system.robot.nv, self.cycle.y[None]
        return self.chart.lane.sliding(y[:, :nv], y[:, nv:])

    def beside(self, change: Mapping[str, float], dy: Array, names: tuple[str, ...] = (), slides: Any = None) -> Orbit:
        """Returns the orbit with other numbers, from the state moved by dy, (2 nv,), and put onto their section.

        Args:
            change: changes of numbers, by name.
            dy: change of the state, to first order; toes at rest stay at rest.
            names: names of the orbit's parameters.
            slides: which toes of the section slide, (k,); by default the toes that slide in this orbit.

        Raises:
            UnknownName: no number has such a name.
            BadValue: a value is not valid, or no state on the section is near.
        """
        values = {name: number(self.system, name) + by for name, by in change.items()}
        system, y = with_numbers(self.system, values), np.concatenate(self.state) + dy
        nv = system.robot.nv
        local = chart(system, (y[:nv], y[nv:]), self.slides if slides is None else slides)
        return Orbit(system, local.state(np.zeros(local.dimension)), names, self.motors)

    def along(self, step: Array, names: tuple[str, ...] = ()) -> Orbit:
        """Returns the orbit `beside` by a step of ξ and of the first parameters, (d + j,)."""
        change = zip(self.names, step[self.dimension :].tolist(), strict=False)
        return self.beside({name: by for name, by in change if by}, self.start[:, : len(step)] @ step, names)


def orbit_of_gait(
    system: HybridSystem,
    state: State,
    over: Sequence[str],
    vary: Sequence[str] = (),
    keep: Sequence[str] = (),
    motors: Mapping[str, Motor | Drive] = NO_MOTORS,
) -> Orbit:
    """Returns the orbit of a gait with cycle and measures found; its names are `vary`, then `over`.

    See `Gait.sensitivity` for the arguments and for what is raised.
    """
    check_equations(system)
    check_gears(system, motors)
    if motors and system.mirrored_toes:
        raise BadValue("motors", sorted(motors), "none for a gait whose cycle is half a stride; leave it out")
    names = (*vary, *over)
    if len(set(names)) != len(names) or not over:
        raise BadValue("over", list(over), "one parameter or more, each once, none of them in vary")
    orbit = Orbit(system, state, names, motors)
    for name in keep:
        if name not in orbit.measures:
            raise UnknownName("measure", name, orbit.measures)
    if len(vary) != len(keep):
        raise BadValue("keep", list(keep), f"as many measures as vary has parameters, {len(vary)}")
    off = float(np.abs(orbit.displacement).max())
    if not off <= CLOSED:
        raise BadValue(
            "change of state", off, f"at most {CLOSED:g} in a cycle, as at a fixed point; find one by find_gait"
        )
    return orbit


def branch(orbit: Orbit, keep: Sequence[str]) -> Array:
    """Returns how ξ and the orbit's parameters change along the branch of gaits, (d + k + m, m).

    Args:
        orbit: the orbit of a gait; k of its parameters are solved for, the first ones, and the branch is over the rest.
        keep: names of k measures that keep their values.
    """
    whole, free = equations(orbit, keep), orbit.dimension + len(keep)
    found = -np.linalg.solve(whole[:, :free], whole[:, free:])
    return np.concatenate([found, np.eye(found.shape[1])])


def equations(orbit: Orbit, keep: Iterable[str]) -> Array:
    """Returns derivatives of ξ after the cycle less ξ before it, and of measures, (d + k, d + m)."""
    moved = orbit.columns - np.eye(*orbit.columns.shape)
    return np.concatenate([moved, *(orbit.measures[name].derivative[None] for name in keep)])
