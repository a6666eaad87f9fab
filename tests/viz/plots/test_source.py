"""Plots that answer figures of the source which no other module draws."""

import numpy as np
import pytest

from spear_pin.errors import BadValue
from spear_pin.model.catalogue import motor
from spear_pin.studies.push_test.power_off import power_off
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots import source as source_plots

FIGURES = (
    source_plots.switched_spring,
    source_plots.design_metrics,
    source_plots.balance,
    source_plots.printed_model,
    source_plots.crank_slider,
)


def lines(axes):
    return {line.get_label(): np.asarray(line.get_xydata()) for line in axes.lines}


@pytest.mark.parametrize("draw", FIGURES, ids=lambda draw: draw.__name__)
def test_it_can_be_written_and_says_what_its_axes_are(draw, tmp_path):
    figure = draw()
    assert save_figure(figure, tmp_path / "figure.svg").stat().st_size > 5000
    for axes in figure.axes:
        assert axes.get_xlabel() or axes.get_title() or not axes.get_xticks().size


def test_the_spring_acts_beyond_the_latched_angle_only():
    (axes,) = source_plots.switched_spring(latched=0.5).axes
    engaged = lines(axes)["key engaged: $S_1$"]
    assert (engaged[engaged[:, 0] <= 0.5, 1] == 0.0).all() and engaged[-1, 1] == pytest.approx(0.7 * 48.84)


def test_what_has_become_smaller_is_told_from_what_has_not():
    (axes,) = source_plots.design_metrics().axes
    widths = [bar.get_width() for bar in axes.patches]
    assert widths[0] == pytest.approx(2.2 / 4.55 - 1.0) and widths[-2] == pytest.approx(0.027 / 0.008 - 1.0)
    smaller = {bar.get_facecolor() for bar in axes.patches if bar.get_width() <= 0.0}
    assert len(smaller) == 1 and axes.patches[-2].get_facecolor() not in smaller


def test_printed_and_corrected_at_one_radian():
    inertia, weight = source_plots.printed_model().axes
    for axes, printed, corrected in ((inertia, 0.1636, 0.1932), (weight, 18.40, 9.62)):
        found = lines(axes)
        for label, value in (("as printed", printed), ("corrected", corrected)):
            assert np.interp(1.0, *found[label].T) == pytest.approx(value, rel=1e-3)


def test_the_leg_stands_on_its_toe_below_its_hip():
    drawn, height, hip = source_plots.crank_slider().axes
    for x, y in (line.get_data() for line in drawn.lines if line.get_label() == "10 cm"):
        assert (x[0], x[2], y[2]) == (0.0, 0.0, 0.0)
        assert np.hypot(x[1] - x[0], y[1] - y[0]) == pytest.approx(0.318)
        assert np.hypot(x[1] - x[2], y[1] - y[2]) == pytest.approx(0.318)
    knee, angle = hip.lines[-1].get_data()
    assert angle == pytest.approx(0.5 * knee, abs=1e-9)  # links of one length
    knee, level = height.lines[-1].get_data()
    assert level == pytest.approx(2 * 0.318 * np.cos(0.5 * knee))


class TestPowerOff:
    def test_heights(self):
        cases = {case.label: case for case in power_off(duration=0.3)}
        (axes,) = source_plots.power_off_heights(cases).axes
        found = lines(axes)
        assert list(found) == list(cases)
        np.testing.assert_array_equal(found["belt taken off"][:, 1], cases["belt taken off"].release.height)

    def test_no_cases(self):
        with pytest.raises(BadValue, match="cases"):
            source_plots.power_off_heights({})


def test_current_flows_through_the_open_bridge_above_the_threshold():
    volts, amperes = source_plots.bridge_currents(motor("spear_ii_knee"), 15.0).axes
    emf = lines(volts)["back-EMF (4.8)"]
    assert np.interp(20.0, *emf.T) == pytest.approx(34.5)
    coasting = lines(amperes)["all switches open"]
    flowing = coasting[coasting[:, 1] > 0.0, 0]
    assert flowing.min() == pytest.approx(25.4 / (0.115 * 15.0), abs=0.11)
    assert (lines(amperes)["supply disconnected"][:, 1] == 0.0).all()
