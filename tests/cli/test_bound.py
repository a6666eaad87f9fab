"""`spear bound`: its figures and files, and one line for every mistake."""

import io
import json
import re
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace

import pytest

from spear_pin import Gait, Trajectory, bounding, load, sagittal
from spear_pin.cli import main
from spear_pin.errors import NoGait
from spear_pin.gaits import library
from spear_pin.studies.bound import mean_speed
from tests.cli.calls import loads, printed, refused, run, words


@pytest.fixture(scope="module")
def bound_run(tmp_path_factory):
    """What `spear bound --json` prints, its status, and the folder it wrote into."""
    folder = tmp_path_factory.mktemp("bound")
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        status = main(["bound", "--json", "--cycles", "2", "--out", str(folder)])
    return status, out.getvalue(), err.getvalue(), folder


@pytest.fixture(scope="module")
def cut_gait(tmp_path_factory):
    """The gait that is shown, of the plane that is cut out of the four-legged robot."""
    gait, robot = Gait.load("long_stride"), sagittal(load("q_spear_full"))
    law, spring, contact = gait.system.law, gait.system.spring, gait.system.contact
    cut = replace(gait, system=bounding(robot, law, spring, contact))
    return cut.save(tmp_path_factory.mktemp("cut") / "gait.json")


class TestOfACut:
    @pytest.mark.slow
    def test_bounds(self, capsys, tmp_path, cut_gait):
        result = printed(capsys, "bound", "--gait", cut_gait, "--cycles", 1, "--rtol", 1e-8, "--out", tmp_path)
        assert result["reason"] == "complete" and result["speed"] == pytest.approx(2.5, abs=1e-6)
        page = (tmp_path / "bound.html").read_text(encoding="utf-8")
        assert "q_spear_full bounding at 2.50 m/s" in page

    def test_is_swept(self, capsys, tmp_path, cut_gait):
        asked = ("sweep", cut_gait, "--over", "colour=1,2", "--out", tmp_path / "s.zarr")
        said = refused(capsys, *asked)
        assert "unknown parameter 'colour'" in said and "nearest of" in said


@pytest.mark.slow
@pytest.mark.parametrize("command", ["bound", "hop"])
def test_files_of_an_earlier_call_are_named(capsys, tmp_path, command):
    """Those that this call does not write, and that a reader would take for its own; they stay."""
    for name in (f"{command}.json", f"{command}.csv", f"{command}.html", f"{command}.txt", "other.json"):
        (tmp_path / name).write_text("older")
    status, out, _ = run(capsys, command, "--cycles", 1, "--rtol", 1e-8, "--out", tmp_path)
    rows = dict(
        re.split(r" {2,}", line, maxsplit=1) for line in out.splitlines() if line.startswith(("files", "of an"))
    )
    assert status == 0 and f"{command}.html" in rows["files"]
    assert rows["of an earlier call"] == f"{tmp_path / command}.json, {tmp_path / command}.csv"
    assert (tmp_path / f"{command}.json").read_text() == "older"
    _, out, _ = run(capsys, command, "--cycles", 1, "--rtol", 1e-8, "--save", "--out", tmp_path)
    assert f"of an earlier call   {tmp_path / command}.csv\n" in out


