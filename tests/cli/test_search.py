"""`spear search`: what it asks for and says, and one line for every mistake."""

import math
import sys
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits import library
from spear_pin.gaits.collocation import Solution
from tests.cli.calls import printed, refused, run, words


@pytest.fixture
def searched(monkeypatch):
    """Searches that end at once with what ships; what was asked of them."""
    asked = []

    def search(robot, request, **options):
        asked.append((robot, request, options))
        options["on_iteration"](0, 1.0, 2.0)
        values = {"peak torque": np.array([150.0]), "violation": np.array([3.0])}
        solution = Solution(values, 29.6, {"mean speed": 1e-9}, True, "Solve_Succeeded", 42)
        return Gait.load("least_effort"), solution

    monkeypatch.setattr("spear_pin.gaits.optimize.search", search)
    monkeypatch.setattr("spear_pin.gaits.collocation.casadi", lambda: None)
    return asked


class TestSearch:
    def test_the_request_of_a_shipped_gait(self, capsys, tmp_path, searched):
        result = printed(capsys, "search", "--out", tmp_path, "--seed", 3)
        robot, request, options = searched[0]
        assert robot.name == "q_spear" and not robot.varied
        assert request == library.REQUESTS["least_effort"] and options["seed"] == 3
        assert result["shipped"] == "least_effort" and result["distance_from_shipped"] == 0.0
        assert result["objective_value"] == pytest.approx(1480.0) and result["objective_unit"] == "N²·m·s"
        assert result["iterations"] == 42 and result["speed"] == pytest.approx(2.5, abs=1e-6)
        assert result["files"] == [str(tmp_path / "gait.json")]
        assert Gait.load(tmp_path / "gait.json").residual <= 1e-8

    def test_text(self, capsys, tmp_path, searched):
        status, out, err = run(capsys, "search", "--out", tmp_path)
        assert status == 0 and err == ""
        assert "the same gait" in out and "2.5000 m/s" in out and "residual" in out and "56.00 N·m/rad" in out

    def test_options(self, capsys, tmp_path, searched):
        options = ["--speed", 2.6, "--lift-off", "force", "--friction", 0.9, "--clearance", 0.04]
        options += ["--minimum-stride", 0.3, "--minimum-knee-torque", 12, "--hip-torque", 50, "--stiffness-per-leg", 80]
        options += ["--knee-touchdown", 45, "--hip-distance", 0.75, "--hardening-per-leg", 50]
        options += ["--preload-per-leg", 1.5]
        result = printed(capsys, "search", "long_stride", *options, "--out", tmp_path)
        robot, request, given = searched[0]
        wanted = {
            "speed": 2.6,
            "lift_off": "force",
            "friction": 0.9,
            "clearance": 0.04,
            "minimum_stride": 0.3,
            "minimum_knee_torque": 24.0,
            "hip_torque": 100.0,
            "stiffness": 160.0,
            "hardening": 100.0,
            "preload": 3.0,
            "knee_touchdown": math.radians(45.0),
        }
        assert request == replace(library.REQUESTS["long_stride"], **wanted)
        assert robot.varied == {"hip_distance": 0.75}
        assert given["contact"].friction == 0.9
        assert result["shipped"] is None and result["distance_from_shipped"] is None

    def test_a_knee_motor_and_free_springs(self, capsys, tmp_path, searched):
        options = ["--knee-motor", "ec_90_flat_260w", "--ratio", 12, "--bus", 60, "--objective", "violation"]
        options += ["--stiffness-per-leg", "free", "--knee-touchdown", "free"]
        result = printed(capsys, "search", *options, "--out", tmp_path)
        robot, request, _ = searched[0]
        assert request.stiffness is None and request.knee_touchdown is None
        drive = request.knee_drive
        assert (drive.gearbox.ratio, drive.gearbox.efficiency, drive.bus) == (12.0, 0.83, 60.0)
        assert robot.varied == {"knee_ratio": 12.0, "knee_rotor": drive.motor.rotor_inertia}
        assert (result["objective_value"], result["objective_unit"]) == (3.0, "N·m")

    def test_the_largest_torque_is_that_of_a_motor(self, capsys, tmp_path, searched):
        result = printed(capsys, "search", "--objective", "peak", "--out", tmp_path)
        assert (result["objective_value"], result["objective_unit"]) == (75.0, "N·m")


class TestMistakes:
    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["gallop"], ["unknown gait 'gallop'", "least_effort", "long_stride"]),
            (["--objective", "speed"], ["unknown objective 'speed'", "effort_per_distance", "peak"]),
            (["--objective", "electrical"], ["--knee-motor", "electrical"]),
            (["--objective", "violation"], ["--knee-motor", "violation"]),
            (["--knee-motor", "steam"], ["unknown motor 'steam'; nearest of 14: "]),
            (["--knee-motor", "ec_60_flat_150w"], ["torque_constant", "ec_60_flat_150w"]),
            (["--knee-motor", "ec_90_flat_260w", "--ratio", "0"], ["ratio"]),
            (["--knee-motor", "ec_90_flat_260w", "--bus", "-1"], ["bus"]),
            (["--ratio", "12"], ["--knee-motor", "--ratio"]),
            (["--bus", "48"], ["--knee-motor", "--bus"]),
            (["--lift-off", "hop"], ["'hop'", "knee, force"]),
            (["--speed", "0"], ["speed", "m/s"]),
            (["--speed", "nan"], ["speed"]),
            (["--speed", "fast"], ["fast"]),
            (["--speed", "12", "--minimum-stride", "0.5"], ["at most 8 m/s"]),
            (["--friction", "0"], ["friction"]),
            (["--clearance", "-1"], ["clearance"]),
            (["--minimum-stride", "1.2"], ["minimum_stride", "at most 1, in s"]),
            (["--minimum-knee-torque", "-1"], ["--minimum-knee-torque"]),
            (["--hip-torque", "-1"], ["--hip-torque"]),
            (["--stiffness-per-leg", "-5"], ["--stiffness-per-leg", "-5"]),
            (["--stiffness-per-leg", "inf"], ["--stiffness-per-leg", "inf"]),
            (["--stiffness-per-leg", "soft"], ["soft", "free"]),
            (["--hardening-per-leg", "-1"], ["--hardening-per-leg", "-1"]),
            (["--preload-per-leg", "inf"], ["--preload-per-leg", "inf"]),
            (["--knee-touchdown", "0"], ["--knee-touchdown", "degrees"]),
            (["--knee-touchdown", "200"], ["--knee-touchdown", "200"]),
            (["--hip-distance", "0"], ["hip_distance", "in m"]),
            (["--seed", "-1"], ["--seed"]),
            (["--seed", "1.5"], ["1.5"]),
            (["--feedback", "strong"], ["strong", "regulated"]),
            (["--colour", "red"], ["--colour"]),
        ],
        ids=words,
    )
    def test_arguments(self, capsys, tmp_path, monkeypatch, arguments, parts):
        monkeypatch.setattr("spear_pin.gaits.optimize.search", lambda *_, **__: pytest.fail("it was searched"))
        text = refused(capsys, "search", *arguments, "--out", tmp_path)
        assert all(part in text for part in parts), text
        assert not list(tmp_path.iterdir())

    def test_without_casadi(self, capsys, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "casadi", None)
        text = refused(capsys, "search", "--out", tmp_path)
        assert "needs casadi" in text and "pip install '.[optimize]' in the folder" in text

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_nothing_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "search", "--out", tmp_path / place)
