"""`spear replay`: the model beside a log whose torques drive it, in numbers and a picture."""

import pytest

from spear_pin import hopping, load, simulate
from tests.cli.calls import printed, refused, run, words
from tests.wrong_calls.files import hops

TRUE = "stiffness=400,rest=0.1459"


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_the_true_model_is_not_off(capsys, lab, tmp_path):
    shown = printed(capsys, "replay", "leg.toml", "hops.csv", "--set", TRUE, "--out", tmp_path)
    assert len(shown["hops"]) == 3 and shown["files"] == [str(tmp_path / "replay.svg")]
    assert (tmp_path / "replay.svg").is_file()
    for hop in shown["hops"]:
        for each in hop["measures"].values():
            assert each["model"] == pytest.approx(each["log"], rel=0.02)


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_its_text_and_a_false_model(capsys, lab, tmp_path):
    status, out, _ = run(capsys, "replay", "leg.toml", "hops.csv", "--out", tmp_path)
    lines = out.splitlines()
    assert status == 0 and lines[0].split() == ["model", "log", "off"]
    assert [line.split(" from ")[0] for line in lines[1:4]] == ["compression", "stance", "push_off"]
    off = float(lines[1].split()[-2])
    assert off < -20.0 and lines[1].endswith(" %")
    assert "synthetic, not measured" in lines and f"picture: {tmp_path}/replay.svg" in lines


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_what_a_leg_that_never_lifts_off_does_not_have(capsys, tmp_path):
    leg = hopping(load("spear_ii", locked=["boom_x"]))
    path = simulate(leg, leg.guess(), 1, progress=False).save(tmp_path / "hop.npz")
    status, out, _ = run(capsys, "replay", "hop", path, "--set", "torque_scale=0.01", "--out", tmp_path)
    lines = out.splitlines()
    assert status == 0 and [line.split()[-1] for line in lines[2:4]] == ["–", "–"] and "nan" not in out
    assert "note: – where a leg never gets as long as it is when it lifts off in the log" in lines


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_the_law_acts(capsys, tmp_path):
    leg = hopping(load("spear_ii", locked=["boom_x"]))
    simulate(leg, leg.guess(), 2, samples=200, progress=False).export(tmp_path / "hop.csv")
    shown = printed(capsys, "replay", "hop", tmp_path / "hop.csv", "--law", "--out", tmp_path)
    assert 'motors="law"' in shown["python"]
    assert all(
        abs(hop["measures"]["stance"]["model"] / hop["measures"]["stance"]["log"] - 1) < 0.02 for hop in shown["hops"]
    )


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (["--window", "0"], "window is 0.0; expected a number > 0, in s"),
        (["--window", "100"], "window is 100.0; expected at most 0."),
        (["--set", "lag=nan"], "lag is nan; expected a number from -1 to 1, in s"),
        (["--settle", "-1"], "settle is -1.0; expected a number >= 0, in s"),
        (["--set", "nope=1"], "unknown"),
        (["--column", "knee=crank_deg"], "unknown quantity in --column 'knee'; valid: time, mode, boom_z"),
        (["--out", "none"], "expected an existing folder"),
    ],
    ids=words,
)
def test_mistakes(capsys, tmp_path, monkeypatch, asked, said):
    monkeypatch.chdir(tmp_path)
    hops(tmp_path / "hops.csv")
    assert said in refused(capsys, "replay", "crank_hopper", "hops.csv", *asked)
    assert [path.name for path in tmp_path.iterdir()] == ["hops.csv"]


@pytest.mark.extra("heyoka")
def test_it_lists_the_numbers_of_the_leg(capsys, tmp_path):
    leg = hopping(load("spear_ii", locked=["boom_x"]))
    path = simulate(leg, leg.guess(), 1, progress=False).save(tmp_path / "hop.npz")
    said = refused(capsys, "replay", "hop", path, "--set", "help", "--out", tmp_path)
    assert "each valid number of the leg: torque_scale, " in said and ", friction," not in said
