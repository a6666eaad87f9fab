"""Routh's impulses of many impacts at once, against one by one."""

import numpy as np
import pytest

from spear_pin.hybrid.rules.impact import plastic_impact, routh


class TestManyImpacts:
    def test_one_by_one(self):
        """As `plastic_impact` has them, of toes that stick, slide on and slide back."""
        rng = np.random.default_rng(8)
        roots, before = rng.normal(size=(200, 2, 2)), rng.normal(size=(2, 200))
        A = (roots @ roots.transpose(0, 2, 1) + 0.05 * np.eye(2)).transpose(1, 2, 0)
        before[1] = -np.abs(before[1])
        friction = rng.uniform(0.1, 2.0, 200)
        impulse, slides = routh(A, before, friction)
        assert 20 < slides.sum() < 180 and np.array_equal(routh(A, before, friction[0])[1][:1], slides[:1])
        for i in range(200):
            # with D = A⁻¹ and J = 1 the toe's velocity is the state
            single = plastic_impact(np.linalg.inv(A[:, :, i]), np.eye(2), before[:, i], float(friction[i]))
            np.testing.assert_allclose(np.array(impulse)[:, i], single.impulse, rtol=1e-9, atol=1e-12)
            assert slides[i] == single.slides

    @pytest.mark.parametrize("angle", [0.9, 0.95, 1.0, -1.1])
    def test_a_toe_that_can_move_one_way_only(self, angle):
        """A slider on a slope, which jams: it stops."""
        jacobian = np.array([[np.sin(angle)], [np.cos(angle)]])
        impact = plastic_impact(np.array([[3.0]]), jacobian, np.array([-1.0]), 1.5 * abs(np.tan(angle)))
        np.testing.assert_allclose(impact.v, 0.0, rtol=0, atol=1e-9)
        assert impact.loss == pytest.approx(1.5)
        A, before = jacobian @ jacobian.T / 3.0, -jacobian[:, 0]
        many, _ = routh(np.repeat(A[..., None], 64, 2), np.repeat(before[:, None], 64, 1), 1.5 * abs(np.tan(angle)))
        np.testing.assert_allclose(np.array(many), np.repeat(impact.impulse[:, None], 64, 1), rtol=1e-12)

    @pytest.mark.parametrize("rate", [1e-12, -1e-12])
    def test_rounding_is_no_impact(self, rate):
        """A toe that slides on the ground, where friction could drive it in: nothing strikes, nothing happens."""
        A = np.array([[3.0, 2.0], [2.0, 1.5]])[:, :, None]
        impulse, slides = routh(A, np.array([[1.0], [rate]]), 1.0)
        assert not np.any(impulse) and slides.all()
