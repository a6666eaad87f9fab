"""`spear turn`: a gait that turns, its figures and its files; `tests/gaits/orbits/test_turning.py` has it find one."""

from pathlib import Path

import numpy as np
import pytest

from spear_pin import Trajectory
from spear_pin.cli.durations import usual
from spear_pin.errors import NoGait
from spear_pin.gaits.orbits import turning
from tests.cli.calls import printed, refused, rows, run

KEPT = Path(__file__).parents[2] / "examples" / "turn.json"


@pytest.mark.slow
def test_a_kept_turn_is_played(capsys, tmp_path):
    result = printed(capsys, "turn", KEPT, "--cycles", 2, "--out", tmp_path)
    assert np.degrees(result["turn"]) == pytest.approx(4.0, abs=1e-6)
    assert result["speed"] == pytest.approx(result["radius"] * result["rate"], rel=1e-12)
    assert result["lateral_acceleration"] == pytest.approx(result["speed"] ** 2 / result["radius"], rel=1e-12)
    assert result["residual"] <= 1e-9 and result["largest_multiplier"] == pytest.approx(1.061, abs=1e-3)
    joints = result["joints"]
    assert 0.0 < joints["adduction"]["power"] < joints["knee"]["power"]
    motion = Trajectory.load(tmp_path / "turn.npz")
    x, y = motion.q[motion.cycle == 2][-1, :2]
    # a chord of the circle, seen from the heading at the begin
    chord = 2.0 * result["radius"] * np.sin(result["turn"])
    assert np.hypot(x, y) == pytest.approx(chord, rel=1e-6)
    assert np.arctan2(y, x) == pytest.approx(result["turn"] + result["drift"], abs=1e-6)
    assert result["files"] == [str(tmp_path / f"turn.{suffix}") for suffix in ("html", "npz", "svg")]
    assert all(Path(file).stat().st_size > 10_000 for file in result["files"])
    assert "turning left by 11.3°/s" in (tmp_path / "turn.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_limits_that_are_not_kept_are_told(capsys, tmp_path):
    """Hips of 120 N·m take 158 in the tightest turn that ships: in print, JSON and page."""
    status, out, _ = run(capsys, "turn", "turn_13", "--cycles", 1, "--out", tmp_path)
    told = "torque of the posterior_left_hip 158, its limit 120 N·m"
    assert status == 0 and told in out and "but implausible" in out
    assert told in (tmp_path / "turn.html").read_text(encoding="utf-8")
    result = printed(capsys, "turn", "turn_13", "--cycles", 1, "--out", tmp_path)
    assert {each["joint"] for each in result["beyond_limits"]} >= {"posterior_left_hip", "posterior_right_hip"}


@pytest.mark.slow
def test_text(capsys, tmp_path):
    status, out, _ = run(capsys, "turn", KEPT, "--cycles", 1, "--out", tmp_path)
    said = rows(out)
    assert "all: 1.0" in out and "unstable" in out  # and its moduli
    assert status == 0 and said["turn"].startswith("4.000° a stride, 11.3") and said["radius"].endswith(" m")
    assert "to the left" in said["gait"] and "W" in said["adduction"] and said["slips"] == "0"


@pytest.mark.slow
def test_a_motion_that_is_lost_is_one_line(capsys, tmp_path, monkeypatch):
    asked = []

    def lost(gait, turn, **options):
        asked.append((gait.system.law.adduction_stiffness, np.degrees(turn)))
        raise NoGait("the turn was lost in stride 7: it fell", 0.3)

    monkeypatch.setattr(turning, "find_turn", lost)
    said = refused(capsys, "turn", "--rate", 20, "--out", tmp_path)
    assert "lost in stride 7" in said and list(tmp_path.iterdir()) == []
    refused(capsys, "turn", "--angle", -3, "--out", tmp_path)
    (free, by_rate), (_, by_angle) = asked
    assert free == 0.0 and by_rate == pytest.approx(20 * 0.3502, abs=0.01) and by_angle == pytest.approx(-3.0)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--angle", 0), "--angle is 0"),
        (("--rate", "nan"), "--rate"),
        (("--angle", 60), "within ±50"),
        (("--rate", 1000), "--rate is 1000"),
        (("--rate", 5, "--angle", 2), "not allowed with"),
        (("nowhere",), "unknown gait"),
        (("nowhere.json",), "nowhere.json"),
        ((KEPT, "--angle", 2), "which has its own turn"),
        (("--cycles", 0), "--cycles"),
    ],
    ids=str,
)
def test_refused(capsys, tmp_path, words, said):
    assert said in refused(capsys, "turn", *words, "--out", tmp_path)


def test_it_says_how_long_it_takes(capsys):
    assert usual("turn") in " ".join(run(capsys, "turn", "--help")[1].split())