class TestBound:
    @pytest.mark.slow
    def test_figures(self, bound_run):
        status, out, err, _ = bound_run
        assert (status, err) == (0, "") and out.count("\n") == 1
        result = json.loads(out)
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
            "work",
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

    @pytest.mark.slow
    def test_files(self, bound_run):
        _, out, _, folder = bound_run
        assert sorted(path.name for path in folder.iterdir()) == ["bound.html", "bound.npz", "bound.svg"]
        files = [str(folder / name) for name in ("bound.html", "bound.npz", "bound.svg")]
        assert json.loads(out)["files"] == files
        trajectory = Trajectory.load(folder / "bound.npz")
        assert trajectory.complete and trajectory.cycles == 2
        assert trajectory.toes == ("posterior_toe", "anterior_toe")
        page = folder / "bound.html"
        assert "Q-SPEAR bounding at 2.50 m/s" in page.read_text(encoding="utf-8")
        assert page.stat().st_size < 3_000_000

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("name", "rule"), [("least_effort", "knee is back at 40°"), ("force_lift_off", "force is zero")]
    )
    def test_text(self, capsys, tmp_path, name, rule):
        status, out, err = run(capsys, "bound", "--gait", name, "--cycles", 1, "--rtol", 1e-8, "--out", tmp_path)
        assert status == 0, err
        assert name in out and rule in out and "2.5000 m/s" in out and "1 strides (complete)" in out
        assert "in the last ms" not in out
        assert str(tmp_path / "bound.html") in out and str(tmp_path / "bound.npz") in out

    @pytest.mark.slow
    def test_a_page_shows_a_part_and_says_which(self, capsys, tmp_path, monkeypatch):
        monkeypatch.setattr("spear_pin.viz.player.MOST_FRAMES", 9)
        status, out, err = run(capsys, "bound", "--cycles", 3, "--rtol", 1e-7, "--out", tmp_path)
        assert status == 0, err
        said = out.partition("page                 shows ")[2].partition("\n")[0]
        assert said.startswith("the last ") and said in (tmp_path / "bound.html").read_text(encoding="utf-8")

    def test_interrupted_while_pictures_are_drawn(self, capsys, tmp_path, monkeypatch):
        def interrupt(*_, **__):
            raise SystemExit(130)

        monkeypatch.setattr("spear_pin.viz.player.record", interrupt)
        status, out, err = run(capsys, "bound", "--cycles", 1, "--rtol", 1e-7, "--out", tmp_path)
        assert status == 130 and err == "" and "1 strides (complete)" in out
        assert [path.name for path in tmp_path.iterdir()] == ["bound.npz"]

    @pytest.mark.slow
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

    def test_list_loads_nothing_that_computes(self):
        assert not {"scipy.integrate", "scipy.optimize", "matplotlib", "spear_pin.hybrid.run"} & loads(
            "bound", "--list"
        )

    @pytest.mark.parametrize("name", ["force_lift_off", "long_stride_1.50", "long_stride_3.50"])
    def test_list_has_the_speed_that_gaits_run_at(self, capsys, name):
        rows = {row["name"]: row for row in printed(capsys, "bound", "--list")["gaits"]}
        assert rows[name]["speed"] == pytest.approx(mean_speed(Gait.load(name)), abs=1e-7)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("speed", "start"),
        [
            (2.9, "long_stride_3.00"),
            pytest.param(2.6, "long_stride", marks=pytest.mark.slow),
            pytest.param(4, "long_stride_3.5", marks=pytest.mark.slow),
        ],
    )
    @pytest.mark.parametrize("asked", [pytest.param("long_stride", marks=pytest.mark.slow), "long_stride_3.00"])
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


class TestMistakes:
    @pytest.mark.slow
    def test_a_gait_that_does_not_bound(self, capsys, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        assert "'hopping'" in refused(capsys, "bound", "--gait", path, "--out", tmp_path)

    def test_a_speed_out_of_reach(self, capsys, tmp_path, monkeypatch):
        def find(*arguments, **options):
            raise NoGait("Newton's method makes no progress", 0.1)

        monkeypatch.setattr("spear_pin.studies.bound.speed.find_gait", find)
        text = refused(capsys, "bound", "--speed", 2.6, "--out", tmp_path)
        assert "no gait found" in text and "to 2.50 m/s, and none" in text
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--gait", "canter"], ["unknown gait 'canter'; nearest of"]),
            (["--gait", "missing.json"], ["missing.json"]),
            (["--gait", "no_such.npz"], ["no_such.npz", "cannot be read"]),
            (["--gait", "canter", "--speed", "2.6"], ["unknown gait 'canter'; nearest of"]),
            (["--gait", ""], ["unknown gait ''"]),
            (["--speed", "0"], ["--speed", "m/s"]),
            (["--speed", "-2.5"], ["--speed"]),
            (["--speed", "nan"], ["--speed"]),
            (["--speed", "inf"], ["--speed"]),
            (["--speed", "99"], ["speed is 99", "within 1 m/s", "3.50"]),
            (["--speed", "fast"], ["fast"]),
            (["--cycles", "0"], ["cycles"]),
            (["--cycles", "1.5"], ["1.5"]),
            (["--rtol", "1"], ["rtol"]),
            (["--colour", "red"], ["--colour"]),
            (
                ["--robot", "biped"],
                ["--robot is 'biped'; expected a quadruped whose trunk is free", "'world', is fixed"],
            ),
        ],
        ids=words,
    )
    def test_arguments(self, capsys, tmp_path, arguments, parts):
        text = refused(capsys, "bound", "--out", tmp_path, *arguments)
        assert all(part in text for part in parts), text
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_nothing_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "bound", "--out", tmp_path / place)


@pytest.mark.parametrize("call", [("long_stride", "--gait", "least_effort"), ("--gait", "least_effort", "long_stride")])
def test_two_gaits_are_refused(capsys, call):
    with pytest.raises(SystemExit):
        main(["bound", *call])
    assert "give one gait" in capsys.readouterr().err
