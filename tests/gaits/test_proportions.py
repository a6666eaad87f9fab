"""Proportions of a leg with closed loops, beside those of crank and rod in closed form."""

import math

import numpy as np
import pytest

from spear_pin import HoppingLaw, load
from spear_pin.errors import BadValue
from spear_pin.gaits.proportions import proportions
from spear_pin.gaits.reaching import pose_leg
from spear_pin.model.scale import load_shipped

CRANK, ROD, BELOW = 0.07, 0.15, 0.04  # m: of the crank hopper, and its toe below the foot


def depth(angle):
    return BELOW - CRANK * math.sin(angle) + math.sqrt(ROD**2 - (CRANK * math.cos(angle)) ** 2)


def slope(length, angle, h=1e-5):
    return (length(angle - h) - length(angle + h)) / (2.0 * h)


@pytest.fixture(scope="module")
def robot():
    return load("crank_hopper")


@pytest.fixture(scope="module")
def found(robot):
    return proportions(robot, 1.0)


def test_it_lands_folded_by_spear_ii_s_share(robot, found):
    like = load_shipped("spear_ii").legs[0]
    whole = like.thigh + like.shank
    longest = found.scale.length * whole
    assert longest == pytest.approx(depth(-1.4), rel=4e-3)  # at the crank's limit
    assert depth(found.knee) / longest == pytest.approx(like.length(1.0) / whole, rel=1e-9)
    levers = slope(depth, found.knee) / slope(like.length, 1.0)
    assert found.torque == pytest.approx(robot.mass / load_shipped("spear_ii").mass * levers, rel=1e-6)
    assert found.scale.time == pytest.approx(math.sqrt(found.scale.length))


def test_its_inertia_is_that_of_its_energy(robot, found):
    knee, h = found.knee, 1e-5
    before, after = (pose_leg(robot, 0.0, knee + step) for step in (-h, h))
    v = (after - before) / (2.0 * h)  # for 1 rad/s of the crank
    hip, crank = found.inertia
    assert crank == pytest.approx(v @ robot.mass_matrix(pose_leg(robot, 0.0, knee)) @ v, rel=1e-6) and hip == 0.0


def test_gains_oscillate_as_often_as_spear_ii_s(robot, found):
    law, like = HoppingLaw.scaled(robot), proportions(load_shipped("spear_ii"), 1.0)
    rates = [math.sqrt(each.knee_gain / of.inertia[1]) for each, of in ((law, found), (HoppingLaw(), like))]
    assert rates[0] * found.scale.time == pytest.approx(rates[1])
    assert (law.hip_gain, law.hip_touchdown) == (0.0, 0.0)


def test_a_knee_that_does_not_fold_the_leg_is_told(robot):
    with pytest.raises(BadValue, match="a knee that folds the leg to 0.1 of its length"):
        proportions(robot, 2.94)


def test_of_spear_ii_itself():
    hip, knee, scale, torque, inertia = proportions(load_shipped("spear_ii"), 1.0)
    assert (knee, torque) == (1.0, pytest.approx(1.0)) and scale == pytest.approx((1.0, 1.0, 1.0))
    assert hip == pytest.approx(load_shipped("spear_ii").legs[0].lean(1.0)) and np.all(inertia > 0.0)
