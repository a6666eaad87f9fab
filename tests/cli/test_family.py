"""`spear family`: what it finds and writes, and one line for every mistake."""

import json
from functools import partial

import pytest

from tests.cli.calls import printed, refused, run, words

HOP = ("family", "hop", "--over", "stance_torque=7.5:8.0")
LATE = partial(pytest.param, marks=pytest.mark.slow)  # said once the hop is found


@pytest.mark.extra("heyoka")
class TestFamily:
    def test_a_hop(self, capsys, tmp_path):
        result = printed(capsys, *HOP, "--out", tmp_path)
        assert result["over"] == "stance_torque" and result["stable"] == result["points"] > 5
        assert [end["reason"] for end in result["ends"]] == ["border", "range"]
        assert result["from"] == pytest.approx(7.59794, abs=1e-5) and result["to"] == pytest.approx(8.0)
        assert result["folds"] == result["flips"] == result["neimark_sacker"] == []
        assert result["files"] == [str(tmp_path / name) for name in ("family.json", "family.svg")]
        kept = json.loads((tmp_path / "family.json").read_text())
        assert kept["format"] == "spear_pin branch 1" and len(kept["values"]) == result["points"]
        assert len(kept["q"]) == len(kept["multipliers"]) == len(kept["order"]) == result["points"]
        assert (tmp_path / "family.svg").stat().st_size > 1000

    def test_from_elsewhere(self, capsys, tmp_path):
        arguments = (*HOP[:3], "stance_torque=6.9:7.9", "--at", 7, "--out", tmp_path)
        status, out, err = run(capsys, *arguments)
        assert status == 0 and err == "" and "stance_torque  what happens" in out and "end: border" in out

    def test_with_a_flight_that_is_kept(self, capsys, tmp_path):
        over = ("--over", "knee_ratio=14.9:15.1", "--flight-time", 0.2, "--out", tmp_path)
        assert "stance torque" in run(capsys, "family", "hop", *over)[1]

    def test_over_a_measure(self, capsys, tmp_path):
        over = ("--over", "flight_time=0.195:0.21", "--at", 0.2, "--out", tmp_path)
        result = printed(capsys, "family", "hop", *over)
        assert [end["reason"] for end in result["ends"]] == ["range", "range"]

    @pytest.mark.slow
    def test_of_a_trot(self, capsys, tmp_path):
        over = ("--over", "mean_speed=1.99:2.01", "--points", 2, "--out", tmp_path)
        assert "posterior hip torque" in run(capsys, "family", "trot", *over)[1]

    @pytest.mark.slow
    def test_at_another_speed(self, capsys, tmp_path):
        """The gait at that speed is found first: the branch begins there."""
        arguments = ("--over", "friction=0.79:0.81", "--speed", 2.05, "--points", 2, "--out", tmp_path)
        result = printed(capsys, "family", "trot", *arguments)
        assert "find_gait(gait.system" in result["python"] and result["points"] >= 2


class TestMistakes:
    @pytest.mark.parametrize(
        ("arguments", "text"),
        [
            (("hop",), "--over"),
            (("hop", "--over", "stiffness"), "is not NAME=LOW:HIGH"),
            (("hop", "--over", "a=1:2,b=1:2"), "more than one range"),
            (("hop", "--over", "stiffness=1:x"), "'x' of stiffness is no number"),
            (
                ("hop", "--over", "stiffness=50:40"),
                "--over is 40.0; expected a number above",
            ),
            (("hop", "--over", "stiffness=nan:40"), "--over is nan; expected a finite number"),
            (("hop", "--over", "stiffness=40:50", "--at", "60"), "--at is 60.0; expected"),
            (
                ("hop", "--over", "stiffness=40:50", "--speed", "2"),
                "only with gaits that travel; for a hop give --flight-time",
            ),
            (("hop", "--over", "stiffness=1:2"), "--over stiffness is '1:2'; expected two numbers"),
            LATE(("hop", "--over", "nope=1:2"), "unknown parameter 'nope'; nearest of "),
            (("hop", "--over", "nope=1:2", "--at", "1"), "unknown parameter 'nope'; nearest of "),
            (("hop", "--over", "help", "--at", "60"), "each valid parameter: "),
            LATE(("hop", "--over", "stiffness=40:60", "--step", "0"), "step is 0.0; expected"),
            LATE(("hop", "--over", "stiffness=40:60", "--points", "1"), "points is 1; expected"),
            (("hop", "--over", "stiffness=40:60", "--rtol", "0"), "rtol is 0.0; expected"),
            (
                ("hop", "--over", "stiffness=40:60", "--out", "none"),
                "--out is 'none'; expected",
            ),
            LATE(
                ("hop", "--over", "mean_speed=-1:1"),
                "over is 'mean_speed'; expected a number that changes along the branch",
            ),
            LATE(
                ("hop", "--over", "flight_time=0.1:0.3", "--flight-time", "0.2"),
                "a parameter; for a measure leave out --flight-time",
            ),
            (("bound", "--over", "stiffness=1:2", "--at", "1"), "--at is 1.0; expected only with hop"),
            (("bound", "--over", "stiffness=1:2", "--flight-time", "1"), "only with a hop"),
            (("trot", "--over", "mean_speed=1:2", "--speed", "1"), "leave out --speed"),
            (("trot", "--over", "friction=0.7:0.9", "--speed", "0"), "mean_speed is 0.0; expected a number > 0"),
            (("trot", "--over", "mean_speed=-1:3"), "mean_speed is -1.0; expected a number > 0"),
            (("fly", "--over", "friction=1:2"), "'fly'"),
        ],
        ids=words,
    )
    def test_take_one_line(self, capsys, tmp_path, monkeypatch, arguments, text):
        monkeypatch.chdir(tmp_path)
        assert text in refused(capsys, "family", *arguments)
        assert not list(tmp_path.iterdir())
