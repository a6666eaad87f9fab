"""`spear uncertainty`: what it finds and writes, and one line for every mistake."""

import json

import numpy as np
import pytest

from tests.cli.calls import printed, refused, run, words

HOP = ("uncertainty", "hop", "--sigma", "stiffness=1%", "--sigma", "damping=0.02")
KEPT = ("--vary", "stance_torque", "--keep", "flight_time")


@pytest.mark.extra("heyoka")
def test_a_hop(capsys, tmp_path):
    result = printed(capsys, *HOP, *KEPT, "--monte-carlo", "20", "--out", tmp_path)
    first, drawn = result["uncertainty"], result["monte_carlo"]
    assert first["deviations"] == pytest.approx({"stiffness": 0.4884, "damping": 0.02})
    torque = first["outputs"]["stance_torque"]
    # half of the torque's spread would be that of one parameter: they add in squares
    assert torque["deviation"] == pytest.approx(0.101, abs=2e-3) and sum(torque["gains"]) == pytest.approx(1.0)
    assert drawn["samples"] == drawn["same_order"] == 20
    assert drawn["outputs"]["stance_torque"]["first_order"] == torque["deviation"]
    assert drawn["outputs"]["flight_time"]["verdict"] == "stays"
    assert json.loads((tmp_path / "uncertainty.json").read_text())["uncertainty"] == first
    for name in ("uncertainty.svg", "monte_carlo.svg"):
        assert (tmp_path / name).stat().st_size > 1000


@pytest.mark.extra("heyoka")
def test_correlated_errors(capsys, tmp_path):
    given = ("--correlation", "damping,stiffness=-0.5", "--out", tmp_path)
    covariance = np.array(printed(capsys, *HOP, *given)["uncertainty"]["covariance"])
    assert covariance[0, 1] == covariance[1, 0] == pytest.approx(-0.5 * 0.4884 * 0.02)
    status, out, err = run(capsys, *HOP, *given)
    assert status == 0 and err == "" and "correlated" in out and not (tmp_path / "monte_carlo.svg").exists()


@pytest.mark.extra("heyoka")
def test_with_a_motor(capsys, tmp_path):
    """1 % of the gear ratio, of which heat has an elasticity of -1.335, is 1.335 % of 9.991 J."""
    given = ("uncertainty", "hop", "--sigma", "knee_ratio=1%", "--motor", "knee=spear_ii_knee", "--out", tmp_path)
    heat = printed(capsys, *given)["uncertainty"]["outputs"]["heat_knee"]
    assert heat["deviation"] == pytest.approx(0.1334, abs=1e-4)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("hop",), "--sigma"),
        (("hop", "--sigma", "stiffness"), "is not NAME=VALUE"),
        (("hop", "--sigma", "stiffness=x"), "'x'"),
        (("hop", "--sigma", "stiffness=-1"), ">= 0"),
        (("hop", "--sigma", "nope=1"), "'nope'"),
        (("hop", "--sigma", "stiffness=1", "--motor", "knee=nope"), "'nope'"),
        (("hop", "--sigma", "stiffness=1", "--sigma", "stiffness=2"), "each name once"),
        (
            ("hop", "--sigma", "stiffness=0"),
            "--sigma is {'stiffness': '0'}; expected at least one standard deviation",
        ),
        (("hop", "--sigma", "stiffness=1", "--correlation", "stiffness=1"), "--correlation is 'stiffness=1'"),
        (("hop", "--sigma", "stiffness=1", "--correlation", "stiffness,damping=1"), "'damping'"),
        ((*HOP[1:], "--correlation", "stiffness,damping=2"), "from -1 to 1"),
        (
            (*HOP[1:], "--correlation", "stiffness, damping=.3", "--correlation", "damping,stiffness=.9"),
            "each pair of parameters once",
        ),
        (("hop", "--sigma", "stiffness=1", "--monte-carlo", "1"), "--monte-carlo is 1"),
        (("hop", "--sigma", "stiffness=1", "--seed", "-1"), "--seed is -1"),
        (("hop", "--sigma", "stiffness=1", "--out", "none"), "--out is 'none'; expected"),
    ],
    ids=words,
)
def test_mistakes_take_one_line(capsys, tmp_path, monkeypatch, arguments, text):
    monkeypatch.chdir(tmp_path)
    assert text in refused(capsys, "uncertainty", *arguments)
    assert not list(tmp_path.iterdir())
