"""`spear design`: what it finds and writes, and one line for every mistake."""

import json

import pytest

from spear_pin import Gait
from tests.cli.calls import printed, refused, words

HOP = ("design", "hop", "--minimize", "energy", "--motor", "knee=spear_ii_knee", "--keep", "flight_time=0.2")


@pytest.mark.extra("heyoka")
def test_a_hop(capsys, tmp_path):
    given = ("--over", "stiffness=46:56,knee_touchdown=0.85:1.02", "--at-least", "margin_spring_switch=0.01")
    also = ("--largest-multiplier", "0.6", "--out", tmp_path)
    result = printed(capsys, *HOP, *given, *also)
    assert result["converged"] and result["objective"] < 21.0 and result["cycles"] < 100
    assert set(result["parameters"]) == {"stiffness", "knee_touchdown"} and result["active"]
    kept = json.loads((tmp_path / "design.json").read_text())
    assert kept["objective"] == pytest.approx(result["objective"])
    assert Gait.load(tmp_path / "design_gait.json").stable
    assert (tmp_path / "design.svg").stat().st_size > 1000


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (HOP, "--over"),
        ((*HOP, "--over", "stiffness"), "is not NAME=LOW:HIGH"),
        ((*HOP, "--over", "help"), "each valid parameter: knee_touchdown, "),
        ((*HOP, "--over", "stiffness=40:60", "--at-most", "help"), "each valid measure: stance_time, "),
        (
            (
                "design",
                "hop",
                "--minimize",
                "help",
                "--keep",
                "flight_time=0.2,period=0.5",
                *("--over", "stiffness=46:56"),
            ),
            "each valid measure: stance_time, ",
        ),
        ((*HOP, "--over", "stiffness=1:2"), "the gait's own value"),
        ((*HOP, "--over", "stiffness=40:60", "--at-most", "work"), "is not NAME=VALUE"),
        ((*HOP, "--over", "stiffness=40:60", "--at-most", "nope=1"), "'nope'"),
        ((*HOP, "--over", "stiffness=40:60", "--motor", "hip=nope"), "'nope'"),
        (
            (*HOP, "--over", "stiffness=40:60", "--motor", "knee=spear_ii_knee"),
            "--motor is 'knee'; expected each name once",
        ),
        ((*HOP, "--over", "stiffness=40:60,stiffness=30:60"), "--over is 'stiffness'; expected each name once"),
        ((*HOP, "--over", "stiffness=40:60", "--out", "none"), "--out is 'none'; expected"),
        ((*HOP, "--over", "stiffness=40:60", "--iterations", "-1"), "iterations"),
        (("design", "fly", "--minimize", "work", "--over", "stiffness=40:60"), "'fly'"),
    ],
    ids=words,
)
def test_mistakes_take_one_line(capsys, tmp_path, monkeypatch, arguments, text):
    monkeypatch.chdir(tmp_path)
    assert text in refused(capsys, *arguments)
    assert not list(tmp_path.iterdir())
