"""Compiled equations of motion of dual numbers, against the same equations of arrays."""

import numpy as np
import pytest

from spear_pin import load
from spear_pin.hybrid.dual import ARRAYS, NUMBERS, Dual, derivative_of, value_of
from spear_pin.hybrid.tangent.terms import ArrayMechanism
from spear_pin.model.equations import mechanism_of

pytestmark = pytest.mark.extra("heyoka")
POINTS, DIRECTIONS = 3, 5
PARTS = ("mass_matrix", "bias", "positions", "jacobians", "drifts")


def flat(nested):
    if isinstance(nested, dict):
        return [each for part in nested.values() for each in flat(part)]
    return [each for part in nested for each in flat(part)] if isinstance(nested, (list, tuple)) else [nested]


def spread(scalars, shape):
    """Values and derivatives of scalars, of one shape."""
    values = [np.broadcast_to(value_of(each), (*shape[:-1], 1)) for each in scalars]
    return np.array(values), np.array([np.broadcast_to(derivative_of(each), shape) for each in scalars])


@pytest.fixture(scope="module", params=["q_spear_full", "hoppy"])
def mechanism(request):
    return mechanism_of(load("q_spear_full", base="chain") if request.param == "q_spear_full" else load("hoppy"))


@pytest.mark.parametrize("shape", [(POINTS, DIRECTIONS), (DIRECTIONS,)], ids=["of arrays", "of numbers"])
def test_they_are_the_same(mechanism, shape):
    rng, nv, ops = np.random.default_rng(4), mechanism.nv, ARRAYS if len(shape) == 2 else NUMBERS

    def some():
        x = rng.uniform(-0.6, 0.6, (*shape[:-1], 1)) if len(shape) == 2 else float(rng.uniform(-0.6, 0.6))
        return Dual(x, rng.normal(size=shape))

    q, v = [some() for _ in range(nv)], [some() for _ in range(nv)]
    numbers = [Dual(n, rng.normal(size=DIRECTIONS)) if n and i % 3 else n for i, n in enumerate(mechanism.numbers)]
    expected = mechanism.with_numbers(numbers).terms(q, v, ops)
    compiled = ArrayMechanism(mechanism).with_numbers(numbers)
    found, frame = compiled.terms(q, v, ops), next(iter(mechanism.toes))
    for one, other in [
        *((getattr(found, part), getattr(expected, part)) for part in PARTS),
        (found.position(frame), expected.position(frame)),
        (compiled.feet(q, v, ops).positions, expected.positions),
        (compiled.position(frame, q, ops), expected.position(frame)),
    ]:
        for mine, theirs in zip(spread(flat(one), shape), spread(flat(other), shape), strict=True):
            np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-12 * max(1.0, np.abs(theirs).max()))
    # what is zero whatever the state is stays the number zero, which elimination leaves out
    zeros = [[type(each) for each in flat(terms.mass_matrix)] for terms in (found, expected)]
    assert zeros[0] == zeros[1]


def test_one_code_serves_robots_that_differ_in_numbers_only():
    one = mechanism_of(load("q_spear_full", base="chain"))
    heavier = one.with_numbers([1.5 * number for number in one.numbers])
    assert ArrayMechanism(one)._code is ArrayMechanism(heavier)._code
    assert ArrayMechanism(one)._code is not ArrayMechanism(mechanism_of(load("hoppy")))._code
