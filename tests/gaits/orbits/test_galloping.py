"""A gallop: the feet of each pair of a bound in space land and lift off one after the other."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.gaits.footfalls.sequence import FOOTFALLS, LEGS
from spear_pin.gaits.orbits.balance import balanced
from spear_pin.gaits.orbits.galloping import galloping
from spear_pin.gaits.orbits.steering import footfall_gap
from spear_pin.hybrid.periodic import residual, return_map
from spear_pin.hybrid.symmetry import asymmetry


@cache
def gallop():
    return Gait.load("gallop")


@cache
def stride():
    return return_map(gallop().system, gallop().state, 1e-11)


def bearing(run):
    """The legs that the law takes to be on the ground, in each phase that lasts, from the touchdown on."""
    down, found = set(), []
    for event in run.events:
        for leg in LEGS:
            if event.name in (f"{leg}_touchdown", f"{leg}_lift_off"):
                down ^= {leg}
                found.append(frozenset(down))
    return found


class TestShipped:
    def test_residual_speed_and_heading(self):
        assert residual(gallop().system, gallop().state) <= 1e-9
        assert gallop().system.measures["mean_speed"](stride()) == pytest.approx(3.0, abs=1e-8)
        assert gallop().system.measures["turn"](stride()) == pytest.approx(0.0, abs=1e-8)
        assert abs(stride().change[0] - stride().work[0].sum()) <= 1e-9

    def test_each_foot_lands_and_lifts_off_for_itself(self):
        assert bearing(stride()) == [frozenset(phase) for phase in FOOTFALLS["gallop"].phases]
        for pair in ("posterior", "anterior"):
            assert footfall_gap(stride(), pair) == pytest.approx(0.02, abs=1e-5)
            assert footfall_gap(stride(), pair, "lift_off") > 1e-3
        assert asymmetry(gallop().system.robot, gallop().state) > 0.25


class TestRefused:
    def test_others(self):
        with pytest.raises(BadValue, match="gait"):
            galloping(Gait.load("trot"), (0.02, 0.02), (0.0, 0.0))
        with pytest.raises(BadValue, match="heading"):
            balanced(gallop(), heading=1.0)

    def test_times(self):
        bound = Gait.load("turn_4")
        with pytest.raises(BadValue, match="landing"):
            galloping(bound, (0.02,), (0.0, 0.0))
        with pytest.raises(BadValue, match="lifting"):
            galloping(bound, (0.02, 0.02), (0.0, np.nan))
