"""The bound in space as it is kept: its multipliers, and that feedback keeps it upright."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.hybrid.periodic import chart, return_map
from tests.solve.gaits import long_stride_in_space, long_stride_steady, long_stride_upright

pytestmark = pytest.mark.slow


def test_multipliers_of_the_plane_are_among_them():
    plane, found = Gait.load("long_stride"), long_stride_in_space()
    assert found.residual <= 1e-9 and not found.stable
    for multiplier in plane.multipliers[:4]:
        assert abs(found.multipliers - multiplier).min() <= 1e-5
    assert found.multipliers[0].real == pytest.approx(1.569, abs=5e-3)  # a fall sideways


def test_one_number_a_stride_suffices():
    """Sideways: what is left above is the plane's, along."""
    plane, found = Gait.load("long_stride").multipliers, long_stride_upright().multipliers
    lateral = [each for each in found if abs(plane - each).min() > 1e-5]
    assert abs(found[0]) == pytest.approx(abs(plane[0]), abs=1e-5) and max(map(abs, lateral)) <= 0.55


def test_a_push_sideways_with_roll_and_yaw_rate_is_recovered_from():
    """0.2 m/s, 5° and 10°/s at once: below a tenth in ten strides, the heading included."""
    closed = long_stride_steady()
    system, local = closed.system, chart(closed.system, closed.state)
    odd = ~local.even
    q, v = (part.copy() for part in closed.state)
    v[1], q[5], v[3] = 0.2, np.radians(5.0), np.radians(10.0)
    q[2] -= min(system.ground.foot(system.robot, q, toe)[0] for toe in system.section_toes)
    state, errors = (q, v), []
    for _ in range(11):
        errors.append(abs(np.append(local.coordinates(state)[odd], state[0][3])).max())
        run = return_map(system, state, 1e-9)
        assert run.cycles == 1
        state = run.state
    assert errors[0] >= 0.19 and errors[10] <= 0.1 * errors[0]
