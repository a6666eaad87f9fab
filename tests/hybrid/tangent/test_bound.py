"""Derivatives of bounds: springs that go slack, slips, lift-offs at once."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.tangent.record import Recorder

pytestmark = pytest.mark.extra("heyoka")


def test_events_that_all_but_meet_are_told_apart():
    """Of a leg that tracks θ̄ all but exactly, spring switch and lift-off follow each other within a microsecond."""
    gait = Gait.load("long_stride_3.50")
    recorder, section = Recorder(gait.system), chart(gait.system, gait.state)
    draws = np.random.default_rng(0)
    sizes = 10.0 ** np.linspace(-9.0, -3.0, 12)
    for size in sizes:
        state = section.state(size * draws.standard_normal(section.dimension))
        found = recorder.lap(np.concatenate(state))  # of these twelve a third was refused
        after = np.concatenate(return_map(gait.system, state, 1e-11).state)
        assert found.y == pytest.approx(after, abs=1e-9)


def test_a_heavier_torso_costs_less_for_its_weight():
    gait, name, step = Gait.load("least_effort"), "torso_mass", 1e-3

    def cost(off):
        system = with_numbers(gait.system, {name: number(gait.system, name) + off})
        return Orbit(system, gait.state, ()).measures["cost_of_transport"].value

    found = Orbit(gait.system, gait.state, (name,)).measures["cost_of_transport"].derivative[-1]
    assert found == pytest.approx((cost(step) - cost(-step)) / (2.0 * step), rel=1e-6)
