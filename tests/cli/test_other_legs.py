"""Another robot's leg or plane in commands other than hop and bound, and one line where one cannot be had."""

import json
import shlex

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Trajectory, load, monopod, sagittal, simulate, vary
from spear_pin.errors import BadValue
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.request import Request
from spear_pin.model.catalogue import motor
from spear_pin.model.mjcf import to_mjcf
from spear_pin.model.origin import move_origin, origin, robot_of
from spear_pin.model.pinned import pin_toe
from spear_pin.model.srdf import to_srdf
from spear_pin.studies.hop_of_another import scaled_hopping
from spear_pin.studies.sweep import store
from tests.cli.calls import printed, refused, rows, run, words
from tests.model.legged import quadruped


@pytest.fixture(scope="module")
def leg(dog):
    return monopod(load(dog, base="fixed", motors="all"), "HR", locked=["boom_x"])


class TestDynamics:
    def test_a_leg(self, capsys, dog):
        result = printed(capsys, "dynamics", dog, "--leg", "HR", "--body", 2, "--q", 0, 0.3, 0.5, 1)
        robot = monopod(load(dog, base="fixed", motors="all"), "HR", 2.0)
        assert result["coordinates"] == list(robot.coordinates) and result["cut"] == str(robot.cut)
        np.testing.assert_array_equal(result["D"], robot.mass_matrix([0, 0.3, 0.5, 1]))

    def test_a_plane(self, capsys, dog):
        robot = sagittal(load(dog, motors="all"))
        np.testing.assert_array_equal(printed(capsys, "dynamics", dog, "--plane")["D"], robot.mass_matrix(np.zeros(7)))
        assert "sagittal of made" in run(capsys, "dynamics", dog, "--plane")[1]

    def test_knees_to_other_sides(self, capsys, dog):
        result = printed(capsys, "dynamics", dog, "--plane", "--bends", 1, 1)
        assert "anterior_knee = -FL_bend" not in result["cut"] and "anterior_knee = FL_bend" in result["cut"]

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            (["--leg", "XX"], "unknown leg 'XX'; valid: FL, FR, HL, HR"),
            (["--leg", "HR", "--plane"], "not allowed with"),
            (["--leg", "HR", "--bends", "1", "1"], "--bends is [1, 1]; expected 1 number, each 1 or -1"),
            (["--plane", "--bends", "1"], "--bends is [1]; expected 2 numbers, each 1 or -1"),
            (["--leg", "HR", "--bends", "2"], "--bends is 2"),
            (["--leg", "HR", "--body", "-1"], "--body is -1"),
            (["--plane", "--body", "1"], "--body is 1.0; expected only with --leg"),
            (["--bends", "1"], "--bends is 1; expected only with --leg or --plane"),
        ],
        ids=words,
    )
    def test_mistakes(self, capsys, dog, options, said):
        assert said in refused(capsys, "dynamics", dog, *options)


class TestSearch:
    @pytest.fixture
    def searched(self, monkeypatch):
        """Searches that end at once with a shipped gait; what was asked of them."""
        asked = []

        def search(robot, request, **options):
            asked.append((robot, request))
            gait = Gait.load("least_effort")
            return gait, Solution({}, 29.6, {"mean speed": 1e-9}, True, "Solve_Succeeded", 42)

        monkeypatch.setattr("spear_pin.gaits.optimize.search", search)
        monkeypatch.setattr("spear_pin.gaits.collocation.casadi", lambda: None)
        return asked

    def test_the_scaled_request(self, capsys, dog, tmp_path, searched):
        options = ("--speed", 1.5, "--knee-motor", "ec_90_flat_260w", "--ratio", 9, "--stiffness-per-leg", 10)
        result = printed(capsys, "search", "--robot", dog, *options, "--out", tmp_path)
        plane, rotor = sagittal(load(dog, motors="all")), motor("ec_90_flat_260w").known("rotor_inertia")
        ((robot, request),) = searched
        assert robot.model == vary(plane, knee_ratio=9.0, knee_rotor=rotor).model
        drive = request.knee_drive
        assert request == Request.scaled(robot, speed=1.5, stiffness=20.0, knee_drive=drive)
        assert drive.gearbox.ratio == 9.0 and drive.motor.name == motor("ec_90_flat_260w").name
        assert result["cut"] == str(plane.cut) and result["gait"] is None and result["shipped"] is None

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            (["long_stride", "--robot", "dog"], "gait is 'long_stride'; expected to be left out with --robot"),
            (["--bends", "1", "1"], "only with --robot"),
            (["--robot", "no_such"], "unknown robot 'no_such'"),
            (["--robot", "spear_ii_series"], "--robot"),
        ],
        ids=words,
    )
    def test_mistakes(self, capsys, monkeypatch, options, said):
        monkeypatch.setattr("spear_pin.gaits.optimize.search", lambda *_, **__: pytest.fail("it was searched"))
        refused(capsys, "search", *options) if said == "--robot" else None
        assert said == "--robot" or said in refused(capsys, "search", *options)


