"""Cycles that begin with more than a state: the section is crossed from a stance, whose leg goes on bearing."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, simulate_many
from spear_pin.hybrid.lanes import runner
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run

pytestmark = pytest.mark.extra("heyoka")

# in the air; the posterior leg then comes down twice before the anterior one is lifted
Q = [0.0, 0.6628, 0.0833, 0.4354, 0.6931, -0.3957, -0.4264]
V = [2.363, -0.101, 3.739, 0.959, 16.735, -3.302, 3.731]
NUMBERS = {"stiffness": 112.365, "friction": 0.616}


@pytest.fixture(scope="module")
def gait():
    """In which every touch closes a cycle, or there would be none that is crossed so."""
    gait = Gait.load("long_stride")
    return replace(gait, system=replace(gait.system, shortest_flight=0.0))


@pytest.fixture(scope="module")
def expected(gait):
    """The same lane by the reference engine without a break."""
    result = run(with_parameters(gait.system, NUMBERS), (np.array(Q), np.array(V)), 3, Options(1e-11))
    crossed = [event.domain for event in result.events if event.name == gait.system.section]
    assert result.reason == "complete" and crossed == ["flight_2", *2 * ["anterior_stance"], "flight_2"]
    return result


@pytest.mark.slow
@pytest.mark.parametrize("few", [0, 16])
@pytest.mark.parametrize("cycles", [2, 3])
def test_what_they_remember(gait, expected, few, cycles, monkeypatch):
    """Such a cycle goes on in the double stance, and where the reference engine repeats it, it knows."""
    monkeypatch.setattr(runner, "FEW", few)
    lanes = {name: [number] for name, number in NUMBERS.items()}
    found = simulate_many(gait.system, [Q], [V], cycles, 1e-9, parameters=lanes)
    assert found.reason.tolist() == ["complete"]
    assert found.repeated.tolist() == [cycles == 3]
    event = [event for event in expected.events if event.name == gait.system.section][cycles]
    np.testing.assert_allclose(found.q[0], event.q, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.v[0], event.v, rtol=0, atol=1e-4)


@pytest.mark.slow
def test_a_lane_that_ends_later_is_left_at_its_last_section(gait):
    """Although the reference engine repeated it from an earlier one."""
    lanes = {name: [number] for name, number in NUMBERS.items()}
    seven, eight = (simulate_many(gait.system, [Q], [V], cycles, parameters=lanes) for cycles in (7, 8))
    assert (seven.reason[0], eight.reason[0]) == ("complete", "fall")
    assert seven.cycles[0] == eight.cycles[0] == 7
    np.testing.assert_allclose(seven.q, eight.q, rtol=1e-9)
    np.testing.assert_allclose(seven.v, eight.v, rtol=1e-9)
