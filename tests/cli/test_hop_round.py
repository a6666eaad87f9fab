"""`spear hop --robot hoppy`: the hop round its post."""

import math

import pytest

from spear_pin import Gait, Trajectory
from tests.cli.calls import printed, refused, run


@pytest.mark.slow
def test_hops_round_its_post(capsys, tmp_path):
    result = printed(capsys, "hop", "--robot", "hoppy", "--cycles", 2, "--save", "--out", tmp_path)
    assert (result["reason"], result["cycles"], result["stable"]) == ("complete", 2, True)
    assert math.degrees(result["turn"]) == pytest.approx(-40.486, abs=1e-2)
    assert result["speed"] == pytest.approx(0.556 * result["turn"] / result["period"])
    assert 0.02 < result["sway"] < 0.03 and result["friction_at_impact"] < result["friction_used"]
    assert result["residual"] < 1e-9 and result["energy_residual"] < 1e-8
    assert {each["joint"] for each in result["beyond_limits"]} == {"hip", "knee"}
    motion, gait = Trajectory.load(tmp_path / "hop.npz"), Gait.load(tmp_path / "hop.json")
    assert motion.force.shape[1:] == (1, 2) and motion.load_robot().post == (0.0, 0.0)
    assert gait.system.kind == "round_hopping" and gait.period == result["period"]
    assert (tmp_path / "hop.html").stat().st_size < 3_000_000


@pytest.mark.slow
def test_says_so(capsys, tmp_path):
    status, out, _ = run(capsys, "hop", "--robot", "hoppy", "--cycles", 1, "--out", tmp_path)
    assert status == 0 and "40.49° a hop to the right, 0.6944 m/s" in out and "torque of the knee 5.95" in out


@pytest.mark.slow
def test_with_a_limit_of_friction(capsys, tmp_path):
    result = printed(capsys, "hop", "--robot", "hoppy", "--friction", 0.8, "--cycles", 1, "--out", tmp_path)
    assert result["friction"] == 0.8 and result["friction_used"] == pytest.approx(0.8) and result["slips"] > 0
    assert result["period"] == pytest.approx(0.6452, abs=1e-4)


@pytest.mark.parametrize("option", ["--knee", "--flight-time", "--slope", "--stiffness", "--body", "--noise"])
def test_options_of_another_law(capsys, tmp_path, option):
    said = refused(capsys, "hop", "--robot", "hoppy", option, "0.3", "--out", tmp_path)
    assert option in said and "goes round a post" in said
