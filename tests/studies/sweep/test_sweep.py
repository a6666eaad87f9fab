"""Sweeps: the same dataset wherever and however often broken off it was made, and what is refused."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, find_gait, hopping, load
from spear_pin.errors import BadFile, BadValue, MissingExtra, UnknownName
from spear_pin.gaits import lane_cycles
from spear_pin.hybrid.brakes import Brake, with_brakes
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import change_system, with_hardware
from spear_pin.studies.hardware import Rig
from spear_pin.studies.sweep import chunks, grid, reasons, sample, store, sweep, table

# workers, which compile as it ships, are held to the bit against what is computed here
pytestmark = [pytest.mark.extra("heyoka", "joblib", "xarray", "zarr"), pytest.mark.optimised]

ROOT = Path(__file__).parents[3]
POINTS = grid({"stiffness": np.linspace(46.0, 52.0, 12), "knee_ratio": [15.0, 14.0]})
ASKED = {"vary": ["stance_torque"], "target": {"flight_time": 0.2}, "chunk": 3}


@dataclass(frozen=True)
class Shared:
    """A change: in stance the knee's motor gives a part of what its law says."""

    part: float

    def __call__(self, system):
        def shared(domain):
            own = domain.law

            def law(t, q, v, held, p, dyn, ops):
                hip, knee = own(t, q, v, held, p, dyn, ops)
                return hip, self.part * knee

            return replace(domain, law=law) if domain.phase == "stance" else domain

        return replace(system, domains=tuple(map(shared, system.domains)))


SCRIPT = """
import sys
from spear_pin import hopping, load
from spear_pin.studies.sweep import sweep
from tests.studies.sweep.test_sweep import ASKED, POINTS

if __name__ == "__main__":
    sweep(hopping(load("spear_ii", locked=["boom_x"])), POINTS, sys.argv[1], **ASKED, resume=True)
"""


@pytest.fixture(scope="module")
def system():
    return hopping(load("spear_ii", locked=["boom_x"]))


@pytest.fixture(scope="module")
def whole(system, tmp_path_factory):
    """The sweep, not interrupted."""
    return sweep(system, POINTS, tmp_path_factory.mktemp("sweep") / "whole.zarr", **ASKED)


def bytes_of(folder):
    """Every file of a store."""
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class TestPoints:
    def test_grid(self):
        points = grid({"a": [1.0, 2.0], "b": 3.0, "c": [4.0, 5.0]})
        assert {name: values.tolist() for name, values in points.items()} == {
            "a": [1.0, 1.0, 2.0, 2.0],
            "b": [3.0] * 4,
            "c": [4.0, 5.0] * 2,
        }

    @pytest.mark.parametrize("method", ["sobol", "latin"])
    def test_sample(self, method):
        points = sample({"a": (1.0, 2.0), "b": (-3.0, 5.0)}, 10, method, seed=4)
        assert all(1.0 <= a <= 2.0 for a in points["a"]) and all(-3.0 <= b <= 5.0 for b in points["b"])
        again, other = (sample({"a": (1.0, 2.0), "b": (-3.0, 5.0)}, 10, method, seed)["b"] for seed in (4, 5))
        np.testing.assert_array_equal(again, points["b"])
        assert (other != again).all()

    def test_refuse(self):
        with pytest.raises(UnknownName, match="sobol, latin"):
            sample({"a": (1.0, 2.0)}, 3, "random")
        for ranges, n in (({"a": (2.0, 1.0)}, 3), ({"a": (1.0, np.inf)}, 3), ({"a": (1.0, 2.0)}, 0)):
            with pytest.raises(BadValue):
                sample(ranges, n)


