"""The maps of sweeps show the numbers of their datasets."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.collections import PathCollection, QuadMesh

from spear_pin.errors import BadValue
from spear_pin.studies.sweep import grid
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.sweep import sweep_map


class Column:
    """What the map asks of an xarray variable."""

    def __init__(self, values):
        self.values = np.asarray(values, dtype=float)

    def to_numpy(self):
        return self.values


def dataset(points, largest, solved=None):
    """What the map asks of a Dataset; periods are two phases of 0.2 s."""
    columns = {name: Column(values) for name, values in points.items()}
    columns |= {"largest_multiplier": Column(largest), "duration": Column(np.full((len(largest), 2), 0.2))}
    columns |= {} if solved is None else {"stance_torque": Column(solved)}
    attributes = {"names": list(points), "vary": [] if solved is None else ["stance_torque"]}
    return type("Dataset", (SimpleNamespace,), {"__getitem__": lambda self, name: columns[name]})(attrs=attributes)


def test_a_grid(tmp_path):
    points = grid({"stiffness": [40.0, 50.0, 60.0], "knee_ratio": [10.0, 15.0]})
    largest = np.array([0.5, 0.6, np.nan, 0.8, 0.9, 1.2])
    figure = sweep_map(dataset(points, largest, 10.0 * largest))
    for panel, factor in zip(figure.axes[:2], (1.0, 10.0), strict=True):
        (mesh,) = [drawn for drawn in panel.collections if isinstance(drawn, QuadMesh)]
        drawn = np.ma.filled(mesh.get_array(), np.nan)
        np.testing.assert_allclose(drawn, factor * np.array([[0.5, np.nan, 0.9], [0.6, 0.8, 1.2]]))
        assert panel.get_xlabel() == "Stiffness (N·m/rad)" and panel.get_ylabel() == "Knee ratio"
        assert panel.get_xlim() == (35.0, 65.0)
    assert {axes.get_ylabel() for axes in figure.axes[2:]} == {"Largest multiplier", "Stance torque (N·m)"}
    assert save_figure(figure, tmp_path / "map.svg").stat().st_size > 1000


def test_a_sample():
    rng = np.random.default_rng(0)
    points = {"stiffness": rng.uniform(size=9), "damping": rng.uniform(size=9), "friction": rng.uniform(size=9)}
    largest = np.append(np.linspace(0.2, 0.9, 8), np.nan)
    panel = sweep_map(dataset(points, largest)).axes[0]
    (cloud,) = [drawn for drawn in panel.collections if isinstance(drawn, PathCollection)]
    np.testing.assert_allclose(cloud.get_offsets(), np.column_stack([points["stiffness"], points["damping"]])[:8])
    np.testing.assert_allclose(cloud.get_array(), largest[:8])
    (lost,) = [line for line in panel.lines if line.get_gid() == "lost"]
    assert lost.get_xdata()[0] == points["stiffness"][8]


def test_one_parameter():
    figure = sweep_map(dataset({"frequency": [2.6, 2.4, 2.5]}, [0.6, 0.4, np.nan]))
    left, right = figure.axes
    np.testing.assert_allclose(left.lines[0].get_ydata(), [0.4, np.nan, 0.6])
    np.testing.assert_allclose(right.lines[0].get_ydata(), [0.4, 0.4, 0.4])
    assert right.get_ylabel() == "Period (s)" and right.get_xlabel() == "Frequency (Hz)"
    assert next(line for line in left.lines if line.get_gid() == "lost").get_xdata().tolist() == [2.5]


def test_nothing_to_draw():
    with pytest.raises(BadValue, match="a gait was found"):
        sweep_map(dataset({"frequency": [2.6, 2.4]}, [np.nan, np.nan]))
