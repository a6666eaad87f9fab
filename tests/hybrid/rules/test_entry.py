"""Which guard is an event at once: one state or many, against the same said in words."""

import math
from itertools import product

import numpy as np
import pytest

from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.rules.entry import (
    BENT,
    CHANGE,
    GLIMPSES,
    NONE,
    ahead,
    at_once,
    clear,
    falls,
    is_bent,
    stays_on_zero,
    thresholds,
)

LEAVING, WITHIN, ENDING, OBSERVED = (
    Guard("lift_off", None, Reset(phase="flight"), tolerance=1e-5),
    Guard("slip", None, Reset(), tolerance=1e-5),
    Guard("fall", None, ends="fall"),
    Guard("apex", None, tolerance=1.0),
)
VALUES = 1.0, 2e-5, 1e-5, 0.0, -1e-5, -2e-5, math.nan
RATES = 1.0, 0.0, -1.0, 1e-8, -1e-8, 1e-12, -1e-12, math.nan
"""A rate of 1e-8 is a change within the second glimpse, of 1e-12 within none."""


def in_words(guard, value, rate):
    if guard.observes or math.isnan(value) or value > guard.tolerance:
        return False
    if value < -guard.tolerance:
        return True
    change = rate * next((h for h in GLIMPSES if abs(rate * h) > CHANGE), 0.0)
    if math.isnan(change):
        return False
    return change < 0.0 or (change == 0.0 and guard.leaves)


@pytest.mark.parametrize("n", [1, 64])
def test_of_many_as_of_each(n):
    guards = [WITHIN, OBSERVED, LEAVING, ENDING]
    rng = np.random.default_rng(n)
    seen = set()
    for _ in range(1280 // n):
        values, rates = (rng.choice(numbers, (len(guards), n)) for numbers in (VALUES, RATES))
        found = at_once(guards, values, lambda h, values=values, rates=rates: values + h * rates)
        for i, index in enumerate(found.tolist()):
            events = [in_words(*each) for each in zip(guards, values[:, i], rates[:, i], strict=True)]
            assert index == (events.index(True) if any(events) else NONE)
            seen.add(index)
    assert seen == {NONE, 0, 2, 3}


def test_of_equals_the_first():
    down = np.full((2, 64), -1.0)
    assert (at_once([LEAVING, ENDING], down, lambda h: down) == 0).all()
    assert (at_once([ENDING, LEAVING], down, lambda h: down) == 0).all()


def test_nothing_waits_nothing_is_asked():
    assert at_once([LEAVING, OBSERVED], np.array([[1.0], [0.0]]), None).tolist() == [NONE]
    assert at_once([], np.empty((0, 3)), None).tolist() == [NONE] * 3


@pytest.mark.parametrize("guard", [LEAVING, WITHIN])
def test_numbers_as_arrays(guard):
    for value, change in product((0.0, -2e-5), (0.0, CHANGE, -CHANGE, 2.0 * CHANGE, -2.0 * CHANGE)):
        for rule in (falls, stays_on_zero):
            assert rule(guard, np.array([value]), np.array([change])).tolist() == [rule(guard, value, change)]
        assert stays_on_zero(guard, value, change) == (value == 0.0 and abs(change) <= CHANGE)


def test_clear():
    cases = [((1.0, 2.0), (-1.0,)), ((0.0, 1.0), (1.0,)), ((1.0, 1.0), (0.0,)), ((1.0, 1.0), (math.nan,))]
    assert [bool(clear(*case)) for case in cases] == [True, False, False, False]
    assert np.isfinite(thresholds([LEAVING, OBSERVED])).tolist() == [True, False]
    values, kinks = (np.array(list(numbers)).T for numbers in zip(*cases, strict=True))
    np.testing.assert_array_equal(clear(values, kinks), [True, False, False, False])
    assert is_bent(BENT) and is_bent(-BENT) and not is_bent(2.0 * BENT)


def test_a_step_ahead_is_of_fourth_order():
    """Of ẏ = -t y², y = 2 / (t² + 2) from t = 0; one state, and many that begin at their own times."""
    errors = [
        abs(float(ahead(lambda t, y: -t * y**2, 0.0, np.array([1.0]), h)[0]) - 2.0 / (h**2 + 2.0)) for h in (0.2, 0.1)
    ]
    assert 4.5 < math.log2(errors[0] / errors[1]) < 6.5
    t = np.linspace(0.0, 1.0, 64)
    many = ahead(lambda t, y: -t * y**2, t, (2.0 / (t**2 + 2.0))[None], 0.1)
    np.testing.assert_allclose(many[0], 2.0 / ((t + 0.1) ** 2 + 2.0), rtol=0, atol=1e-6)
