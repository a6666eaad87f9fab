"""Robots of others bound in space, upright by one input a stride, and trot; `tests.solve` finds these gaits."""

import numpy as np
import pytest

from spear_pin import simulate
from spear_pin.gaits.spatial.trotting import halfway
from spear_pin.hybrid.event_feedback import feedback_of, with_feedback
from spear_pin.hybrid.periodic import chart, residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import asymmetry, head_state
from tests.solve.gaits import (
    anymal_b_bound,
    anymal_b_bound_upright,
    anymal_b_trot,
    solo12_bound,
    solo12_bound_upright,
    solo12_trot,
    solo12_trot_steady,
)

pytestmark = [
    *(pytest.mark.slow, pytest.mark.extra("example-robot-data")),
    pytest.mark.filterwarnings("ignore:.*repair=True:spear_pin.errors.RobotWarning"),  # of anymal_b's massless base
]


@pytest.mark.parametrize(
    ("bound", "upright", "fall"),
    [(solo12_bound, solo12_bound_upright, 1.51), (anymal_b_bound, anymal_b_bound_upright, 1.62)],
    ids=["solo12", "anymal_b"],
)
class TestInSpace:
    def test_an_orbit_that_falls_sideways(self, bound, upright, fall):
        gait = bound()
        assert gait.residual <= 1e-9 and residual(gait.system, gait.state) <= 1e-9
        assert gait.multipliers[0].real == pytest.approx(fall, abs=0.05)
        assert 0.0 < asymmetry(gait.system.robot, gait.state) < 0.2

    def test_upright_by_one_input(self, bound, upright, fall):
        steady = upright()
        assert abs(steady.multipliers[0]) < 1.0
        local = chart(steady.system, steady.state)
        q, v = (part.copy() for part in steady.state)
        v[1] += 0.1
        pushed = run(steady.system, (q, v), 25, Options(rtol=1e-8))
        assert pushed.cycles == 25
        assert np.abs(local.coordinates(pushed.state)).max() <= 0.5 * np.abs(local.coordinates((q, v))).max()


class TestTrot:
    def test_an_orbit(self):
        """Of whole strides, its sides not being alike."""
        assert solo12_trot().residual <= 1e-9 and residual(solo12_trot().system, solo12_trot().state) <= 1e-9
        assert {"diagonal_left_stance", "diagonal_right_stance"} <= solo12_trot().durations.keys()
        stride = return_map(solo12_trot().system, solo12_trot().state)
        assert solo12_trot().system.measures["mean_speed"](stride) == pytest.approx(1.4187, abs=1e-4)
        assert "slip" not in {event.name for event in stride.events}
        np.testing.assert_allclose(np.abs(solo12_trot().multipliers[:3]), [17.4, 6.84, 1.034], rtol=0.02)
        between = np.concatenate(halfway(solo12_trot().system, stride))
        assert 1e-6 < np.abs(between - np.concatenate(head_state(*solo12_trot().state))).max() < 0.01

    def test_feedback_twice_a_stride_holds_it(self):
        steady = solo12_trot_steady()
        assert residual(steady.system, steady.state) <= 1e-9
        assert abs(steady.multipliers[0]) <= 0.3
        local = chart(steady.system, steady.state)
        q, v = (part.copy() for part in steady.state)
        v[1] += 0.2
        pushed = run(steady.system, (q, v), 10, Options(rtol=1e-8))
        assert pushed.cycles == 10
        assert np.abs(local.coordinates(pushed.state)).max() <= 0.01 * np.abs(local.coordinates((q, v))).max()


class TestTrotOfAnymal:
    def test_an_orbit(self):
        gait, free = anymal_b_trot(), with_feedback(anymal_b_trot().system, None)
        assert residual(gait.system, gait.state) <= 1e-9 and residual(free, gait.state) <= 1e-9
        stride = return_map(free, gait.state)
        assert {"diagonal_left_stance", "diagonal_right_stance", "flight_1", "flight_2"} <= stride.durations.keys()
        assert free.measures["mean_speed"](stride) == pytest.approx(0.9603, abs=1e-4)
        assert "slip" not in {event.name for event in stride.events}
        np.testing.assert_allclose(stride.change, [work.sum() for work in stride.work], rtol=0, atol=1e-8)

    def test_within_the_limits_of_its_file(self):
        motion, robot = simulate(anymal_b_trot().system, anymal_b_trot().state, 1), anymal_b_trot().system.robot
        limits = [robot.limits[name] for name in robot.coordinates[6:]]
        assert (abs(motion.u).max(axis=0) < [0.4 * limit.effort for limit in limits]).all()
        assert (abs(motion.v[:, 6:]).max(axis=0) < [limit.velocity for limit in limits]).all()
        force = motion.force[motion.force[..., 2] > 1.0]
        assert 0.4 < (np.hypot(force[:, 0], force[:, 1]) / force[:, 2]).max() < 0.6

    def test_unstable_by_itself_and_held_by_feedback(self):
        ends = []
        for feedback in (None, feedback_of(anymal_b_trot().system)):
            system = with_feedback(anymal_b_trot().system, feedback)
            q, v = (part.copy() for part in anymal_b_trot().state)
            v[1] += 1e-3 if not feedback else 0.2
            pushed = run(system, (q, v), 3 if not feedback else 10, Options(rtol=1e-8))
            local = chart(system, anymal_b_trot().state)
            ends.append(np.abs(local.coordinates(pushed.state)).max() / np.abs(local.coordinates((q, v))).max())
            assert pushed.reason == "complete"
        assert ends[0] > 10.0 and ends[1] < 0.01
