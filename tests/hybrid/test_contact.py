"""Contact: constrained accelerations, Painlevé's rod, and the coefficient of friction."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spear_pin import Contact
from spear_pin.errors import BadValue
from spear_pin.hybrid.contact import impose_rows, solve_constrained
from tests.hybrid.impacts import impacts, many, rod


class TestConstrained:
    @many
    @given(impacts(), st.booleans())
    def test_solves_its_equations(self, case, slips):
        D, J, v, friction = case
        rng = np.random.default_rng(3)
        force = rng.normal(size=len(v))
        A, G = (J[1:], (J[1:] - friction * J[:1]).T) if slips else (J, J.T)
        drift = rng.normal(size=len(A))
        if abs(np.linalg.det(A @ np.linalg.solve(D, G))) < 1e-2:
            return
        a, multiplier, schur = solve_constrained(D, force, A, G, drift)
        np.testing.assert_allclose(D @ a, force + G @ multiplier, rtol=0, atol=1e-9)
        np.testing.assert_allclose(A @ a + drift, 0.0, rtol=0, atol=1e-9)
        np.testing.assert_allclose(schur, A @ np.linalg.inv(D) @ G, rtol=0, atol=1e-9)

    @pytest.mark.parametrize(("friction", "sign"), [(4 / 3 - 1e-6, 1.0), (4 / 3 + 1e-6, -1.0)])
    def test_painleve_begins_at_four_thirds_for_the_rod_at_tangent_two(self, friction, sign):
        """The pivot (1 + 3 cos² - 3 μ sin cos) / m of a rod pushed ahead vanishes there, for no lower friction."""
        D, J = rod(math.atan(2.0))
        forward, backward = (
            float(solve_constrained(D, np.zeros(3), J[1:], (J[1] - friction * s * J[0])[:, None], np.zeros(1))[2][0, 0])
            for s in (1.0, -1.0)
        )
        pushed, pulled = sorted([forward, backward])
        assert math.copysign(1.0, pushed) == sign and pushed == pytest.approx(0.0, abs=1e-5)
        assert pulled > 1.0

    @pytest.mark.parametrize("angle", [0.4, 0.9, 1.4])
    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_pivot_of_the_rod(self, angle, side):
        D, J = rod(angle)
        friction, sine, cosine = 1.7, math.sin(angle), math.cos(angle)
        pivot = solve_constrained(D, np.zeros(3), J[1:], (J[1] - friction * side * J[0])[:, None], np.zeros(1))[2][0, 0]
        # the toe lies behind the centre, so that sliding forward drags the rod along
        expected = (1 + 3 * cosine**2 + 3 * friction * side * sine * cosine) / D[0, 0]
        assert pivot == pytest.approx(expected, rel=1e-12)


class TestContact:
    @pytest.mark.parametrize("friction", [0.0, -0.1, math.nan, math.inf])
    def test_refuses(self, friction):
        with pytest.raises(BadValue, match="Contact.friction"):
            Contact(friction)

    def test_default_is_the_documented_assumption(self):
        assert Contact().friction == 0.8


@pytest.mark.parametrize("m", [0, 2])
def test_forces_that_impose_accelerations(m):
    """Against the accelerations that they give, on toes at rest and in the air."""
    rng, nv, driven = np.random.default_rng(8), 6, [5, 2, 3]
    root = rng.normal(size=(nv, nv))
    D, force = root @ root.T + np.eye(nv), rng.normal(size=nv)
    J, drift = rng.normal(size=(m, nv)), rng.normal(size=m)
    rows, wanted = rng.normal(size=(3, nv)), rng.normal(size=3)
    applied = force.copy()
    applied[driven] += impose_rows(D, force, J, drift, rows, wanted.tolist(), driven)
    a = solve_constrained(D, applied, J, J.T, drift)[0] if m else np.linalg.solve(D, applied)
    np.testing.assert_allclose(rows @ a, wanted, rtol=0, atol=1e-11)
    np.testing.assert_allclose(J @ a + drift, 0.0, atol=1e-11)
