"""Tables 4.1 and 4.2 as printed: their arithmetic, and what they say about the reading of RA."""

import numpy as np
import pytest

from spear_pin.studies.audit.printed_estimates import (
    COLUMNS,
    TABLE_4_1,
    TABLE_4_2,
    average,
    deviation_ratios,
    weighted_stiffness,
)

WITH, WITHOUT = TABLE_4_2


def numbers(row):
    return [getattr(row, name) for name in COLUMNS]


def test_averages_with_motor_are_not_the_printed_ones():
    assert [round(value, 2) for value in numbers(average(True))] == [51.35, 1.31, 1.01, 6.41, 0.50, 0.03, 86.20]
    assert numbers(WITH) == [48.84, 1.30, 1.00, 6.19, 0.50, 0.03, 84.62]


def test_an_older_row_explains_the_printed_stiffness():
    rows = [row.stiffness for row in TABLE_4_1 if row.motor]
    assert 3 * WITH.stiffness - rows[0] - rows[2] == pytest.approx(48.39, abs=1e-9)


def test_averages_without_motor_are_the_printed_ones():
    np.testing.assert_allclose(numbers(average(False)), numbers(WITHOUT), rtol=0, atol=0.0151)
    assert average(False).motor is False and average(False).depth is None


@pytest.mark.parametrize(("motor", "mean", "deviation"), [(True, 49.66, 2.59), (False, 47.47, 2.23)])
def test_weighted_means(motor, mean, deviation):
    assert weighted_stiffness(motor) == (pytest.approx(mean, abs=5e-3), pytest.approx(deviation, abs=5e-3))


def test_rows():
    assert [(row.motor, row.depth) for row in TABLE_4_1] == [
        (motor, depth) for motor in (True, False) for depth in (0.05, 0.075, 0.10)
    ]
    for row in TABLE_4_1:  # the deviations fall with the depth, the fit is a percentage
        assert 0 < row.sigma_rest_angle < row.sigma_damping < row.sigma_stiffness < row.stiffness
        assert 80 < row.fit < 100


@pytest.fixture(scope="module")
def found():
    return deviation_ratios(rate=250.0)


class TestDeviationRatios:
    @pytest.mark.slow
    def test_zero_of_the_spring_explains_the_printed(self, found):
        assert [ratios.row for ratios in found] == list(TABLE_4_1)
        for ratios in found[:3]:
            np.testing.assert_allclose(ratios.spring_zero, ratios.printed, rtol=0.25)

    @pytest.mark.slow
    def test_static_rest_does_not(self, found):
        off = [ratios.static_rest[0] / ratios.printed[0] for ratios in found]
        assert min(off) < 0.6

    def test_printed(self, found):
        assert found[0].printed == (pytest.approx(0.05 / 9.97), pytest.approx(0.81 / 9.97))

    def test_damping_does_not_depend_on_the_reading(self, found):
        for ratios in found:  # σ_b is the same either way, σ_k not by much
            assert ratios.static_rest[1] == pytest.approx(ratios.spring_zero[1], rel=0.2)

    @pytest.mark.slow
    def test_sampling_does_not_matter(self, found):
        np.testing.assert_allclose(deviation_ratios(rate=500.0)[0].spring_zero, found[0].spring_zero, rtol=0.02)
