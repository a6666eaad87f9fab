"""`spear export`: robots for other programs, trajectories as tables, pictures and films, and mistakes."""

import csv
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree
from scipy.io import loadmat

from spear_pin import Gait, load, simulate
from spear_pin.model.loading import ROBOTS
from spear_pin.model.sagittal import sagittal
from spear_pin.viz import chromium
from tests.cli.calls import printed, refused, run, words


@pytest.fixture(scope="module")
def bound(tmp_path_factory):
    """A stride of Q-SPEAR, and the file it is saved in."""
    gait = Gait.load("long_stride")
    stride = simulate(gait.system, gait.state, cycles=1)
    return stride, stride.save(tmp_path_factory.mktemp("bound") / "bound.npz")


class TestRobots:
    def test_files(self, capsys, tmp_path):
        result = printed(capsys, "export", "spear_ii", "--mjcf", "--srdf", "--out", tmp_path)
        assert result["files"] == [str(tmp_path / "spear_ii.xml"), str(tmp_path / "spear_ii.srdf")]
        assert result["mass"] == pytest.approx(6.8) and result["postures"] == ["home", "touchdown"]
        assert sorted(path.name for path in tmp_path.iterdir()) == ["spear_ii.srdf", "spear_ii.xml"]
        q = np.array([0.1, 0.6, 0.5, 1.0])
        model = pin.buildModelFromMJCF(str(tmp_path / "spear_ii.xml"))
        matrix = pin.crba(model, model.createData(), q)
        np.testing.assert_allclose(matrix, load("spear_ii").mass_matrix(q), rtol=0, atol=1e-9)

    @pytest.mark.parametrize(("name", "toe"), [("spear_ii", "toe"), ("q_spear", "posterior_toe")])
    def test_a_leg_stands_at_touchdown(self, capsys, tmp_path, name, toe):
        robot = load(name)
        printed(capsys, "export", name, "--mjcf", "--out", tmp_path)
        key = etree.parse(tmp_path / f"{name}.xml").find(".//key[@name='touchdown']")
        q = np.array(key.get("qpos").split(), dtype=float)
        assert q[-1] != 0.0
        heights = {each: robot.toe_position(q, each)[-1] for each in robot.toes}
        assert heights.pop(toe) == pytest.approx(0.0, abs=1e-9)
        assert all(height > 0.01 for height in heights.values())

    def test_text_and_locked_joints(self, capsys, tmp_path):
        status, out, err = run(capsys, "export", "spear_ii", "--mjcf", "--lock", "boom_x", "--out", tmp_path)
        assert status == 0 and err == "" and "spear_ii, 6.8 kg" in out and "spear_ii.xml" in out
        joints = [each.get("name") for each in etree.parse(tmp_path / "spear_ii.xml").iter("joint")]
        assert joints == ["boom_z", "hip", "knee"]

    def test_a_urdf(self, capsys, tmp_path):
        path = shutil.copy(ROBOTS["q_spear"].path, tmp_path / "mine.urdf")
        result = printed(capsys, "export", path, "--mjcf", "--toes", "anterior_toe", "--out", tmp_path)
        assert result["files"] == [str(tmp_path / "mine.xml")] and result["postures"] == ["home"]
        assert [site.get("name") for site in etree.parse(tmp_path / "mine.xml").iter("site")] == ["anterior_toe"]

    def test_a_plane_and_the_gait_of_one(self, capsys, tmp_path):
        result = printed(capsys, "export", "q_spear_full", "--plane", "--mjcf", "--out", tmp_path)
        assert result["files"] == [str(tmp_path / "q_spear_full_plane.xml")]
        plane = sagittal(load("q_spear_full"))
        q = np.array([0.1, 0.6, 0.2, 0.5, 1.0, -0.4, 0.9])
        gait = Gait.load("long_stride")
        gait.save(tmp_path / "mine.json")
        again = printed(capsys, "export", tmp_path / "mine.json", "--mjcf", "--out", tmp_path)
        assert again["files"] == [str(tmp_path / "mine.xml")] and again["robot"] == gait.system.robot.name
        for name, robot in (("q_spear_full_plane", plane), ("mine", gait.system.robot)):
            model = pin.buildModelFromMJCF(str(tmp_path / f"{name}.xml"))
            matrix = pin.crba(model, model.createData(), q)
            np.testing.assert_allclose(matrix, robot.mass_matrix(q), rtol=0, atol=1e-9)

    def test_parts_that_do_not_fit(self, capsys, tmp_path):
        path = Gait.load("long_stride").save(tmp_path / "mine.json")
        for options, part in (
            (["--plane"], "--plane is True"),
            (["--lock", "boom_x"], "a saved gait already has these options"),
        ):
            assert part in refused(capsys, "export", path, "--mjcf", *options, "--out", tmp_path)
        text = refused(capsys, "export", "q_spear_full", "--plane", "--mjcf", "--srdf", "--out", tmp_path)
        assert "out of which it is cut" in text and "MJCF needs none" in text
        assert "unknown leg" in refused(capsys, "export", "spear_ii", "--leg", "x", "--mjcf", "--out", tmp_path)
        assert [each.name for each in tmp_path.iterdir()] == ["mine.json"]


