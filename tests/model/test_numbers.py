"""Numbers of a robot's bodies, read and changed by name."""

import numpy as np
import pytest

from spear_pin import load, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.numbers import body_numbers

ROBOTS = ("spear_ii", "q_spear")


@pytest.mark.parametrize("name", ROBOTS)
def test_each_is_changed_and_no_other(name):
    robot = load(name)
    before = body_numbers(robot)
    for which, number in before.items():
        after = body_numbers(vary(robot, **{which: 1.25 * number.value}))
        changed = [each for each in before if after[each].value != pytest.approx(before[each].value, rel=1e-12)]
        assert changed == [which] and after[which].value == pytest.approx(1.25 * number.value, rel=1e-12)


def test_a_longer_shank_puts_the_toe_lower():
    robot = load("spear_ii")
    q = np.zeros(robot.nq)
    longer = vary(robot, knee_to_toe=0.4)
    assert robot.toe_position(q, "toe")[1] - longer.toe_position(q, "toe")[1] == pytest.approx(0.4 - 0.318, abs=1e-12)


def test_a_number_of_the_gears_says_the_same():
    robot = load("spear_ii")
    one, other = vary(robot, knee_ratio=20.0), vary(robot, knee_armature=0.027 * (20.0 / 15.0) ** 2)
    q = np.full(robot.nq, 0.3)
    assert one.mass_matrix(q) == pytest.approx(other.mass_matrix(q), rel=1e-12)


def test_units_are_said():
    assert {
        name: body_numbers(load("spear_ii"))[name].unit for name in ("knee_mass", "knee_inertia", "hip_to_knee")
    } == {
        "knee_mass": "kg",
        "knee_inertia": "kg·m²",
        "hip_to_knee": "m",
    }


def test_what_is_refused():
    robot = load("spear_ii")
    with pytest.raises(UnknownName, match="knee_mass"):
        vary(robot, nope=1.0)
    with pytest.raises(BadValue, match="knee_mass is -1"):
        vary(robot, knee_mass=-1.0)
    with pytest.raises(BadValue, match="hip_to_knee is 0"):
        vary(robot, hip_to_knee=0.0)
