"""Integrals and peaks of polynomials, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.gaits.sensitivity.signals import Pieces, integral, largest_ratio, peak, positive
from spear_pin.hybrid.tangent.collocation import POINTS, rule

SHARES = np.array([0.2, 0.5, 0.3])  # of panels
STEP = 1e-5  # of differences


def pieces(function, slope, begin=0.0, end=2.0, since=0.0, tau=0.0):
    """A signal f(t) over an arc, with its derivative along one direction at fixed times, and what its ends move."""
    lengths = (end - begin) * SHARES
    t = (begin + (np.cumsum(lengths) - lengths)[:, None] + np.outer(lengths, rule(POINTS).nodes)).ravel()
    arc, moved = SimpleNamespace(t=begin, end=end), {"since": np.array([since]), "tau": np.array([tau])}
    weights = np.append(np.outer(lengths, rule(POINTS).weights), [0.0, 0.0])
    carried = SimpleNamespace(lengths=lengths)
    stretch = SimpleNamespace(arc=arc, at_once=False, weights=weights, carried=carried, **moved)
    t, ends = np.append(t, [begin, end]), np.array([begin, end])
    rates = (function(ends + STEP) - function(ends - STEP)) / (2.0 * STEP)
    return Pieces(stretch, function(t), slope(t)[:, None], rates)


def test_an_integral_with_ends_that_move():
    value, change = integral([pieces(np.cos, lambda t: t, since=0.5, tau=2.0)])
    assert value == pytest.approx(np.sin(2.0), rel=1e-13)
    assert change == pytest.approx([2.0 + 2.0 * np.cos(2.0) - 0.5], rel=1e-12)


def test_the_positive_part():
    value, change = positive([pieces(np.cos, np.sin)])  # of cos(t - p), up to where it is zero
    assert value == pytest.approx(1.0, rel=1e-12) and change == pytest.approx([1.0], rel=1e-12)


def test_the_positive_part_with_ends_that_move():
    value, change = positive([pieces(np.sin, lambda t: 0.0 * t, begin=1.0, since=0.5, tau=2.0)])
    assert value == pytest.approx(np.cos(1.0) - np.cos(2.0), rel=1e-12)
    assert change == pytest.approx([2.0 * np.sin(2.0) - 0.5 * np.sin(1.0)], rel=1e-12)


def test_a_peak_inside_and_at_an_end():
    value, change = peak([pieces(np.sin, np.cos)])
    assert value == pytest.approx(1.0, rel=1e-13) and change == pytest.approx([0.0], abs=1e-7)
    value, change = peak([pieces(np.exp, lambda t: 0.0 * t, tau=0.25)])
    assert value == pytest.approx(np.exp(2.0), rel=1e-12) and change == pytest.approx([0.25 * np.exp(2.0)], rel=1e-10)


def test_the_largest_ratio_where_the_second_is_large_enough():
    above = pieces(lambda t: 1.0 + 0.0 * t, lambda t: 0.0 * t)
    below = pieces(lambda t: 3.0 - t, lambda t: np.ones_like(t))  # of 3 + p - t, at least 2 where t <= 1 + p
    value, change = largest_ratio([(above, below)], 2.0)
    assert value == pytest.approx(0.5, rel=1e-12) and change == pytest.approx([0.0], abs=1e-12)
    value, change = largest_ratio([(above, below)], 2.0, np.array([0.5]))  # of 3 + p - t, at least 2 + p / 2
    assert value == pytest.approx(0.5, rel=1e-12) and change == pytest.approx([-0.125], rel=1e-12)


def test_ends_are_exact_where_panels_are_too_coarse():
    """Forces are less smooth than the motion that panels are made for."""
    rough = pieces(lambda t: -1.0 / (1.0 + 20.0 * (2.0 - t)), lambda t: np.exp(-20.0 * (2.0 - t)), tau=0.5)
    value, change = peak([rough.times(-1.0)])
    assert value == pytest.approx(1.0, rel=1e-14) and change == pytest.approx([-1.0 + 0.5 * 20.0], rel=1e-6)
    flat = pieces(np.ones_like, lambda t: 0.0 * t, tau=0.5)
    value, change = largest_ratio([(rough, flat)], 0.5)
    assert value == pytest.approx(1.0, rel=1e-14) and change == pytest.approx([-1.0 + 0.5 * 20.0], rel=1e-6)
