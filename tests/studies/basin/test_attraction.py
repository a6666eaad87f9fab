"""Basins of attraction, and dropping the leg from rest."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.studies.basin.attraction import attraction, make_drops

compiles = pytest.mark.extra("heyoka")
HEIGHTS, KNEES = np.linspace(0.005, 0.6, 317), np.linspace(0.1, 2.4, 317)


@pytest.mark.slow
def test_dropped(hop):
    q, v = make_drops(hop, [0.1, 0.2], [0.5, 1.0, 1.5])
    assert q.shape == (6, 3) and not v.any()
    toes = [hop.system.robot.toe_position(each, "toe") for each in q]
    np.testing.assert_allclose([toe[1] for toe in toes], [0.1] * 3 + [0.2] * 3, atol=1e-12)
    np.testing.assert_allclose([toe[0] for toe in toes], 0.0, atol=1e-12)  # thigh and shank are as long
    with pytest.raises(BadValue, match="^gait is 'bounding'"):
        make_drops(Gait.load("long_stride"), [0.1], [1.0])


@pytest.mark.parametrize("place", [15590, 22193, 23462, 33441, 42998, 44591, 47778])
def test_sliding_begins_the_right_way(hop, place):
    """With next to no force on the toe both ways seemed right, the first was taken, and it stopped at once for ever."""
    q, v = make_drops(hop, [HEIGHTS[place // 317]], [KNEES[place % 317]])
    assert run(hop.system, (q[0], v[0]), 1, Options()).reason == "complete"


@compiles
class TestAttraction:
    def test_near_the_gait_all_return(self, hop):
        heights = [hop.system.robot.toe_position(hop.state[0], "toe")[1] + 0.05]
        told = []
        found = attraction(hop, *make_drops(hop, heights, np.linspace(0.9, 1.1, 5)), on_cycle=lambda *n: told.append(n))
        assert found.share == 1.0 and (found.reason == "reached").all()
        assert told[0] == (1, 5) and np.nanmax(found.cycles) == told[-1][0]

    def test_counts_as_single_runs_do(self, hop):
        """Whole cycles until every coordinate and rate is within 0.01 of the gait's, by the reference engine."""
        q, v = make_drops(hop, np.linspace(0.02, 0.5, 4), np.linspace(0.3, 2.3, 4))
        found = attraction(hop, q, v, cycles=8)
        assert {"reached", "fall"} <= set(found.reason)
        for i in range(len(q)):
            state, taken, reason = (q[i], v[i]), np.nan, "elsewhere"
            for cycle in range(1, 9):
                result = run(hop.system, state, 1, Options(1e-9))
                if result.reason != "complete":
                    reason = result.reason
                    break
                state = result.state
                if np.abs(np.concatenate(state) - np.concatenate(hop.state)).max() < 0.01:
                    taken, reason = cycle, "reached"
                    break
            assert found.reason[i] == reason
            np.testing.assert_equal(found.cycles[i], taken)

    def test_bad_distance(self, hop):
        with pytest.raises(BadValue, match="^near is 0"):
            attraction(hop, np.zeros((1, 3)), np.zeros((1, 3)), near=0.0)
