"""Where a run begins: one state and many, and on the edges of what is tolerated."""

import numpy as np
import pytest

from spear_pin.hybrid.rules.footing import AT_REST
from spear_pin.hybrid.rules.guards import NEAR_GROUND, ON_GROUND
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.rules.start import FALLING, PLACED, STATE_AT_REST, below_ground, is_aloft, is_placed, rests, start

HEIGHTS = {-2.0 * ON_GROUND: True, -ON_GROUND: True, 0.0: True, ON_GROUND: True, 2.0 * ON_GROUND: False}
SPEEDS = {0.0: True, AT_REST: True, -AT_REST: True, 2.0 * AT_REST: False, -0.5: False}


@pytest.mark.parametrize("n", [1, 64])
def test_rests(n):
    for height, near in HEIGHTS.items():
        for speed, still in SPEEDS.items():
            assert rests(height, speed) == (near and still)
            assert (rests(np.full(n, height), np.full(n, speed)) == (near and still)).all()
            assert below_ground(height) == (height < -ON_GROUND) == below_ground(np.full(n, height)).all()
    assert rests(0.0, STATE_AT_REST, STATE_AT_REST) and not rests(0.0, STATE_AT_REST)


@pytest.mark.parametrize("n", [1, 64])
def test_placed(n):
    for height, on_it in {0.0: True, 0.5 * PLACED: True, -0.5 * PLACED: True, PLACED: False, -PLACED: False}.items():
        assert is_placed(height) == on_it and (is_placed(np.full(n, height)) == on_it).all()


@pytest.mark.parametrize("n", [1, 64])
def test_a_toe_that_bounces_is_aloft_until_it_has_struck_the_ground(n):
    speeds = {0.0: False, AT_REST: False, 2.0 * AT_REST: True, -0.5 * FALLING: False, -2.0 * FALLING: True}
    for rising, moves in speeds.items():
        for height, above in {-NEAR_GROUND: False, NEAR_GROUND: False, 2.0 * NEAR_GROUND: True}.items():
            assert is_aloft(height, rising) == (above or moves)
            assert (is_aloft(np.full(n, height), np.full(n, rising)) == (above or moves)).all()


def test_as_if_the_phase_had_just_begun(hop):
    system = hop.system
    (flight, lift_off), (stance, both) = (start(system, standing) for standing in (False, True))
    assert (flight, stance) == ("flight", "stance")
    assert lift_off == both[:1] and [reset.phase for reset in both] == ["flight", "stance"]


def test_later_latches_see_earlier_ones(hop):
    _, resets = start(hop.system, True)
    q, v = (part.tolist() for part in hop.state)
    held = latch_values({"kept": 1.0}, resets, q, v, hop.system.law)
    assert held["kept"] == 1.0 and len(held) > 1
    assert (
        latch_values(latch_values({"kept": 1.0}, resets[:1], q, v, hop.system.law), resets[1:], q, v, hop.system.law)
        == held
    )
