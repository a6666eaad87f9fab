"""Columns over time: what is drawn is the trajectory."""

import numpy as np
import pytest

from spear_pin import HoppingLaw, hopping, simulate
from spear_pin.errors import UnknownName
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.paper import SCREEN, STANCE


@pytest.fixture(scope="module")
def hops(robot):
    system = hopping(robot, HoppingLaw(stance_torque=8.0))
    return simulate(system, system.guess(), 3, 1e-7, progress=False)


def lines(figure):
    return {line.get_label(): line for axes in figure.axes for line in axes.lines}


def test_columns_are_those_of_the_trajectory(hops):
    figure = hops.plot("q_knee", "u", "force_z", "q_boom_z")
    drawn = lines(figure)
    assert list(drawn) == ["q_knee", "u_hip", "u_knee", "force_z_toe", "q_boom_z"]
    np.testing.assert_array_equal(drawn["q_knee"].get_ydata(), hops.q[:, 2])
    np.testing.assert_array_equal(drawn["force_z_toe"].get_xdata(), hops.t)
    assert [axes.get_ylabel() for axes in figure.axes] == ["Angle (rad)", "Torque (N·m)", "Force (N)", "Position (m)"]
    assert figure.axes[-1].get_xlabel() == "Time (s)"


def test_by_default_angles_and_forces(hops):
    assert list(lines(hops.plot())) == ["q_boom_z", "q_hip", "q_knee", "force_z_toe"]


def test_nothing_is_drawn_across_what_is_left_out(hops):
    stance = hops.in_phase("stance")
    figure = stance.plot("q_knee")
    values = lines(figure)["q_knee"].get_ydata()
    assert np.isnan(values).sum() == hops.cycles - 1 and len(values) == len(stance) + hops.cycles - 1
    assert sum(patch.get_gid() == STANCE for patch in figure.axes[0].patches) == hops.cycles


def test_an_unknown_column(hops):
    with pytest.raises(UnknownName, match="q_kneee"):
        hops.plot("q_kneee")


def test_shows_itself_and_is_saved(hops, tmp_path):
    figure = hops.plot("q_knee")
    data, shown = figure._repr_png_()
    assert data.startswith(b"\x89PNG") and shown["width"] == pytest.approx(SCREEN * figure.get_figwidth(), abs=1)
    assert save_figure(figure, tmp_path / "knee.svg").stat().st_size > 1000