class TestDataset:
    def test_keeps_what_was_changed_in_the_system(self, system, tmp_path):
        """It would answer the hop without it."""
        shared, points = change_system(system, Shared(0.9)), {"stiffness": [system.spring.stiffness]}
        alone = find_gait(shared, ["stance_torque"], {"flight_time": 0.2})
        found = sweep(replace(shared, phase_limit=2.0), points, tmp_path / "shared.zarr", **ASKED)
        torque = float(found["stance_torque"][0])
        assert torque == pytest.approx(alone.parameters["stance_torque"], abs=1e-6)
        assert 0.9 * torque == pytest.approx(
            float(sweep(system, points, tmp_path / "own.zarr", **ASKED)["stance_torque"][0])
        )
        for other in (shared, replace(change_system(system, Shared(0.8)), phase_limit=2.0)):
            with pytest.raises(BadFile, match="another"):
                sweep(other, points, tmp_path / "shared.zarr", **ASKED, resume=True)

    def test_refuses_a_builder_without_a_name(self, system, tmp_path):
        unnamed = replace(system, build=lambda *parts, **named: hopping(*parts, **named))
        with pytest.raises(BadValue, match="a function with a name"):
            sweep(unnamed, grid({"stiffness": [50.0]}), tmp_path / "points.zarr")

    def test_refuses_what_cannot_be_carried(self, system, tmp_path):
        for other, told in (
            (change_system(system, lambda built: built), "dataclass"),
            (replace(system, domains=tuple(reversed(system.domains))), "change_system"),
            (with_dry_friction(system, {"hip": 0.1}), "dry friction"),
            (with_brakes(system, {"knee": Brake(1.0, ("flight",), until=lambda *_: 1.0)}), "without `when`"),
            (replace(system, measures={**system.measures, "nothing": lambda run: 0.0}), "measures"),
        ):
            with pytest.raises(BadValue, match=told):
                sweep(other, {"stiffness": [50.0]}, tmp_path / "other.zarr", **ASKED)
        assert not list(tmp_path.iterdir())

    def test_has_a_row_for_each_point(self, whole):
        assert dict(whole.sizes) == {"point": 24, "coordinate": 3, "multiplier": 4, "phase": 2}
        assert whole["knee_ratio"].to_numpy().tolist() == [14.0] * 12 + [15.0] * 12  # a robot's points together
        assert set(reasons(whole)) == {"converged"} and bool(whole["stable"].all())
        flight = whole["duration"][:, whole.attrs["phases"].index("flight")]
        np.testing.assert_allclose(flight, 0.2, atol=1e-9)
        table = whole.set_index(point=["knee_ratio", "stiffness"]).unstack("point")
        assert table["stance_torque"].shape == (2, 12)
        assert (table["stance_torque"][1] > table["stance_torque"][0]).all()

    def test_is_a_table_that_shows_itself(self, whole):
        shown = table(whole)
        assert shown.converged.all() and shown.stable.all() and len(shown) == whole.sizes["point"]
        np.testing.assert_array_equal(shown.largest, whole["largest_multiplier"])
        np.testing.assert_array_equal(
            shown.durations["flight"], whole["duration"][:, list(whole.attrs["phases"]).index("flight")]
        )
        assert set(shown.parameters) == {*whole.attrs["names"], *whole.attrs["vary"]}
        assert "Gaits" in shown._repr_html_()

    def test_is_what_one_search_finds(self, system, hop, tmp_path):
        found = sweep(system, {"stiffness": [48.84]}, tmp_path / "one.zarr", ["stance_torque"], {"flight_time": 0.2})
        assert float(found["stance_torque"][0]) == pytest.approx(hop.parameters["stance_torque"], abs=1e-7)
        assert float(found["largest_multiplier"][0]) == pytest.approx(abs(hop.multipliers[0]), abs=1e-6)

    def test_keeps_the_limits(self, system, tmp_path):
        hurried = replace(system, phase_limit=0.3)  # stance takes 0.36 s
        found = sweep(hurried, {"stance_torque": [7.8]}, tmp_path / "hurried.zarr")
        assert reasons(found).tolist() == ["no_event"]

    def test_failures_are_rows(self, system, tmp_path):
        points = {"stance_torque": [7.8, -1.0, 7.8, 7.8], "knee_ratio": [15.0, 15.0, -2.0, 15.0]}
        found = sweep(system, points, tmp_path / "bad.zarr")
        assert reasons(found).tolist() == ["not_valid", "converged", "not_valid", "converged"]
        assert np.isnan(found["q"][0]).all() and found["stable"].to_numpy().tolist() == [False, True, False, True]

    def test_targets_may_be_swept(self, system, tmp_path):
        found = sweep(system, {"flight_time": [0.2, 0.21]}, tmp_path / "targets.zarr", ["stance_torque"])
        np.testing.assert_allclose(found["duration"].sum("phase"), found["duration"][:, 0] + [0.2, 0.21], atol=1e-9)


