"""Lanes in space end as the reference engine says, whether they are compiled or left to it."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.hybrid.lanes import compiles

LANES, SPREAD = 3, (2e-4, 2e-3)  # the first lane is the gait itself; m and rad, m/s and rad/s


@compiles
@pytest.mark.slow
@pytest.mark.parametrize(("name", "cycles"), [("trot", 1), ("pronk", 1)])
def test_pushed(name, cycles):
    gait = Gait.load(name)
    rng = np.random.default_rng(5)
    q, v = (np.tile(part, (LANES, 1)) for part in gait.state)
    for part, spread in zip((q, v), SPREAD, strict=True):
        part[1:] += rng.uniform(-spread, spread, part[1:].shape)
    q[1:, 2] += 0.01  # no toe is below the ground, so these fly on first
    found = simulate_many(gait.system, q, v, cycles, unroll=False)
    for lane in range(LANES):
        expected = run(gait.system, (q[lane], v[lane]), cycles, Options(1e-9))
        assert (found.reason[lane], found.cycles[lane]) == (expected.reason, expected.cycles)
        if expected.reason == "complete":
            off = np.abs(np.concatenate([found.q[lane] - expected.state[0], found.v[lane] - expected.state[1]])).max()
            assert off < 1e-7, (lane, off)
    assert not found.repeated[0]
