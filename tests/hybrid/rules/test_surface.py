"""When motion on switching surfaces begins, for one state and many."""

from itertools import product

import numpy as np
import pytest

from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.surface import BEYOND, ON_EDGE, begins, within

SHARES = 0.5, 0.0, 1.0, -2.0 * ON_EDGE, 1.0 + 2.0 * ON_EDGE, -0.5 * ON_EDGE, np.nan


@pytest.mark.parametrize("n", [1, 64])
@pytest.mark.parametrize("toes", [1, 2])
def test_of_many_as_of_each(n, toes):
    rng = np.random.default_rng(n)
    events, shares = rng.choice([NONE, 0, 1, 2, 3, 4, 5], n), [rng.choice(SHARES, n) for _ in range(toes)]
    for beyond in BEYOND:
        found = begins(events, shares, beyond)
        for i in range(n):
            alone = [float(share[i]) for share in shares]
            assert found[i] == begins(int(events[i]), alone, beyond)
            assert found[i] == ((events[i] == NONE or events[i] >= 2 * toes) and all(within(s, beyond) for s in alone))


def test_within():
    """On its ends it is all but inside; where it may go beyond, it has to begin well inside."""
    assert [within(share, 0.0) for share in SHARES] == [True, True, True, False, False, True, False]
    for beyond, end in product(BEYOND[1:], (0.0, 1.0)):
        out = end + (beyond if end else -beyond)
        assert not within(out, beyond) and within(end + 0.8 * (out - end), beyond)
