"""The biped of the examples, an automaton written outside the package, in the Taylor engine."""

import numpy as np
import pytest

from spear_pin import simulate, simulate_many
from tests import biped

pytestmark = pytest.mark.extra("heyoka")


def test_the_taylor_engine_runs_it_alike():
    system = biped.system()
    apex = simulate(system, system.guess()).named("apex")[1]  # of the flight that ends at the section
    rng = np.random.default_rng(3)
    q, v = np.tile(apex.q, (3, 1)), apex.v + rng.normal(0.0, 0.05, (3, 7))
    lanes = simulate_many(system, q, v, cycles=2)
    assert lanes.reason.tolist() == ["complete"] * 3 and not lanes.repeated.any()
    for i in range(len(q)):
        last = simulate(system, (q[i], v[i]), cycles=2, rtol=1e-10).events[-1]
        np.testing.assert_allclose(lanes.q[i], last.q, rtol=0, atol=1e-8)
        np.testing.assert_allclose(lanes.v[i], last.v, rtol=0, atol=1e-7)
