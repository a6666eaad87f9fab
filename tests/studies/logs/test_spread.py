"""Deviations of fitted values, beside those of plain regression, and how correlated residuals enlarge them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from spear_pin.errors import BadValue
from spear_pin.studies.logs.spread import correlation_time, spread, spread_by_parts

N = 4000
T = np.linspace(0.0, 1.0, N)


def test_are_those_of_regression_with_all_unknowns():
    """Two values and a start, against the covariance of least squares of all three."""
    residual = np.random.default_rng(0).standard_normal(N)
    jacobian = np.column_stack([T, np.sin(5.0 * T), np.ones(N)])
    deviations, correlation = spread(SimpleNamespace(over=("a", "b")), (residual, jacobian), 1.0)
    covariance = np.linalg.inv(jacobian.T @ jacobian) * (residual @ residual) / (N - 3)
    expected = np.sqrt(np.diag(covariance))[:2]
    assert deviations == pytest.approx(expected, rel=1e-10)
    assert correlation[0, 1] == pytest.approx(covariance[0, 1] / expected.prod(), rel=1e-9)
    assert spread(SimpleNamespace(over=("a", "b")), (residual, jacobian), 3.0)[0] == pytest.approx(3.0 * expected)


def test_values_that_only_a_start_explains_are_refused():
    jacobian = np.column_stack([T, 2.0 * T + 1.0, np.ones(N)])
    with pytest.raises(BadValue, match="the data do not tell mass and stiffness apart"):
        spread(SimpleNamespace(over=("mass", "stiffness")), (np.ones(N), jacobian), 1.0)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_correlation_times_are_those_of_a_first_order_process(rho):
    """In closed form (1 + ρ) / (1 - ρ)."""
    noise = np.random.default_rng(1).standard_normal(30_000)
    assert correlation_time(lfilter([1.0], [1.0, -rho], noise)) == pytest.approx((1.0 + rho) / (1.0 - rho), rel=0.2)


def test_parts_that_are_left_out_spread_a_mean_as_their_means_do():
    """In closed form, of G equal parts: Σ (mean of a part - mean)² / G (G - 1)."""
    parts = np.repeat(np.arange(8), N // 8)
    residual = np.random.default_rng(2).standard_normal(8)[parts] + np.random.default_rng(3).standard_normal(N)
    residual -= residual.mean()
    found = spread_by_parts(SimpleNamespace(over=("mean",)), (residual, np.full((N, 1), 3.0)), parts)
    means = residual.reshape(8, -1).mean(axis=1) / 3.0
    assert found == pytest.approx(np.sqrt(np.sum(means**2) / (8 * 7)), rel=1e-9)
    assert spread(SimpleNamespace(over=("mean",)), (residual, np.full((N, 1), 3.0)), 1.0)[0] < 0.1 * found


def test_what_a_start_explains_is_no_spread_of_parts():
    """The start of each phase explains its mean; what is left is a slope, alike in all parts."""
    first = np.repeat([1.0, 0.0], N // 2)
    jacobian = np.column_stack([np.tile(T[: N // 2], 2), first, 1.0 - first])
    noise = 1e-6 * np.random.default_rng(4).standard_normal(N)
    away = noise - jacobian @ np.linalg.lstsq(jacobian, noise, rcond=None)[0]
    found = spread_by_parts(SimpleNamespace(over=("a",)), (away, jacobian), np.arange(N) * 8 // N % 4)
    assert found == pytest.approx(spread(SimpleNamespace(over=("a",)), (away, jacobian), 1.0)[0], rel=1.0)
