"""The picture of what a gait survives."""

import numpy as np
import pytest

from spear_pin.studies.basin.robustness import Robustness
from spear_pin.viz.plots.robustness import BINS, robustness_figure


def test_a_panel_for_each_number():
    rng = np.random.default_rng(0)
    stiffness, friction = rng.normal(49.0, 2.0, 200), rng.normal(0.8, 0.1, 200)
    reason = np.where(stiffness < 49.0, "fall", "complete")
    figure = robustness_figure(Robustness({"stiffness": stiffness, "friction": friction}, np.ones(200, int), reason))
    first, second = figure.axes
    assert (first.get_xlabel(), second.get_xlabel()) == ("Stiffness (N·m/rad)", "Friction")
    shares = [float(line.get_ydata()[0]) for line in first.lines if line.get_marker() == "o"]
    assert len(shares) == BINS and shares[0] == 0.0 and shares[-1] == 1.0
    middles = [float(line.get_xdata()[0]) for line in first.lines if line.get_marker() == "o"]
    assert middles[0] == pytest.approx(np.median(np.sort(stiffness)[:20]))


def test_of_few_draws():
    found = Robustness({"friction": np.array([0.7, 0.8])}, np.ones(2, int), np.array(["complete", "fall"]))
    assert len([line for line in robustness_figure(found).axes[0].lines if line.get_marker() == "o"]) == 2
