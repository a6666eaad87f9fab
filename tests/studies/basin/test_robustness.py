"""Numbers drawn at random, and what survives them."""

import numpy as np
import pytest
import scipy

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.studies.basin.robustness import Robustness, robustness

compiles = pytest.mark.extra("heyoka")


def test_interval_is_clopper_and_pearsons():
    found = Robustness({}, np.arange(10), np.array(["complete"] * 7 + ["fall"] * 3))
    assert found.share == pytest.approx(0.7)
    beta = scipy.stats.beta
    assert found.interval(0.9) == pytest.approx((beta.ppf(0.05, 7, 4), beta.ppf(0.95, 8, 3)), abs=1e-9)


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        ({"spread": {"stiffnes": 0.1}}, UnknownName, "stiffness"),
        ({"spread": {"stiffness": -0.1}}, BadValue, "^standard deviation of stiffness is -0.1"),
        ({"spread": {}, "disturbance": float("nan")}, BadValue, "^standard deviation of disturbance"),
        ({"spread": {}, "draws": 0}, BadValue, "^draws is 0"),
    ],
)
def test_refuses(hop, given, error, said):
    with pytest.raises(error, match=said):
        robustness(hop, **given)


@compiles
class TestRobustness:
    def test_nothing_drawn_survives(self, hop):
        assert robustness(hop, {}, draws=3, cycles=5).interval()[1] == 1.0

    def test_as_single_runs(self, hop):
        """Each draw as the reference engine runs it with the same numbers; some fall."""
        found = robustness(hop, {"stiffness": 0.2, "stance_torque": 0.2}, draws=12, cycles=4, seed=2)
        assert 0.0 < found.share < 1.0
        for i, reason in enumerate(found.reason):
            system = with_parameters(hop.system, {name: float(values[i]) for name, values in found.drawn.items()})
            expected = run(system, hop.state, 4, Options())
            assert (expected.reason, expected.cycles) == (reason, found.cycles[i])

    def test_is_drawn_as_asked(self, hop):
        found = robustness(hop, {"friction": 0.05}, draws=400, cycles=1, seed=1)
        assert found.drawn["friction"].mean() == pytest.approx(0.8, abs=0.01)
        assert found.drawn["friction"].std() == pytest.approx(0.04, rel=0.15)
        again = robustness(hop, {"friction": 0.05}, draws=400, cycles=1, seed=1)
        np.testing.assert_array_equal(again.drawn["friction"], found.drawn["friction"])

    def test_disturbance_shifts_the_start(self, hop):
        """So far off that some fall, though all have the gait's own numbers."""
        assert 0.0 < robustness(hop, {}, 0.5, draws=40, cycles=2).share < 1.0
