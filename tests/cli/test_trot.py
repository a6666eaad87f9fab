"""`spear trot`: a trot, a pace or a pronk in space held by feedback, its figures and its files."""

import math
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, Trajectory, simulate
from spear_pin.cli.bound_in_space import list_checks_in_space, list_push
from spear_pin.cli.durations import usual
from spear_pin.gaits import feedback
from spear_pin.gaits.parity import merge_multipliers
from spear_pin.hybrid.event_feedback import feedback_of
from tests.cli.calls import printed, refused, rows, run
from tests.gaits.feeding import idle
from tests.solve.kept import FOLDER


def unregulated(gait, inputs=None):
    of = merge_multipliers({None: gait.multipliers})
    return feedback.Regulated(idle(gait), of, of)


@pytest.fixture(scope="module")
def steady(tmp_path_factory):
    return idle(Gait.load("trot")).save(tmp_path_factory.mktemp("trot") / "trot_steady.json")


@pytest.mark.slow
def test_a_gait_with_feedback_is_played(capsys, tmp_path, steady):
    result = printed(capsys, "trot", steady, "--cycles", 2, "--out", tmp_path)
    assert result["goes"] == "trot" and result["in_a_stride"] == 2 and result["cycles"] == 2
    assert result["stride_time"] == pytest.approx(0.459, abs=1e-3) and result["speed"] == pytest.approx(2.0, abs=0.01)
    assert result["residual"] <= 1e-9 and result["slips"] == 0 and result["energy_residual"] < 1e-8
    assert abs(result["aside"]) < 1e-5  # its heading at the beginning is half a degree off its course
    assert result["multipliers_without_feedback"] is None and result["stable"] is False
    assert result["lost"] is None and result["beyond_limits"] == []
    assert Trajectory.load(tmp_path / "trot.npz").cycles == 4
    assert result["files"] == [str(tmp_path / f"trot.{suffix}") for suffix in ("html", "npz", "svg")]
    assert all(Path(file).stat().st_size > 10_000 for file in result["files"])


@pytest.mark.slow
def test_feedback_is_found_and_kept(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(feedback, "regulate", unregulated)
    status, out, _ = run(capsys, "trot", "pace", "--push", 0.01, "--cycles", 1, "--out", tmp_path)
    said = rows(out)
    assert status == 0 and said["gait"] == "pace, a pace in space"
    assert "unstable" in said["without feedback"] and "all: 1.5" in out and said["push"] == "0.01 m/s to the left"
    kept = Gait.load(tmp_path / "trot_steady.json")
    assert feedback_of(kept.system) is not None
    q, v = kept.state
    v[1] += 0.01
    wanted, motion = simulate(kept.system, (q, v), 1), Trajectory.load(tmp_path / "trot.npz")
    np.testing.assert_allclose(motion.v[0], wanted.v[0], rtol=0, atol=1e-12)


@pytest.mark.slow
def test_a_pronk_is_held_by_all_inputs(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(feedback, "regulate", unregulated)
    result = printed(capsys, "trot", "pronk", "--cycles", 1, "--out", tmp_path)
    assert result["goes"] == "pronk" and result["in_a_stride"] == 1 and result["cycles"] == 1
    assert result["stride_time"] == pytest.approx(0.289, abs=1e-3) and result["speed"] == pytest.approx(2.0, abs=1e-6)
    assert Gait.load(tmp_path / "trot_steady.json").system.kind == "pronking"


def test_rows_of_a_push_and_of_a_cycle():
    summary = {"push": 0.0, "aside": 0.0, "heading": 0.0, "largest_roll": 0.0}
    assert list_push(summary)[0] == ("push", "none")
    assert list_push(summary | {"push": -0.1})[0] == ("push", "-0.1 m/s to the left")
    summary = {"friction_used": 0.5, "friction_used_across": 0.1, "slips": 0, "energy_residual": 1e-9}
    joints = {part: {"range": 0, "speed": 0, "torque": 0, "power": 0} for part in ("adduction", "hip", "knee")}
    summary |= {"joints": joints, "cycles": 2, "reason": "complete"}
    said = dict(list_checks_in_space(summary, "half a stride"))
    assert said["energy ledger"] == "closes to 1.0e-09 J in half a stride"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("nowhere",), "unknown gait"),
        (("nowhere.json",), "nowhere.json"),
        (("long_stride",), "trot, pace, pronk, or the file of a saved"),
        (("turn_9",), "trot, pace, pronk, or the file of a saved"),
        (("--push", math.nan), "--push"),
        (("--cycles", 0), "--cycles"),
    ],
    ids=str,
)
def test_refused(capsys, tmp_path, words, said):
    assert said in refused(capsys, "trot", *words, "--out", tmp_path)


def test_it_says_how_long_it_takes(capsys):
    assert usual("trot") in " ".join(run(capsys, "trot", "--help")[1].split())


@pytest.mark.slow
def test_a_push_is_recovered_from(capsys, tmp_path):
    result = printed(capsys, "trot", FOLDER / "trot_steady.json", "--push", 0.2, "--out", tmp_path)
    assert result["cycles"] == 10 and abs(math.degrees(result["heading"])) < 3.0
    assert abs(complex(*result["multipliers"][0])) < 0.5


def test_feedback_of_the_shipped_trot_is_found_and_holds_it(capsys, tmp_path):
    result = printed(capsys, "trot", "--push", 0.2, "--out", tmp_path)
    assert result["cycles"] == 10 and abs(math.degrees(result["heading"])) < 3.0
    assert abs(complex(*result["multipliers"][0])) < 0.5 < abs(complex(*result["multipliers_without_feedback"][0]))
