"""Measures of the cycles of many lanes at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import Batch

MeasureOfLanes = Callable[[HybridSystem, Array, Batch], Array]


def _durations(phase: str) -> MeasureOfLanes:
    return lambda system, q, batch: batch.durations[phase]


def _period(system: HybridSystem, q: Array, batch: Batch) -> Array:
    return np.asarray(sum(batch.durations.values()))


def _stride(system: HybridSystem, q: Array, batch: Batch) -> Array:
    if not system.cyclic:
        return np.zeros(len(q))
    forward = system.robot.index(system.cyclic[0])
    return np.asarray(batch.q[:, forward] - q[:, forward])


OBSERVED = ("apex_height",)  # measures at events that change nothing; each costs a stop in each cycle
MEASURES: Mapping[str, MeasureOfLanes] = {
    "apex_height": lambda system, q, batch: batch.observed["apex"][:, system.robot.index("boom_z")],
    "flight_time": _durations("flight"),
    "stance_time": _durations("stance"),
    "period": _period,
    "stride": _stride,
    "mean_speed": lambda system, q, batch: _stride(system, q, batch) / _period(system, q, batch),
}
