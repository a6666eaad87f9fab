"""Cycles in space with their derivatives: against differences of cycles, gaits found again, and samples."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, find_gait, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.hybrid.tangent.section import aside, exact_jacobian
from tests.solve import gaits  # noqa: F401  registers the recipes
from tests.solve.kept import RECIPES, jacobian

pytestmark = pytest.mark.slow


@cache
def orbit(name: str) -> Orbit:
    gait = Gait.load(RECIPES[name].path)
    return Orbit(gait.system, gait.state, ())


@pytest.mark.parametrize("name", ["trot", "trot_steady", "turn_9"])
def test_the_jacobian_is_that_of_differences(name):
    kept = jacobian(name)
    np.testing.assert_allclose(orbit(name).jacobian, kept, rtol=0, atol=3e-6 * np.abs(kept).max())


class TestSymmetric:
    """A bound lands on two feet at once: differences depend on whether their step tells the feet apart."""

    def test_even_and_odd_do_not_mix(self):
        found, even = orbit("long_stride_in_space").jacobian, orbit("long_stride_in_space").chart.lane.even
        assert aside(orbit("long_stride_in_space").system, orbit("long_stride_in_space").chart) is not None
        assert not found[np.ix_(even, ~even)].any() and not found[np.ix_(~even, even)].any()

    def test_feet_that_land_one_after_the_other(self):
        one = orbit("long_stride_in_space")
        local, h = chart(one.system, one.state), 1e-4
        kept, odd = jacobian("long_stride_in_space"), ~local.lane.even
        far = np.abs(one.jacobian - kept) * np.outer(odd, odd)
        j = int(far.max(axis=0).argmax())
        ends = [
            local.coordinates(return_map(one.system, local.state(sign * h * np.eye(local.dimension)[j]), 1e-12).state)
            for sign in (1.0, -1.0)
        ]
        wanted = (ends[0] - ends[1])[odd] / (2.0 * h)
        np.testing.assert_allclose(one.jacobian[odd, j], wanted, rtol=0, atol=2e-5)
        assert far.max() > 1e-2  # of a step so small that the other foot is still taken for one on the ground

    def test_along_it_is_the_differences(self):
        one, even = orbit("long_stride_in_space"), orbit("long_stride_in_space").chart.lane.even
        kept = jacobian("long_stride_in_space")
        np.testing.assert_allclose(one.jacobian[np.ix_(even, even)], kept[np.ix_(even, even)], rtol=0, atol=2e-5)


@pytest.mark.parametrize("name", ["trot", "turn_9"])
def test_measures_are_those_of_samples(name):
    one = orbit(name)
    halves = 2 if one.system.mirrored_toes else 1
    run = simulate(one.system, one.state, halves, progress=False)
    sampled = Sampled(one.system.robot, run, range(1, halves + 1)).values()
    found = {each: one.measures[each].value for each in sampled}
    for each, value in sampled.items():
        assert found[each] == pytest.approx(value, rel=1e-6, abs=1e-6), each


def test_a_gait_with_another_roll_inertia():
    """The whole gait moves as its derivatives say."""
    gait, name = Gait.load("trot"), "roll_inertia_xx"
    table = gait.sensitivity([name])
    value, h = number(gait.system, name), 2e-4
    ends = []
    for side in (1.0, -1.0):
        found = find_gait(with_numbers(gait.system, {name: value * (1.0 + side * h)}), guess=gait.state)
        ends.append(Orbit(found.system, found.state, ()).measures)
    for each in ("mean_speed", "period", "effort", "absolute_work", "peak_force_posterior_left_toe"):
        wanted = (ends[0][each].value - ends[1][each].value) / (2.0 * h * value)
        assert table.derivatives[each][0] == pytest.approx(wanted, rel=1e-6), each


class TestRefused:
    def test_bounces(self):
        gait = Gait.load("gallop")
        with pytest.raises(NotDifferentiable, match="a toe bounces"):
            exact_jacobian(gait.system, gait.state)

    def test_heat_in_half_a_stride(self):
        from spear_pin.model.catalogue import motor

        gait = Gait.load("trot")
        motors = {joint: motor("assumed_600w") for joint in gait.system.robot.actuated}
        with pytest.raises(BadValue, match="half a stride"):
            gait.sensitivity(["friction"], motors=motors)
