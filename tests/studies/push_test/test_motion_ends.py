"""Where the motion of a released leg ends, and what is refused."""

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.push_test import PassiveKnee, spear_ii
from spear_pin.studies.push_test.motion import move
from tests.studies.push_test.release import LEG, START, TIMES


class TestEnds:
    @pytest.mark.parametrize("knee", [PassiveKnee(stiffness=0.0), PassiveKnee(stiffness=0.0, coulomb=1.0)])
    def test_limit(self, knee):
        """Without a spring the leg folds, and is then taken to be held."""
        motion = move(LEG, knee, 1.3, TIMES, wrt=["rotor", "initial_angle"])
        assert motion.reason == "limit"
        held = motion.angle >= 2.8 - 1e-12
        assert 100 < held.sum() < 240 and (motion.angle[held] == motion.angle[-1]).all()
        assert motion.angle[-1] == pytest.approx(2.8, abs=1e-12)
        for still in (motion.rate, motion.acceleration, motion.sensitivity):
            assert not still[held].any()
        assert (np.diff(motion.angle[~held]) > 0).all()

    def test_lower_limit(self):
        """Pulled straight and beyond."""
        motion = move(LEG, PassiveKnee(stiffness=300.0, zero=-1.0), 0.3, TIMES)
        assert motion.reason == "limit" and motion.angle[-1] == pytest.approx(-0.2, abs=1e-12)

    @pytest.mark.parametrize(
        ("start", "zero", "reason"), [(2.8, 1.0, "complete"), (2.8, 5.0, "limit"), (-0.2, 1.0, "complete")]
    )
    def test_from_a_limit(self, start, zero, reason):
        motion = move(LEG, PassiveKnee(zero=zero, damping=5.0), start, TIMES)
        assert motion.reason == reason and motion.angle[0] == start
        if reason == "limit":
            assert (motion.angle == start).all()

    @pytest.mark.parametrize("coulomb", [0.0, 0.4, 50.0])
    def test_times_are_but_samples(self, coulomb):
        """Not from zero, a single one, at the release itself."""
        knee = PassiveKnee(coulomb=coulomb)
        whole = move(LEG, knee, START, TIMES, wrt=["zero"])
        for chosen in (slice(0, 1), slice(100, 101), slice(57, 200, 3)):
            part = move(LEG, knee, START, TIMES[chosen], wrt=["zero"])
            for name in ("angle", "rate", "acceleration", "sensitivity"):
                expected = getattr(whole, name)[chosen]
                np.testing.assert_allclose(getattr(part, name), expected, rtol=1e-6, atol=1e-7, err_msg=name)
            assert part.turns.size == (whole.turns <= TIMES[chosen][-1]).sum() and part.reason == "complete"

    def test_spring_torque(self):
        angles = np.array([0.5, 1.0, 1.5])
        np.testing.assert_array_equal(PassiveKnee(10.0).spring_torque(angles), [5.0, 0.0, -5.0])
        np.testing.assert_array_equal(PassiveKnee(10.0, unilateral=True).spring_torque(angles), [0.0, 0.0, -5.0])


class TestRefusals:
    @pytest.mark.parametrize("times", [[], [-0.1, 1.0], [0.0, 0.0], [1.0, 0.5], [0.0, np.nan], [[0.0, 1.0]], 1.0])
    def test_times(self, times):
        with pytest.raises(BadValue, match="^times is .*in s$"):
            move(LEG, PassiveKnee(), START, times)

    @pytest.mark.parametrize("angle", [-0.21, 2.81, np.nan, None, "1"])
    def test_initial_angle(self, angle):
        with pytest.raises(BadValue, match="^initial_angle is .*within -0.2 … 2.8 rad$"):
            move(LEG, PassiveKnee(), angle, TIMES)

    def test_parameter(self):
        with pytest.raises(UnknownName, match="unknown parameter 'mass'; valid: stiffness, damping, coulomb"):
            move(LEG, PassiveKnee(), START, TIMES, wrt=["zero", "mass"])

    @pytest.mark.parametrize("field", ["stiffness", "damping", "coulomb", "zero"])
    @pytest.mark.parametrize("value", [-np.inf, np.nan, np.inf, "soft", None])
    def test_knee(self, field, value):
        with pytest.raises(BadValue) as caught:
            PassiveKnee(**{field: value})
        assert caught.value.name == f"PassiveKnee.{field}"


class TestWork:
    def test_forces_that_are_too_stiff_end_it(self):
        """With a reason, and held from there on; not after minutes."""
        motion = move(spear_ii(), PassiveKnee(damping=1e6), 1.5, np.linspace(0, 1.5, 100))
        assert motion.reason == "work" and np.isfinite(motion.angle).all() and motion.rate[-1] == 0.0

    @pytest.mark.parametrize("rtol", [float("nan"), -1.0, 0.0, 1.0])
    def test_bad_tolerance(self, rtol):
        with pytest.raises(BadValue, match="^rtol is "):
            move(spear_ii(), PassiveKnee(), 1.5, [0.0, 1.0], rtol=rtol)
