"""Turns that ship, and steps from one to the next."""

import math
from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits import library
from spear_pin.gaits.orbits.steering import GAP, SECOND, STEERED_BY
from spear_pin.gaits.orbits.strides import Strides, first_times, footfall_gap
from spear_pin.gaits.spatial.automaton import forward_speed
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import residual, return_map
from spear_pin.hybrid.symmetry import mirror_of
from tests.slow import slow_but
from tests.solve.gaits import turn_sharper


@cache
def stride(name):
    gait = Gait.load(name)
    return return_map(gait.system, gait.state)


@pytest.mark.parametrize("name", slow_but(library.TURNS, "turn_9"))
class TestShipped:
    @pytest.mark.slow
    def test_they_are_orbits_that_turn_as_they_are_called(self, name):
        gait, run = Gait.load(name), stride(name)
        angle, speed = library.TURNS[name]
        assert residual(gait.system, gait.state) < 1e-9
        assert math.degrees(gait.system.measures["turn"](run)) == pytest.approx(angle, abs=1e-7)
        assert forward_speed(run) == pytest.approx(speed, abs=1e-8)
        assert abs(run.change[0] - run.work[0].sum()) < 1e-9

    @pytest.mark.slow
    def test_the_mirror_image_turns_to_the_other_side(self, name):
        gait, mirror = Gait.load(name), mirror_of(Gait.load(name).system.robot)
        right = with_parameters(gait.system, {each: -parameter(gait.system, each) for each in ACROSS})
        state = mirror(gait.state[0]), mirror(gait.state[1])
        assert residual(right, state) < 1e-9
        turn = gait.system.measures["turn"](stride(name))
        assert right.measures["turn"](return_map(right, state)) == pytest.approx(-turn, abs=1e-9)

    @pytest.mark.slow
    def test_feet_of_a_pair_land_soon_after_each_other(self, name):
        times = first_times(stride(name))
        assert all(abs(footfall_gap(times, pair)) < GAP + 1e-5 for pair in ("posterior", "anterior"))


@pytest.mark.slow
def test_a_step_to_a_sharper_turn_is_the_shortest():
    gait, (system, state) = Gait.load("turn_4"), (turn_sharper().system, turn_sharper().state)
    run = return_map(system, state)
    assert residual(system, state) < 1e-7
    assert math.degrees(system.measures["turn"](run)) == pytest.approx(4.2, abs=1e-5)
    changes = [parameter(system, name) - parameter(gait.system, name) for name in STEERED_BY]
    assert 0.0 < np.abs(changes).max() < 3.0


@pytest.mark.slow
def test_a_stride_is_the_reference_engine_s():
    """Its turn, its speed, and the times between the touchdowns of a pair."""
    gait, run = Gait.load("turn_4"), stride("turn_4")
    strides = Strides(gait.system, gait.state, STEERED_BY, SECOND, 1e-12)
    gaps = [footfall_gap(first_times(run), pair) / SECOND for pair in ("posterior", "anterior")]
    expected = [*strides.n * [0.0], gait.system.measures["turn"](run), forward_speed(run), *gaps]
    np.testing.assert_allclose(strides.values(np.zeros(strides.unknowns)), expected, rtol=0, atol=1e-9)
    assert all(gaps)


@pytest.mark.slow
def test_slopes_of_a_stride_are_those_of_differences():
    """With the turn, the speed and the times between the touchdowns of a pair."""
    gait = Gait.load("turn_4")
    strides = Strides(gait.system, gait.state, STEERED_BY, SECOND, 1e-12)
    still, h = np.zeros(strides.unknowns), 1e-5
    found = strides._exact(still)  # `slopes` may take differences
    assert found is not None
    np.testing.assert_array_equal(strides.slopes(still), found)
    for column in (0, 20, strides.n + 3, strides.n + 10):
        by = h * np.eye(strides.unknowns)[column]
        wanted = (strides.values(by) - strides.values(-by)) / (2.0 * h)
        np.testing.assert_allclose(found[:, column], wanted, rtol=0, atol=1e-6 * max(1.0, np.abs(wanted).max()))
        assert wanted[-2:].any()