class TestControllers:
    @pytest.mark.extra("casadi")
    def test_files(self, capsys, tmp_path):
        path = Gait.load("long_stride").save(tmp_path / "bound.json")
        result = printed(capsys, "export", path, "--c", tmp_path / "c")
        names = ["controller.h", "controller.c", "test.c", "README.md"]
        assert result["files"] == [str(tmp_path / "c" / name) for name in names]
        assert sorted(path.name for path in (tmp_path / "c").iterdir()) == sorted(names)

    def test_parts_that_do_not_fit(self, capsys, tmp_path):
        path = Gait.load("long_stride").save(tmp_path / "bound.json")
        assert "--mjcf" in refused(capsys, "export", path, "--c", tmp_path / "c", "--mjcf")
        assert "--leg is 'x'" in refused(capsys, "export", path, "--c", tmp_path / "c", "--leg", "x")
        assert "--rows is 100.0" in refused(capsys, "export", path, "--c", tmp_path / "c", "--rows", "100")
        assert ".csv, .npz, .mcap" in refused(capsys, "export", path, "--table", tmp_path / "a.txt")
        assert "rate is 0.0" in refused(capsys, "export", path, "--table", tmp_path / "a.csv", "--rows", "0")
        trot = Gait.load("trot").save(tmp_path / "trot.json")
        assert "gait is 'trotting'" in refused(capsys, "export", trot, "--c", tmp_path / "c")
        assert not (tmp_path / "c").exists()

    def test_a_table(self, capsys, tmp_path):
        path, table = Gait.load("long_stride").save(tmp_path / "bound.json"), tmp_path / "bound.csv"
        result = printed(capsys, "export", path, "--table", table, "--rows", "20")
        assert result["files"] == [str(table)] and len(table.read_text().splitlines()) == 9


