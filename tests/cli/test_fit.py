"""`spear fit`: from a laboratory's log to fitted numbers with their errors, and one line for every mistake."""

import json

import pytest

from tests.cli.calls import printed, refused, rows, run, words
from tests.wrong_calls.files import hops

OVER = "--over", "stiffness,rest"


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_truth_is_found(capsys, lab, tmp_path):
    """Names, units, a torque before the gear and Unix time in ns are as in a laboratory."""
    shown = printed(capsys, "fit", "leg.toml", "hops.csv", *OVER, "--out", tmp_path)
    for name, truth in (("stiffness", 400.0), ("rest", 0.1459)):
        found = shown["found"][name]
        assert abs(found["value"] - truth) < 4 * found["deviation"] < 1e-3 * truth
    assert shown["found"]["stiffness"]["unit"] == "N/m" and shown["converged"]
    assert 0.9e-4 < shown["rms"] < 1.1e-4 and shown["inflation"] < 1.5
    assert [phase["name"] for phase in shown["phases"]] == ["stance", "flight"] * 3
    assert {phase["log"] for phase in shown["phases"]} == {"hops.csv"}
    assert shown["correlation"][0][0] == pytest.approx(1.0) and abs(shown["correlation"][0][1]) < 1.0
    assert [*map(str, (tmp_path / "fit.json", tmp_path / "fit.svg"))] == shown["files"]
    assert json.loads((tmp_path / "fit.json").read_text())["found"] == shown["found"]


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_its_text(capsys, lab, tmp_path):
    """Options go before the TOML file, so that the torque is read as the joint's."""
    columns = ("--column", "time=stamp", "--column", "crank=theta_deg", "--column", "crank_torque=drive_mNm")
    asked = ("--over", "stiffness", "--phases", "stance", "--out", tmp_path)
    status, out, _ = run(capsys, "fit", "leg.toml", "hops.csv", *columns, *asked)
    assert status == 0
    found = rows(out)
    assert found["stiffness"].endswith(" N/m") and "±" in found["stiffness"]
    assert found["phases"] == "3" and found["rms"].endswith(" rad")
    for line in (
        "note: hops.csv: 'stamp' names no unit: taken as ns, by its name or as Unix time",
        "note: hops.csv: columns that are not read: 'temperature'",
        "synthetic, not measured",
        f"files: {tmp_path}/fit.json, {tmp_path}/fit.svg",
    ):
        assert line in out.splitlines()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (
            ["--over", "stiffness", "--column", "time=time_s", "--column", "crank=crank_deg"],
            "log hops.csv is ['crank']; expected 'crank_torque' as well; of a motor that is off, zeros",
        ),
        (["hops.csv", "--over", "stiffness"], "log is ['hops.csv', 'hops.csv']; expected different logs, each once"),
        (["--over", "stiffness", "--set", "torque_scale=-1"], "torque_scale is -1.0; expected a number > 0"),
        (["--over", "nope"], "unknown number of the leg 'nope'"),
        (["--over", "stiffness,stiffness"], "each once"),
        ([], "--over"),
        (["--over", "stiffness", "--phases", "air"], "'stance', 'flight' or both"),
        (
            ["--over", "stiffness", "--column", "crnk=crank_deg"],
            "unknown quantity in --column 'crnk'; valid: time, mode",
        ),
        (["--over", "stiffness", "--column", "crank=theta"], "unknown column for 'crank' in hops.csv: 'theta'; valid"),
        (["--over", "stiffness", "--unit", "crank_deg=furlong"], "'furlong'; valid: rad, mrad, deg, turns"),
        (
            ["--over", "stiffness", "--unit", "crank=deg"],
            "unknown column in units, of hops.csv: 'crank'; valid: time_s",
        ),
        (["--over", "stiffness", "--settle", "nan"], "settle is nan; expected a number >= 0, in s"),
        (["--over", "stiffness", "--set", "stiffness"], "NAME=VALUE"),
        (["--over", "stiffness", "--out", "none"], "expected an existing folder"),
        (["none.csv", "--over", "stiffness"], "none.csv"),
    ],
    ids=words,
)
def test_mistakes(capsys, tmp_path, monkeypatch, asked, said):
    monkeypatch.chdir(tmp_path)
    hops(tmp_path / "hops.csv")
    assert said in refused(capsys, "fit", "crank_hopper", "hops.csv", *asked)
    assert [path.name for path in tmp_path.iterdir()] == ["hops.csv"]


def test_a_robot_that_has_other_joints(capsys, tmp_path):
    line = refused(capsys, "fit", "spear_ii", hops(tmp_path / "hops.csv"), "--over", "stiffness", "--out", tmp_path)
    assert "joint of spear_ii" in line.lower().replace("-", "_") and "hip, knee" in line


def test_a_spring_that_rests_where_its_switch_closes(capsys, tmp_path):
    path = tmp_path / "hops.csv"
    path.write_bytes(hops(path).read_bytes().replace(b"crank_deg,crank_torque", b"knee_deg,knee_torque", 1))
    line = refused(capsys, "fit", "spear_ii", path, "--over", "rest", "--out", tmp_path)
    assert "rest is None; expected a number: set it in the law, spring or ground first" in line
