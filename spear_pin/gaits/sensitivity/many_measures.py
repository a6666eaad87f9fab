"""Measures of many cycles with different numbers, by the names of `measures`, without derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.sensitivity.drives import DrivenJoints
from spear_pin.gaits.sensitivity.measures import differentiate_measures
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import Recorder, many
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.motor import NO_MOTORS, Motor


def measure_lanes(
    system: HybridSystem,
    given: Mapping[str, Array],
    q: Array,
    v: Array,
    motors: Mapping[str, Motor] = NO_MOTORS,
    on_lanes: Callable[[int], object] = lambda n: None,
) -> tuple[dict[str, Array], list[Order]]:
    """Measures one cycle of each lane.

    Args:
        system: the system.
        given: numbers that differ between lanes, (n,) each, among those that `simulate_many` takes.
        q: configurations on the section, (n, nq).
        v: velocities there, (n, nv).
        motors: motors whose heat is measured, by the names of their joints; none by default.
        on_lanes: called with the number of lanes done since the last call.

    Returns:
        measures by name, (n,) each, NaN where a cycle does not close or has no derivative; and the orders of events,
        empty there.
    """
    n, numbers, found = len(q), many(system, given), dict[str, Array]()
    orders: list[Order] = [()] * n
    still = np.zeros((2 * system.robot.nv, 1))
    driven = DrivenJoints(system, motors, (), 1)
    for i in range(n):
        recorder = Recorder(system, numbers, i)
        nothing = np.zeros((len(recorder.numbers), 1))
        with suppress(NotDifferentiable):
            cycle = differentiate_cycle(system, recorder, np.concatenate([q[i], v[i]]), still, nothing)
            orders[i] = cycle.record.order
            for name, each in differentiate_measures(cycle, still, still[0], driven).items():
                found.setdefault(name, np.full(n, np.nan))[i] = each.value if np.isfinite(each.value) else np.nan
        on_lanes(1)
    return found, orders
