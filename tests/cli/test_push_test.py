"""`spear push-test`."""

import json

import numpy as np
import pytest

from spear_pin import Trajectory
from tests.cli.calls import printed, refused, run, words


def test_release(capsys, tmp_path):
    shown = printed(capsys, "push-test", "--static-rest", "--out", tmp_path)
    assert shown["initial_angle"] == pytest.approx(1.533, abs=5e-4)
    assert shown["frequency"] == pytest.approx(2.274, abs=1e-3)
    assert shown["first_extremum"][0] == pytest.approx(0.2313, abs=1e-4)
    assert shown["least_force"] == pytest.approx(-11.2, abs=0.1)
    assert shown["lift_off"] == pytest.approx(0.1749, abs=1e-4)
    assert shown["reason"] == "complete"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["push_test.html", "push_test.npz", "push_test.svg"]
    assert "pins" not in shown


def test_text(capsys, tmp_path):
    status, out, _ = run(capsys, "push-test", "--out", tmp_path)
    assert status == 0 and "the pin pulls never" in out and "rests at             1.2420 rad" in out


@pytest.mark.slow
def test_options_reach_the_model(capsys, tmp_path):
    plain = printed(capsys, "push-test", "--out", tmp_path)
    for options in (
        ["--depth", "0.05"],
        ["--ratio", "30"],
        ["--no-motor"],
        ["--stiffness", "60"],
        ["--damping", "2"],
        ["--coulomb", "1"],
        ["--rest-angle", "0.9"],
        ["--static-rest"],
        ["--unilateral"],
    ):
        other = printed(capsys, "push-test", *options, "--out", tmp_path)
        assert other["first_extremum"] != plain["first_extremum"], options


@pytest.mark.slow
def test_ratios(capsys, tmp_path):
    shown = printed(capsys, "push-test", "--ratios", "none", "15", "30", "66", "--out", tmp_path)
    times = [row["first_extremum"][0] for row in shown["ratios"]]
    assert times == sorted(times) and len(times) == 4
    assert [row["ratio"] for row in shown["ratios"]] == [None, 15, 30, 66]
    assert (tmp_path / "gear_ratios.svg").is_file()


def test_record(capsys, tmp_path):
    options = ["push-test", "--write-csv", "lab", "--repeats", "1", "--out", tmp_path]
    shown = printed(capsys, *options)
    text = (tmp_path / "lab.csv").read_text(encoding="utf-8")
    assert text.startswith("# SYNTHETIC") and "not measured" in text.splitlines()[0]
    assert shown["synthetic"] is True and shown["truth"]["stiffness"] == 48.25
    run(capsys, *options)
    assert (tmp_path / "lab.csv").read_text(encoding="utf-8") == text
    run(capsys, *options, "--seed", "1")
    assert (tmp_path / "lab.csv").read_text(encoding="utf-8") != text


@pytest.mark.slow
def test_record_names_the_command_that_reads_it(capsys, tmp_path):
    _, out, _ = run(capsys, "push-test", "--write-csv", "lab.csv", "--repeats", "1", "--no-motor", "--out", tmp_path)
    line = next(line for line in out.splitlines() if "spear identify" in line)
    command = line[line.index("spear identify") :].split()[1:]
    status, out, err = run(capsys, *command, "--out", tmp_path, "--json")
    assert status == 0, err
    found = json.loads(out)["estimates"][0]["parameters"][0]
    assert abs(found["value"] - 47.12) < 3 * found["deviation"]


@pytest.mark.parametrize(
    ("options", "picture", "number", "left"),
    [
        ([], "player.record", "first extremum", ["push_test.npz"]),
        ([], "plots.save_figure", "first extremum", ["push_test.html", "push_test.npz"]),
        (["--ratios", "15"], "plots.save_figure", "15:1", []),
    ],
)
def test_interrupted_while_pictures_are_drawn(capsys, tmp_path, monkeypatch, options, picture, number, left):
    """The numbers are there, and the files that are whole."""

    def interrupt(*_, **__):
        raise SystemExit(130)

    monkeypatch.setattr(f"spear_pin.viz.{picture}", interrupt)
    status, out, err = run(capsys, "push-test", *options, "--out", tmp_path)
    assert status == 130 and err == "" and number in out
    assert sorted(path.name for path in tmp_path.iterdir()) == left


