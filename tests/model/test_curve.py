"""Smooth curves through points, against SciPy's piecewise polynomials and numerical quadrature."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from spear_pin.model.curve import Curve, through

TABLES = [
    ((0.0, 0.0), (0.1, 4.0), (0.3, 5.0), (0.6, 30.0)),
    ((-0.3, -9.0), (-0.1, -2.0), (0.0, 0.0), (0.2, 3.0), (0.5, 40.0)),
    ((0.0, 0.0), (0.5, 20.0)),
    ((0.0, 0.0), (0.3, 0.0), (0.35, 20.0)),
]
SMALL = 1e-6


@pytest.mark.parametrize("points", TABLES)
def test_is_the_monotone_cubic_and_straight_beyond(points):
    curve, cubic = through(points), PchipInterpolator(*np.transpose(points))
    (low, _), (high, _) = points[0], points[-1]
    within = np.linspace(low, high, 101)
    np.testing.assert_allclose(curve(within), cubic(within), rtol=0, atol=1e-12)
    assert curve(high + 0.2) == pytest.approx(cubic(high) + 0.2 * cubic(high, 1))
    if low < 0.0:
        assert curve(low - 0.2) == pytest.approx(cubic(low) - 0.2 * cubic(low, 1))


@pytest.mark.parametrize("points", TABLES)
def test_has_a_continuous_derivative(points):
    curve = through(points)
    for x in curve.starts[1:]:
        below, above = (curve(x) - curve(x - SMALL)) / SMALL, (curve(x + SMALL) - curve(x)) / SMALL
        assert above == pytest.approx(below, abs=2e-2)  # of up to 1000, a second derivative of up to 1e4 times SMALL


@example([(0.1, 5e-324), (0.1, 1.0), (0.1, 1.0)])
@given(st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(0.0, 50.0)), min_size=1, max_size=8))
def test_rises_as_its_points_do(steps):
    points = [(0.0, 0.0), *map(tuple, np.cumsum(steps, axis=0).tolist())]
    values = through(points)(np.linspace(0.0, points[-1][0] + 1.0, 300))
    assert (np.diff(values) >= -1e-10).all()


@pytest.mark.parametrize("points", TABLES)
@pytest.mark.parametrize("end", [-0.5, -0.2, 0.0, 0.05, 0.32, 0.9])
def test_integral(points, end):
    curve = through(points)
    area, _ = quad(curve, 0.0, end, points=curve.starts, limit=200)
    assert curve.integral()(end) == pytest.approx(area, rel=1e-9, abs=1e-12)


def test_by_hand():
    """1 + 2 u below 3, then 7 + ½ u²."""
    curve = Curve((0.0, 3.0), ((2.0,), (0.0, 0.5)), 1.0)
    np.testing.assert_array_equal(curve(np.array([-1.0, 0.0, 2.0, 3.0, 5.0])), [-1.0, 1.0, 5.0, 7.0, 9.0])
