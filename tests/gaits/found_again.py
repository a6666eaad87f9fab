"""Derivatives of gaits against gaits that are found again with other values of a number."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from spear_pin import Gait, find_gait
from spear_pin.arrays import Array
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import State
from spear_pin.model.motor import NO_MOTORS, Drive, Motor
from tests.hybrid.tangent.oracle import richardson


def hops(
    gait: Gait, over: str, step: float, begin: Callable[[HybridSystem, State], State] = lambda system, state: state
) -> tuple[Array, Array]:
    """The derivatives of a hop's torque and state by a number, with its flight kept, and what they are by differences.

    Steps are shares of the number; hops are searched for from what `begin` makes of the given one's state.
    """
    table, given = gait.sensitivity([over], ["stance_torque"], ["flight_time"]), number(gait.system, over)
    target = {"flight_time": table.outputs["flight_time"]}

    def found(change: float) -> Array:
        system = with_numbers(gait.system, {over: given + change})
        near = find_gait(system, ["stance_torque"], target, guess=begin(system, gait.state), rtol=1e-12)
        return np.array([near.parameters["stance_torque"], *near.state[0], *near.state[1]])

    return np.array([*table.solved["stance_torque"], *table.state[:, 0]]), richardson(found, step * given, 2)


def measures(
    gait: Gait, name: str, of: Callable[[Orbit], Sequence[float]], motors: Mapping[str, Motor | Drive] = NO_MOTORS
) -> Array:
    """The derivatives by a number of what is measured of a gait's cycle, by differences of fourth order."""
    value = number(gait.system, name)

    def found(change: float) -> Array:
        system = with_numbers(gait.system, {name: value + change})
        return np.array(of(Orbit(system, gait_beside(system, gait.state, [], {}, 1e-12).state, (), motors)))

    return richardson(found, 4e-4 * abs(value), 2)
