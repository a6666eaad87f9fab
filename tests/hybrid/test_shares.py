"""Shares of time of laws that alternate on two toes."""

import numpy as np
import pytest

from spear_pin.hybrid.shares import TURNS, of_one, of_two, weights

PLACES = [(0.3, 0.8), (0.05, 0.5), (0.99, 0.02), (0.5, 0.5)]


def corners(first, second):
    """How long both, one or no switch is closed if they are independent."""
    return {
        (True, True): first * second,
        (True, False): first * (1.0 - second),
        (False, True): (1.0 - first) * second,
        (False, False): (1.0 - first) * (1.0 - second),
    }


def closed(turn):
    """Whether the first and the second toe's switch are closed."""
    return (turn.bears, turn.other) if turn.toe == 0 else (turn.other, turn.bears)


@pytest.mark.parametrize("place", PLACES)
def test_switches_are_independent(place):
    found = dict.fromkeys(corners(*place), 0.0)
    for turn, weight in zip(TURNS, weights(*place), strict=True):
        assert weight >= 0.0
        found[closed(turn)] += weight
    assert found == pytest.approx(corners(*place), abs=1e-15)


@pytest.mark.parametrize("i", [0, 1])
def test_where_one_toe_alone_alternates_it_alone_has_changed(i):
    """So motion of two toes ends in motion of one."""
    place = (0.4, 1e-12)[:: 1 - 2 * i]
    for turn, weight in zip(TURNS, weights(*place), strict=True):
        assert weight < 1e-11 or turn.toe == i


@pytest.mark.parametrize("place", PLACES)
def test_no_toe_accelerates(place):
    """Accelerations that add up to nothing at known shares lead back to shares at which they do."""
    chance = np.random.default_rng(1)
    accelerations = 100.0 * np.array([[1.0 if bears else -1.0 for bears in closed(turn)] for turn in TURNS])
    accelerations += 10.0 * chance.standard_normal(accelerations.shape)
    accelerations -= weights(*place) @ accelerations
    found = of_two(accelerations)
    assert all(0.0 < share < 1.0 for share in found)
    np.testing.assert_allclose(weights(*found) @ accelerations, 0.0, atol=1e-6)
    np.testing.assert_allclose(of_two(accelerations, found), found, rtol=0, atol=1e-10)


def test_two_switches_apart_are_two_of_one():
    """Where neither toe feels the other's law."""
    rises, falls = (30.0, 20.0), (-90.0, -5.0)
    accelerations = [[(f, r)[on] for f, r, on in zip(falls, rises, closed(turn), strict=True)] for turn in TURNS]
    expected = [of_one(rise, fall) for rise, fall in zip(rises, falls, strict=True)]
    np.testing.assert_allclose(of_two(np.array(accelerations)), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("accelerations", [np.full((8, 2), 3.0), np.full((8, 2), np.nan)])
def test_there_may_be_none(accelerations):
    assert np.isnan(of_two(accelerations)).all()
