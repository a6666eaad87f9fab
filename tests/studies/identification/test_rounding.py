"""Errors of rounding by their covariance against rounding itself, many times over."""

import numpy as np
import pytest

from spear_pin.studies.identification.rounding import Rounding, errors, estimate_rounding

STEP = 0.003
ANGLE = np.array([1.3, 1.3004, 1.2991, 1.31, 1.0, 1.0001, 1.0017, 1.2, 1.0047])
COUNTS = np.arange(400, 430)


def covariance(angle, rounded, moving=None):
    """Σ L Lᵀ of one record, all of it motion unless told."""
    moving = np.ones(angle.size, dtype=bool) if moving is None else moving
    return sum(factor @ factor.T for factor in errors([angle], [moving], [rounded]))


class TestRounding:
    @pytest.mark.parametrize(
        "angle",
        [
            STEP * COUNTS,
            np.concatenate([STEP * COUNTS, STEP * COUNTS + 2 * np.pi - 2 * np.pi]),  # alike but for the last digit
            np.round(STEP * 1.01 * COUNTS, 4),  # as written
            np.round((1.06 * STEP * COUNTS + 0.4) / 0.001) * 0.001 / 1.06,
        ],
        ids=["exact", "unwrapped", "written", "volts"],
    )
    def test_step(self, angle):
        seen = np.repeat(angle[::-1], 3)
        assert estimate_rounding(seen, seen).step == pytest.approx(STEP, rel=0.06)

    def test_no_step(self):
        rest, noise = np.full(100, 1.2), 1e-3 * np.random.default_rng(0).normal(size=2000)
        assert estimate_rounding(rest, rest) == Rounding() == estimate_rounding(None, rest)
        found = estimate_rounding(noise, 0 * noise)
        assert found.step < 1e-5 and found.noise == pytest.approx(1e-3, rel=0.05) and not found.coarse

    @pytest.mark.parametrize("share", [0.0, 0.5, 3.0])  # of a step
    def test_noise(self, share):
        t = np.linspace(0, 1, 4000)
        true = 1.2 + 0.2 * np.cos(20 * t)
        noise = share * STEP * np.random.default_rng(1).normal(size=t.size)
        found = estimate_rounding(
            STEP * np.round((true + noise) / STEP), true + 0.01 * np.cos(9 * t)
        )  # a model that is off
        assert found.noise == pytest.approx(share * STEP, rel=0.05)
        assert found.variance == pytest.approx((share**2 + 1 / 12) * STEP**2, rel=0.1)
        assert found.coarse == (share == 0.0)

    @pytest.mark.parametrize("glitch", [0.5 * STEP, 0.3, -1e3])
    def test_one_sample_off_the_counts(self, glitch):
        true = 1.2 + 0.2 * np.cos(20 * np.linspace(0, 1, 400))
        seen = STEP * np.round(true / STEP)
        seen[100] += glitch
        found = estimate_rounding(seen, true)
        assert found.step == pytest.approx(STEP, rel=1e-3) and found.noise < 0.05 * STEP and found.coarse


class TestErrors:
    @pytest.mark.parametrize("share", [0.0, 0.1, 0.25])
    def test_many_times_over(self, share):
        rng, count = np.random.default_rng(2), 40_000
        place = STEP * rng.uniform(size=count)  # of the steps
        read = ANGLE[:, None] + share * STEP * rng.normal(size=(ANGLE.size, count))
        wrong = STEP * np.round((read - place) / STEP) + place - ANGLE[:, None]
        expected, found = np.cov(wrong), covariance(ANGLE, Rounding(STEP, share * STEP))
        apart = ~np.eye(ANGLE.size, dtype=bool)
        np.testing.assert_allclose(found[apart] / STEP**2, expected[apart] / STEP**2, rtol=0, atol=2.5e-3)
        assert np.diag(expected) == pytest.approx(Rounding(STEP, share * STEP).variance, rel=0.03)

    def test_polynomial(self):
        part = np.mod((ANGLE[:, None] - ANGLE) / STEP, 1.0)
        expected = 0.5 * STEP**2 * (part**2 - part + 1 / 6)
        assert np.abs(covariance(ANGLE, Rounding(STEP)) - expected).max() < 0.03 * STEP**2 / 12

    def test_holds_are_apart_from_motions(self):
        moving = ANGLE < 1.25
        found, whole = covariance(ANGLE, Rounding(STEP), moving), covariance(ANGLE, Rounding(STEP))
        alike = moving[:, None] == moving
        np.testing.assert_allclose(found, np.where(alike, whole, 0.0), rtol=0, atol=1e-18)

    def test_records_of_one_encoder_share_its_counts(self):
        moving, rounded = np.ones(ANGLE.size, dtype=bool), Rounding(STEP)
        factors = list(errors([ANGLE, ANGLE], [moving, moving], [rounded, rounded]))
        whole = sum(factor @ factor.T for factor in factors)
        np.testing.assert_allclose(whole, np.tile(covariance(ANGLE, rounded), (2, 2)), rtol=0, atol=1e-18)

    def test_one_record_that_was_not_rounded(self):
        moving = np.ones(ANGLE.size, dtype=bool)
        whole = sum(f @ f.T for f in errors([ANGLE, ANGLE], [moving, moving], [Rounding(), Rounding(STEP)]))
        n = ANGLE.size
        assert not whole[:n].any()
        np.testing.assert_array_equal(whole[n:, n:], covariance(ANGLE, Rounding(STEP)))

    def test_none_under_noise(self):
        moving = np.ones(ANGLE.size, dtype=bool)
        assert list(errors([ANGLE], [moving], [Rounding()])) == []
        assert np.abs(covariance(ANGLE, Rounding(STEP, STEP))).max() < 1e-15 * STEP**2
