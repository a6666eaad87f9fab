"""Columns over time: what is drawn is the trajectory."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, hopping, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.viz.plots import ground_force, knee_torque, save_figure
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
    assert list(lines(hops.plot())) == ["q_boom_z", "q_hip", "q_knee", "spring_knee", "force_z_toe"]


def test_without_springs_there_is_none_of_them(hops):
    free = replace(hops, spring=hops.spring[:, :0], engaged=hops.engaged[:, :0], spring_joints=())
    assert list(lines(free.plot())) == ["q_boom_z", "q_hip", "q_knee", "force_z_toe"]


def test_the_first_cycles_and_how_to_see_all(hops):
    two, every = hops.plot("q_knee", cycles=2), hops.plot("q_knee", cycles=None)
    shown = hops.in_cycles(1, 2)
    np.testing.assert_array_equal(lines(two)["q_knee"].get_xdata(), shown.t)
    assert two.get_suptitle() == "cycles 1 to 2 of 3; plot(…, cycles=None) shows all"
    np.testing.assert_array_equal(lines(every)["q_knee"].get_xdata(), hops.t)
    assert every.get_suptitle() == hops.plot("q_knee").get_suptitle() == ""
    later = hops.in_cycles(2, 3).plot("q_knee", cycles=1)
    assert later.get_suptitle() == "cycle 2 of 2; plot(…, cycles=None) shows all"
    with pytest.raises(BadValue, match="cycles is 0"):
        hops.plot(cycles=0)


def test_what_is_of_a_pair_says_so():
    gait = Gait.load("long_stride")
    stride = simulate(gait.system, gait.state, progress=False)
    figure = stride.plot("q_pitch", "u", "force_z", "v_torso_x")
    assert [axes.get_ylabel() for axes in figure.axes] == [
        *("Angle (rad)", "Torque, a pair (N·m)", "Force, a pair (N)", "Velocity (m/s)")
    ]
    assert "u_posterior_hip" in lines(figure)
    mixed = stride.plot("friction_pitch", "u_posterior_hip")
    assert mixed.axes[0].get_ylabel() == "Torque (N·m)"
    assert list(lines(mixed)) == ["friction_pitch", "u_posterior_hip, a pair"]
    assert knee_torque(stride, "posterior_knee").axes[0].get_ylabel() == "Posterior knee torque, a pair (N·m)"
    assert ground_force(stride).axes[0].get_ylabel() == "Ground force, a pair (N)"


@pytest.mark.slow
def test_in_space_joints_of_all_legs_are_together():
    gait = Gait.load(Path(__file__).parents[3] / "examples" / "turn.json")
    figure = simulate(gait.system, gait.state, progress=False).plot("q", "spring", "force_z")
    assert [axes.get_ylabel() for axes in figure.axes] == [
        *("Position (m)", "Angle (rad)", "Adduction angle (rad)", "Hip angle (rad)", "Knee angle (rad)"),
        *("Knee torque (N·m)", "Force (N)"),
    ]
    assert [len(axes.lines) for axes in figure.axes] == [3, 3, 4, 4, 4, 4, 4]
    figure.canvas.draw()
    for axes in figure.axes:
        legend = axes.get_legend().get_window_extent()
        assert legend.x1 <= figure.bbox.x1 + 1, "what is labelled has room"
        assert axes.get_window_extent().width > 0.7 * figure.bbox.width


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
