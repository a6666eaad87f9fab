"""`spear hop`: its figures and files, and one line for every mistake."""

import io
import json
import re
from contextlib import redirect_stderr, redirect_stdout

import numpy as np
import pytest

from spear_pin import Ground, Trajectory, find_gait
from spear_pin.cli import main
from spear_pin.errors import NoGait, SpearError
from tests.cli.calls import printed, refused, run, words


@pytest.fixture(scope="module")
def hop_run(tmp_path_factory):
    """What `spear hop --json` prints, its status, and the folder it wrote into."""
    folder = tmp_path_factory.mktemp("hop")
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        status = main(["hop", "--json", "--out", str(folder)])
    return status, out.getvalue(), err.getvalue(), folder


class TestHop:
    @pytest.mark.slow
    def test_figures(self, hop_run):
        status, out, err, _ = hop_run
        assert (status, err) == (0, "") and out.count("\n") == 1
        result = json.loads(out)
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
        _, out, _, folder = hop_run
        assert sorted(path.name for path in folder.iterdir()) == ["hop.html", "hop.npz", "hop.svg"]
        files = [str(folder / name) for name in ("hop.html", "hop.npz", "hop.svg")]
        assert json.loads(out)["files"] == files
        assert "Knee torque" in (folder / "hop.svg").read_text(encoding="utf-8")
        trajectory = Trajectory.load(folder / "hop.npz")
        assert trajectory.complete and trajectory.cycles == 11
        assert trajectory.coordinates == ("boom_z", "hip", "knee")
        page = (folder / "hop.html").read_text(encoding="utf-8")
        assert page.lstrip().lower().startswith("<!doctype html>") and "</html>" in page

    @pytest.mark.slow
    def test_text_and_options(self, capsys, tmp_path):
        options = ["--stance-torque", 8.2, "--knee", 0.95, "--frequency", 2.6, "--stiffness", 50, "--friction", 0.9]
        status, out, err = run(capsys, "hop", *options, "--cycles", 2, "--rtol", 1e-8, "--out", tmp_path)
        assert status == 0, err
        assert "motors' work, net" in out and "8.2000 N·m" in out and "50 N·m/rad in the knee" in out
        assert "stable" in out and "2 hops (complete)" in out
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

    @pytest.mark.slow
    def test_a_spring_that_hardens_and_is_preloaded(self, capsys, tmp_path):
        options = ["--stance-torque", 8.2, "--hardening", 30, "--preload", 2]
        status, _, err = run(capsys, "hop", *options, "--cycles", 1, "--out", tmp_path)
        assert status == 0, err
        trajectory = Trajectory.load(tmp_path / "hop.npz")
        beyond = trajectory.q[:50, 2] - trajectory.q[0, 2]
        expected = -(2.0 + 48.84 * beyond + 30.0 * beyond**3)
        np.testing.assert_allclose(trajectory.spring[:50, 0], expected, rtol=0, atol=1e-9)

    @pytest.mark.slow
    def test_slope(self, capsys, tmp_path):
        """The ground is in the samples, and the page shows it."""
        options = ["--stance-torque", 7.8, "--slope", 0.1, "--friction", 0.7, "--cycles", 1, "--out", tmp_path]
        result = printed(capsys, "hop", *options)
        assert (result["slope"], result["friction"], result["cycles"]) == (0.1, 0.7, 1)
        assert Trajectory.load(tmp_path / "hop.npz").ground == Ground(0.7, 0.1)

    @pytest.mark.slow
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


