"""The command line: what it prints, what it writes, and one line for every mistake."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, Trajectory, load
from spear_pin.cli import main
from spear_pin.errors import NoGait
from spear_pin.gaits import library
from spear_pin.gaits.collocation import Solution
from spear_pin.model.loading import ROBOTS
from tests.lagrangian import monopod

STATE = [0.1, 0.55, 0.5, 1.0], [0.2, -0.4, 1.5, -2.5]


def words(value):
    """The name of a test case, from a list of arguments."""
    return " ".join(value) if isinstance(value, (list, tuple)) else ""


def run(capsys, *arguments):
    """Status, stdout and stderr of a command."""
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as stop:
        status = stop.code
    return status, *capsys.readouterr()


def printed(capsys, *arguments):
    """The JSON object a command prints."""
    status, out, err = run(capsys, *arguments, "--json")
    assert status == 0, err
    assert out.count("\n") == 1
    return json.loads(out)


def refused(capsys, *arguments):
    """The one line of a command that fails."""
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1 and err.endswith("\n") and len(err) > 20
    assert "Traceback" not in err
    return err


@pytest.fixture(scope="module")
def hop_run(tmp_path_factory):
    """`spear hop --json` as a process, and the folder it wrote into."""
    folder = tmp_path_factory.mktemp("hop")
    command = [sys.executable, "-m", "spear_pin", "hop", "--json", "--out", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[1]), folder


class TestRobots:
    def test_text(self, capsys):
        status, out, err = run(capsys, "robots")
        assert status == 0 and err == ""
        assert all(name in out for name in ROBOTS)
        assert "6.80 kg" in out and "43.76 kg" in out

    def test_json(self, capsys):
        rows = {row["name"]: row for row in printed(capsys, "robots")["robots"]}
        assert set(rows) == set(ROBOTS)
        assert rows["spear_ii"]["degrees_of_freedom"] == 4 and rows["spear_ii"]["motors"] == 2
        assert rows["q_spear"]["degrees_of_freedom"] == 7 and rows["q_spear"]["motors"] == 4
        assert rows["spear_ii"]["mass"] == pytest.approx(6.8)
        assert rows["spear_ii"]["coordinates"] == ["boom_x", "boom_z", "hip", "knee"]


class TestDynamics:
    def test_values(self, capsys):
        result = printed(capsys, "dynamics", "spear_ii", "--q", *STATE[0], "--v", *STATE[1])
        terms = monopod().terms(*STATE)
        np.testing.assert_allclose(result["D"], terms.mass_matrix, rtol=0, atol=1e-12)
        np.testing.assert_allclose(np.array(result["C"]) @ STATE[1], terms.coriolis, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["G"], terms.gravity, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["bias"], terms.coriolis + terms.gravity, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["J"]["toe"], terms.jacobians["toe"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["J_dot_v"]["toe"], terms.drifts["toe"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["toe_position"]["toe"], terms.toes["toe"], rtol=0, atol=1e-12)
        assert result["B"] == [[0, 0], [0, 0], [1, 0], [0, 1]]
        assert (result["q"], result["v"]) == STATE

    def test_text(self, capsys):
        status, out, err = run(capsys, "dynamics", "spear_ii", "--q", *STATE[0])
        assert status == 0 and err == ""
        assert out.startswith("spear_ii: boom_x, boom_z, hip, knee  (SI units, radians)")
        for name in ("D =", "C =", "G =", "J toe =", "J_dot_v toe =", "toe_position toe ="):
            assert name in out
        assert f"{monopod().terms(*STATE).mass_matrix[2, 2]:.6f}".rstrip("0") in out

    def test_zero_is_the_default(self, capsys):
        result = printed(capsys, "dynamics", "q_spear")
        assert result["q"] == result["v"] == [0.0] * 7

    @pytest.mark.parametrize("number", ["-0.5", "-.5", "-5e-1", "-5E-1"])
    def test_negative_numbers(self, capsys, number):
        result = printed(capsys, "dynamics", "spear_ii", "--q", "0", number, "0.5", "1", "--v", number, "0", "0", "0")
        assert result["q"] == [0.0, -0.5, 0.5, 1.0] and result["v"] == [-0.5, 0.0, 0.0, 0.0]

    def test_lock(self, capsys):
        result = printed(capsys, "dynamics", "spear_ii", "--lock", "boom_x", "boom_z", "--q", "0.5", "1")
        assert result["coordinates"] == ["hip", "knee"]
        np.testing.assert_allclose(result["D"], monopod().terms(*STATE).mass_matrix[2:, 2:], rtol=0, atol=1e-12)

    def test_a_urdf(self, capsys):
        result = printed(capsys, "dynamics", ROBOTS["spear_ii"].path, "--toes", "toe", "--q", *STATE[0])
        np.testing.assert_allclose(result["D"], load("spear_ii").mass_matrix(STATE[0]), rtol=1e-15)
        assert list(result["J"]) == ["toe"]


class TestHop:
    def test_figures(self, hop_run):
        process, folder = hop_run
        assert process.returncode == 0, process.stderr
        assert process.stderr == "" and process.stdout.count("\n") == 1
        result = json.loads(process.stdout)
        assert {
            "stance_torque",
            "flight_time",
            "stance_time",
            "residual",
            "multipliers",
            "apex_height",
            "peak_force",
            "energy_residual",
            "spring_share",
        } <= set(result)
        assert result["stance_torque"] == pytest.approx(7.826, abs=1e-3)
        assert result["flight_time"] == pytest.approx(0.2, abs=1e-8)
        assert result["stance_time"] == pytest.approx(0.3643, abs=1e-4)
        assert result["residual"] <= 1e-9
        assert [abs(complex(*value)) for value in result["multipliers"]] == pytest.approx(
            [0.406, 0.235, 0.235], abs=1e-3
        )
        assert result["stable"] is True
        assert result["apex_height"] == pytest.approx(0.612, abs=1e-3)
        assert result["energy_residual"] <= 1e-8
        assert result["spring_share"] == pytest.approx(0.70, abs=0.01)
        assert (result["cycles"], result["reason"]) == (11, "complete")
        assert "text" not in result

    def test_files(self, hop_run):
        process, folder = hop_run
        assert sorted(path.name for path in folder.iterdir()) == ["hop.html", "hop.npz"]
        assert json.loads(process.stdout)["files"] == [str(folder / "hop.html"), str(folder / "hop.npz")]
        trajectory = Trajectory.load(folder / "hop.npz")
        assert trajectory.complete and trajectory.cycles == 11
        assert trajectory.coordinates == ("boom_z", "hip", "knee")
        page = (folder / "hop.html").read_text(encoding="utf-8")
        assert page.lstrip().lower().startswith("<!doctype html>") and "</html>" in page

    def test_text_and_options(self, capsys, tmp_path):
        options = ["--stance-torque", 8.2, "--knee", 0.95, "--frequency", 2.6, "--stiffness", 50, "--friction", 0.9]
        status, out, err = run(capsys, "hop", *options, "--cycles", 2, "--rtol", 1e-8, "--out", tmp_path)
        assert status == 0, err
        assert "8.2000 N·m" in out and "stable" in out and "2 hops (complete)" in out
        assert str(tmp_path / "hop.html") in out and str(tmp_path / "hop.npz") in out
        trajectory = Trajectory.load(tmp_path / "hop.npz")
        assert trajectory.cycles == 2
        stance, flight = (trajectory.phase == phase for phase in ("stance", "flight"))
        assert np.abs(trajectory.u[stance, 1]).max() == 8.2
        assert trajectory.named("torque_switch")[0].time == pytest.approx(0.5 / 2.6)
        np.testing.assert_allclose(
            trajectory.u[flight, 1],
            63.25 * (0.95 - trajectory.q[flight, 2]) - 0.52 * trajectory.v[flight, 2],
            atol=1e-9,
        )
        compression = np.maximum(trajectory.q[stance, 2] - trajectory.q[0, 2], 0)[:50]
        np.testing.assert_allclose(trajectory.spring[stance, 0][:50], -50 * compression, atol=1e-9)
        sliding = np.char.startswith(trajectory.domain, "stance slip")
        np.testing.assert_allclose(
            np.abs(trajectory.force[sliding, 0, 0]), 0.9 * trajectory.force[sliding, 0, 1], rtol=1e-9, atol=1e-9
        )

    def test_free(self, capsys, tmp_path):
        """The hip angle is solved for no drift, and foot placement stabilises it."""
        arguments = ["hop", "--free-x", "--cycles", 1, "--out", tmp_path]
        result = printed(capsys, *arguments)
        assert len(result["multipliers"]) == 4 and result["stable"] is False
        assert result["flight_time"] == pytest.approx(0.2, abs=1e-8)
        trajectory = Trajectory.load(tmp_path / "hop.npz")
        assert trajectory.coordinates[0] == "boom_x"
        assert trajectory.q[-1, 0] == pytest.approx(trajectory.q[0, 0], abs=1e-8)
        placed = printed(capsys, *arguments, "--foot-placement", 0.15)
        assert placed["stable"] is True


@pytest.fixture(scope="module")
def bound_run(tmp_path_factory):
    """`spear bound --json` as a process, and the folder it wrote into."""
    folder = tmp_path_factory.mktemp("bound")
    command = [sys.executable, "-m", "spear_pin", "bound", "--json", "--cycles", "2", "--out", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[1]), folder


class TestBound:
    def test_figures(self, bound_run):
        process, folder = bound_run
        assert process.returncode == 0, process.stderr
        assert process.stderr == "" and process.stdout.count("\n") == 1
        result = json.loads(process.stdout)
        assert {
            "gait",
            "speed",
            "stride",
            "period",
            "durations",
            "lift_off",
            "lift_off_force",
            "residual",
            "multipliers",
            "friction_used",
            "friction_at_impact",
            "clearance",
            "peak_torque_stance",
            "peak_torque_swing",
            "net_joint_work",
            "energy_balance",
            "cost_of_transport",
            "effort",
        } <= set(result)
        assert result["gait"] == "long_stride"
        assert result["speed"] == pytest.approx(2.5, abs=1e-6)
        assert result["residual"] <= 1e-8 and abs(result["energy_balance"]) <= 1e-6
        assert list(result["durations"]) == ["posterior_stance", "flight_1", "anterior_stance", "flight_2"]
        assert (result["cycles"], result["reason"]) == (2, "complete")
        assert "text" not in result

    def test_files(self, bound_run):
        process, folder = bound_run
        assert sorted(path.name for path in folder.iterdir()) == ["bound.html", "bound.npz"]
        assert json.loads(process.stdout)["files"] == [str(folder / "bound.html"), str(folder / "bound.npz")]
        trajectory = Trajectory.load(folder / "bound.npz")
        assert trajectory.complete and trajectory.cycles == 2
        assert trajectory.toes == ("posterior_toe", "anterior_toe")
        page = folder / "bound.html"
        assert "Q-SPEAR bounding at 2.50 m/s" in page.read_text(encoding="utf-8")
        assert page.stat().st_size < 3_000_000

    @pytest.mark.parametrize(
        ("name", "rule"), [("least_effort", "knee is back at 40°"), ("force_lift_off", "force is zero")]
    )
    def test_text(self, capsys, tmp_path, name, rule):
        status, out, err = run(capsys, "bound", "--gait", name, "--cycles", 1, "--rtol", 1e-8, "--out", tmp_path)
        assert status == 0, err
        assert name in out and rule in out and "2.5000 m/s" in out and "1 strides (complete)" in out
        assert ("in the last ms" in out) == (name == "force_lift_off")
        assert str(tmp_path / "bound.html") in out and str(tmp_path / "bound.npz") in out

    def test_a_saved_gait(self, capsys, tmp_path):
        path = Gait.load("least_effort").save(tmp_path / "mine.json")
        result = printed(capsys, "bound", "--gait", path, "--cycles", 1, "--out", tmp_path)
        assert result["gait"] == str(path) and result["speed"] == pytest.approx(2.5, abs=1e-6)

    def test_list(self, capsys, tmp_path):
        rows = {row["name"]: row for row in printed(capsys, "bound", "--list")["gaits"]}
        assert {"least_effort", "long_stride", "force_lift_off"} <= set(rows)
        assert rows["long_stride"]["speed"] == pytest.approx(2.5, abs=1e-6)
        assert rows["force_lift_off"]["lift_off"] == "force"
        assert all(row["residual"] <= 1e-8 and row["largest_multiplier"] > 0 for row in rows.values())
        status, out, err = run(capsys, "bound", "--list", "--out", tmp_path)
        assert status == 0 and err == "" and not list(tmp_path.iterdir())
        assert all(name in out for name in rows) and "2.50 m/s" in out

    @pytest.mark.parametrize(
        ("speed", "start"), [(2.6, "long_stride"), (2.9, "long_stride_3.00"), (4, "long_stride_3.5")]
    )
    @pytest.mark.parametrize("asked", ["long_stride", "long_stride_3.00"])
    def test_continues_the_nearest_of_its_family(self, capsys, tmp_path, monkeypatch, asked, speed, start):
        source = library.path("long_stride")
        family = ("least_effort", "long_stride", "long_stride_3.00", "long_stride_3.5", "long_stride_x_4.00")
        monkeypatch.setattr(library, "names", lambda: family)
        monkeypatch.setattr(library, "path", lambda name: source)
        continued = []
        monkeypatch.setattr(
            "spear_pin.studies.bound.at_speed", lambda gait, speed, on_iteration: continued.append(speed) or gait
        )
        arguments = ["bound", "--gait", asked, "--speed", speed, "--cycles", 1, "--out", tmp_path]
        assert printed(capsys, *arguments)["gait"] == start
        assert continued == [speed]


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
        assert result["objective_value"] == pytest.approx(2960.0) and result["objective_unit"] == "N²m²s/m"
        assert result["iterations"] == 42 and result["speed"] == pytest.approx(2.5, abs=1e-6)
        assert result["files"] == [str(tmp_path / "gait.json")]
        assert Gait.load(tmp_path / "gait.json").residual <= 1e-8

    def test_text(self, capsys, tmp_path, searched):
        status, out, err = run(capsys, "search", "--out", tmp_path)
        assert status == 0 and err == ""
        assert "the same gait" in out and "2.5000 m/s" in out and "residual" in out and "56.00 N·m/rad" in out

    def test_options(self, capsys, tmp_path, searched):
        options = ["--speed", 2.6, "--lift-off", "force", "--friction", 0.9, "--clearance", 0.04]
        options += ["--minimum-stride", 0.3, "--minimum-knee-torque", 12, "--hip-torque", 50, "--stiffness", 80]
        options += ["--knee-touchdown", 45, "--hip-distance", 0.75]
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
            "knee_touchdown": math.radians(45.0),
        }
        assert request == replace(library.REQUESTS["long_stride"], **wanted)
        assert robot.varied == {"hip_distance": 0.75}
        assert given["contact"].friction == 0.9
        assert result["shipped"] is None and result["distance_from_shipped"] is None

    def test_a_knee_motor_and_free_springs(self, capsys, tmp_path, searched):
        options = ["--knee-motor", "ec_90_flat_260w", "--ratio", 12, "--bus", 60, "--objective", "violation"]
        options += ["--stiffness", "free", "--knee-touchdown", "free"]
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


class TestDoctor:
    def test_json(self, capsys):
        result = printed(capsys, "doctor")
        assert result["python"] == ".".join(map(str, sys.version_info[:3]))
        assert all(result["packages"][name] for name in ("pin", "numpy", "scipy", "lxml"))
        assert set(result["checks"].values()) == {"ok"}

    def test_text(self, capsys):
        status, out, err = run(capsys, "doctor")
        assert status == 0 and err == ""
        assert "numpy" in out and "one hop: ok" in out and "one stride: ok" in out

    def test_a_check_that_fails(self, capsys, monkeypatch):
        def broken():
            raise RuntimeError("no libpinocchio")

        monkeypatch.setattr("spear_pin.cli._CHECKS", {"dynamics": broken})
        status, out, err = run(capsys, "doctor")
        assert status == 2
        assert "dynamics: FAILED: RuntimeError: no libpinocchio" in out


class TestHelp:
    @pytest.mark.parametrize(
        "command", [(), ("robots",), ("dynamics",), ("hop",), ("bound",), ("search",), ("doctor",)], ids=words
    )
    def test_help(self, capsys, command):
        status, out, err = run(capsys, *command, "--help")
        assert status == 0 and err == ""
        assert out.startswith("usage: spear") and "--help" in out

    def test_lists_the_commands(self, capsys):
        _, out, _ = run(capsys, "--help")
        assert all(command in out for command in ("robots", "dynamics", "hop", "bound", "search", "doctor"))


class TestMistakes:
    def test_an_unknown_robot(self, capsys):
        assert "unknown robot 'spear_iii'; valid: spear_ii, q_spear" in refused(capsys, "dynamics", "spear_iii")

    def test_a_missing_urdf(self, capsys, tmp_path):
        assert "missing.urdf" in refused(capsys, "dynamics", tmp_path / "missing.urdf")

    def test_a_urdf_that_is_none(self, capsys, tmp_path):
        path = tmp_path / "text.urdf"
        path.write_text("no\nxml\nat all")
        assert "text.urdf" in refused(capsys, "dynamics", path)

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--q", "1", "2"], ["q is", "4 numbers (boom_x, boom_z, hip, knee)"]),
            (["--v", "1"], ["v is", "4 numbers"]),
            (["--q", "0", "nan", "0", "0"], ["q[1]", "nan"]),
            (["--q", "0", "0", "0", "inf"], ["q[3]", "inf"]),
            (["--q", "0", "0", "zero", "0"], ["--q", "zero"]),
            (["--q"], ["--q"]),
            (["--lock", "ankle"], ["unknown joint 'ankle'", "boom_x"]),
            (["--toes", "hoof"], ["unknown frame 'hoof'", "toe"]),
            (["--colour", "red"], ["--colour"]),
        ],
        ids=words,
    )
    def test_dynamics(self, capsys, arguments, parts):
        text = refused(capsys, "dynamics", "spear_ii", *arguments)
        assert all(part in text for part in parts), text

    @pytest.mark.parametrize(
        ("arguments", "part"),
        [
            (["--flight-time", "-1"], "--flight-time"),
            (["--flight-time", "0"], "--flight-time"),
            (["--flight-time", "nan"], "--flight-time"),
            (["--flight-time", "inf"], "flight_time"),
            (["--flight-time", "soon"], "soon"),
            (["--flight-time", "0.2", "--stance-torque", "8"], "not allowed with"),
            (["--stance-torque", "-1"], "stance_torque"),
            (["--stance-torque", "nan"], "stance_torque"),
            (["--knee", "4"], "knee_touchdown"),
            (["--frequency", "0"], "frequency"),
            (["--stiffness", "-5"], "stiffness"),
            (["--friction", "0"], "friction"),
            (["--foot-placement", "0.1"], "foot_placement"),
            (["--colour", "red"], "--colour"),
            (["--cycles", "1.5"], "1.5"),
            (["--stance-torque", "8", "--cycles", "0"], "cycles"),
            (["--stance-torque", "8", "--rtol", "1"], "rtol"),
            (["--stance-torque", "0"], "no gait found"),
        ],
        ids=words,
    )
    def test_hop(self, capsys, tmp_path, arguments, part):
        assert part in refused(capsys, "hop", "--out", tmp_path, *arguments)
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--gait", "gallop"], ["unknown gait 'gallop'", "least_effort", "long_stride"]),
            (["--gait", "missing.json"], ["missing.json"]),
            (["--gait", "gallop", "--speed", "2.6"], ["unknown gait 'gallop'", "long_stride"]),
            (["--speed", "0"], ["--speed", "m/s"]),
            (["--speed", "-2.5"], ["--speed"]),
            (["--speed", "nan"], ["--speed"]),
            (["--speed", "inf"], ["--speed"]),
            (["--speed", "fast"], ["fast"]),
            (["--cycles", "0"], ["cycles"]),
            (["--cycles", "1.5"], ["1.5"]),
            (["--rtol", "1"], ["rtol"]),
            (["--colour", "red"], ["--colour"]),
        ],
        ids=words,
    )
    def test_bound(self, capsys, tmp_path, arguments, parts):
        text = refused(capsys, "bound", "--out", tmp_path, *arguments)
        assert all(part in text for part in parts), text
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["gallop"], ["unknown gait 'gallop'", "least_effort", "long_stride"]),
            (["--objective", "speed"], ["unknown objective 'speed'", "effort", "cot"]),
            (["--objective", "electrical"], ["--knee-motor", "electrical"]),
            (["--objective", "violation"], ["--knee-motor", "violation"]),
            (["--knee-motor", "steam"], ["unknown motor 'steam'", "ec_90_flat_260w"]),
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
            (["--stiffness", "-5"], ["--stiffness", "-5"]),
            (["--stiffness", "inf"], ["--stiffness", "inf"]),
            (["--stiffness", "soft"], ["soft", "free"]),
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
    def test_search(self, capsys, tmp_path, monkeypatch, arguments, parts):
        monkeypatch.setattr("spear_pin.gaits.optimize.search", lambda *_, **__: pytest.fail("it was searched"))
        text = refused(capsys, "search", *arguments, "--out", tmp_path)
        assert all(part in text for part in parts), text
        assert not list(tmp_path.iterdir())

    def test_search_without_casadi(self, capsys, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "casadi", None)
        text = refused(capsys, "search", "--out", tmp_path)
        assert "needs casadi" in text and "pip install 'spear-pin[optimize]'" in text

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_no_gait_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "search", "--out", tmp_path / place)

    def test_a_gait_that_does_not_bound(self, capsys, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        assert "'hopping'" in refused(capsys, "bound", "--gait", path, "--out", tmp_path)

    def test_a_speed_out_of_reach(self, capsys, tmp_path, monkeypatch):
        def find(*arguments, **options):
            raise NoGait("Newton's method makes no progress", 0.1)

        monkeypatch.setattr("spear_pin.studies.bound.find_gait", find)
        text = refused(capsys, "bound", "--speed", 2.6, "--out", tmp_path)
        assert "no gait found" in text and "it goes to 2.50" in text
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_no_bound_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "bound", "--out", tmp_path / place)

    @pytest.mark.parametrize(("arguments", "part"), [(["--cycles", "0"], "cycles"), (["--rtol", "1"], "rtol")])
    def test_what_is_simulated_before_anything_is_solved(self, capsys, tmp_path, monkeypatch, arguments, part):
        monkeypatch.setattr("spear_pin.find_gait", lambda *_, **__: pytest.fail("the gait was solved for"))
        assert part in refused(capsys, "hop", "--out", tmp_path, *arguments)

    @pytest.mark.slow
    def test_a_hop_that_cannot_be(self, capsys, tmp_path):
        assert "no gait found" in refused(capsys, "hop", "--out", tmp_path, "--flight-time", "5")

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_nothing_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "hop", "--out", tmp_path / place)

    @pytest.mark.parametrize("arguments", [[], ["fly"], ["--json"], ["robots", "spear_ii"]], ids=words)
    def test_commands(self, capsys, arguments):
        refused(capsys, *arguments)

    def test_as_a_process(self):
        process = subprocess.run(
            [sys.executable, "-m", "spear_pin", "dynamics", "spear_iii"],
            capture_output=True,
            text=True,
            cwd=Path(__file__).parents[1],
        )
        assert process.returncode == 2 and process.stdout == ""
        assert process.stderr.count("\n") == 1 and "spear_iii" in process.stderr

    def test_a_reader_that_stops_reading(self):
        """As `spear dynamics q_spear | head -1` does."""
        process = subprocess.Popen(
            [sys.executable, "-m", "spear_pin", "dynamics", "q_spear"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=Path(__file__).parents[1],
        )
        process.stdout.close()
        error = process.stderr.read()
        process.stderr.close()
        process.wait()
        assert b"Traceback" not in error and b"Exception" not in error


def test_every_number_is_json(capsys):
    """Neither NaN nor infinity is ever printed."""
    status, out, _ = run(capsys, "dynamics", "spear_ii", "--json")
    assert status == 0

    def refuse(name):
        raise AssertionError(name)

    assert math.isfinite(json.loads(out, parse_constant=refuse)["D"][0][0])
