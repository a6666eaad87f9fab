"""Robots of others bound in space, upright by one input a stride, and trot."""

from functools import cache

import numpy as np
import pytest

from spear_pin import in_space, load, sagittal
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
