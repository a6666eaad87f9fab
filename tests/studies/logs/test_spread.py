"""Deviations of fitted values, beside those of plain regression, and how correlated residuals enlarge them."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from spear_pin.errors import BadValue
from spear_pin.studies.logs.spread import correlation_time, spread

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
    with pytest.raises(BadValue, match="the log does not tell mass and stiffness apart"):
        spread(SimpleNamespace(over=("mass", "stiffness")), (np.ones(N), jacobian), 1.0)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_correlation_times_are_those_of_a_first_order_process(rho):
    """In closed form (1 + ρ) / (1 - ρ)."""
    noise = np.random.default_rng(1).standard_normal(30_000)
    assert correlation_time(lfilter([1.0], [1.0, -rho], noise)) == pytest.approx((1.0 + rho) / (1.0 - rho), rel=0.2)
