"""`spear dynamics`: its numbers, and one line for every mistake."""

import re

import numpy as np
import pytest

from spear_pin import load
from spear_pin.model.loading import ROBOTS
from tests.cli.calls import printed, refused, run, words
from tests.lagrangian import monopod

STATE = [0.1, 0.55, 0.5, 1.0], [0.2, -0.4, 1.5, -2.5]


class TestDynamics:
    def test_values(self, capsys):
        result = printed(capsys, "dynamics", "spear_ii", "--q", *STATE[0], "--v", *STATE[1])
        terms = monopod().terms(*STATE)
        np.testing.assert_allclose(result["D"], terms.mass_matrix, rtol=0, atol=1e-12)
        np.testing.assert_allclose(np.array(result["C"]) @ STATE[1], terms.coriolis, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["G"], terms.gravity, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["bias"], terms.coriolis + terms.gravity, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["J"]["toe"], terms.jacobians["toe"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["J_dot_v"]["toe"], terms.drifts["toe"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["toe_position"]["toe"], terms.toes["toe"], rtol=0, atol=1e-12)
        assert result["B"] == [[0, 0], [0, 0], [1, 0], [0, 1]]
        assert (result["q"], result["v"]) == STATE

    def test_loops(self, capsys):
        leg = load("crank_hopper")
        q = leg.closed([0.2, -0.35, -0.1, 0.16]).tolist()
        result = printed(capsys, "dynamics", "crank_hopper", "--q", *q, "--v", *[1.0] * 4)
        np.testing.assert_allclose(result["loops_gap"], [0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(result["loops_A"], leg.loop_jacobian(q), rtol=0, atol=1e-12)
        np.testing.assert_allclose(result["loops_A_dot_v"], leg.loop_drift(q, [1.0] * 4), rtol=0, atol=1e-12)
        assert "loops_A" not in printed(capsys, "dynamics", "spear_ii")

    def test_text(self, capsys):
        status, out, err = run(capsys, "dynamics", "spear_ii", "--q", *STATE[0])
        assert status == 0 and err == ""
        assert out.startswith("spear_ii: boom_x, boom_z, hip, knee  (SI units, radians)")
        for name in ("D =", "C =", "G =", "J toe =", "J_dot_v toe =", "toe_position toe ="):
            assert name in out
        assert f"{monopod().terms(*STATE).mass_matrix[2, 2]:.6f}".rstrip("0") in out

    def test_zero_is_the_default(self, capsys):
        result = printed(capsys, "dynamics", "q_spear")
        assert result["q"] == result["v"] == [0.0] * 7

    @pytest.mark.parametrize("number", ["-0.5", "-.5", "-5e-1", "-5E-1"])
    def test_negative_numbers(self, capsys, number):
        result = printed(capsys, "dynamics", "spear_ii", "--q", "0", number, "0.5", "1", "--v", number, "0", "0", "0")
        assert result["q"] == [0.0, -0.5, 0.5, 1.0] and result["v"] == [-0.5, 0.0, 0.0, 0.0]

    def test_lock(self, capsys):
        result = printed(capsys, "dynamics", "spear_ii", "--lock", "boom_x", "boom_z", "--q", "0.5", "1")
        assert result["coordinates"] == ["hip", "knee"]
        np.testing.assert_allclose(result["D"], monopod().terms(*STATE).mass_matrix[2:, 2:], rtol=0, atol=1e-12)

    def test_a_urdf(self, capsys):
        result = printed(capsys, "dynamics", ROBOTS["spear_ii"].path, "--toes", "toe", "--q", *STATE[0])
        np.testing.assert_allclose(result["D"], load("spear_ii").mass_matrix(STATE[0]), rtol=1e-15)
        assert list(result["J"]) == ["toe"]

    def test_a_base_and_motors(self, capsys):
        path = ROBOTS["spear_ii"].path
        result = printed(capsys, "dynamics", path, "--base", "fixed", "--motors", "all", "--repair")
        assert np.shape(result["B"]) == (4, 4)
        assert np.shape(printed(capsys, "dynamics", path, "--motors", "knee")["B"]) == (4, 1)
        assert "valid: free, chain, fixed" in refused(capsys, "dynamics", path, "--base", "floating")
        assert "unknown joint 'ankle'" in refused(capsys, "dynamics", path, "--motors", "ankle")

    def test_what_loading_warns_of_is_one_line(self, capsys, tmp_path):
        text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
        path = tmp_path / "plain.urdf"
        path.write_text(re.sub(r"<transmission.*</transmission>", "", text, flags=re.DOTALL), encoding="utf-8")
        status, out, err = run(capsys, "dynamics", path)
        assert status == 0 and out and err.startswith("spear: spear_ii: no joint has a motor") and err.count("\n") == 1
        assert "--q" in refused(capsys, "dynamics", path, "--q", "1")  # a mistake is said alone

    def test_a_floating_torso(self, capsys):
        """Its configuration has a quaternion, one number more than its velocity."""
        robot = load("q_spear_full")
        q, v = np.linspace(0.1, 0.5, robot.nq), np.linspace(-1.0, 1.0, robot.nv)
        q[3:7] = 0.5
        result = printed(capsys, "dynamics", "q_spear_full", "--q", *q, "--v", *v)
        np.testing.assert_allclose(result["bias"], robot.bias(q, v), rtol=1e-15)
        assert (result["q"], result["v"]) == (q.tolist(), v.tolist())


class TestMistakes:
    @pytest.mark.parametrize(
        ("option", "number", "expected"), [("--q", 18, "19 (base_x, base_y, "), ("--v", 19, "18 (base_vx, ")]
    )
    def test_the_lengths_of_a_floating_torso(self, capsys, option, number, expected):
        text = refused(capsys, "dynamics", "q_spear_full", option, *["0.1"] * number)
        assert f"{option} has {number} numbers; expected {expected}" in text

    @pytest.mark.parametrize("form", [(), ("--json",)], ids=words)
    @pytest.mark.parametrize("option", ["--q", "--v"])
    def test_a_number_out_of_all_proportion(self, capsys, option, form):
        """Its square is no number any more."""
        text = refused(capsys, "dynamics", "spear_ii", option, "0", "0", "0", "1e200", *form)
        assert f"{option[2:]}[3] is 1e+200; expected a finite number within ±1e+30" in text

    def test_an_unknown_robot(self, capsys):
        said = refused(capsys, "dynamics", "spear_iii")
        assert "spear_ii, spear_ii_series, q_spear" in said and "or the path" in said

    def test_a_missing_urdf(self, capsys, tmp_path):
        assert "missing.urdf" in refused(capsys, "dynamics", tmp_path / "missing.urdf")

    def test_a_urdf_that_is_none(self, capsys, tmp_path):
        path = tmp_path / "text.urdf"
        path.write_text("no\nxml\nat all")
        assert "text.urdf" in refused(capsys, "dynamics", path)

    @pytest.mark.parametrize(
        ("arguments", "parts"),
        [
            (["--q", "1", "2"], ["--q has 2 numbers; expected 4 (boom_x, boom_z, hip, knee)"]),
            (["--v", "1"], ["--v has 1 number; expected 4"]),
            (["--q", "0", "nan", "0", "0"], ["q[1]", "nan"]),
            (["--q", "0", "0", "0", "inf"], ["q[3]", "inf"]),
            (["--q", "0", "0", "zero", "0"], ["--q", "zero"]),
            (["--q"], ["--q"]),
            (["--lock", "ankle"], ["unknown joint 'ankle'", "boom_x"]),
            (["--toes", "hoof"], ["unknown frame 'hoof'", "toe"]),
            (["--colour", "red"], ["--colour"]),
        ],
        ids=words,
    )
    def test_arguments(self, capsys, arguments, parts):
        text = refused(capsys, "dynamics", "spear_ii", *arguments)
        assert all(part in text for part in parts), text