class TestLongRuns:
    SHORT = ("hop", "--cycles", 4, "--rtol", 1e-7)

    @pytest.fixture
    def narrow(self, monkeypatch):
        """Pages that hold a hop or so."""
        monkeypatch.setattr("spear_pin.viz.player.MOST_FRAMES", 20)

    @pytest.mark.slow
    def test_a_page_shows_a_part_and_says_which(self, capsys, tmp_path, narrow):
        status, out, err = run(capsys, *self.SHORT, "--out", tmp_path)
        assert status == 0, err
        said = re.search(r"page +shows (the last [\d.]+ s of 2.3 s, from [\d.]+ to 2.3 s)", out)
        assert said is not None
        page = (tmp_path / "hop.html").read_text(encoding="utf-8")
        assert f"shown: {said[1]}" in page
        assert Trajectory.load(tmp_path / "hop.npz").cycles == 4

    @pytest.mark.slow
    def test_as_json(self, capsys, tmp_path, narrow):
        begin, end = printed(capsys, *self.SHORT, "--out", tmp_path)["shown"]
        assert end == pytest.approx(2.257, abs=1e-2) and 0.5 < end - begin < 20 / 30

    @pytest.mark.slow
    def test_a_short_one_is_shown_whole(self, capsys, tmp_path):
        result = printed(capsys, "hop", "--cycles", 1, "--rtol", 1e-7, "--out", tmp_path)
        assert result["shown"] == [0.0, pytest.approx(result["period"])]

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("picture", "left"),
        [("player.record", ["hop.npz"]), ("plots.save_figure", ["hop.html", "hop.npz"])],
    )
    def test_interrupted_while_pictures_are_drawn(self, capsys, tmp_path, monkeypatch, picture, left):
        """Figures and samples are there."""

        def interrupt(*_, **__):
            raise SystemExit(130)

        monkeypatch.setattr(f"spear_pin.viz.{picture}", interrupt)
        status, out, err = run(capsys, *self.SHORT, "--json", "--out", tmp_path)
        assert status == 130 and err == "" and json.loads(out)["cycles"] == 4
        assert sorted(path.name for path in tmp_path.iterdir()) == left
        assert Trajectory.load(tmp_path / "hop.npz").complete

    @pytest.mark.slow
    def test_pictures_that_fail_leave_the_samples(self, capsys, tmp_path, monkeypatch):
        def fail(*_, **__):
            raise SpearError("there is no more ink")

        monkeypatch.setattr("spear_pin.viz.player.record", fail)
        status, out, err = run(capsys, *self.SHORT, "--out", tmp_path)
        assert status == 2 and err == "spear: there is no more ink\n" and "4 hops (complete)" in out
        assert [path.name for path in tmp_path.iterdir()] == ["hop.npz"]


class TestMistakes:
    @pytest.mark.parametrize(
        ("arguments", "part"),
        [
            (["--cycles", "0"], "cycles"),
            (["--cycles", "9" * 20], "a whole number from 1 to 10000"),
            (["--rtol", "1"], "rtol"),
            (["--stiffness", "1e300"], "from 0 to 1e+06"),
            (["--hardening", "-1"], "Spring.hardening is -1"),
            (["--preload", "nan"], "Spring.preload is nan"),
            (["--switch-delay", "-0.001"], "Clutch.on_delay is -0.001"),
            (["--tooth", "nan"], "Clutch.pitch is nan"),
            (["--damping", "-1"], "Spring.damping is -1.0; expected a number from 0"),
            (["--hardware", "--bandwidth", "-1"], "bandwidth is -1"),
            (["--hardware", "--current-limit", "0"], "current_limit is 0"),
        ],
        ids=words,
    )
    def test_what_is_simulated_before_anything_is_solved(self, capsys, tmp_path, monkeypatch, arguments, part):
        monkeypatch.setattr("spear_pin.find_gait", lambda *_, **__: pytest.fail("the gait was solved for"))
        assert part in refused(capsys, "hop", "--out", tmp_path, *arguments)

    @pytest.mark.slow
    def test_a_hop_that_cannot_be(self, capsys, tmp_path):
        status, _, err = run(capsys, "hop", "--out", tmp_path, "--flight-time", "5")
        assert status == 2 and "no gait found" in err.splitlines()[-1]  # a slow machine says before how far it is

    @pytest.mark.parametrize("place", ["missing", "file"])
    def test_where_nothing_can_be_written(self, capsys, tmp_path, place):
        (tmp_path / "file").touch()
        assert "--out" in refused(capsys, "hop", "--out", tmp_path / place)

    @pytest.mark.parametrize(
        ("arguments", "part"),
        [
            *(
                (["--flight-time", wanted], f"flight_time is {float(wanted)}; expected a number from 0.05 to 5, in s")
                for wanted in ("-1", "0", "nan", "inf", "0.04", "5.1")
            ),
            (["--flight-time", "soon"], "soon"),
            (["--flight-time", "0.2", "--stance-torque", "8"], "not allowed with"),
            (["--stance-torque", "-1"], "stance_torque"),
            (["--stance-torque", "nan"], "stance_torque"),
            (["--knee", "4"], "knee_touchdown"),
            (["--frequency", "0"], "frequency"),
            (["--stiffness", "-5"], "stiffness"),
            (["--friction", "0"], "friction"),
            (["--slope", "1.3"], "slope"),
            (["--slope", "steep"], "steep"),
            (["--foot-placement", "0.1"], "--foot-placement is 0.1; expected only with --free-x"),
            (["--colour", "red"], "--colour"),
            (["--cycles", "1.5"], "1.5"),
            (["--stance-torque", "8", "--cycles", "0"], "cycles"),
            (["--stance-torque", "8", "--rtol", "1"], "rtol"),
            (["--stance-torque", "0"], "no gait found"),
        ],
        ids=words,
    )
    def test_arguments(self, capsys, tmp_path, arguments, part):
        assert part in refused(capsys, "hop", "--out", tmp_path, *arguments)
        assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def solved():
    """Gaits that were found."""
    return []


