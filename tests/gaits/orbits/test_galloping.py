"""A gallop: the feet of each pair of a bound in space land and lift off one after the other."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.footfalls.sequence import FOOTFALLS, LEGS
from spear_pin.gaits.orbits.galloping import find_gallop
from spear_pin.gaits.orbits.strides import first_times, footfall_gap
from spear_pin.gaits.spatial.automaton import forward_speed
from spear_pin.hybrid.periodic import chart, residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import asymmetry
from tests.solve.gaits import gallop_begun, gallop_steady


@cache
def gallop():
    return Gait.load("gallop")


@cache
def stride():
    return return_map(gallop().system, gallop().state, 1e-11)


def bearing(motion):
    """The legs that the law takes to be on the ground, in each phase that lasts, from the touchdown on."""
    down, found = set(), []
    for event in motion.events:
        for leg in LEGS:
            if event.name in (f"{leg}_touchdown", f"{leg}_lift_off"):
                down ^= {leg}
                found.append(frozenset(down))
    return found


class TestShipped:
    @pytest.mark.slow
    def test_residual_speed_and_heading(self):
        assert residual(gallop().system, gallop().state) <= 1e-9
        assert forward_speed(stride()) == pytest.approx(3.0, abs=1e-8)
        assert gallop().system.measures["turn"](stride()) == pytest.approx(0.0, abs=1e-8)
        assert abs(stride().change[0] - stride().work[0].sum()) <= 1e-9

    @pytest.mark.slow
    def test_each_foot_lands_for_itself(self):
        """In the order of the collocated gallop, but that the fore foot that lands last lifts off first."""
        own, wanted = bearing(stride()), [frozenset(phase) for phase in FOOTFALLS["gallop"].phases]
        assert own[:6] == wanted[:6] and own[6] == {"anterior_left"} and own[7] == wanted[7]
        for pair in ("posterior", "anterior"):
            assert footfall_gap(first_times(stride()), pair) == pytest.approx(0.02, abs=1e-4)
        lifting = [footfall_gap(first_times(stride()), pair, "lift_off") for pair in ("posterior", "anterior")]
        assert lifting[0] > 2e-3 and lifting[1] < -2e-3
        assert asymmetry(gallop().system.robot, gallop().state) > 0.25


class TestRefused:
    def test_others(self):
        with pytest.raises(BadValue, match="gait"):
            find_gallop(Gait.load("trot"), (0.02, 0.02))
        with pytest.raises(BadValue, match="heading"):
            add_feedback(gallop(), heading=1.0)

    def test_times(self):
        bound = Gait.load("turn_4")
        with pytest.raises(BadValue, match="landing"):
            find_gallop(bound, (0.02,))
        with pytest.raises(BadValue, match="landing"):
            find_gallop(bound, (0.02, np.nan))


@pytest.mark.slow
def test_the_way_to_it_begins():
    """By half a millisecond from the bound."""
    found = gallop_begun()
    cycle = return_map(found.system, found.state)
    assert found.residual <= 1e-9 and forward_speed(cycle) == pytest.approx(3.0, abs=1e-4)
    times = first_times(cycle)
    assert [footfall_gap(times, pair) for pair in ("posterior", "anterior")] == pytest.approx(2 * [5e-4], abs=1e-5)


@pytest.mark.slow
def test_balanced_at_once():
    steady = gallop_steady()
    assert abs(steady.multipliers[0]) <= 0.9
    q, v = (part.copy() for part in steady.state)
    v[1] += 0.1
    local = chart(steady.system, steady.state)
    pushed = run(steady.system, (q, v), 15, Options(rtol=1e-8))
    assert pushed.cycles == 15
    assert abs(local.coordinates(pushed.state)).max() <= 0.1 * abs(local.coordinates((q, v))).max()
