"""Robots of others bound in space, upright by one input a stride."""

from functools import cache

import numpy as np
import pytest

from spear_pin import in_space, load, sagittal
from spear_pin.gaits.orbits.balance import balanced
from spear_pin.hybrid.periodic import chart, residual
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import asymmetry
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
