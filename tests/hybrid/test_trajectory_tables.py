"""Trajectories as tables: what they hold is the trajectory, with its units."""

import sys
from dataclasses import replace

import numpy as np
import pandas
import pytest

from spear_pin import Gait, Trajectory, load, simulate
from spear_pin.errors import BadValue, MissingExtra, SpearError, UnknownName
from spear_pin.hybrid.column_names import heading
from spear_pin.hybrid.trajectory_tables import choose_columns

UNITS = {
    "t": "s",
    "cycle": "",
    "q_boom_z": "m",
    "q_knee": "rad",
    "v_boom_z": "m/s",
    "v_knee": "rad/s",
    "a_boom_z": "m/s²",
    "a_knee": "rad/s²",
    "u_knee": "N·m",
    "tau_hip": "N·m",
    "friction_boom_z": "N",
    "friction_knee": "N·m",
    "spring_knee": "N·m",
    "force_x_toe": "N",
    "force_z_toe": "N",
}


def test_every_column_has_a_unit(hops):
    units = hops.units()
    assert list(units) == hops.columns()[0]
    assert units | UNITS == units


def test_units_that_only_a_lost_robot_knows(hops):
    lost = replace(hops, origin=None, robot="lost.urdf").units()
    assert lost["q_knee"] == "m or rad" and lost["v_knee"] == "m/s or rad/s" and lost["u_knee"] == "N or N·m"
    assert lost["force_z_toe"] == "N"


def test_units_of_a_robot_are_those_of_its_joints():
    assert load("spear_ii").units == ("m", "m", "rad", "rad")
    assert load("q_spear_full").units[:7] == (*3 * ("m",), *3 * ("rad",), "rad")


class TestPandas:
    def test_is_indexed_by_time_and_has_all_columns(self, hops):
        frame = hops.to_pandas()
        names, table = hops.columns()
        np.testing.assert_array_equal(frame.index, hops.t)
        np.testing.assert_array_equal(frame[names[1:]].to_numpy(), table[:, 1:])
        assert frame.columns.is_unique and list(frame.columns)[:3] == ["domain", "phase", "cycle"]
        assert frame["cycle"].dtype == np.int64 and frame["engaged_knee"].dtype == bool
        assert frame["phase"].tolist() == hops.phase.tolist() and frame["domain"].tolist() == hops.domain.tolist()

    def test_has_the_units_of_its_columns(self, hops):
        frame = hops.to_pandas()
        units = frame.attrs["units"]
        assert units["t"] == "s" and units["q_knee"] == "rad"
        assert set(units) == {"t", *frame.columns} - {"domain", "phase", "engaged_knee"}

    def test_is_what_is_in_a_csv_file(self, hops, tmp_path):
        """Of the same columns in the same order, each headed by its unit."""
        frame = hops.in_cycles(1).to_pandas().reset_index()
        read = pandas.read_csv(hops.in_cycles(1).export(tmp_path / "hop.csv"))
        assert list(read)[:5] == ["t [s]", "domain", "phase", "cycle", "q_boom_z [m]"]
        assert list(read) == [heading(name, frame.attrs["units"].get(name, "")) for name in frame]
        # pandas before 3 reads the last digit wrong
        pandas.testing.assert_frame_equal(read.set_axis(list(frame), axis=1), frame, rtol=1e-13, atol=0.0)


@pytest.mark.extra("xarray")
def test_xarray_has_the_arrays_with_names_and_units(hops):
    data = hops.to_xarray()
    np.testing.assert_array_equal(data["q"].sel(coordinate="knee"), hops.q[:, 2])
    np.testing.assert_array_equal(data["force"].sel(toe="toe", axis="z"), hops.force[:, 0, 1])
    np.testing.assert_array_equal(data["engaged"].sel(spring_joint="knee"), hops.engaged[:, 0])
    assert data["t"].attrs["units"] == "s" and data["force"].attrs["units"] == "N"
    assert data["unit"].to_numpy().tolist() == ["m", "rad", "rad"]
    assert data["v"].attrs["units"] == "m/s or rad/s" and "units" not in data["engaged"].attrs
    assert "current" not in data


def test_without_xarray(hops, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MissingExtra, match="sweep"):
        hops.to_xarray()


class TestChosen:
    def test_by_name_and_by_kind(self, hops):
        names = hops.columns()[0]
        assert choose_columns(names, ("q_knee", "u", "q")) == ["q_knee", "u_hip", "u_knee", "q_boom_z", "q_hip"]
        assert choose_columns(names, ("force_z",)) == ["force_z_toe"]

    @pytest.mark.parametrize("name", ["knee", "q_", "current", "force"])
    def test_what_there_is(self, hops, name):
        with pytest.raises(UnknownName, match="nearest of .*'help' in its place lists all"):
            choose_columns(hops.columns()[0], (name,))


class TestRobot:
    def test_of_a_loaded_one(self, hops, tmp_path):
        robot = Trajectory.load(hops.save(tmp_path / "hops.npz")).load_robot()
        assert robot.name == "spear_ii" and robot.locked == ("boom_x",)

    def test_of_one_that_does_not_say_where_from(self, hops):
        assert replace(hops, origin=None).load_robot().coordinates == hops.coordinates

    def test_elsewhere(self, hops):
        assert replace(hops, origin=None, robot="lost.urdf").load_robot("spear_ii").coordinates == hops.coordinates
        with pytest.raises(BadValue, match=r"source is 'q_spear'.*boom_z, hip, knee"):
            hops.load_robot("q_spear")

    def test_lost(self, hops):
        with pytest.raises(SpearError, match="lost.urdf"):
            replace(hops, origin=None, robot="lost.urdf").load_robot()


def test_texts_are_short(hop, hops):
    assert repr(hops).startswith("Trajectory('spear_ii': 11 cycles, 6.2") and len(repr(hops)) < 100
    assert repr(hop) == "Gait(hopping of 'spear_ii': period 0.5643 s, largest multiplier 0.4062, stable)"
    assert repr(Gait.load("long_stride")).endswith("unstable)")
    broken = simulate(hop.system, hop.state, max_evaluations=100)
    assert repr(broken).endswith("evaluation_cap)")
