"""Unit masses: their equations are v̇ = u, in numbers and in symbols."""

import math

import numpy as np
import pytest

from spear_pin import find_gait
from spear_pin.errors import BadValue
from spear_pin.model.equations import mechanism_of
from spear_pin.model.unit_masses import unit_masses
from tests.walkers import example


def test_only_a_force_accelerates_them():
    robot, q, v = unit_masses(x="m", angle="rad"), [0.3, 2.0], [-1.0, 5.0]
    assert (robot.coordinates, robot.actuated, robot.units) == (("x", "angle"), ("x", "angle"), ("m", "rad"))
    np.testing.assert_array_equal(robot.mass_matrix(q), np.eye(2))
    np.testing.assert_array_equal(robot.bias(q, v), np.zeros(2))
    terms = mechanism_of(robot).terms(q, v, math)
    np.testing.assert_array_equal(terms.mass_matrix, np.eye(2))
    np.testing.assert_array_equal(terms.bias, np.zeros(2))


def test_no_file_has_them(tmp_path):
    wheel = find_gait(example().rimless_wheel())
    with pytest.raises(BadValue, match="a robot that was no file"):
        wheel.save(tmp_path / "wheel.json")


@pytest.mark.parametrize(
    ("units", "said"),
    [({}, r'a coordinate at least, such as unit_masses\(theta="rad"\)'), ({"x": "cm"}, "'m' or 'rad'")],
)
def test_refuses_units_that_are_none(units, said):
    with pytest.raises(BadValue, match=said):
        unit_masses(**units)
