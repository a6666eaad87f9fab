"""Residual and multipliers of a bounding gait a second time: another section, everything written by hand.

From anterior touchdown to anterior touchdown instead of posterior to posterior, in all 13 numbers of the
state instead of a chart of ten: the multipliers are the eigenvalues there too, beside zeros.
"""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits import library
from spear_pin.hybrid.periodic import return_map
from tests.gaits.bounding_by_hand import Bounder

STEP = 2e-5
LEAST = 1e-2  # what is smaller counts as zero, where rounding is amplified


def suitable(found):
    """A gait of the robot and the lift-off that were written down."""
    system = found.system
    return system.kind == "bounding" and system.law.lift_off == "knee" and not system.robot.varied


NAME = next((name for name in library.names() if suitable(Gait.load(name))), None)
assert NAME is not None, "no gait that ships is written down by hand"


@cache
def at_anterior_touchdown():
    """The gait, and the state there."""
    found = Gait.load(NAME)
    event = return_map(found.system, found.state, 1e-12).event("anterior_touchdown")
    return found, event.q, event.v


def mapped(z):
    """One stride, of the state less torso_x."""
    q, v = Bounder(Gait.load(NAME).system.law).stride((np.array([0.0, *z[:6]]), z[6:]))
    return np.concatenate([q[1:], v])


@pytest.mark.slow
def test_the_stride_by_hand_is_periodic():
    found, q, v = at_anterior_touchdown()
    z = np.concatenate([q[1:], v])
    np.testing.assert_allclose(mapped(z), z, rtol=0, atol=1e-7)


@pytest.mark.slow
def test_multipliers_from_another_section():
    found, q, v = at_anterior_touchdown()
    z = np.concatenate([q[1:], v])
    jacobian = np.zeros((13, 13))
    for i in range(13):
        offset = STEP * np.eye(13)[i]
        jacobian[:, i] = (mapped(z + offset) - mapped(z - offset)) / (2.0 * STEP)
    actual = np.linalg.eigvals(jacobian)
    large = [value for value in found.multipliers if abs(value) > LEAST]
    assert large and sum(abs(value) > LEAST for value in actual) == len(large)
    for value in large:  # each has its counterpart
        assert np.abs(actual - value).min() < 1e-4 * max(1.0, abs(value)), (value, actual)