class TestInterrupted:
    @pytest.mark.slow
    def test_killed_twice(self, whole, tmp_path):
        script, out = tmp_path / "run.py", tmp_path / "whole.zarr"
        script.write_text(SCRIPT)
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        rng, parts = np.random.default_rng(), store.parts(out)
        stamps = {}
        for kill in range(1, 3):
            process = subprocess.Popen([sys.executable, str(script), str(out)], env=environment, cwd=tmp_path)
            deadline = time.monotonic() + 60.0
            while len(list(parts.glob("[0-9]*.npz"))) < 2 * kill and process.poll() is None:
                assert time.monotonic() < deadline
                time.sleep(0.001)
            time.sleep(rng.uniform(0.0, 0.1))
            process.send_signal(signal.SIGKILL)
            process.wait()
            for path in parts.glob("[0-9]*.npz"):
                assert stamps.setdefault(path.name, path.stat().st_mtime_ns) == path.stat().st_mtime_ns, "solved again"
        subprocess.run([sys.executable, str(script), str(out)], env=environment, cwd=tmp_path, check=True)
        assert store.read(out).identical(whole)
        assert sorted(path.name for path in tmp_path.iterdir()) == ["run.py", "whole.zarr"]

    def stopped(self, system, out):
        """Breaks the sweep off after three chunks."""

        class Stop(Exception):
            pass

        def stop(done, total):
            if done == 9:
                raise Stop

        with pytest.raises(Stop):
            sweep(system, POINTS, out, **ASKED, on_points=stop)
        assert not out.exists()

    def test_goes_on_where_it_was(self, system, whole, tmp_path, monkeypatch):
        out, told = tmp_path / "whole.zarr", []
        self.stopped(system, out)
        found = sweep(system, POINTS, out, **ASKED, resume=True, on_points=lambda *counts: told.append(counts))
        assert told[0] == (9, 24) and told[-1] == (24, 24) and len(told) == 6
        assert found.identical(whole) and not store.parts(out).exists()
        monkeypatch.setattr(chunks, "_solve", None)
        assert sweep(system, POINTS, out, **ASKED, resume=True).identical(whole)  # nothing is left to do

    def test_goes_on_by_exact_jacobians(self, system, whole, tmp_path, monkeypatch):
        """As one does that was begun when all Jacobians were differences."""
        self.stopped(system, tmp_path / "whole.zarr")
        monkeypatch.setattr(lane_cycles, "is_unrolled", lambda system: False)
        found = sweep(system, POINTS, tmp_path / "whole.zarr", **ASKED, resume=True)
        np.testing.assert_array_equal(found["reason"], whole["reason"])
        for name, near in (("q", 1e-9), ("v", 1e-8), ("largest_multiplier", 1e-6)):
            same = np.isclose(found[name], whole[name], rtol=0, atol=near, equal_nan=True)
            assert same.all()
            assert (found[name][:9] == whole[name][:9]).all()
        assert not found.identical(whole)

    def test_refuses_another_request(self, system, whole, tmp_path):
        out = tmp_path / "other.zarr"
        with pytest.raises(KeyError):
            sweep(system, POINTS, out, **ASKED, on_points=_raise)
        with pytest.raises(BadFile, match="unfinished sweep; resume it"):
            sweep(system, POINTS, out, **ASKED)
        with pytest.raises(BadFile, match="differs in target, rtol; give another path"):
            sweep(system, POINTS, out, **{**ASKED, "target": {"flight_time": 0.21}}, rtol=1e-8, resume=True)
        with pytest.raises(BadFile, match="differs in spring"):
            stiff = hopping(system.robot, spring=Gait.load("long_stride").system.spring)
            sweep(stiff, POINTS, out, **ASKED, resume=True)
        for damaged in ("{}", "[]", '{"request": 3}', '{"request": {"chunk": NaN}}', "[" * 99999):
            (store.parts(out) / "manifest.json").write_text(damaged)
            with pytest.raises(BadFile, match="is not the manifest of a sweep"):
                sweep(system, POINTS, out, **ASKED, resume=True)

    @pytest.mark.parametrize("damaged", [b"", b"PK", b"no rows"])
    def test_refuses_a_part_that_is_damaged(self, tmp_path, damaged):
        out = tmp_path / "map.zarr"
        store.begin(out, {}, resume=False)
        (part := store.parts(out) / "000000.npz").write_bytes(damaged)
        with pytest.raises(BadFile, match=f"{part.name}: is no part of a sweep; remove it and resume"):
            store.finish(out, None, {"number": 1}, 1)

    def test_leaves_what_is_there(self, system, whole, tmp_path):
        out = tmp_path / "notes.zarr"
        out.mkdir()
        with pytest.raises(BadFile, match="exists already"):
            sweep(system, POINTS, out, **ASKED)
        with pytest.raises(BadFile, match="is not a sweep"):
            sweep(system, POINTS, out, **ASKED, resume=True)
        assert list(tmp_path.iterdir()) == [out]


