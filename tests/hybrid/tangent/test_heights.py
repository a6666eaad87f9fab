"""Heights of toes against Pinocchio's, on slopes and steps, and their derivatives against differences."""

import numpy as np
import pytest

from spear_pin import Gait, Ground, bounding, hopping, load
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.heights import dual_heights
from spear_pin.hybrid.tangent.seeds import numbers, seeds

COUNT, STEP = 4, 1e-5
HOP, BOUND = ("hip_to_knee", "knee_to_toe", "slope", "height"), ("hip_distance", "slope")


def system_of(kind):
    ground = Ground(slope=0.1, height=0.2 if kind == "hop" else 0.0)
    if kind == "hop":
        return hopping(load("spear_ii"), ground=ground), HOP
    return bounding(load("q_spear"), Gait.load("long_stride").system.law, ground=ground), BOUND


def by_pinocchio(system, toe, q):
    return system.ground.foot(system.robot, q, toe)[0]


@pytest.mark.parametrize("kind", ["hop", "bound"])
def test_against_pinocchio(kind):
    system, names = system_of(kind)
    robot, rng = system.robot, np.random.default_rng(5)
    q = rng.uniform(-1.0, 1.0, (robot.nv, COUNT))
    own = np.concatenate([np.zeros((len(numbers(system)), robot.nv)), seeds(system, names).numbers], axis=1)
    dq = np.tile(np.eye(robot.nv, robot.nv + len(names))[:, None], (1, COUNT, 1))
    heights = dual_heights(system, numbers(system), own)
    for toe in robot.toes:
        values, slopes = heights.along(toe, q, dq)
        for i in range(COUNT):
            assert values[i] == pytest.approx(by_pinocchio(system, toe, q[:, i]), abs=1e-12)
            assert slopes[i, : robot.nv] == pytest.approx(system.ground.foot(robot, q[:, i], toe)[1][-1], abs=1e-12)
            for j, name in enumerate(names):
                value = number(system, name)
                up, down = (
                    by_pinocchio(with_numbers(system, {name: value + side * STEP}), toe, q[:, i]) for side in (1, -1)
                )
                assert slopes[i, robot.nv + j] == pytest.approx((up - down) / (2.0 * STEP), abs=1e-8), (toe, name)
