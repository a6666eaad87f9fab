"""A gait of a few numbers, and its hops."""

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Trajectory, hopping, simulate


@pytest.fixture(scope="session")
def gait(robot) -> Gait:
    system = hopping(robot, HoppingLaw(stance_torque=8.0))
    multipliers = np.array([0.4 + 0.1j, 0.4 - 0.1j, -0.2])
    return Gait(system, system.guess(), {"stance_torque": 8.0}, 1e-12, multipliers, {"stance": 0.36, "flight": 0.2})


@pytest.fixture(scope="session")
def hops(gait) -> Trajectory:
    return simulate(gait.system, gait.state, 4, 1e-7, progress=False)
