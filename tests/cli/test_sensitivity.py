"""`spear sensitivity`: what it finds and writes, and one line for every mistake."""

import json

import pytest

from tests.cli.calls import printed, refused, run, words


@pytest.mark.extra("heyoka")
def test_a_hop(capsys, tmp_path):
    result = printed(capsys, "sensitivity", "hop", "--over", "stiffness,knee_mass", "--out", tmp_path)
    assert list(result["parameters"]) == ["stiffness", "knee_mass"]
    assert result["elasticities"]["flight_time"] == pytest.approx([-0.0606, -0.0968], abs=1e-3)
    kept = json.loads((tmp_path / "sensitivity.json").read_text())
    assert kept["units"] == {"stiffness": "N·m/rad", "knee_mass": "kg"}
    assert (tmp_path / "sensitivity.svg").stat().st_size > 1000


@pytest.mark.extra("heyoka")
def test_with_a_flight_that_is_kept(capsys, tmp_path):
    given = ("--vary", "stance_torque", "--keep", "flight_time", "--out", tmp_path)
    status, out, err = run(capsys, "sensitivity", "hop", *given)
    assert status == 0 and err == "" and "% for one more %" in out and "knee_ratio" in out


@pytest.mark.extra("heyoka")
def test_with_a_motor(capsys, tmp_path):
    given = ("--over", "knee_ratio", "--motor", "knee=spear_ii_knee", "--out", tmp_path)
    result = printed(capsys, "sensitivity", "hop", *given)
    assert result["values"]["heat_knee"] == pytest.approx(9.991, abs=1e-3) and result["units"]["energy"] == "J"
    assert result["elasticities"]["heat_knee"] == pytest.approx([-1.335], abs=1e-3)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("fly",), "'fly'"),
        (("hop", "--over", "nope"), "'nope'"),
        (("hop", "--over", "stiffness", "--vary", "stance_torque"), "as many measures"),
        (("hop", "--keep", "help"), "each valid measure: stance_time, "),
        (("hop", "--motor", "knee=nope"), "'nope'"),
        (("hop", "--motor", "toe=spear_ii_knee"), "'toe'"),
        (("hop", "--motor", "knee=ec_45"), "'ec_45'"),
        (("hop", "--efficiency", "0.9"), "--efficiency is 0.9; expected only with --bus"),
        (("hop", "--bus", "9"), "--bus is 9.0; expected only with --motor JOINT=MOTOR"),
        (("hop", "--out", "none"), "--out is 'none'; expected"),
    ],
    ids=words,
)
def test_mistakes_take_one_line(capsys, tmp_path, monkeypatch, arguments, text):
    monkeypatch.chdir(tmp_path)
    assert text in refused(capsys, "sensitivity", *arguments)
    assert not list(tmp_path.iterdir())