@pytest.mark.slow
def test_the_page_is_opened_once_it_is_there(capsys, tmp_path, monkeypatch):
    opened, page = [], tmp_path / "push_test.html"
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append((address, page.is_file())))
    printed(capsys, "push-test", "--out", tmp_path)
    assert opened == []
    printed(capsys, "push-test", "--open", "--out", tmp_path)
    assert opened == [(page.resolve().as_uri(), True)]


def test_the_picture_of_ratios_is_opened(capsys, tmp_path, monkeypatch):
    opened, picture = [], tmp_path / "gear_ratios.svg"
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append((address, picture.is_file())))
    printed(capsys, "push-test", "--ratios", "15", "--open", "--out", tmp_path)
    assert opened == [(picture.resolve().as_uri(), True)]


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--depth", "0.9"], "depth"),
        (["--depth", "-0.1"], "depth"),
        (["--depth", "nan"], "depth"),
        (["--stiffness", "-1"], "stiffness"),
        (["--stiffness", "3"], "knee"),
        (["--stiffness", "1e300"], "stiffness"),
        (["--damping", "1e300"], "damping"),
        (["--coulomb", "1e300"], "coulomb"),
        (["--write-csv", "x", "--repeats", "99999999"], "repeats"),
        (["--coulomb", "-1"], "coulomb"),
        (["--ratio", "0"], "--ratio"),
        (["--ratio", "15", "--no-motor"], "--no-motor"),
        (["--ratios", "-3"], "knee_ratio"),
        (["--ratios", "many"], "many"),
        (["--duration", "0"], "duration"),
        (["--write-csv", "x", "--noise", "-1"], "noise"),
        (["--write-csv", "x", "--seed", "-1"], "--seed"),
        (["--write-csv", "x", "--repeats", "0"], "repeats"),
        (["--write-csv", "x", "--volts-per-rad", "0"], "volts_per_rad"),
        *((["--write-csv", name], f"{name!r} is not a file name") for name in ("no/where", "", " ", ".", "..", "/")),
        *((["--write-csv", name], f"{name!r} is not a file name") for name in ("/tmp/x.csv", "../x", "x/")),
        (["--write-csv", "x", "--ratios", "15"], "--write-csv"),
        (["--write-csv", "x", "--duration", "2"], "--duration"),
        (["--ratios", "15", "--no-motor"], "--no-motor"),
        (["--noise", "0.1"], "--noise"),
        (["--out", "nowhere"], "--out"),
    ],
    ids=words,
)
def test_mistakes(capsys, tmp_path, monkeypatch, options, named):
    monkeypatch.chdir(tmp_path)
    assert named in refused(capsys, "push-test", *options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_page_shows_the_beginning_of_a_long_release(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("spear_pin.viz.player.MOST_FRAMES", 100)
    result = printed(capsys, "push-test", "--duration", "20", "--out", tmp_path)
    begin, end = result["shown"]
    assert begin == -0.5 and 1.0 < end < 20.0
    status, out, _ = run(capsys, "push-test", "--duration", "20", "--out", tmp_path)
    assert status == 0 and f"shows the first {end + 0.5:.1f} s of 20.5 s" in out


@pytest.mark.slow
def test_its_samples_are_a_trajectory(capsys, tmp_path):
    shown = printed(capsys, "push-test", "--ratio", "30", "--out", tmp_path)
    motion = Trajectory.load(tmp_path / "push_test.npz")
    assert (motion.reason, motion.t[0], motion.t[-1]) == ("complete", 0.0, 1.5)
    assert motion.q[0, 2] == pytest.approx(shown["initial_angle"], abs=1e-12)
    assert [event.name for event in motion.events][:2] == ["release", "turn"]
    time, angle = shown["first_extremum"]
    assert motion.events[1].time == pytest.approx(time, abs=1e-9)
    assert motion.events[1].q[2] == pytest.approx(angle, abs=1e-9)
    assert motion.force[:, 0, 1].min() == pytest.approx(shown["least_force"], abs=0.02)
    robot = motion.load_robot()
    assert dict(robot.varied) == {"knee_ratio": 30.0}
    np.testing.assert_allclose([robot.toe_position(q, "toe") for q in motion.q[::100]], 0.0, rtol=0, atol=1e-9)
    exported = printed(capsys, "export", tmp_path / "push_test.npz", "--csv", "--out", tmp_path)
    assert exported["files"] == [str(tmp_path / "push_test.csv")]
