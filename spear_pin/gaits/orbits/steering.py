"""A turning gait near another: of all changes of the inputs that give the wanted turn, the smallest.

If both feet of a pair land long after each other, the impact of the second foot throws up the first. So the inputs also
keep the time between the two landings within bounds.
"""

from __future__ import annotations

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.gaits.orbits.strides import Strides
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import State
from spear_pin.hybrid.symmetry import head_state

STEERED_BY = (
    *(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ("hip_difference", "leg_difference")),
    *(f"{pair}_{name}" for pair in ("posterior", "anterior") for name in ("adduction", "adduction_torque")),
    *("posterior_hip_torque", "posterior_leg_touchdown", "anterior_leg_touchdown"),
)
GAP = 0.004  # s: longest time between the two touchdowns of a pair
SECOND = 0.1  # s: what counts as one of that time
LONGEST = 0.3  # change of an unknown in a step


def find_steered(
    system: HybridSystem, state: State, turn: float, speed: float, rtol: float
) -> tuple[HybridSystem, State]:
    """Finds the system and state that turn by an angle in a stride, at a speed, near a system and state that nearly do.

    The Gauss-Newton method varies the state and `STEERED_BY`, and takes the shortest of all steps.

    Args:
        system: a system in space.
        state: state on its section.
        turn: change of the heading in a stride, to the left, in rad.
        speed: along the heading, in m/s.
        rtol: relative tolerance of the integrator.

    Raises:
        NoGait: the method does not converge, or a stride does not close.
    """
    strides, wanted = Strides(system, state, STEERED_BY, SECOND, rtol), np.array([turn, speed])

    def off(values: Array) -> Array:
        gaps = values[-2:]
        return np.concatenate([values[:-4], values[-4:-2] - wanted, gaps - np.clip(gaps, -GAP / SECOND, GAP / SECOND)])

    def held(values: Array) -> Array:  # a time between touchdowns that is not too long is free
        return np.append(np.ones(len(values) - 2), np.abs(values[-2:]) >= GAP / SECOND)

    try:
        x = strides.solved(np.zeros(strides.unknowns), off, held, 10.0 * rtol, LONGEST)
    except NoGait as failure:
        problem = f"no turn by {np.degrees(turn):.3g}° a stride was found: {failure.reason}"
        raise NoGait(problem, failure.residual, remedy="a smaller turn") from None
    return strides.system(x), head_state(*strides.state(x))
