"""Directions in which toes in space slide, and what a step that is only tried may do to them: nothing."""

import math

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.hybrid.contact import SETTING_OUT, SLOW
from spear_pin.hybrid.engines.sliding import AIM, GLANCE, Grounded, Sliding

TOE = "toe"


def grounded(push):
    """A point mass of 1 kg pressed to the ground, and pushed along it."""
    weight = np.array([*push, -10.0])
    return Grounded(np.eye(3), weight, {TOE: np.eye(3)}, {TOE: np.zeros(3)}, np.zeros((0, 3)), np.zeros(0), 0.5)


def at(*velocity):
    return lambda toe: (*velocity, 0.0)


@pytest.fixture
def sliding():
    return Sliding({TOE: "slip"})


def test_one_that_moves_slides_along_its_velocity_however_slow_a_rejected_step_was(sliding):
    pushed = grounded((0.0, 20.0))
    assert sliding(pushed, at(0.3, 0.4))[TOE] == pytest.approx((0.6, 0.8))
    sliding(pushed, at(1e-12, 0.0))  # where it would set out sideways
    assert sliding(pushed, at(3.0 * SLOW, 4.0 * SLOW))[TOE] == pytest.approx((0.6, 0.8))


def test_one_at_rest_sets_out_along_the_push(sliding):
    assert sliding(grounded((3.0, 4.0)), at(0.0, 0.0))[TOE] == pytest.approx((0.6, 0.8))
    assert sliding(grounded((3.0, 4.0)), at(1e-6, 0.0))[TOE] == pytest.approx((0.6, 0.8))


def test_it_does_so_until_it_arrives_at_a_speed(sliding):
    pushed = grounded((30.0, 40.0))
    ways = sliding(pushed, at(0.0, 0.0))
    assert sliding(pushed, at(1.0, 0.0))[TOE] == pytest.approx((0.6, 0.8))  # only tried
    assert sliding(pushed, at(1e-6, 0.0))[TOE] == pytest.approx((0.6, 0.8))
    sliding.arrive({TOE: 0.5 * SETTING_OUT}, {TOE: 45.0}, ways)
    assert sliding.sets_out
    sliding.arrive({TOE: 2.0 * SETTING_OUT}, {TOE: 45.0}, ways)
    assert not sliding.sets_out
    assert sliding(pushed, at(1e-6, 0.0))[TOE] == (1.0, 0.0)


@pytest.mark.parametrize(
    ("speed", "gain", "jerk", "left"),
    [
        (0.0, 50.0, 0.0, AIM / 50.0),
        (0.75 * SETTING_OUT, 50.0, 0.0, (AIM - 0.75 * SETTING_OUT) / 50.0),
        (SETTING_OUT, 50.0, 0.0, (AIM - SETTING_OUT) / 50.0),
        (0.0, 0.0, 1e6, math.sqrt(2.0 * AIM / 1e6)),
        (0.0, 50.0, -1e6, AIM / 50.0),  # it may slow down less soon
        (0.0, 1e-3, 0.0, 1e-4),  # it may gain more soon
        (SLOW, -1.0, 0.0, 1e-4),
        (2.0 * SETTING_OUT, 50.0, 0.0, math.inf),
    ],
)
def test_the_longest_step_ends_near_the_speed_at_which_it_has_set_out(sliding, speed, gain, jerk, left):
    ways = sliding(grounded((30.0, 40.0)), at(0.0, 0.0))
    sliding.arrive({TOE: speed}, {TOE: gain}, ways)
    sliding.look_ahead({TOE: speed}, {TOE: gain}, {TOE: gain + jerk * GLANCE})
    assert sliding.left == pytest.approx(left)


def test_one_reaches_that_speed_under_gain_and_jerk_together(sliding):
    ways = sliding(grounded((30.0, 40.0)), at(0.0, 0.0))
    sliding.arrive({TOE: 0.0}, {TOE: 1.0}, ways)
    sliding.look_ahead({TOE: 0.0}, {TOE: 1.0}, {TOE: 1.0 + 5e4 * GLANCE})
    assert 1.0 * sliding.left + 0.5 * 5e4 * sliding.left**2 == pytest.approx(AIM)


def test_one_that_slows_down_sets_out_no_more(sliding):
    ways = sliding(grounded((30.0, 40.0)), at(0.0, 0.0))
    sliding.arrive({TOE: 0.5 * SETTING_OUT}, {TOE: -1.0}, ways)
    assert not sliding.sets_out


@pytest.mark.parametrize("speed", [0.5 * SLOW, -3.0 * SLOW])
def test_one_that_slows_down_before_it_has_a_speed_moves_back_along_its_way(sliding, speed):
    """Its velocity back has the other direction, so that friction would push it on."""
    ways = sliding(grounded((30.0, 40.0)), at(0.0, 0.0))
    sliding.arrive({TOE: speed}, {TOE: -1.0}, ways)
    assert sliding.sets_out
    assert sliding(grounded((3.0, 4.0)), at(0.6 * speed, 0.8 * speed))[TOE] == pytest.approx((0.6, 0.8))


def test_one_that_is_fast_whichever_way_sets_out_no_more(sliding):
    """As a sample may be, which is no step of the integrator."""
    ways = sliding(grounded((30.0, 40.0)), at(0.0, 0.0))
    sliding.arrive({TOE: -2.0 * SETTING_OUT}, {TOE: -1.0}, ways)
    assert not sliding.sets_out


def test_directions_are_unit_vectors(sliding):
    assert math.hypot(*sliding(grounded((5.0, -12.0)), at(0.0, 0.0))[TOE]) == pytest.approx(1.0)


@pytest.mark.slow
def test_samples_of_a_sliding_toe_have_friction_against_its_velocity():
    """Also the first one after it has set out, from which it has a velocity."""
    gait = Gait.load("turn_9")
    motion, robot, seen = simulate(gait.system, gait.state, 1, progress=False), gait.system.robot, 0
    modes = {domain.key: domain.contacts for domain in gait.system.domains}
    for k in range(len(motion.t)):
        for i, toe in enumerate(robot.toes):
            velocity = (robot.toe_jacobian(motion.q[k], toe) @ motion.v[k])[:2]
            if modes[motion.phase[k], motion.domain[k]][i] != "slip" or np.hypot(*velocity) < 1.2 * SETTING_OUT:
                continue
            along, force = velocity / np.hypot(*velocity), motion.force[k, i, :2]
            assert force / np.hypot(*force) == pytest.approx(-along, abs=1e-9), (motion.t[k], toe)
            seen += 1
    assert seen > 3