class TestWorkers:
    @pytest.mark.slow
    def test_two_do_what_one_does(self, system, whole, tmp_path):
        sweep(system, POINTS, tmp_path / "one.zarr", **ASKED, n_jobs=1)
        sweep(system, POINTS, tmp_path / "two.zarr", **ASKED, n_jobs=2)
        assert bytes_of(tmp_path / "one.zarr") == bytes_of(tmp_path / "two.zarr")
        assert store.read(tmp_path / "two.zarr").identical(whole)

    @pytest.mark.slow
    @pytest.mark.extra("distributed")
    @pytest.mark.filterwarnings("ignore")  # of the cluster, about ports and the lost worker
    def test_a_cluster_that_loses_a_worker(self, system, whole, tmp_path):
        import distributed
        import joblib

        options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "host": "127.0.0.1"}
        killed = []
        with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:

            def lose(done, total):
                if done >= 6 and not killed:
                    killed.append(next(iter(client.run(os.getpid).values())))
                    os.kill(killed[0], signal.SIGKILL)

            with joblib.parallel_config(backend="dask"):
                found = sweep(system, POINTS, tmp_path / "cluster.zarr", **ASKED, on_points=lose)
        assert killed and found.identical(whole)


class TestBadInput:
    def test_points(self, system, tmp_path):
        for points in ({}, {"stiffness": [np.nan]}, {"stiffness": [50.0, 51.0], "damping": [1.0]}):
            with pytest.raises(BadValue, match="^points"):
                sweep(system, points, tmp_path / "a.zarr")
        with pytest.raises(UnknownName, match="unknown parameter 'stiffnes'; nearest of .*: stiffness, "):
            sweep(system, {"stiffnes": [50.0]}, tmp_path / "a.zarr")
        with pytest.raises(UnknownName, match="torso_mass"):
            sweep(system, {"torso_mass": [35.0]}, tmp_path / "a.zarr")
        assert not list(tmp_path.iterdir())

    def test_what_is_asked(self, system, robot, tmp_path):
        points = {"stiffness": [50.0]}
        with pytest.raises(BadValue, match="^target is "):
            sweep(system, points, tmp_path / "a.zarr", ["stance_torque"])
        with pytest.raises(UnknownName, match="target 'hight'"):
            sweep(system, points, tmp_path / "a.zarr", ["stance_torque"], {"hight": 1.0})
        for swept, target in (({}, {"flight_time": 0.03}), ({"flight_time": [0.03]}, {})):
            with pytest.raises(BadValue, match=r"^target flight_time is 0.03; expected a number from 0\.05 to 5"):
                sweep(system, points | swept, tmp_path / "a.zarr", ["stance_torque"], target)
        with pytest.raises(BadValue, match="^vary is 'stiffness'"):
            sweep(system, points, tmp_path / "a.zarr", ["stiffness"], {"flight_time": 0.2})
        with pytest.raises(BadValue, match="^chunk is 0"):
            sweep(system, points, tmp_path / "a.zarr", chunk=0)
        for other in (with_hardware(system, Rig().on(robot)), with_dry_friction(system, {"boom_z": 1.0})):
            with pytest.raises(BadValue, match="^system is 'hopping'; expected one without"):
                sweep(other, points, tmp_path / "a.zarr")

    @pytest.mark.parametrize("package", ["joblib", "xarray", "zarr"])
    def test_without_the_extra(self, system, tmp_path, monkeypatch, package):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(MissingExtra, match=rf"needs {package}.*'\.\[sweep\]'"):
            sweep(system, {"stiffness": [50.0]}, tmp_path / "a.zarr")


def _raise(done, total):
    raise KeyError
