"""A trot: the automaton of the bound with diagonal pairs, a gait by half a stride seen in the mirror."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, Robot, TrotLaw, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.linear import linear
from spear_pin.hybrid.newton import STEP
from spear_pin.hybrid.periodic import chart, eigenvalues, residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import head_state, mirror_of
from tests.solve.gaits import trot_steady
from tests.solve.kept import jacobian


@cache
def trot():
    return Gait.load("trot")


@cache
def stride():
    return run(trot().system, trot().state, 2, Options(rtol=1e-11))


def test_gravity_that_is_not_along_z_is_refused():
    """Turned about z the robot would not do the same, and in the mirror neither."""
    system = trot().system
    model = system.robot.model.copy()
    model.gravity.linear = np.array([0.0, 0.5, -9.8])
    tilted = Robot(model, name="tilted", toes=system.robot.toes, actuated=system.robot.actuated)
    with pytest.raises(BadValue, match=r"gravity is \(0.0, 0.5, -9.8\).*along z"):
        replace(system, robot=tilted)


class TestOrbit:
    @pytest.mark.slow
    def test_residual(self):
        assert residual(trot().system, trot().state) <= 1e-9

    @pytest.mark.slow
    def test_half_a_stride_is_the_mirror_image_of_the_other(self):
        system, mirror = trot().system, mirror_of(trot().system.robot)
        half = return_map(system, trot().state, 1e-11)
        for part, own in zip(head_state(*half.state), head_state(*trot().state), strict=True):
            np.testing.assert_allclose(part, mirror(own), rtol=0, atol=1e-8)
            assert abs(part - own).max() > 1e-3

    @pytest.mark.slow
    def test_a_whole_stride_leads_back(self):
        for part, own in zip(head_state(*stride().state), head_state(*trot().state), strict=True):
            np.testing.assert_allclose(part, own, rtol=0, atol=1e-7)
        assert stride().state[0][3] - trot().state[0][3] == pytest.approx(0.0, abs=1e-8)

    @pytest.mark.slow
    def test_ledger(self):
        for change, work in zip(stride().change, stride().work, strict=True):
            assert abs(change - work.sum()) <= 1e-8

    def test_diagonal_legs_bear_together_and_it_flies_between(self):
        half = return_map(trot().system, trot().state)
        assert half.durations["diagonal_left_stance"] == pytest.approx(0.142, abs=1e-3)
        assert half.durations["flight_2"] == pytest.approx(0.087, abs=1e-3)
        struck = [event.name for event in stride().events if event.name.endswith("_touchdown")]
        assert struck[0] == "posterior_left_touchdown" and struck[1] == "anterior_right_touchdown"
        assert struck[2] == "diagonal_touchdown" == struck[5]
        assert struck[3:5] == ["posterior_right_touchdown", "anterior_left_touchdown"]
        assert "slip" not in {event.name for event in stride().events}
        speed = trot().system.measures["mean_speed"](half)
        assert speed == pytest.approx(2.0, abs=0.01)

    def test_kept(self, tmp_path):
        again = Gait.load(trot().save(tmp_path / "trot.json"))
        assert again.system.law == trot().system.law and again.system.kind == "trotting"


@pytest.mark.slow
class TestMultipliers:
    def test_a_whole_strides_are_the_squares_of_halfs(self):
        """Along the eigenvectors of the three largest, by differences over a whole stride."""
        system, local = trot().system, chart(trot().system, trot().state)
        values, vectors = np.linalg.eig(jacobian("trot"))
        np.testing.assert_allclose(eigenvalues(np.diag(values))[:3], trot().multipliers[:3], rtol=1e-4)
        assert abs(trot().multipliers[0]) == pytest.approx(3.69, abs=0.02)
        for i in np.argsort(-abs(values))[:3]:
            along = STEP * vectors[:, i].real
            states = (local.state(sign * along) for sign in (1.0, -1.0))
            ends = [local.coordinates(run(system, state, 2, Options(rtol=1e-11)).state) for state in states]
            np.testing.assert_allclose((ends[0] - ends[1]) / 2.0, values[i].real ** 2 * along, rtol=0, atol=1e-4 * STEP)


@pytest.mark.slow
def test_balanced():
    steady = trot_steady()
    assert abs(steady.multipliers[0]) <= 0.5
    local = chart(steady.system, steady.state)
    q, v = (part.copy() for part in steady.state)
    v[1] += 0.1
    pushed = run(steady.system, (q, v), 30, Options(rtol=1e-9))
    assert pushed.cycles == 30
    assert abs(local.coordinates(pushed.state)).max() <= 0.1 * abs(local.coordinates((q, v))).max()


class TestRefused:
    def test_numbers(self):
        law = trot().system.law
        for name, wrong in (
            ("stance_span", 0.4),
            ("flight_span", 0.0),
            ("epsilon", 0.0),
            ("posterior_swing", ((0.0,), (0.0,))),
            ("lift_off", "foot"),
            ("posterior_squeeze", np.nan),
        ):
            with pytest.raises(BadValue, match=name):
                replace(law, **{name: wrong})
        assert isinstance(law, TrotLaw)

    def test_parity_and_heading(self):
        with pytest.raises(BadValue, match="gait"):
            linear(trot(), (), lateral=True)
        with pytest.raises(BadValue, match="heading"):
            add_feedback(trot(), heading=1.0)
        with pytest.raises(UnknownName, match="input"):
            add_feedback(trot(), ("posterior_adduction",))

    def test_no_guess(self):
        with pytest.raises(BadValue, match="nominal"):
            trot().system.guess()


@pytest.mark.slow
def test_simulated():
    motion = simulate(trot().system, trot().state, 2)
    assert motion.cycles == 2 and abs(motion.ledger.residual).max() <= 1e-8
    assert {"diagonal_left_stance", "diagonal_right_stance"} <= {*motion.phase}
