"""Gaits found for other parameters: in lanes where these may differ between lanes, else one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError
from spear_pin.gaits.gait_table import CONVERGED, NO_CONVERGENCE
from spear_pin.gaits.lane_cycles import NOT_VALID, spread_lanes
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.many import find_many
from spear_pin.gaits.sensitivity.closing import close_cycle
from spear_pin.gaits.sensitivity.many_measures import measure_lanes
from spear_pin.gaits.sensitivity.measure import MULTIPLIER
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import has_lanes
from spear_pin.hybrid.ground import PLACE
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.section import section
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.motor import Drive, Motor
from spear_pin.model.robot import Robot

if TYPE_CHECKING:
    from spear_pin.gaits.sensitivity.sensitivity import Sensitivity

OnLanes = Callable[[int], object]
NOT_PLAIN = "not_plain"


@dataclass(frozen=True)
class SampledGaits:
    """Gaits with parameters drawn at random.

    Attributes:
        parameters: values of the parameters, (n, m).
        outputs: solved parameters, measures, moduli of multipliers and numbers of the state, by name, (n,) each, NaN
            where there is no value.
        reason: "converged" where a gait was found, else the reason why not, (n,).
        largest: modulus of the largest multiplier, (n,).
        alike: whether the gait was found and its events are in the same order, (n,).
    """

    parameters: Array
    outputs: Mapping[str, Array]
    reason: NDArray[np.str_]
    largest: Array
    alike: NDArray[np.bool_]

    @property
    def found(self) -> NDArray[np.bool_]:
        """Whether a gait was found, (n,)."""
        return np.asarray(self.reason == CONVERGED)


def find_anew(table: Sensitivity, parameters: Array, on_lanes: OnLanes = lambda n: None) -> SampledGaits:
    """Finds the gaits near a gait for other parameters, (n, m).

    Args:
        table: derivatives of the gait, which tell where gaits near it are.
        parameters: parameters of each gait.
        on_lanes: called with the number of gaits done since the last call.
    """
    return (_in_lanes if side_by_side(table) else _one_by_one)(table, parameters, on_lanes)


def side_by_side(table: Sensitivity) -> bool:
    """Tells whether lanes may differ in all parameters, and can record all that is kept and measured."""
    return (
        not any(isinstance(each, Drive) for each in table.motors.values())
        and has_lanes(table.system, (*table.parameters, *table.solved))
        and not set(table.solved) & set(PLACE)
        and all(name in MEASURES and name in table.system.measures for name in table.keep)
    )


def state_columns(robot: Robot) -> dict[str, str]:
    """Returns the units of the numbers of a state, by the names of a trajectory's columns."""
    names = [f"{part}_{name}" for part in "qv" for name in robot.coordinates]
    return dict(zip(names, (*robot.units, *(f"{unit}/s" for unit in robot.units)), strict=True))


def _kept(table: Sensitivity) -> dict[str, float]:
    return {name: table.outputs[name] for name in table.keep}


def _predicted(table: Sensitivity, parameters: Array) -> tuple[Array, Array]:
    """Predicts states, (n, 2 nv), near the section, and solved numbers, (n, k), for parameters, (n, m)."""
    change, slopes = parameters - table.given, np.reshape([*table.solved.values()], (-1, len(table.given)))
    solved = np.array([number(table.system, name) for name in table.solved])
    return np.concatenate(table.at) + change @ table.state.T, solved + change @ slopes.T


def _placed(
    table: Sensitivity, system: HybridSystem, y: Array, numbers: Mapping[str, Array] | None = None
) -> tuple[Array, Array]:
    """Puts states, (n, 2 nv), onto a system's section, which may differ between them; the same toes slide."""
    (q, v), nv = table.at, system.robot.nv
    slides = section(table.system).sliding(q[None], v[None])[0]
    charts = section(system, numbers).charts(y[:, :nv], y[:, nv:], slides)
    return charts.states(np.zeros((len(y), charts.dimension)))


