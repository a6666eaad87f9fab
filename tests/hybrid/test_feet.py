"""The compiled motion of the toes, beside Pinocchio's."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, Ground, simulate_many
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.numbers import Numbers
from tests.walkers import example

pytestmark = pytest.mark.extra("heyoka")


@pytest.mark.parametrize("gait", ["long_stride", "trot"])
@pytest.mark.parametrize("slope", [0.0, 0.1])
def test_is_pinocchios(gait, slope):
    """Heights and velocities of random states, of many at once and of one."""
    rng, system = np.random.default_rng(0), Gait.load(gait).system
    system = replace(system, contact=Ground(slope=slope, height=0.3 * slope))
    nv, n = system.robot.nv, 5
    y = rng.normal(size=(2 * nv, n))
    numbers = Numbers(system, {}, Code(1e-12))
    parameters = np.array(numbers.constants(0))
    heights, velocities = numbers.compilation.feet(y, np.tile(parameters[:, None], n))
    for lane in range(n):
        feet = [system.ground.foot(system.robot, y[:nv, lane], toe) for toe in system.robot.toes]
        np.testing.assert_allclose(heights[:, lane], [height for height, _ in feet], atol=1e-13)
        np.testing.assert_allclose(velocities[..., lane], [rows @ y[nv:, lane] for _, rows in feet], atol=1e-12)
        for one, many in zip(numbers.compilation.feet(y[:, lane], parameters), (heights, velocities), strict=True):
            np.testing.assert_allclose(one, many[..., lane], atol=1e-13)


@pytest.mark.parametrize("n", [0, 3])
def test_of_a_robot_without_toes(n):
    """They are none, and lanes run nevertheless."""
    system = example().simplest_walker()
    heights, velocities = Numbers(system, {}, Code(1e-12)).compilation.feet(np.zeros((4, n)), np.zeros((9, n)))
    assert heights.shape == (0, n) and velocities.shape == (0, 2, n)
    q, v = (np.tile(part, (n, 1)) for part in system.guess())
    assert simulate_many(system, q, v).reason.tolist() == n * ["complete"]
