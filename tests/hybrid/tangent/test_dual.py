"""Dual numbers against differences."""

import numpy as np
import pytest

from spear_pin.hybrid.tangent.dual import NUMBERS, Dual, derivative_of, value_of

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
