"""Integrals and peaks of samples, against what is known of functions that have jumps at events."""

import numpy as np
import pytest

from spear_pin.gaits.measures.curves import Curves

ALL = slice(None)


def sampled(function, count=60, jump=1.0, end=2.0):
    """Times with an event in two samples, and a function of the time and of whether it is before the event."""
    before, after = np.linspace(0.0, jump, count), np.linspace(jump, end, count)
    t = np.concatenate([before, after])
    return Curves(t, np.ones(len(t), dtype=bool)), np.concatenate([function(before, True), function(after, False)])


def wave(t, before):
    """A sine, upside down and half as large after the event."""
    return np.sin(7.0 * t) * (1.0 if before else -0.5)


def test_integrals():
    curves, values = sampled(wave)
    fine = [np.linspace(low, low + 1.0, 200_001) for low in (0.0, 1.0)]
    parts = [wave(fine[0], True), wave(fine[1], False)]
    whole, positive = (
        sum(np.trapezoid(of(part), t) for part, t in zip(parts, fine, strict=True))
        for of in (lambda x: x, lambda x: np.maximum(x, 0.0))
    )
    assert curves.integral(values) == pytest.approx(whole, abs=1e-9)
    assert curves.positive(values) == pytest.approx(positive, abs=1e-9)
    assert curves.positive(-values) == pytest.approx(positive - whole, abs=1e-9)
    assert curves.duration == pytest.approx(2.0)


def test_peaks_between_samples_and_at_events():
    curves, values = sampled(wave, count=31)
    assert curves.peak(values) == pytest.approx(1.0, abs=1e-7) and values.max() < 1.0 - 1e-5
    rising, ramp = sampled(lambda t, before: t if before else 0.5 * t)
    assert rising.peak(ramp) == 1.0 and rising.range(ramp)[0] == 0.0 and rising.amount(-ramp) == 1.0


def test_where_a_signal_is_positive():
    curves, values = sampled(lambda t, before: t * 1.0)
    gate = np.cos(3.0 * curves.t)
    ends = (0.0, np.pi / 6.0), (np.pi / 2.0, 2.0)
    expected = sum(0.5 * (high**2 - low**2) for low, high in ends)
    assert curves.integral(values, where=gate) == pytest.approx(expected, abs=1e-8)


def test_a_ratio_counts_only_where_enough_is_borne():
    curves, below = sampled(lambda t, before: 10.0 * np.sin(0.5 * np.pi * t) if before else 0.0 * t)
    above = np.where(curves.t <= 1.0, 1.0 + curves.t, 0.0)
    t = np.linspace(0.0, 1.0, 2_000_001)
    load = 10.0 * np.sin(0.5 * np.pi * t)
    for least in (0.5, 3.0):
        expected = ((1.0 + t) / np.maximum(load, 1e-9))[load >= least].max()
        assert curves.ratio(above, below, least) == pytest.approx(expected, rel=1e-5)
    assert curves.ratio(above, below, 11.0) == 0.0


def test_a_power_that_jumps_where_torque_or_speed_change_their_signs():
    """By gears that lose a share to whichever side power goes."""

    def power(u, w):
        return u * w * np.where(u * w >= 0.0, 1.0 / 0.8, 0.8) + 0.3 * u**2

    curves, u = sampled(lambda t, before: np.cos(5.0 * t), count=100)
    w = np.sin(4.0 * curves.t + 0.3)
    t = np.linspace(0.0, 2.0, 4_000_001)
    exact = power(np.cos(5.0 * t), np.sin(4.0 * t + 0.3))
    expected = np.trapezoid(np.maximum(exact, 0.0), t), np.trapezoid(np.maximum(-exact, 0.0), t)
    assert curves.halves(power, u, w) == pytest.approx(expected, abs=1e-7)


def test_samples_that_are_left_out_part_what_is_on_either_side():
    t = np.linspace(0.0, 2.0, 101)
    curves = Curves(t, np.ones(101, dtype=bool)).among((t < 0.5) | (t > 1.5))
    assert len(curves.runs) == 2 and curves.integral(np.ones(101)) == pytest.approx(0.96)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_few_samples(count):
    curves, values = Curves(np.linspace(0.0, 1.0, count), np.ones(count, dtype=bool)), np.arange(float(count))
    assert curves.peak(values) == count - 1.0
    assert curves.integral(values) == pytest.approx(0.5 * (count - 1.0) if count > 1 else 0.0)


@pytest.mark.parametrize(
    ("signal", "peak"),
    [
        (lambda t: np.minimum(15.0 * np.sin(np.pi * t), 12.0), 12.0),
        (lambda t: np.where(t < 0.507, 0.0, 10.0), 10.0),
        (lambda t: np.where(t < 0.507, 3.0 * t, 12.0 - t), 12.0 - 51 / 99),
        (lambda t: 8.0 - 30.0 * np.abs(t - 0.5051), None),
    ],
    ids=["a limit", "a jump", "a jump between slopes", "a kink"],
)
def test_a_peak_does_not_swing_about_what_samples_do_not_resolve(signal, peak):
    t = np.linspace(0.0, 1.0, 100)
    for sign in (1.0, -1.0):
        found = Curves.of(t).amount(sign * signal(t))
        assert found == pytest.approx(np.abs(signal(t)).max() if peak is None else peak, rel=2e-3)


def test_a_peak_between_samples_is_found():
    t = np.linspace(0.0, 1.0, 100)
    assert Curves.of(t).peak(np.sin(7.0 * t)) == pytest.approx(1.0, abs=1e-9)