@pytest.fixture
def solved_once(solved, monkeypatch):
    """Hops with the same hardware are solved without noise and losses, and so need it once."""

    def find(*asked, **options):
        solved.extend([] if solved else [find_gait(*asked, **options)])
        return solved[0]

    monkeypatch.setattr("spear_pin.find_gait", find)


class TestHardware:
    @pytest.mark.slow
    @pytest.mark.usefixtures("solved_once")
    def test_costs_more_than_its_motors_work(self, capsys, tmp_path):
        shown = printed(capsys, "hop", "--hardware", "--stance-torque", "9.43", "--cycles", "1", "--out", tmp_path)
        energy = shown["electrical"]
        assert energy["battery_knee"] > -energy["motor_knee"] > 5.0 > -energy["gearbox_knee"] > 0.0
        assert abs(sum(energy.values())) < 1e-8
        assert 5.0 < shown["peak_current"]["knee"] < 10.0 and shown["energy_residual"] < 1e-7

    def test_begins_with_what_the_gears_lose(self, capsys, tmp_path, monkeypatch):
        """From the torque of a hop without losses the search takes six times as long."""

        def find(system, *_, **__):
            raise NoGait(f"begun at {system.law.stance_torque:.2f} N·m", 0.0)

        monkeypatch.setattr("spear_pin.find_gait", find)
        assert "begun at 9.64 N·m" in refused(capsys, "hop", "--hardware", "--out", tmp_path)
        assert "begun at 8.00 N·m" in refused(capsys, "hop", "--out", tmp_path)
        given = refused(capsys, "hop", "--hardware", "--stance-torque", "7", "--out", tmp_path)
        assert "begun at 7.00 N·m" in given

    @pytest.mark.slow
    @pytest.mark.usefixtures("solved_once")
    def test_noise_and_losses_reach_the_run(self, capsys, tmp_path):
        common = ["hop", "--hardware", "--stance-torque", "9.43", "--cycles", "1", "--rtol", "1e-7", "--out", tmp_path]
        runs = [
            printed(capsys, *common, *options)["electrical"]["battery_knee"]
            for options in ([], ["--noise", "0.01"], ["--noise", "0.01", "--seed", "1"], ["--losses", "20"])
        ]
        assert len(set(runs)) == 4

    @pytest.mark.parametrize(
        ("options", "named"),
        [
            (["--noise", "0.1"], "--hardware"),
            (["--hardware", "--current-limit", "-1"], "current_limit"),
            (["--hardware", "--bandwidth", "0"], "bandwidth"),
            (["--hardware", "--losses", "1000"], "losses"),
            (["--hardware", "--noise", "0.1", "--seed", "-1"], "--seed"),
        ],
    )
    def test_mistakes(self, capsys, tmp_path, options, named):
        assert named in refused(capsys, "hop", *options, "--out", tmp_path)
