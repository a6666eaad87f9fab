"""Dual numbers against differences."""

import numpy as np
import pytest

from spear_pin.hybrid.tangent.dual import NUMBERS, Dual
from tests.hybrid.tangent.oracle import richardson

FUNCTIONS = {
    "sums": lambda a: (a + 2.0) - (1.0 - a) * 3.0 - a,
    "products": lambda a: a * a * 0.7 + a**3,
    "quotients": lambda a: 1.0 / a + a / (a + 2.0) + a / 3.0,
    "trigonometry": lambda a: NUMBERS.sin(a) * NUMBERS.cos(a) + NUMBERS.tan(a),
    "growth": lambda a: NUMBERS.exp(a) + NUMBERS.sqrt(a) + NUMBERS.tanh(a),
    "angle": lambda a: NUMBERS.atan2(a * a, a + 1.0),
    "largest": lambda a: NUMBERS.maximum(a, 0.1) * NUMBERS.maximum(-a, 0.2) + abs(-a),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivative_is_that_of_differences(name):
    function, x = FUNCTIONS[name], 0.8
    found = function(Dual(x, np.array([1.0, -2.0])))
    expected = richardson(lambda h: function(x + h), 0.05, 5)
    assert found.x == pytest.approx(function(x), rel=1e-15)
    assert found.d == pytest.approx([expected, -2.0 * expected], rel=1e-9)


def test_solution_of_linear_equations_has_the_derivative_of_differences():
    def solved(a):
        return NUMBERS.solve([[a, 0.3], [a * a, 2.0]], [1.0, a])

    found = solved(Dual(0.8, np.ones(1)))
    expected = richardson(lambda h: np.array(solved(0.8 + h)), 0.02, 5)
    assert np.array([each.d[0] for each in found]) == pytest.approx(expected, rel=1e-9)


def test_nothing_makes_a_plain_number_of_one():
    with pytest.raises(TypeError):
        float(Dual(1.0, 2.0))
