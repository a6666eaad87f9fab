"""The picture of a basin of attraction."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh

from spear_pin.errors import BadValue
from spear_pin.studies.basin.attraction import Attraction
from spear_pin.viz.plots.basin import attraction_map, basin_map

REASONS = np.array(["reached", "fall", "reached", "elsewhere", "no_event", "zeno"])
FOUND = Attraction(np.array([1.0, np.nan, 4.0, np.nan, np.nan, np.nan]), REASONS)


def test_shows_cycles_and_what_is_lost():
    figure = attraction_map(FOUND, [0.1, 0.3], [1.0, 2.0, 3.0], "Height (m)", "Knee (rad)")
    axes = figure.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Knee (rad)", "Height (m)")
    cycles = axes.images[-1].get_array()
    np.testing.assert_array_equal(np.ma.filled(cycles, np.nan), FOUND.cycles.reshape(2, 3))
    assert axes.images[-1].get_extent() == pytest.approx([0.5, 3.5, 0.0, 0.4])
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["goes on elsewhere", "falls", "stays down", "events accumulate"]
    assert len(axes.images) == 5


def test_all_return():
    every = Attraction(np.ones(4), np.full(4, "reached"))
    assert not attraction_map(every, [0.0, 1.0], [0.0, 1.0], "a", "b").legends


def test_refuses_another_grid():
    with pytest.raises(BadValue, match=r"^found is \(6,\); expected a grid of 2 x 2 states"):
        attraction_map(FOUND, [0.0, 1.0], [0.0, 1.0], "a", "b")


def test_basin_leaves_lost_ones_open():
    axes = {"torso_x": (-0.1, 0.0, 0.2), "pitch": (-1.0, 1.0)}
    strides = np.array([[3.0, np.nan], [4.0, 5.0], [np.nan, 7.0]])
    panel = basin_map(strides, axes).axes[0]
    mesh = next(drawn for drawn in panel.collections if isinstance(drawn, QuadMesh))
    shown = np.ma.masked_invalid(strides)
    assert np.array_equal(np.ma.getmaskarray(mesh.get_array()), shown.mask)
    assert np.ma.allequal(mesh.get_array(), shown)
    assert panel.get_xlabel() == "Push on pitch (rad/s)" and panel.get_ylabel() == "Push on torso x (m/s)"
    assert panel.get_xlim() == (-2.0, 2.0) and panel.get_ylim() == pytest.approx((-0.15, 0.3))
    with pytest.raises(BadValue, match="strides"):
        basin_map(strides.T, axes)
