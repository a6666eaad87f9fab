"""Integrals and peaks of polynomials, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.gaits.sensitivity.signals import (
    SIZE,
    Pieces,
    bernstein,
    extremes,
    integral,
    largest_ratio,
    peak,
    positive,
    roots,
    where_it_falls,
)
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


def test_a_wave_has_all_its_turns_and_half_waves():
    wave = pieces(lambda t: np.sin(6.0 * t), lambda t: t * np.cos(6.0 * t))
    values = [value for place, value, _ in extremes(wave) if 0.0 < place < 1.0]
    assert values == pytest.approx([1.0, -1.0] * 2, rel=1e-9)
    assert positive([wave])[0] == pytest.approx(4.0 / 6.0, rel=1e-12)


def test_a_signal_that_is_zero_has_no_positive_part():
    value, change = positive([pieces(lambda t: 0.0 * t, np.ones_like)])
    assert value == 0.0 and change == pytest.approx([0.0])


def test_where_a_guard_falls():
    shifted = pieces(lambda t: np.cos(3.0 * t), lambda t: 3.0 * np.sin(3.0 * t))  # of cos(3 (t - p))
    value, change = where_it_falls(shifted, pieces(lambda t: t**2, lambda t: 0.0 * t))
    there = np.pi / 6.0
    assert value == pytest.approx(there**2, rel=1e-10) and change == pytest.approx([2.0 * there], rel=1e-9)
    assert where_it_falls(pieces(np.exp, lambda t: 0.0 * t), shifted) is None


def test_the_largest_ratio_inside():
    above, below = (pieces(f, lambda t: 0.0 * t) for f in (lambda t: -t * (2.0 - t), np.ones_like))
    assert largest_ratio([(above, below)], 0.1)[0] == pytest.approx(1.0, rel=1e-9)


def test_panels_without_roots_are_those_without_changes_of_sign():
    chance = np.random.default_rng(0)
    x, counts = np.linspace(-1.0, 1.0, 20_001), set()
    for n in range(300):
        series = chance.normal(size=SIZE) * 0.6 ** np.arange(SIZE)
        series[0] += 0.02 * (n % 100)
        values = np.polynomial.legendre.legval(x, series)
        changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
        assert roots(series) == pytest.approx(0.5 * (x[changes] + x[changes + 1]), abs=1e-4)
        counts.add(len(changes))
    assert {0, 1, 2} <= counts


def test_a_polynomial_lies_within_its_hull():
    series = np.random.default_rng(1).normal(size=(50, SIZE))
    values = np.polynomial.legendre.legval(np.linspace(-1.0, 1.0, 500), series.T)
    hulls = series @ bernstein().T
    np.testing.assert_allclose(hulls[:, [0, -1]], values[:, [0, -1]], rtol=1e-10, atol=1e-10)
    assert (hulls.min(axis=1) <= values.min(axis=1)).all() and (hulls.max(axis=1) >= values.max(axis=1)).all()