class TestTrajectories:
    def test_tables(self, capsys, tmp_path, bound):
        stride, path = bound
        result = printed(capsys, "export", path, "--csv", "--mat", "--out", tmp_path)
        assert result["files"] == [str(tmp_path / "bound.csv"), str(tmp_path / "bound.mat")]
        assert (result["robot"], result["samples"]) == ("q_spear", len(stride.t))
        with (tmp_path / "bound.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert [float(row["q_pitch [rad]"]) for row in rows] == stride.q[:, 2].tolist()
        np.testing.assert_array_equal(loadmat(tmp_path / "bound.mat")["q"], stride.q)

    @pytest.mark.extra("mcap", "mcap_protobuf", "foxglove_schemas_protobuf")
    def test_a_log(self, capsys, tmp_path, bound):
        result = printed(capsys, "export", bound[1], "--mcap", "--out", tmp_path)
        assert result["files"] == [str(tmp_path / "bound.mcap")]
        assert (tmp_path / "bound.mcap").read_bytes()[:5] == b"\x89MCAP"
        assert [path.name for path in tmp_path.iterdir()] == ["bound.mcap"]

    @pytest.mark.slow
    @pytest.mark.browser
    @pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
    def test_a_picture_of_a_robot_that_is_given(self, capsys, tmp_path, bound):
        stride, _ = bound
        path = replace(stride, robot="gone/mine.urdf", origin=None).save(tmp_path / "run.npz")
        asked = "export", path, "--png", "--size", "320x180", "--time", "0.1", "--out", tmp_path
        assert "run.npz: its robot is not found" in refused(capsys, *asked)
        assert printed(capsys, *asked, "--robot", "q_spear")["files"] == [str(tmp_path / "run.png")]
        assert (tmp_path / "run.png").read_bytes()[16:24] == b"\0\0\1\x40\0\0\0\xb4"

    @pytest.mark.slow
    @pytest.mark.browser
    @pytest.mark.skipif(not (chromium.find() and shutil.which("ffmpeg")), reason="no Chromium or no ffmpeg here")
    def test_a_film(self, tmp_path, bound):
        options = ["--size", "320x180", "--fps", "5", "--out", str(tmp_path)]
        command = [sys.executable, "-m", "spear_pin", "export", str(bound[1]), "--mp4", *options]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0 and done.stderr == "", done.stderr
        assert (tmp_path / "bound.mp4").read_bytes()[4:8] == b"ftyp"
        assert [path.name for path in tmp_path.iterdir()] == ["bound.mp4"]


class TestMistakes:
    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["spear_ii"], ["spear_ii is a robot", "choose what to write: --mjcf, --srdf"]),
            (["hop.npz"], ["hop.npz is a trajectory", "choose what to write: --csv, --mat, --mcap, --png, --mp4"]),
            (["hop.html", "--png"], ["hop.html", "neither a robot nor a saved trajectory (.npz)"]),
            (["mine.urdf", "--png"], ["format is '--png'", "expected a format for a robot"]),
            (["spear_ii", "--csv"], ["format is '--csv'", "expected a format for a robot"]),
            (["spear_iii", "--mjcf"], ["unknown robot 'spear_iii'"]),
            (["spear_ii", "--srdf", "--lock", "boom_x"], ["robot is", "nothing locked"]),
            (["spear_ii", "--mjcf", "--lock", "ankle"], ["unknown joint 'ankle'"]),
            (["spear_ii", "--mjcf", "--time", "1"], ["--time is 1.0", "--png"]),
            (["spear_ii", "--mjcf", "--out", "nowhere"], ["--out", "nowhere"]),
            (["spear_ii", "--c", "new"], ["--c is 'new'", "a saved gait (.json), not with spear_ii"]),
            (["spear_ii", "--table", "new.csv"], ["--table is 'new.csv'", "a saved gait (.json)"]),
            (["spear_ii", "--mjcf", "--rows", "10"], ["--rows is 10.0", "--table"]),
            (["missing.json", "--c", "new"], ["missing.json"]),
            (["missing.urdf", "--mjcf"], ["missing.urdf"]),
            (["missing.npz", "--csv"], ["missing.npz"]),
        ],
        ids=words,
    )
    def test_arguments(self, capsys, tmp_path, monkeypatch, arguments, parts):
        monkeypatch.chdir(tmp_path)
        text = refused(capsys, "export", *arguments)
        assert all(part in text for part in parts), text
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--mjcf"], ["format is '--mjcf'", "a format for a trajectory: --csv, --mat, --mcap, --png, --mp4"]),
            (["--csv", "--fps", "10"], ["--fps is 10.0", "--mp4"]),
            (["--png", "--size", "wide"], ["--size", "WIDTHxHEIGHT"]),
            (["--png", "--size", "9x9"], ["size", "64 to 4096"]),
            (["--png", "--time", "99"], ["time is 99.0"]),
            (["--png", "--robot", "spear_ii"], ["--robot is 'spear_ii'", "torso_x"]),
            (["--mp4", "--speed", "0"], ["speed is 0.0"]),
        ],
        ids=words,
    )
    def test_of_trajectories(self, capsys, tmp_path, bound, arguments, parts):
        text = refused(capsys, "export", bound[1], *arguments, "--out", tmp_path)
        assert all(part in text for part in parts), text
        assert list(tmp_path.iterdir()) == []
