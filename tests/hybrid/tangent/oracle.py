"""What derivatives along cycles are compared with: Richardson's extrapolation of differences between cycles."""

from collections.abc import Callable

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.section import chart
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.derivative import Derivative
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.seeds import seeds

LEVELS = 4


def richardson(function: Callable[[float], Array], step: float, levels: int = LEVELS) -> Array:
    """The derivative at zero, from central differences with steps that are halved."""
    table = []
    for level in range(levels):
        h = step / 2.0**level
        table.append((function(h) - function(-h)) / (2.0 * h))
    for order in range(1, levels):
        table = [
            (4.0**order * fine - rough) / (4.0**order - 1.0) for rough, fine in zip(table, table[1:], strict=False)
        ]
    return table[0]


def tangents(section: Chart, nv: int) -> Array:
    """Derivatives of the state by coordinates of the section, (2 nv, d)."""
    d = section.dimension
    return np.array([richardson(lambda h, u=u: np.concatenate(section.state(h * u)), 1e-2) for u in np.eye(d)]).T


def derivative(system: HybridSystem, y: Array, names: tuple[str, ...] = ()) -> tuple[Derivative, Chart, Recorder]:
    """Derivatives of a cycle by coordinates of the section, then by parameters."""
    nv, recorder = system.robot.nv, Recorder(system)
    around = chart(system, (y[:nv], y[nv:]))
    columns, numbers = tangents(around, nv), seeds(system, names).numbers
    dy = np.concatenate([columns, np.zeros((2 * nv, len(names)))], axis=1)
    along = np.concatenate([np.zeros((len(numbers), columns.shape[1])), numbers], axis=1)
    return differentiate_cycle(system, recorder, y, dy, along), around, recorder


def end(system: HybridSystem, y: Array) -> Array:
    """State at the end of a cycle, with the durations of its phases."""
    record = Recorder(system).lap(y)
    spent = [
        sum(
            arc.end
            for arc in record.arcs
            if arc.event is not None
            and arc.event.reset is not None
            and arc.event.reset.phase is not None
            and arc.domain.phase == phase
        )
        for phase in system.phases
    ]
    return np.concatenate([record.y, spent])


def by_coordinate(system: HybridSystem, around: Chart, j: int, step: float) -> Array:
    """Derivative of `end` by a coordinate of the section."""
    u = np.eye(around.dimension)[j]
    return richardson(lambda h: end(system, np.concatenate(around.state(h * u))), step)


def by_parameter(system: HybridSystem, y: Array, name: str, step: float) -> Array:
    """Derivative of `end` by a parameter, with a step in the parameter's size."""
    value = parameter(system, name)
    return richardson(lambda h: end(with_parameters(system, {name: value + h}), y), step * (abs(value) or 1.0))


def found(result: Derivative, column: int) -> Array:
    """The same from the derivatives, one of their columns."""
    dual = [result.durations.get(phase) for phase in result.system.phases]
    spent = [0.0 if each is None else each.d[column] for each in dual]
    return np.concatenate([result.dy[:, column], spent])
