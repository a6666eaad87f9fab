"""Multipliers of a whole section, along and lateral: none is left out, and the largest is first."""

import numpy as np
import pytest

from spear_pin.gaits.parity import ALONG, LATERAL, merge_multipliers, split_multipliers
from spear_pin.hybrid.periodic import eigenvalues

LATERAL_BLOCK = np.array([[1.5, 0.3], [0.0, 0.2]])
ALONG_BLOCK = np.array([[0.0, -1.1, 0.0], [1.1, 0.0, 0.0], [0.2, 0.0, 0.4]])


def test_parts_are_put_together():
    found = merge_multipliers({True: eigenvalues(LATERAL_BLOCK), False: eigenvalues(ALONG_BLOCK)})
    np.testing.assert_allclose(found.values, [1.5, 1.1j, -1.1j, 0.4, 0.2], rtol=0, atol=1e-12)
    assert found.kinds == (LATERAL, ALONG, ALONG, ALONG, LATERAL)


def test_of_what_is_one_no_kind_is_told():
    assert merge_multipliers({None: eigenvalues(ALONG_BLOCK)}).kinds == (None, None, None)


@pytest.mark.parametrize("coupling", [0.0, 1e-3])
def test_a_kind_is_that_of_the_greater_part(coupling):
    """Coordinates of either parity in any order, and a little of the one acting on the other."""
    A = np.full((5, 5), coupling)
    symmetric = np.array([True, False, True, False, True])
    A[np.ix_(symmetric, symmetric)] += ALONG_BLOCK
    A[np.ix_(~symmetric, ~symmetric)] += LATERAL_BLOCK
    found = split_multipliers(A, symmetric)
    assert found.kinds == (LATERAL, ALONG, ALONG, ALONG, LATERAL)
    np.testing.assert_allclose(found.values, eigenvalues(A), rtol=0, atol=1e-12)


def test_a_kind_that_drives_the_other_much_keeps_its_own():
    """A lateral mode of which most is motion along: the robot is a little lopsided."""
    A = np.array([[0.9, 0.0, 5.0], [0.0, 0.6, 4.0], [1e-3, 0.0, 0.7]])
    found = split_multipliers(A, np.array([True, True, False]))
    assert found.values == pytest.approx([0.9, 0.7, 0.6], abs=0.03)
    assert found.kinds == (ALONG, LATERAL, ALONG)
