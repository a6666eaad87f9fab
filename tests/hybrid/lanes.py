"""States of many lanes, and what they are compared with."""

import numpy as np
import pytest

from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run

FINE = 1e-11

compiles = pytest.mark.extra("heyoka")


def around(gait, spread, n, seed=0):
    """States on the section beside a gait's."""
    local, rng = chart(gait.system, gait.state), np.random.default_rng(seed)
    states = [local.state(spread * rng.normal(size=local.dimension)) for _ in range(n)]
    return tuple(np.array(part) for part in zip(*states, strict=True))


def watch_laps(monkeypatch):
    """Returns a list that receives every cycle that a lane runs alone, None for one that is refused."""
    laps, request = [], LoneRunner.request_lap

    def watched(*given):
        laps.append((yield from request(*given)))
        return laps[-1]

    monkeypatch.setattr(LoneRunner, "request_lap", watched)
    return laps


def refuse_laps(monkeypatch):
    """Refuses every cycle that a lane would run alone; returns a list that receives what was asked for."""
    asked = []

    def refused(*given):
        asked.append(given)
        yield from ()

    monkeypatch.setattr(LoneRunner, "request_lap", refused)
    return asked


def assert_agree(system, q, v, found, cycles=1, tolerance=1e-8, parameters=None):
    """Every lane with the reference engine: the reason, the cycles, the state and the durations."""
    for i, state in enumerate(zip(q, v, strict=True)):
        own = with_parameters(system, {name: float(values[i]) for name, values in (parameters or {}).items()})
        expected = run(own, state, cycles, Options(FINE))
        assert (found.reason[i], found.cycles[i]) == (expected.reason, expected.cycles), (i, expected.message)
        if expected.reason == "complete":
            np.testing.assert_allclose(found.q[i], expected.state[0], rtol=0, atol=tolerance)
            np.testing.assert_allclose(found.v[i], expected.state[1], rtol=0, atol=10 * tolerance)
            for phase, seconds in expected.durations.items():
                assert found.durations[phase][i] == pytest.approx(seconds, abs=tolerance)


def assert_same(one, other, atol=1e-10):
    """Two batches of the same lanes, to rounding but for those that the reference engine repeated in one of them."""
    assert one.message == other.message
    np.testing.assert_array_equal(one.cycles, other.cycles)
    clear = ~(one.repeated | other.repeated)
    assert clear.sum() > 0.9 * len(clear)
    pairs = [(one.q.T, other.q.T), (one.v.T, other.v.T)]
    for own, others in ((one.durations, other.durations), (one.observed, other.observed)):
        assert own.keys() == others.keys()
        pairs += [(own[name].T, others[name].T) for name in own]
    for mine, theirs in pairs:
        np.testing.assert_allclose(mine[..., clear], theirs[..., clear], rtol=0, atol=atol)
