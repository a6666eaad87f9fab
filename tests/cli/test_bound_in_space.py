"""`spear bound --space`: a gait of the plane in space, kept upright, and pushed."""

import pytest

from spear_pin import Gait, Trajectory
from spear_pin.hybrid.event_feedback import feedback_of
from tests.cli.calls import printed, refused
from tests.solve.kept import FOLDER


@pytest.mark.slow
def test_a_push_is_recovered_from(capsys, tmp_path):
    result = printed(capsys, "bound", "--space", "--push", 0.1, "--cycles", 6, "--save", "--out", tmp_path)
    assert result["reason"] == "complete" and result["cycles"] == 6
    for of, lateral, along in (("_without_feedback", 1.569, 1.0674), ("", 0.308, 1.0674)):
        moduli = [abs(complex(*each)) for each in result[f"multipliers{of}"]]
        kinds = result[f"kinds{of}"]
        assert len(moduli) == len(kinds) == 32
        assert moduli[kinds.index("lateral")] == pytest.approx(lateral, abs=5e-3)
        assert moduli[kinds.index("along")] == pytest.approx(along, abs=1e-4)
        assert result[f"stable{of}"] is False
    assert result["lost"] is None and result["beyond_limits"] == [] and result["implausible"] == []
    assert result["residual"] <= 1e-9 and result["energy_residual"] <= 1e-8
    assert 0.0 < result["joints"]["adduction"]["range"] < result["joints"]["knee"]["range"]
    motion = Trajectory.load(tmp_path / "bound_in_space.npz")
    assert motion.force.shape[1:] == (4, 3) and motion.load_robot().coordinates[:3] == motion.coordinates[:3]
    assert (tmp_path / "bound_in_space.html").stat().st_size < 5_000_000
    kept = tmp_path / "bound_in_space.json"
    assert str(kept) in result["files"] and feedback_of(Gait.load(kept).system).inputs == ("posterior_adduction",)
    assert "--space plays it" in refused(capsys, "bound", "--gait", kept, "--out", tmp_path)
    assert "has feedback" in refused(capsys, "bound", "--space", "--gait", kept, "--keep-heading", "--out", tmp_path)
    again = printed(capsys, "bound", "--space", "--gait", kept, "--push", 0.1, "--cycles", 6, "--out", tmp_path)
    assert again["multipliers"] == result["multipliers"] and again["multipliers_without_feedback"] is None
    assert again["aside"] == pytest.approx(result["aside"], abs=1e-9) and again["inputs"] == result["inputs"]


@pytest.mark.slow
def test_a_kept_gait_is_pushed(capsys, tmp_path):
    asked = ("bound", "--space", "--gait", FOLDER / "long_stride_upright.json", "--out", tmp_path)
    result = printed(capsys, *asked, "--push", 0.1, "--cycles", 2)
    assert result["reason"] == "complete" and result["cycles"] == 2 and result["lost"] is None
    assert max(abs(complex(*each)) for each in result["multipliers"]) == pytest.approx(1.0674, abs=1e-4)
    assert result["residual"] <= 1e-9 and result["energy_residual"] <= 1e-8 and result["beyond_limits"] == []
    motion = Trajectory.load(tmp_path / "bound_in_space.npz")
    assert motion.force.shape[1:] == (4, 3) and motion.v[0, 1] == pytest.approx(0.1, abs=1e-3)
    assert (tmp_path / "bound_in_space.html").stat().st_size < 5_000_000
    assert "has feedback" in refused(capsys, *asked, "--keep-heading")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--push", 0.1), "--space"),
        (("--keep-heading",), "--space"),
        (("--space", "--speed", 2.0), "--speed"),
        (("--space", "--push", "nan"), "--push"),
        (("--space", "--push", 1e4), "within ±1000"),
    ],
)
def test_refused(capsys, tmp_path, options, said):
    assert said in refused(capsys, "bound", *options, "--out", tmp_path)
