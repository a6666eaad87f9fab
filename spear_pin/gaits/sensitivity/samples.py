"""Gaits found for other parameters: in lanes where these may differ between lanes, else one by one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError
from spear_pin.gaits.gait_table import CONVERGED, NO_CONVERGENCE
from spear_pin.gaits.lane_cycles import NOT_VALID, spread_lanes
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.many import find_many
from spear_pin.gaits.sensitivity.closing import close_cycle
from spear_pin.gaits.sensitivity.many_measures import measure_lanes
from spear_pin.gaits.sensitivity.neighbourhood import Neighbourhood
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.batch import has_lanes
from spear_pin.hybrid.ground import PLACE
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.motor import Drive, Motor

OnLanes = Callable[[int], object]
NOT_PLAIN = "not_plain"


@dataclass(frozen=True)
class Samples:
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


def find_anew(local: Neighbourhood, parameters: Array, on_lanes: OnLanes = lambda n: None) -> Samples:
    """Finds the gaits near a gait for other parameters, (n, m).

    Args:
        local: the gait.
        parameters: parameters of each gait.
        on_lanes: called with the number of gaits done since the last call.
    """
    return (_in_lanes if side_by_side(local) else _one_by_one)(local, parameters, on_lanes)


def side_by_side(local: Neighbourhood) -> bool:
    """Tells whether lanes may differ in all parameters, and can record all that is kept and measured."""
    return (
        not any(isinstance(each, Drive) for each in local.motors.values())
        and has_lanes(local.system, (*local.over, *local.vary))
        and not set(local.vary) & set(PLACE)
        and all(name in MEASURES and name in local.system.measures for name in local.keep)
    )


def _in_lanes(local: Neighbourhood, parameters: Array, on_lanes: OnLanes) -> Samples:
    system, order = local.system, Recorder(local.system).lap(np.concatenate(local.state)).order
    given = dict(zip(local.over, parameters.T, strict=True))
    y, begin = local.predicted(parameters)
    target = dict(zip(local.keep, local.kept.tolist(), strict=True))
    start = given | dict(zip(local.vary, np.where(begin * local.solved > 0.0, begin, local.solved).T, strict=True))
    table = find_many(system, start, local.vary, target, guess=local.placed(system, y, given))
    found = np.flatnonzero(table.converged)
    own = {name: table.parameters[name][found] for name in (*local.over, *local.vary)}
    motors = {joint: each for joint, each in local.motors.items() if isinstance(each, Motor)}  # as all are
    cycles, orders = measure_lanes(system, own, table.q[found], table.v[found], motors, on_lanes)
    on_lanes(len(parameters) - len(found))
    outputs = {name: table.parameters[name] for name in local.vary}
    outputs |= {name: spread_lanes(values, found, len(parameters)) for name, values in cycles.items()}
    moduli = np.full((len(parameters), len(local.multipliers)), np.nan)
    for i in found:
        moduli[i] = local.moduli(table.multipliers[i])
    outputs |= {f"multiplier_{i + 1}": column for i, column in enumerate(moduli.T)}
    outputs |= dict(zip(local.columns, np.column_stack([table.q, table.v]).T, strict=True))
    alike = np.zeros(len(parameters), dtype=bool)
    alike[found] = [each == order for each in orders]
    return Samples(parameters, outputs, table.reason, table.largest, alike)


def _one_by_one(local: Neighbourhood, parameters: Array, on_lanes: OnLanes) -> Samples:
    n, order = len(parameters), Recorder(local.system).lap(np.concatenate(local.state)).order
    y, begin = local.predicted(parameters)
    reason, alike, largest = np.full(n, CONVERGED, dtype=object), np.zeros(n, dtype=bool), np.full(n, np.nan)
    outputs: dict[str, Array] = {}
    kept = dict(zip(local.keep, local.kept.tolist(), strict=True))
    for i in range(n):
        on_lanes(1)
        try:
            system = with_numbers(local.system, dict(zip(local.over, parameters[i].tolist(), strict=True)))
        except BadValue:
            reason[i] = NOT_VALID
            continue
        try:
            near = with_numbers(system, dict(zip(local.vary, begin[i].tolist(), strict=True)))
            q, v = local.placed(near, y[i][None])
            orbit = close_cycle(Orbit(near, (q[0], v[0]), local.vary, local.motors), kept)
        except (SpearError, np.linalg.LinAlgError) as error:
            plain = not isinstance(error.__cause__ or error, NotDifferentiable)
            reason[i] = NO_CONVERGENCE if plain else NOT_PLAIN
            continue
        multipliers = np.linalg.eigvals(orbit.jacobian).astype(np.complex128)
        row = {name: number(orbit.system, name) for name in local.vary}
        row |= {name: measure.value for name, measure in orbit.measures.items()}
        row |= {f"multiplier_{k + 1}": value for k, value in enumerate(local.moduli(multipliers))}
        row |= dict(zip(local.columns, np.concatenate(orbit.state), strict=True))
        for name, value in row.items():
            outputs.setdefault(name, np.full(n, np.nan))[i] = value
        alike[i] = Recorder(orbit.system).lap(np.concatenate(orbit.state)).order == order
        largest[i] = np.abs(multipliers).max()
    return Samples(parameters, outputs, reason.astype(str), largest, alike)