def _moduli(table: Sensitivity, multipliers: NDArray[np.complex128]) -> Array:
    """Returns moduli of multipliers in the order of the gait's, (d,); NaN where a toe begins to slide as it lands."""
    here, others = table.multipliers, multipliers[np.isfinite(multipliers)]
    if len(here) != len(others):
        return np.full(len(here), np.nan)
    _, order = scipy.optimize.linear_sum_assignment(np.abs(here[:, None] - others))
    return np.asarray(np.abs(others[order]), np.float64)


def _in_lanes(table: Sensitivity, parameters: Array, on_lanes: OnLanes) -> SampledGaits:
    system, order = table.system, Recorder(table.system).lap(np.concatenate(table.at)).order
    given = dict(zip(table.parameters, parameters.T, strict=True))
    y, begin = _predicted(table, parameters)
    for column, name in zip(begin.T, table.solved, strict=True):
        own = number(system, name)
        given[name] = np.where(column * own > 0.0, column, own)
    numbers = {name: given[name] for name in table.parameters}
    gaits = find_many(system, given, tuple(table.solved), _kept(table), guess=_placed(table, system, y, numbers))
    found = np.flatnonzero(gaits.converged)
    own_numbers = {name: gaits.parameters[name][found] for name in given}
    motors = {joint: each for joint, each in table.motors.items() if isinstance(each, Motor)}  # as all are
    cycles, orders = measure_lanes(system, own_numbers, gaits.q[found], gaits.v[found], motors, on_lanes)
    on_lanes(len(parameters) - len(found))
    outputs = {name: gaits.parameters[name] for name in table.solved}
    outputs |= {name: spread_lanes(values, found, len(parameters)) for name, values in cycles.items()}
    moduli = np.full((len(parameters), len(table.multipliers)), np.nan)
    for i in found:
        moduli[i] = _moduli(table, gaits.multipliers[i])
    outputs |= {f"{MULTIPLIER}{i + 1}": column for i, column in enumerate(moduli.T)}
    outputs |= dict(zip(state_columns(system.robot), np.column_stack([gaits.q, gaits.v]).T, strict=True))
    alike = np.zeros(len(parameters), dtype=bool)
    alike[found] = [each == order for each in orders]
    return SampledGaits(parameters, outputs, gaits.reason, gaits.largest, alike)


def _one_by_one(table: Sensitivity, parameters: Array, on_lanes: OnLanes) -> SampledGaits:
    n, order = len(parameters), Recorder(table.system).lap(np.concatenate(table.at)).order
    y, begin = _predicted(table, parameters)
    reason, alike, largest = np.full(n, CONVERGED, dtype=object), np.zeros(n, dtype=bool), np.full(n, np.nan)
    outputs: dict[str, Array] = {}
    vary = tuple(table.solved)
    for i in range(n):
        on_lanes(1)
        try:
            system = with_numbers(table.system, dict(zip(table.parameters, parameters[i].tolist(), strict=True)))
        except BadValue:
            reason[i] = NOT_VALID
            continue
        try:
            near = with_numbers(system, dict(zip(vary, begin[i].tolist(), strict=True)))
            q, v = _placed(table, near, y[i][None])
            orbit = close_cycle(Orbit(near, (q[0], v[0]), vary, table.motors), _kept(table))
        except (SpearError, np.linalg.LinAlgError) as error:
            plain = not isinstance(error.__cause__ or error, NotDifferentiable)
            reason[i] = NO_CONVERGENCE if plain else NOT_PLAIN
            continue
        multipliers = np.linalg.eigvals(orbit.jacobian).astype(np.complex128)
        row = {name: number(orbit.system, name) for name in vary}
        row |= {name: measure.value for name, measure in orbit.measures.items()}
        row |= {f"{MULTIPLIER}{k + 1}": value for k, value in enumerate(_moduli(table, multipliers))}
        row |= dict(zip(state_columns(near.robot), np.concatenate(orbit.state), strict=True))
        for name, value in row.items():
            outputs.setdefault(name, np.full(n, np.nan))[i] = value
        alike[i] = Recorder(orbit.system).lap(np.concatenate(orbit.state)).order == order
        largest[i] = np.abs(multipliers).max()
    return SampledGaits(parameters, outputs, reason.astype(str), largest, alike)
