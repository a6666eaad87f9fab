"""The plots of the design studies: what they show is what the studies found."""

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.design import Member, against, points, spring_sweep
from spear_pin.viz.plots import design as design_plots
from spear_pin.viz.plots import save_figure

LABEL = re.compile(r"\((s|ms|m/s|rad/s|rad|N·m|N·m/rad|m|kg·m²)\)|^Largest multiplier$")
DRIVES = {
    f"{power} W": Drive(motor(name), Gearbox(15.0, 0.83), 48.0)
    for power, name in ((260, "ec_90_flat_260w"), (600, "assumed_600w"))
}


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


def line(axes: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    drawn = next(line for line in axes.lines if line.get_label() == label)
    x, y = np.asarray(drawn.get_xdata(), float), np.asarray(drawn.get_ydata(), float)
    return x[np.isfinite(y)], y[np.isfinite(y)]


@pytest.mark.slow
def test_compliance_shows_both_legs_with_and_without(gait: Gait):
    front, back = design_plots.compliance(gait).axes
    sweep = spring_sweep(gait, (0.0, 56.0))
    for axes, i in ((front, 1), (back, 0)):
        for label, stiffness in (("without a spring", 0.0), ("with 56 N·m/rad", 56.0)):
            t, torque = line(axes, label)
            assert t == pytest.approx(1e3 * sweep[stiffness].t)
            assert np.array_equal(torque, sweep[stiffness].torque[:, i])
    for axes in (front, back):
        spans = {patch.get_gid(): patch.get_width() for patch in axes.patches}
        for leg in ("posterior", "anterior"):
            assert spans[f"{leg}_stance"] == pytest.approx(1e3 * gait.durations[f"{leg}_stance"], abs=1e-3)


@pytest.mark.slow
def test_sweep_shows_each_spring_in_stance(gait: Gait):
    front, back = design_plots.stiffness_sweep(gait, (0.0, 200.0)).axes
    sweep = spring_sweep(gait, (0.0, 200.0))
    for axes, i in ((front, 1), (back, 0)):
        for stiffness, given in sweep.items():
            t, torque = line(axes, f"{stiffness:g}")
            assert np.array_equal(torque, given.torque[given.bears[:, i], i])
            assert t[0] == 0.0
    with pytest.raises(BadValue, match="stiffnesses"):
        design_plots.stiffness_sweep(gait, ())


@pytest.mark.slow
def test_hips_show_their_root_mean_square(gait: Gait):
    given = points(gait, "hip")
    for axes, i in zip(design_plots.hip_torques(gait).axes, (1, 0), strict=True):
        assert np.array_equal(line(axes, "motor")[1], given.torque[:, i])
        levels = [drawn.get_ydata()[0] for drawn in axes.lines if drawn.get_linestyle() == "--"]
        assert np.abs(levels) == pytest.approx([given.rms[i]] * 2)


class TestTorqueSpeed:
    def test_rings_what_is_outside(self, gait: Gait):
        (axes,) = design_plots.torque_speed(gait, DRIVES).axes
        rings = {drawn.get_gid(): drawn for drawn in axes.lines if drawn.get_gid()}
        given = points(gait)
        for name, drive in DRIVES.items():
            out = against(given, drive).margin < 0.0
            ring = rings[f"outside {name}"]
            assert np.sort(ring.get_ydata()) == pytest.approx(np.sort(np.abs(given.torque[out])))
            assert out.any()

    @pytest.mark.slow
    def test_every_point_is_drawn_once(self, gait: Gait):
        (axes,) = design_plots.torque_speed(gait, DRIVES).axes
        given = points(gait)
        drawn = [
            line(axes, f"{leg}, {where}")[1] for leg in ("posterior", "anterior") for where in ("stance", "flight")
        ]
        assert np.sort(np.concatenate(drawn)) == pytest.approx(np.sort(np.abs(given.torque).ravel()))

    def test_the_solid_lines_part_what_fits_from_what_does_not(self, gait: Gait):
        (axes,) = design_plots.torque_speed(gait, {"260 W": DRIVES["260 W"]}).axes
        drive = DRIVES["260 W"]
        most = next(drawn for drawn in axes.lines if len(drawn.get_xdata()) == 401)
        speed, torque = np.asarray(most.get_xdata()), np.asarray(most.get_ydata())
        chosen = np.isfinite(torque) & (np.abs(speed) < drive.no_load_speed)
        assert chosen.sum() > 100
        assert drive.margin(torque[chosen], speed[chosen]) == pytest.approx(0.0, abs=1e-9)

    def test_the_legend_says_how_the_numbers_were_verified(self, gait: Gait):
        by_hand = replace(DRIVES["260 W"], motor=replace(motor("ec_90_flat_260w"), resistance=0.5))
        figure = design_plots.torque_speed(gait, {**DRIVES, "other": by_hand})
        texts = [text.get_text() for text in figure.legends[0].get_texts()]
        assert "260 W: secondary source, assumption" in texts
        assert "600 W: assumption" in texts
        assert "other: secondary source, given by hand, assumption" in texts

    def test_needs_drives(self, gait: Gait):
        for drives in ({}, {f"{n}": DRIVES["260 W"] for n in range(6)}):
            with pytest.raises(BadValue, match="drives"):
                design_plots.torque_speed(gait, drives)


@pytest.mark.slow
def test_family_shows_the_members_and_what_was_not_found(gait: Gait):
    other = Gait.load("least_effort")
    members = [Member(2.6, other, None), Member(2.5, gait, None), Member(2.7, None, None, "nothing")]
    figure = design_plots.family_plot(members, "speed")
    knee, hip, stride, largest = figure.axes
    assert line(knee, "posterior")[0] == pytest.approx([2.5, 2.6])
    assert line(knee, "posterior")[1] == pytest.approx([points(gait).peak[0], points(other).peak[0]])
    assert line(hip, "anterior")[1] == pytest.approx(
        [np.abs(points(g, "hip").torque[:, 1]).max() for g in (gait, other)]
    )
    assert stride.lines[0].get_ydata() == pytest.approx([1e3 * gait.period, 1e3 * other.period])
    assert largest.lines[0].get_ydata() == pytest.approx([abs(gait.multipliers[0]), abs(other.multipliers[0])])
    assert all(line(axes, "none found")[0] == [2.7] for axes in figure.axes)
    assert stride.get_xlabel() == "Speed (m/s)"
    with pytest.raises(BadValue, match="members"):
        design_plots.family_plot([members[2]], "speed")


@pytest.mark.slow
def test_a_family_over_a_number_of_the_robot_has_its_unit(gait: Gait):
    figure = design_plots.family_plot([Member(0.7, gait, None)], "hip_distance")
    assert figure.axes[2].get_xlabel() == "Hip distance (m)"


@pytest.mark.slow
def test_every_axis_has_a_unit_and_files_are_small(gait: Gait, tmp_path):
    figures: dict[str, Figure] = {
        "compliance": design_plots.compliance(gait),
        "sweep": design_plots.stiffness_sweep(gait),
        "hips": design_plots.hip_torques(gait),
        "drives": design_plots.torque_speed(gait, DRIVES),
        "family": design_plots.family_plot([Member(2.5, gait, None)], "speed"),
    }
    for name, figure in figures.items():
        for axes in figure.axes:
            assert LABEL.search(axes.get_ylabel()), axes.get_ylabel()
            assert LABEL.search(axes.get_xlabel()) or name == "family"
        assert save_figure(figure, tmp_path / f"{name}.svg").stat().st_size < 200_000