class TestPushTest:
    def test_a_leg(self, capsys, dog, leg, tmp_path):
        result = printed(capsys, "push-test", "--robot", dog, "--leg", "HR", "--ratio", 12, "--out", tmp_path)
        geared = vary(leg, knee_ratio=12.0)
        assert result["cut"] == str(leg.cut) and result["rotor_inertia"] == pin_toe(geared).rotor > pin_toe(leg).rotor
        assert result["stiffness"] == scaled_hopping(leg).spring.stiffness
        assert 0.05 < result["depth"] < 0.07
        assert "leg HR, released from 6.289 cm" in (tmp_path / "push_test.html").read_text(encoding="utf-8")

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            (["--ratios", "12"], "left out with --ratios: give one by --ratio"),
            (["--leg", "XX"], "unknown leg 'XX'"),
        ],
        ids=words,
    )
    def test_mistakes(self, capsys, dog, tmp_path, options, said):
        assert said in refused(capsys, "push-test", "--robot", dog, *options, "--out", tmp_path)
        assert not list(tmp_path.iterdir())

    @pytest.mark.slow
    def test_its_record_is_identified(self, capsys, dog, tmp_path):
        record = ("--robot", dog, "--leg", "HR", "--write-csv", "dog", "--repeats", 2, "--out", tmp_path)
        said = rows(run(capsys, "push-test", *record)[1])
        asked = shlex.split(said["identify it by"])
        assert asked[:2] == ["spear", "identify"] and asked[-4:] == ["--robot", str(dog), "--leg", "HR"]
        found = printed(capsys, *asked[1:], "--out", tmp_path)
        assert found["leg"].endswith("leg HR")
        (stiffness,) = (each for each in found["estimates"][0]["parameters"] if each["name"] == "stiffness")
        assert stiffness["value"] == pytest.approx(float(said["truth"].split()[1]), rel=5e-3)

    def test_a_rotor_without_inertia(self, capsys, tmp_path):
        path = tmp_path / "light.urdf"
        path.write_text(
            quadruped().replace('rotor_inertia value="0.0001"', 'rotor_inertia value="0"'), encoding="utf-8"
        )
        said = refused(capsys, "push-test", "--robot", path, "--ratio", 12, "--out", tmp_path)
        assert "--ratio is 12.0; expected to be left out: the knee of" in said and "a rotor without inertia" in said

    @pytest.mark.slow
    def test_a_knee_whose_limits_the_file_does_not_know(self, capsys, tmp_path):
        path = tmp_path / "free.urdf"
        path.write_text(quadruped(knee_limits=(-10.0, 10.0)), encoding="utf-8")
        asked = ("push-test", "--robot", path, "--leg", "HR", "--bends", 1, "--out", tmp_path)
        assert printed(capsys, *asked)["reason"] == "complete"


class TestSweep:
    @pytest.mark.slow
    @pytest.mark.extra("heyoka", "joblib", "xarray", "zarr")
    def test_a_leg(self, capsys, dog, leg, tmp_path):
        """What is written names the robot that was cut, and the leg."""
        over = ("--over", "stiffness=13,14", "--over", "knee_ratio=8,9")
        out = tmp_path / "hops.zarr"
        asked = ("sweep", "hop", "--robot", dog, "--leg", "HR", *over, "--flight-time", 0.2, "--out", out)
        result = printed(capsys, *asked)
        assert result["converged"] == 4 and result["cut"] == str(leg.cut)
        assert robot_of(json.loads(store.read(out).attrs["robot"])).model == leg.model

    def test_a_bound_is_saved_first(self, capsys, dog, tmp_path):
        asked = ("sweep", "bound", "--robot", dog, "--over", "stiffness=1,2", "--out", tmp_path / "a.zarr")
        assert "type `spear bound --robot NAME --save`, then `spear sweep bound.json`" in refused(capsys, *asked)

    def test_goes_with_a_robot(self, capsys, tmp_path):
        asked = ("sweep", "hop", "--leg", "HR", "--over", "stiffness=1,2", "--out", tmp_path / "a.zarr")
        assert "--leg is 'HR'; expected only with --robot" in refused(capsys, *asked)


class TestExport:
    def test_a_cut_is_no_file(self, leg):
        with pytest.raises(BadValue, match="a robot with a URDF, such as made, out of which it is cut"):
            to_srdf(leg)
        assert "shapes are left out: it is cut out of made" in to_mjcf(leg)

    def test_a_file_that_moved(self, dog, leg, tmp_path):
        elsewhere = tmp_path / "elsewhere.urdf"
        elsewhere.write_bytes(dog.read_bytes())
        robot = robot_of(move_origin(origin(leg), str(elsewhere)))
        assert robot.model == leg.model and robot.cut.source == str(elsewhere)
        assert move_origin(origin(leg), None) == origin(leg)
        assert move_origin(origin(load("spear_ii")), "q_spear")["source"] == "q_spear"

    def test_is_drawn_from_where_it_is_now(self, capsys, dog, leg, tmp_path, monkeypatch):
        gone = tmp_path / "gone.urdf"
        gone.write_bytes(dog.read_bytes())
        robot = monopod(load(gone, base="fixed", motors="all"), "HR", locked=["boom_x"])
        system = scaled_hopping(robot)
        trajectory = simulate(system, system.guess(), 1, progress=False)
        trajectory.save(tmp_path / "hop.npz")
        gone.unlink()
        drawn = []
        monkeypatch.setattr("spear_pin.viz.video.still", lambda robot, *_, **__: drawn.append(robot))
        asked = ("export", tmp_path / "hop.npz", "--png", "--out", tmp_path)
        assert "its robot is not found" in refused(capsys, *asked)
        printed(capsys, *asked, "--robot", dog)
        assert drawn[0].model == leg.model and drawn[0].coordinates == Trajectory.load(tmp_path / "hop.npz").coordinates


def test_a_bound_is_explored_of_a_saved_gait(capsys, dog):
    said = refused(capsys, "explore", "bound", "--robot", dog)
    assert "--robot is" in said and "spear bound --robot NAME --save" in said


def test_the_law_of_a_leg(leg):
    assert scaled_hopping(leg).law == HoppingLaw.scaled(leg)
