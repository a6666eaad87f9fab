"""`spear bound --space`: a gait of the plane in space, kept upright, and pushed."""

import pytest

from spear_pin import Trajectory
from tests.cli.calls import printed, refused


@pytest.mark.slow
def test_a_push_is_recovered_from(capsys, tmp_path):
    result = printed(capsys, "bound", "--space", "--push", 0.1, "--cycles", 6, "--out", tmp_path)
    assert result["reason"] == "complete" and result["cycles"] == 6
    assert abs(complex(*result["multipliers_without_feedback"][0])) == pytest.approx(1.569, abs=5e-3)
    assert abs(complex(*result["multipliers"][0])) < 0.55
    assert result["residual"] <= 1e-9 and result["energy_residual"] <= 1e-8
    assert 0.0 < result["joints"]["adduction"]["range"] < result["joints"]["knee"]["range"]
    motion = Trajectory.load(tmp_path / "bound_in_space.npz")
    assert motion.force.shape[1:] == (4, 3) and motion.load_robot().coordinates[:3] == motion.coordinates[:3]
    assert (tmp_path / "bound_in_space.html").stat().st_size < 5_000_000


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--push", 0.1), "--space"),
        (("--keep-heading",), "--space"),
        (("--space", "--speed", 2.0), "--speed"),
        (("--space", "--save"), "--save"),
        (("--space", "--push", "nan"), "--push"),
    ],
)
def test_refused(capsys, tmp_path, options, said):
    assert said in refused(capsys, "bound", *options, "--out", tmp_path)
