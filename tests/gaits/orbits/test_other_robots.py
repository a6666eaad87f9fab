"""Robots of others bound in space, upright by one input a stride, and trot."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, in_space, load, sagittal, simulate
from spear_pin.gaits.footfalls.collocate import collocated
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.footfalls.trots import trot_beside
from spear_pin.gaits.orbits.balance import balanced
from spear_pin.gaits.spatial.trotting import halfway
from spear_pin.hybrid.periodic import chart, residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import asymmetry, headed
from spear_pin.studies.bound import bound_of

pytestmark = [
    *(pytest.mark.slow, pytest.mark.extra("example-robot-data"), pytest.mark.extra("casadi")),
    pytest.mark.filterwarnings("ignore:.*repair=True:spear_pin.errors.RobotWarning"),  # of anymal_b's massless base
]


@cache
def found(name):
    return in_space(bound_of(sagittal(load(name, base="free", motors="all"))))


@pytest.mark.parametrize(("name", "fall"), [("solo12", 1.51), ("anymal_b", 1.62)])
class TestInSpace:
    def test_an_orbit_that_falls_sideways(self, name, fall):
        gait = found(name)
        assert gait.residual <= 1e-9 and residual(gait.system, gait.state) <= 1e-9
        assert gait.multipliers[0].real == pytest.approx(fall, abs=0.05)
        assert 0.0 < asymmetry(gait.system.robot, gait.state) < 0.2

    def test_upright_by_one_input(self, name, fall):
        steady = balanced(found(name))
        assert abs(steady.multipliers[0]) < 1.0
        local = chart(steady.system, steady.state)
        q, v = (part.copy() for part in steady.state)
        v[1] += 0.1
        pushed = run(steady.system, (q, v), 25, Options(rtol=1e-8))
        assert pushed.cycles == 25
        assert np.abs(local.coordinates(pushed.state)).max() <= 0.5 * np.abs(local.coordinates((q, v))).max()


@cache
def trot():
    robot = load("solo12", base="chain", motors="all", toes=[f"{leg}_FOOT" for leg in ("FL", "FR", "HL", "HR")])
    footfalls, law, swing = FOOTFALLS["trot"].finer(2), StanceLaw.scaled(robot), SwingLaw.scaled(robot)
    asked = FootfallRequest.scaled(robot, footfalls=footfalls, law=law, swing=swing)
    return trot_beside(collocated(robot, asked), apart=(0.004,))


class TestTrot:
    def test_an_orbit(self):
        """Of whole strides, its sides not being alike."""
        assert trot().residual <= 1e-9 and residual(trot().system, trot().state) <= 1e-9
        assert {"diagonal_left_stance", "diagonal_right_stance"} <= trot().durations.keys()
        stride = return_map(trot().system, trot().state)
        assert trot().system.measures["mean_speed"](stride) == pytest.approx(1.4187, abs=1e-4)
        assert "slip" not in {event.name for event in stride.events}
        np.testing.assert_allclose(np.abs(trot().multipliers[:3]), [17.4, 6.84, 1.034], rtol=0.02)
        between = np.concatenate(halfway(trot().system, stride))
        assert 1e-6 < np.abs(between - np.concatenate(headed(*trot().state))).max() < 0.01

    def test_feedback_twice_a_stride_holds_it(self):
        steady = balanced(trot())
        assert residual(steady.system, steady.state) <= 1e-9
        assert abs(steady.multipliers[0]) <= 0.3
        local = chart(steady.system, steady.state)
        q, v = (part.copy() for part in steady.state)
        v[1] += 0.2
        pushed = run(steady.system, (q, v), 10, Options(rtol=1e-8))
        assert pushed.cycles == 10
        assert np.abs(local.coordinates(pushed.state)).max() <= 0.01 * np.abs(local.coordinates((q, v))).max()


@cache
def kept():
    """ANYmal B's with its feedback, as it was found once as docs/space.md says, in ten minutes; these take one."""
    return Gait.load(Path(__file__).parents[2] / "solved" / "anymal_b_trot.json")


class TestTrotOfAnymal:
    def test_an_orbit(self):
        gait, free = kept(), kept().with_law(feedback=()).system
        assert residual(gait.system, gait.state) <= 1e-9 and residual(free, gait.state) <= 1e-9
        stride = return_map(free, gait.state)
        assert {"diagonal_left_stance", "diagonal_right_stance", "flight_1", "flight_2"} <= stride.durations.keys()
        assert free.measures["mean_speed"](stride) == pytest.approx(0.9603, abs=1e-4)
        assert "slip" not in {event.name for event in stride.events}
        np.testing.assert_allclose(stride.change, [work.sum() for work in stride.work], rtol=0, atol=1e-8)

    def test_within_the_limits_of_its_file(self):
        motion, robot = simulate(kept().system, kept().state, 1), kept().system.robot
        limits = [robot.limits[name] for name in robot.coordinates[6:]]
        assert (abs(motion.u).max(axis=0) < [0.4 * limit.effort for limit in limits]).all()
        assert (abs(motion.v[:, 6:]).max(axis=0) < [limit.velocity for limit in limits]).all()
        force = motion.force[motion.force[..., 2] > 1.0]
        assert 0.4 < (np.hypot(force[:, 0], force[:, 1]) / force[:, 2]).max() < 0.6

    def test_unstable_by_itself_and_held_by_feedback(self):
        ends = []
        for feedback in ((), kept().system.law.feedback):
            system = kept().with_law(feedback=feedback).system
            q, v = (part.copy() for part in kept().state)
            v[1] += 1e-3 if not feedback else 0.2
            pushed = run(system, (q, v), 3 if not feedback else 10, Options(rtol=1e-8))
            local = chart(system, kept().state)
            ends.append(np.abs(local.coordinates(pushed.state)).max() / np.abs(local.coordinates((q, v))).max())
            assert pushed.reason == "complete"
        assert ends[0] > 10.0 and ends[1] < 0.01
