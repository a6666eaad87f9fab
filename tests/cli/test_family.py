"""`spear family`: what it finds and writes, and one line for every mistake."""

import json

import pytest

from tests.cli.calls import printed, refused, run, words

HOP = ("family", "hop", "--over", "stance_torque", "--from", 7.5, "--to", 8.0)


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
        assert kept["format"] == "spear_pin branch 1" and len(kept["parameter"]) == result["points"]
        assert len(kept["q"]) == len(kept["multipliers"]) == len(kept["order"]) == result["points"]
        assert (tmp_path / "family.svg").stat().st_size > 1000

    def test_from_elsewhere(self, capsys, tmp_path):
        arguments = (*HOP[:4], "--from", 6.9, "--to", 7.9, "--at", 7, "--out", tmp_path)
        status, out, err = run(capsys, *arguments)
        assert status == 0 and err == "" and "stance_torque  what happens" in out and "end: border" in out

    def test_with_a_flight_that_is_kept(self, capsys, tmp_path):
        over = ("--over", "knee_ratio", "--from", 14.9, "--to", 15.1, "--flight-time", 0.2, "--out", tmp_path)
        assert "stance torque" in run(capsys, "family", "hop", *over)[1]

    def test_over_a_measure(self, capsys, tmp_path):
        over = ("--over", "flight_time", "--from", 0.195, "--to", 0.21, "--at", 0.2, "--out", tmp_path)
        result = printed(capsys, "family", "hop", *over)
        assert [end["reason"] for end in result["ends"]] == ["range", "range"]


class TestMistakes:
    @pytest.mark.parametrize(
        ("arguments", "text"),
        [
            (("hop",), "--over"),
            (("hop", "--over", "stiffness"), "--from, --to"),
            (
                ("hop", "--over", "stiffness", "--from", "50", "--to", "40"),
                "--to is 40.0; expected a number above --from",
            ),
            (("hop", "--over", "stiffness", "--from", "nan", "--to", "40"), "--from is nan; expected a finite number"),
            (("hop", "--over", "stiffness", "--from", "40", "--to", "50", "--at", "60"), "--at is 60.0; expected"),
            (("hop", "--over", "stiffness", "--from", "40", "--to", "50", "--speed", "2"), "a hop takes --flight-time"),
            (("hop", "--over", "stiffness", "--from", "1", "--to", "2"), "within is (1.0, 2.0); expected"),
            (("hop", "--over", "nope", "--from", "1", "--to", "2"), "unknown parameter 'nope'; valid:"),
            (("hop", "--over", "nope", "--from", "1", "--to", "2", "--at", "1"), "unknown parameter 'nope'; valid:"),
            (("hop", "--over", "stiffness", "--from", "40", "--to", "60", "--step", "0"), "step is 0.0; expected"),
            (("hop", "--over", "stiffness", "--from", "40", "--to", "60", "--points", "1"), "points is 1; expected"),
            (("hop", "--over", "stiffness", "--from", "40", "--to", "60", "--rtol", "0"), "rtol is 0.0; expected"),
            (
                ("hop", "--over", "stiffness", "--from", "40", "--to", "60", "--out", "none"),
                "--out is 'none'; expected",
            ),
            (
                ("hop", "--over", "flight_time", "--from", "0.1", "--to", "0.3", "--flight-time", "0.2"),
                "another name, or no --flight-time",
            ),
            (("bound", "--over", "stiffness", "--from", "1", "--to", "2", "--at", "1"), "--at is 1.0; expected to go"),
            (("bound", "--over", "stiffness", "--from", "1", "--to", "2", "--flight-time", "1"), "to go with hop"),
            (("trot", "--over", "friction", "--from", "1", "--to", "2", "--speed", "1"), "to go with a bound"),
            (("fly", "--over", "friction", "--from", "1", "--to", "2"), "'fly'"),
        ],
        ids=words,
    )
    def test_take_one_line(self, capsys, tmp_path, monkeypatch, arguments, text):
        monkeypatch.chdir(tmp_path)
        assert text in refused(capsys, "family", *arguments)
        assert not list(tmp_path.iterdir())
