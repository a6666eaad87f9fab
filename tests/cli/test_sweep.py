"""`spear sweep`: what it finds and writes, and one line for every mistake."""

import sys
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, find_gait
from spear_pin.errors import BadFile
from spear_pin.gaits.targets import measures_of
from spear_pin.model.variants import parameters_of
from spear_pin.studies.sweep import store
from tests.cli.calls import printed, refused, run, words

pytestmark = pytest.mark.extra("heyoka", "joblib", "xarray", "zarr")

OVER = ("--over", "stiffness=47:51:3", "--over", "knee_ratio=14,15")


class TestSweep:
    def test_a_grid_of_hops(self, capsys, tmp_path):
        out = tmp_path / "hops.zarr"
        result = printed(capsys, "sweep", "hop", *OVER, "--flight-time", 0.2, "--out", out)
        assert result["points"] == result["converged"] == result["stable"] == 6
        assert result["reasons"] == {"converged": 6} and result["vary"] == ["stance_torque"]
        assert result["files"] == [str(out), str(tmp_path / "hops.svg")]
        dataset = store.read(out)
        np.testing.assert_allclose(np.unique(dataset["stiffness"]), [47.0, 49.0, 51.0])
        again = printed(capsys, "sweep", "hop", *OVER, "--flight-time", 0.2, "--out", out, "--resume")
        assert again == result
        assert "differs in target" in refused(
            capsys, "sweep", "hop", *OVER, "--flight-time", 0.21, "--out", out, "--resume"
        )

    def test_a_sample(self, capsys, tmp_path):
        arguments = ("sweep", "hop", "--over", "stance_torque=7.7:8", "--over", "friction=0.01:0.9", "--seed", 3)
        status, out, err = run(capsys, *arguments, "--sobol", 8, "--out", tmp_path / "a.zarr")
        assert status == 0 and err == "" and "gaits found" in out and "largest multiplier" in out
        dataset = store.read(tmp_path / "a.zarr")
        assert dataset.sizes["point"] == 8 and dataset.attrs["vary"] == []
        run(capsys, *arguments, "--latin", 8, "--out", tmp_path / "b.zarr")
        assert (store.read(tmp_path / "b.zarr")["friction"] != dataset["friction"]).all()

    def test_flight_times(self, capsys, tmp_path):
        arguments = ("sweep", "hop", "--over", "flight_time=0.2,0.21", "--out", tmp_path / "a.zarr")
        assert printed(capsys, *arguments)["vary"] == ["stance_torque"]

    @pytest.mark.parametrize("name", ["trot", "pace", "pronk", "turn_9"])
    def test_asks_the_same_of_gaits_in_space(self, name, capsys, tmp_path, monkeypatch):
        """As of bounds: each begins from its own state, and the hips' torque is solved for the speed."""
        gait, asked = Gait.load(name), {}

        def stop(system, points, out, vary, target, **options):
            asked.update(system=system, points=points, vary=vary, target=target, **options)
            raise BadFile(out, "stops here")

        monkeypatch.setattr("spear_pin.studies.sweep.sweep", stop)
        out = ("--out", tmp_path / "a.zarr")
        refused(capsys, "sweep", name, "--over", "torso_mass=34,36", "--speed", 2, *out)
        assert asked["system"].kind == gait.system.kind and asked["chunk"] is None
        assert (asked["vary"], asked["target"]) == (["posterior_hip_torque"], {"mean_speed": 2.0})
        for given, own in zip(asked["guess"], gait.state, strict=True):
            np.testing.assert_array_equal(given, own)
        refused(capsys, "sweep", name, "--over", "mean_speed=1.9,2", *out)
        assert (asked["vary"], asked["target"]) == (["posterior_hip_torque"], {})

    @pytest.mark.slow
    def test_trots(self, capsys, tmp_path):
        """Each point is what one search finds, it is stored by itself, and the Python lines name the start."""
        gait = Gait.load("trot")
        result = printed(capsys, "sweep", "trot", "--over", "mean_speed=1.98,2.02", "--out", tmp_path / "a.zarr")
        assert result["converged"] == 2 and result["vary"] == ["posterior_hip_torque"]
        assert "guess=gait.state" in result["python"] and (tmp_path / "a.svg").exists()
        dataset = store.read(tmp_path / "a.zarr")
        alone = find_gait(gait.system, ["posterior_hip_torque"], {"mean_speed": 2.02}, guess=gait.state)
        assert float(dataset["posterior_hip_torque"][1]) == pytest.approx(
            alone.parameters["posterior_hip_torque"], abs=1e-6
        )
        assert float(dataset["largest_multiplier"][1]) == pytest.approx(abs(alone.multipliers[0]), abs=1e-5)

    def test_a_saved_hop(self, capsys, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        arguments = ("sweep", path, "--over", "stiffness=48,50", "--flight-time", 0.2)
        result = printed(capsys, *arguments, "--out", tmp_path / "a.zarr")
        assert result["converged"] == 2 and result["vary"] == ["stance_torque"]

    def test_none_found(self, capsys, tmp_path):
        status, out, _ = run(capsys, "sweep", "hop", "--over", "stance_torque=-1,-2", "--out", tmp_path / "a.zarr")
        assert status == 0 and "2 not_valid" in out and not (tmp_path / "a.svg").exists()


class TestMistakes:
    @pytest.mark.parametrize(
        "arguments",
        [
            ("fly", "--over", "stiffness=1,2"),
            ("hop",),
            ("hop", "--over", "stiffness"),
            ("hop", "--over", "stiffness=a,b"),
            ("hop", "--over", "stiffness=1:2"),
            ("hop", "--over", "stiffness=1:2:1"),
            ("hop", "--over", "stiffness=1:2:2.5"),
            ("hop", "--over", "stiffness=1:2:3,4"),
            ("hop", "--over", "stiffness=1,nan"),
            ("hop", "--over", "stiffness=1,2", "--over", "stiffness=3"),
            ("hop", "--over", "stiffness=1:2:3", "--sobol", "4"),
            ("hop", "--over", "stiffness=2:1", "--sobol", "4"),
            ("hop", "--over", "stiffness=1:2", "--sobol", "0"),
            ("hop", "--over", "stiffness=1:2", "--sobol", "4", "--latin", "4"),
            ("hop", "--over", "stiffness=1:2", "--sobol", "4", "--seed", "-1"),
            ("hop", "--over", "stiffnes=1,2"),
            ("hop", "--over", "torso_mass=30,40"),
            ("hop", "--over", "stiffness=40,50", "--flight-time", "-1"),
            ("hop", "--over", "flight_time=0.2,0.3", "--flight-time", "0.2"),
            ("hop", "--over", "stiffness=40,50", "--speed", "2"),
            ("bound", "--over", "stiffness=40,50", "--flight-time", "0.2"),
            ("hop", "--over", "stiffness=40,50", "--workers", "0"),
            ("hop", "--over", "stiffness=40,50", "--chunk", "0"),
            ("hop", "--over", "stiffness=40,50", "--rtol", "0"),
            ("hop", "--over", "stiffness=40,50", "--out", "sweep.csv"),
            ("hop", "--over", "stiffness=40,50", "--out", "no/where.zarr"),
        ],
        ids=words,
    )
    def test_take_one_line(self, capsys, tmp_path, monkeypatch, arguments):
        monkeypatch.chdir(tmp_path)
        refused(capsys, "sweep", *arguments)
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        ("arguments", "text"),
        [
            (("stiffness=1:2:0",), "a whole NUMBER of values"),
            (("stiffness=46:52",), "--sobol or --latin with a range"),
            (("stiffness=1,2", "--over", "stiffness=3,4"), "each name once"),
            (("help",), "each valid parameter: knee_touchdown, "),
            (("help", "--sobol", "4"), "each valid parameter: knee_touchdown, "),
            (("stiffness=46,52", "--speed", "2"), "only with gaits that travel; for a hop give --flight-time"),
            (("stiffness=46,52", "--flight-time", "0.03"), "flight_time is 0.03; expected a number from 0.05 to 5"),
            (("flight_time=0.2,0.03",), "flight_time is 0.03; expected"),
            (("flight_time=0.03:0.3", "--sobol", "4"), "flight_time is 0.03; expected"),
        ],
        ids=words,
    )
    def test_say_what_is_wrong(self, capsys, tmp_path, monkeypatch, arguments, text):
        monkeypatch.chdir(tmp_path)
        assert text in refused(capsys, "sweep", "hop", "--over", *arguments)

    def test_what_exists_already(self, capsys, tmp_path, monkeypatch):
        monkeypatch.setattr("spear_pin.load", lambda *_, **__: pytest.fail("a robot was loaded"))
        (tmp_path / "a.zarr").mkdir()
        text = refused(capsys, "sweep", "hop", *OVER, "--out", tmp_path / "a.zarr")
        assert "exists already: give another --out, delete it, or --resume" in text

    def test_in_a_folder(self, capsys, tmp_path):
        (tmp_path / "sweep.zarr").mkdir()
        text = refused(capsys, "sweep", "hop", *OVER, "--out", tmp_path)
        assert f"{tmp_path / 'sweep.zarr'}: exists already" in text

    def test_help_lists_all_names(self, capsys, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        system = Gait.load("trot").system
        listed = refused(capsys, "sweep", "trot", "--over", "help")
        assert all(f" {name}" in listed for name in (*parameters_of(system.robot), *measures_of(system)))

    def test_of_a_gait_by_its_name(self, capsys, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        Path("hop.npz").write_bytes(b"")
        assert "is a trajectory; expected a saved gait, a .json file" in refused(capsys, "sweep", "hop.npz", *OVER)
        assert "nearest of 24: bound," in refused(capsys, "sweep", "bounds", *OVER)
        for gait in ("long_stride", "trot"):
            text = refused(capsys, "sweep", gait, *OVER, "--flight-time", "0.2")
            assert "only with a hop; for gaits that travel give --speed" in text
        assert "leave out --speed" in refused(capsys, "sweep", "trot", "--over", "period=0.2,0.3", "--speed", "2")
        assert "mean_speed is -1.0; expected a number > 0" in refused(
            capsys, "sweep", "trot", "--over", "mean_speed=-1,2"
        )

    def test_of_what_is_not_installed(self, capsys, tmp_path, monkeypatch):
        """One extra has everything, and a mistake needs none."""
        monkeypatch.setitem(sys.modules, "heyoka", None)
        monkeypatch.setitem(sys.modules, "xarray", None)
        monkeypatch.chdir(tmp_path)
        assert "'.[sweep]'" in refused(capsys, "sweep", "hop", *OVER)
        assert "unknown parameter 'stiffnes'" in refused(capsys, "sweep", "hop", "--over", "stiffnes=1,2")
        assert "flight_time is 0.03" in refused(capsys, "sweep", "hop", *OVER, "--flight-time", "0.03")

    def test_of_a_disk(self, capsys, tmp_path, monkeypatch):
        def full(*_):
            raise BadFile("sweep.zarr", "cannot be written: no space left on device")

        monkeypatch.setattr(store, "keep", full)
        assert "no space left" in refused(capsys, "sweep", "hop", *OVER, "--out", tmp_path / "a.zarr")
