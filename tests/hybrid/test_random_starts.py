"""However a run begins, it ends with a reason."""

import numpy as np
import pytest

from spear_pin.hybrid.reasons import NUMERICAL, REASONS
from tests.random_starts import CAP, draw, outcomes, robot

BATCH = 50  # so that processes can share them


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 200, BATCH))
def test_every_run_ends_with_a_reason_and_finite_numbers(first):
    found = list(outcomes(BATCH, first=first))
    assert len(found) == BATCH
    for one in found:
        assert one.reason in REASONS, one
        assert one.finite, one
        assert one.evaluations < CAP, one
        assert one.residual < 1e-5, one
    numerical = [one for one in found if one.reason in NUMERICAL]
    assert len(numerical) <= 0.02 * BATCH, numerical
    assert {"complete", "fall"} <= {one.reason for one in found}, "starts that all end alike are not worth much"


def test_starts_are_what_they_are_said_to_be():
    for seed in range(50):
        start = draw(seed)
        q, v = np.array(start.q), np.array(start.v)
        assert len(q) == len(v) == robot(start.free).nv == (4 if start.free else 3)
        assert 0.0 <= robot(start.free).toe_position(q, "toe")[1] <= 0.3
        assert 0.1 <= q[-1] <= 2.0 and abs(q[-2] - q[-1] / 2) <= 0.3
        assert np.abs(v[-2:]).max() <= 10.0 and np.abs(v[:-2]).max() <= 2.0
        assert 0.1 <= start.friction <= 2.0
        assert draw(seed) == start
