"""The plot of motors and gear ratios: what it shows is what the study found."""

import re
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.drivetrain import KneeDrive
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.drivetrain import PANELS, drivetrain


@pytest.fixture(scope="module")
def rows():
    """Two motors; the second has one ratio outside its envelope and one without a gait."""
    gait, made = Gait.load("long_stride"), []
    for i, name in enumerate(("spear_ii_knee", "ec_90_flat_260w")):
        for ratio in (10.0, 15.0, 22.0):
            drive = Drive(motor(name), Gearbox(ratio), 24.0)
            figures = {"energy": 300.0 / ratio + i, "heat": 200.0 / ratio, "thermal_load": 30.0 / ratio - i}
            figures |= {"margin": 10.0 - 3.0 * i, "impact": 0.05 * ratio}
            made.append(KneeDrive(name, drive, drive.reflected_inertia, gait=gait, **figures))
    made[-2] = replace(made[-2], margin=-8.0, reason="outside")
    made[-1] = KneeDrive(made[-1].motor, made[-1].drive, made[-1].reflected_inertia, reason="no gait found: none")
    return made


def shown(axes, label):
    (line,) = (line for line in axes.lines if label in (line.get_label(), line.get_gid()))
    return np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float), line


def test_lines_are_the_rows(rows):
    figure = drivetrain(rows[::-1])
    for axes, (label, value) in zip(figure.axes, PANELS.items(), strict=True):
        assert axes.get_ylabel() == label
        for name in ("spear_ii_knee", "ec_90_flat_260w"):
            x, y, _ = shown(axes, name)
            own = [row for row in rows if row.motor == name]
            assert x == pytest.approx([10, 15, 22])
            assert y == pytest.approx([value(row) if row.gait else np.nan for row in own], nan_ok=True)


def test_what_cannot_be_is_hollow_or_a_cross(rows):
    for axes in drivetrain(rows).axes:
        assert shown(axes, "spear_ii_knee, can")[0] == pytest.approx([10, 15, 22])
        assert not len(shown(axes, "spear_ii_knee, cannot")[0])
        assert shown(axes, "ec_90_flat_260w, can")[0] == [10]
        x, _, hollow = shown(axes, "ec_90_flat_260w, cannot")
        assert x == [15] and hollow.get_markerfacecolor() == "white"
        x, y, cross = shown(axes, "ec_90_flat_260w, no gait")
        assert x == [22] and 0.0 < y < 0.1 and cross.get_marker() == "x"


def test_limits_are_drawn_and_in_view(rows):
    limits = {}
    for axes in drivetrain(rows).axes:
        for line in axes.lines:
            if line.get_gid() == "limit":
                limits[axes.get_ylabel()] = line.get_ydata()[0]
                assert axes.get_ylim()[0] < line.get_ydata()[0] < axes.get_ylim()[1]
    assert limits == {"Rms over continuous torque": 1.0, "Margin to the envelope (N·m)": 0.0}


def test_every_axis_has_a_unit_and_the_file_is_small(rows, tmp_path):
    figure = drivetrain(rows)
    for axes in figure.axes:
        assert re.search(r"\((J a hop|N·m|g·m²)\)$|^Rms over continuous torque$", axes.get_ylabel())
    assert {axes.get_xlabel() for axes in figure.axes[3:]} == {"Gear ratio"}
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts[:2] == ["spear_ii_knee", "ec_90_flat_260w"] and "no gait" in texts
    assert save_figure(figure, tmp_path / "drivetrain.svg").stat().st_size < 200_000


def test_it_needs_gaits_and_not_too_many_motors(rows):
    for none in ([], rows[-1:]):
        with pytest.raises(BadValue, match="rows .*at least one with a gait"):
            drivetrain(none)
    with pytest.raises(BadValue, match="at most 7 motors"):
        drivetrain([replace(rows[0], motor=f"{i}") for i in range(8)])
