"""Integrals and peaks of many cycles against closed forms."""

import numpy as np
import pytest

from spear_pin.gaits.sensitivity.panels import Panels
from spear_pin.hybrid.tangent.collocation import rule

RATES = np.array([3.0, 5.0])  # rad/s of sin(ω t) in two cycles of 2 s, four panels each, in any order
LANES = np.array([1, 0, 0, 1, 1, 0, 1, 0])
BEGIN = np.array([0.5, 1.5, 0.0, 0.0, 1.5, 0.5, 1.0, 1.0])
T = BEGIN[:, None] + 0.5 * rule().nodes
PANELS = Panels(LANES, np.full(8, 0.5), 2)
SINE = np.sin(RATES[LANES][:, None] * T)


def test_integrals():
    assert PANELS.integral(SINE) == pytest.approx((1.0 - np.cos(2.0 * RATES)) / RATES, rel=1e-13)


def test_positive_parts():
    # half waves of 2/ω, and what is left of the last
    full, left = np.divmod(2.0 * RATES, 2.0 * np.pi)
    expected = (2.0 * full + 1.0 - np.cos(np.minimum(left, np.pi))) / RATES
    assert PANELS.positive(SINE) == pytest.approx(expected, rel=1e-12)
    assert PANELS.positive(SINE) - PANELS.positive(-SINE) == pytest.approx(PANELS.integral(SINE), abs=1e-13)


def test_peaks():
    assert PANELS.peak(SINE) == pytest.approx([1.0, 1.0], rel=1e-9)
    rising = Panels(np.zeros(1, dtype=int), np.ones(1), 2)
    assert rising.peak(rule().nodes[None] * 3.0)[0] == pytest.approx(3.0, rel=1e-12)  # at the end
    assert rising.peak(rule().nodes[None])[1] == -np.inf  # no panel


def test_ratios():
    one = Panels(np.zeros(1, dtype=int), np.ones(1), 1)
    x = rule().nodes[None]
    # x (1 - x) / 1 has its peak at ½
    assert one.ratio(-x * (1.0 - x), np.ones_like(x), 0.1)[0] == pytest.approx(0.25, rel=1e-9)
    # 1 / (1 - x) grows until 1 - x falls to 0.3
    assert one.ratio(np.ones_like(x), 1.0 - x, 0.3)[0] == pytest.approx(1.0 / 0.3, rel=1e-9)
    assert one.ratio(x, -np.ones_like(x), 0.3)[0] == -np.inf


def test_where_it_falls():
    # cos(ω t) falls through zero at π / 2ω first
    found = PANELS.where_it_falls(np.cos(RATES[LANES][:, None] * T), T)
    assert np.isin(np.round(found * RATES, 9), np.round([np.pi / 2.0, 5.0 * np.pi / 2.0], 9)).all()
    assert np.isnan(PANELS.where_it_falls(np.ones_like(T), T)).all()
