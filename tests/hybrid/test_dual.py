"""Dual numbers against differences."""

import numpy as np
import pytest

from spear_pin.hybrid.dual import NUMBERS, Dual, derivative_of, solve_all, value_of
from spear_pin.hybrid.elimination import solve_sparse

H = 1e-6
FUNCTIONS = {
    "sum": lambda x, y, o: x + 2.0 * y - 3.0,
    "product": lambda x, y, o: x * y * x,
    "quotient": lambda x, y, o: x / y + 1.0 / x,
    "power": lambda x, y, o: x**3,
    "modulus": lambda x, y, o: abs(x - 2.0 * y),
    "elementary": lambda x, y, o: o.sin(x) * o.cos(y) + o.tan(x) + o.tanh(y) + o.sqrt(x) + o.exp(-y),
    "angle": lambda x, y, o: o.atan2(x, y),
    "maximum": lambda x, y, o: o.maximum(x, 2.0 * y) * o.maximum(x * y, 5.0),
    "system": lambda x, y, o: o.solve([[x, 1.0], [y, 3.0]], [1.0, x])[0],
    "array function": lambda x, y, o: np.maximum(x, y) + np.minimum(x, y) * np.sin(x),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_against_differences(name):
    function = FUNCTIONS[name]
    found = function(Dual(0.7, np.array([1.0, 0.0])), Dual(0.9, np.array([0.0, 1.0])), NUMBERS)
    assert value_of(found) == pytest.approx(function(0.7, 0.9, NUMBERS), rel=1e-14)
    expected = [
        (function(0.7 + H, 0.9, NUMBERS) - function(0.7 - H, 0.9, NUMBERS)) / (2.0 * H),
        (function(0.7, 0.9 + H, NUMBERS) - function(0.7, 0.9 - H, NUMBERS)) / (2.0 * H),
    ]
    assert derivative_of(found) + np.zeros(2) == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_a_derivative_is_never_lost():
    with pytest.raises(TypeError):
        float(Dual(1.0, 2.0))


def test_systems_of_arrays_are_those_of_numbers():
    """Each point of an array is a system of its own, which needs a pivot off the diagonal; right sides may be many."""
    rng = np.random.default_rng(1)
    points, c, m = 3, 4, 3
    values, slopes = rng.normal(size=(m, m + 2, points)), rng.normal(size=(m, m + 2, points, c))
    values[0, 0], slopes[0, 0] = 0.0, 0.0

    def system(scalar):
        entries = [[scalar(i, j) if (i, j) != (0, 0) else 0.0 for j in range(m + 2)] for i in range(m)]
        return [row[:m] for row in entries], [[row[m + k] for row in entries] for k in range(2)]

    found = solve_all(*system(lambda i, j: Dual(values[i, j][:, None], slopes[i, j])))
    for point in range(points):
        matrix, rights = system(lambda i, j, at=point: Dual(float(values[i, j, at]), slopes[i, j, at]))
        for k, right in enumerate(rights):
            for one, other in zip(found[k], solve_sparse(matrix, right), strict=True):
                np.testing.assert_allclose(value_of(one)[point, 0], value_of(other), rtol=1e-12)
                np.testing.assert_allclose(derivative_of(one)[point], derivative_of(other), rtol=1e-10)
