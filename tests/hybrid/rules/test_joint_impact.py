"""The joint impact of several toes: complementarity and the cone, Gauss's principle, Q-SPEAR, redundant feet."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from spear_pin import load
from spear_pin.hybrid.rules.impact import joint_impact, land_toes, plastic_impact
from tests.hybrid.impacts import MODERATE, impacts, inverse_mass, many


@st.composite
def joint_impacts(draw, frictions=(0.0, 0.1, 0.5, 0.8, 1.5, 3.0), most=3):
    """D, J, v of several toes, some of them at rest on the ground, some striking it; a coefficient of friction."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    m = draw(st.integers(1, most))
    n = draw(st.integers(2 * m, 2 * m + 4))
    rotation, _ = np.linalg.qr(rng.normal(size=(n, n)))
    D = rotation @ np.diag(rng.uniform(0.1, 3.0, n)) @ rotation.T
    J = rng.normal(size=(2 * m, n))
    u = rng.uniform(-MODERATE, MODERATE, 2 * m)
    u[1::2] = -np.abs(u[1::2])
    resting = rng.random(m) < 0.5
    resting[0] = False
    u[1::2][resting] = 0.0
    u[::2][resting & (rng.random(m) < 0.7)] = 0.0
    v = rng.normal(size=n)
    return 0.5 * (D + D.T), J, v + np.linalg.pinv(J) @ (u - J @ v), draw(st.sampled_from(frictions))


def quadruped(seed):
    """D, J and v of Q-SPEAR in a random posture, both toes on the ground, the anterior one striking it."""
    robot = load("q_spear")
    rng = np.random.default_rng(seed)
    knees = rng.uniform(0.4, 1.4, 2)
    pitch = rng.uniform(-0.2, 0.2)
    hips = 0.5 * knees + rng.uniform(-0.3, 0.3, 2)
    q = np.array([0.0, 0.5, pitch, hips[0], knees[0], hips[1], knees[1]])
    J = np.concatenate([robot.toe_jacobian(q, toe) for toe in robot.toes])
    v = rng.uniform(-MODERATE, MODERATE, robot.nv)
    u = np.array([0.0, 0.0, *rng.uniform(-1.0, 1.0, 2)])
    u[3] = -abs(u[3])
    return robot.mass_matrix(q), J, v + np.linalg.pinv(J) @ (u - J @ v)


def energy(D, v):
    return 0.5 * v @ D @ v


class TestJointImpactProperties:
    @pytest.mark.slow
    @many
    @given(joint_impacts())
    def test_momentum_and_loss(self, case):
        D, J, v, friction = case
        impact = joint_impact(D, J, v, friction)
        flat = impact.impulse.ravel()
        np.testing.assert_allclose(D @ (impact.v - v), J.T @ flat, rtol=0, atol=1e-10 * (1 + np.abs(flat).max()))
        size = max(1.0, energy(D, v))
        assert impact.loss == pytest.approx(-0.5 * flat @ (J @ impact.v + J @ v), rel=0, abs=1e-12 * size)
        assert impact.loss == pytest.approx(energy(D, v) - energy(D, impact.v), rel=0, abs=1e-12 * size)
        assert impact.loss >= -1e-12 * size

    @many
    @given(joint_impacts())
    def test_complementarity_and_the_cone(self, case):
        D, J, v, friction = case
        impact = joint_impact(D, J, v, friction)
        u = (J @ impact.v).reshape(-1, 2)
        small = 1e-8 * (1 + np.abs(impact.impulse).max())
        for (slide, rise), (tangential, normal), slides, leaves in zip(
            u, impact.impulse, impact.slides, impact.leaves, strict=True
        ):
            assert rise > -small and normal > -small and abs(rise * normal) < small
            assert abs(tangential) <= friction * normal + small
            assert not (slides and leaves)
            if leaves:
                assert tangential == normal == 0.0
            elif slides:  # friction opposes what is left of the sliding
                assert tangential * slide <= small
                assert abs(tangential) == pytest.approx(friction * abs(normal), rel=1e-9, abs=small)
            else:
                assert abs(slide) < small and abs(rise) < small

    @many
    @given(joint_impacts())
    def test_one_answer(self, case):
        D, J, v, friction = case
        first, again = joint_impact(D, J, v, friction), joint_impact(D.copy(), J.copy(), v.copy(), friction)
        np.testing.assert_array_equal(first.v, again.v)
        np.testing.assert_array_equal(first.impulse, again.impulse)
        assert (first.slides, first.leaves) == (again.slides, again.leaves)

    @many
    @given(joint_impacts(most=2))
    def test_as_many_toes_stick_as_can(self, case):
        """No toe may be said to slide where the impulse that stops all of them lies in their cones."""
        D, J, v, friction = case
        impulse = -np.linalg.solve(inverse_mass(D, J), J @ v).reshape(-1, 2)
        if (np.abs(impulse[:, 0]) <= friction * impulse[:, 1]).all():
            impact = joint_impact(D, J, v, friction)
            assert not any(impact.slides) and not any(impact.leaves)
            np.testing.assert_allclose(impact.impulse, impulse, rtol=0, atol=1e-8 * (1 + np.abs(impulse).max()))

    @many
    @given(impacts())
    def test_of_one_toe_that_sticks(self, case):
        D, J, v, friction = case
        alone = plastic_impact(D, J, v, friction)
        if not alone.slides:
            impact = joint_impact(D, J, v, friction)
            assert impact.slides == impact.leaves == (False,)
            np.testing.assert_allclose(impact.v, alone.v, rtol=0, atol=1e-9)
            np.testing.assert_allclose(impact.impulse[0], alone.impulse, rtol=1e-9, atol=1e-9)

    @pytest.mark.slow
    @many
    @given(joint_impacts(frictions=[0.0]))
    def test_without_friction_is_the_nearest_motion_that_does_not_enter_the_ground(self, case):
        """Gauss: it minimises ½ (v⁺ - v)ᵀ D (v⁺ - v) under J_z v⁺ ≥ 0, here by its dual in the impulses."""
        D, J, v, _ = case
        A, approach = inverse_mass(D, J[1::2]), J[1::2] @ v
        dual = minimize(
            lambda x: 0.5 * x @ A @ x + approach @ x,
            np.ones(len(A)),
            jac=lambda x: A @ x + approach,
            bounds=[(0.0, None)] * len(A),
            method="L-BFGS-B",
            options={"ftol": 1e-16, "gtol": 1e-11, "maxiter": 5000},
        )
        impact = joint_impact(D, J, v, 0.0)
        normal = impact.impulse[:, 1]
        assert 0.5 * normal @ A @ normal + approach @ normal <= dual.fun + 1e-9 * (1 + abs(dual.fun))
        after = v + np.linalg.solve(D, J[1::2].T @ dual.x)
        np.testing.assert_allclose(impact.v, after, rtol=0, atol=1e-4 * (1 + np.abs(after).max()))

    def test_nothing_happens_to_toes_at_rest(self):
        D, J, _ = quadruped(0)
        v = np.linalg.svd(J)[2][-1]  # in the null space
        impact = joint_impact(D, J, v, 0.8)
        np.testing.assert_allclose(impact.v, v, rtol=0, atol=1e-14)
        assert impact.loss == pytest.approx(0.0, abs=1e-14) and not any(impact.leaves)


class TestJointImpactOfTheQuadruped:
    @pytest.mark.parametrize("seed", range(40))
    def test_rough_ground(self, seed):
        """Both toes at rest afterwards, where the impulse for it pushes on both: the KKT equations."""
        D, J, v = quadruped(seed)
        zero = np.zeros((4, 4))
        solution = np.linalg.solve(np.block([[D, -J.T], [J, zero]]), np.concatenate([D @ v, np.zeros(4)]))
        impulse = solution[7:].reshape(2, 2)
        impact = joint_impact(D, J, v, 50.0)
        if (np.abs(impulse[:, 0]) <= 50.0 * impulse[:, 1]).all():
            np.testing.assert_allclose(impact.v, solution[:7], rtol=0, atol=1e-10)
            np.testing.assert_allclose(impact.impulse, impulse, rtol=0, atol=1e-9)
        else:
            assert any(impact.leaves) or any(impact.slides)
        assert impact.loss >= 0.0

    def test_toes_that_stick_and_toes_that_leave_both_occur(self):
        found = {(impact.slides, impact.leaves) for impact in (joint_impact(*quadruped(s), 0.8) for s in range(60))}
        assert ((False, False), (False, False)) in found
        assert any(leaves[0] for _, leaves in found) and any(any(slides) for slides, _ in found)

    def test_a_toe_that_leaves_is_not_struck(self):
        for seed in range(60):
            D, J, v = quadruped(seed)
            impact = joint_impact(D, J, v, 0.8)
            if impact.leaves[0]:
                alone = joint_impact(D, J[2:], v, 0.8)
                np.testing.assert_allclose(impact.v, alone.v, rtol=0, atol=1e-12)
                assert (J @ impact.v)[1] > 0.0

    def test_the_order_of_the_toes_does_not_matter(self):
        for seed in range(20):
            D, J, v = quadruped(seed)
            impact, swapped = joint_impact(D, J, v, 0.8), joint_impact(D, J[[2, 3, 0, 1]], v, 0.8)
            np.testing.assert_allclose(impact.v, swapped.v, rtol=0, atol=1e-10)


class TestRedundantToes:
    """A rigid body on two feet that drops flat: four rows, three coordinates."""

    D = np.diag([2.0, 2.0, 0.3])
    J = np.array([[1.0, 0.0, 0.4], [0.0, 1.0, -0.5], [1.0, 0.0, 0.4], [0.0, 1.0, 0.5]])

    def test_falls_flat(self):
        impact = joint_impact(self.D, self.J, np.array([0.0, -1.0, 0.0]), 0.8)
        np.testing.assert_allclose(impact.v, 0.0, atol=1e-14)
        np.testing.assert_allclose(impact.impulse, [[0.0, 1.0], [0.0, 1.0]], rtol=0, atol=1e-14)
        assert impact.loss == pytest.approx(1.0, rel=1e-14)

    def test_rocks(self):
        """Turning about the foot that stands, it comes down on the other, and goes on turning about that."""
        turning = np.array([-0.4 * 0.7, 0.5 * 0.7, 0.7])  # the first foot at rest
        np.testing.assert_allclose((self.J @ turning)[:2], 0.0, atol=1e-15)
        turning = -turning  # so that the second comes down
        impact = joint_impact(self.D, self.J, turning, 5.0)
        alone = plastic_impact(self.D, self.J[2:], turning, 5.0)
        assert impact.leaves == ((self.J @ alone.v)[1] > 0.0, False)
        assert impact.loss > 0.0


class TestLanded:
    """Toes that land although they rise: they are back within an instant."""

    @pytest.mark.parametrize("seed", range(3))
    def test_they_rise_no_more(self, seed):
        D, J, v = quadruped(seed)
        v = v + np.linalg.pinv(J) @ (np.array([0.3, 2e-6, -0.1, 5e-5]) - J @ v)
        after, impulse = land_toes(D, J, v, [True, True])
        np.testing.assert_allclose((J @ after)[1::2], 0.0, atol=1e-15)
        np.testing.assert_allclose(D @ (after - v), J[1::2].T @ impulse, rtol=0, atol=1e-12)
        lost = energy(D, v) - energy(D, after)
        assert 0.0 < lost < 1e-7
        assert -0.5 * impulse @ (J @ (v + after))[1::2] == pytest.approx(lost, abs=1e-12)

    def test_what_strikes_or_does_not_land_is_left_alone(self):
        D, J, v = quadruped(0)
        for speeds, lands in (((0.0, -0.5), (True, True)), ((1e-3, 0.0), (False, True))):
            before = v + np.linalg.pinv(J[1::2]) @ (np.array(speeds) - J[1::2] @ v)
            after, impulse = land_toes(D, J, before, lands)
            np.testing.assert_array_equal(after, before)
            assert not impulse.any()


def test_toes_of_one_body_move_as_if_each_had_a_cone_of_its_own():
    """The sum of forces in cones is any force in the cone of the sum; here the impulse of each toe is unique."""
    rng, found = np.random.default_rng(0), set()
    for _ in range(60):
        m, B, friction = int(rng.integers(2, 4)), rng.normal(size=(5, 5)), float(rng.choice([0.1, 0.5, 1.5]))
        D, J, v = B @ B.T + 0.3 * np.eye(5), rng.normal(size=(2 * m, 5)), rng.normal(size=5)
        J[2] = J[0]
        impact = joint_impact(D, J, v, friction, [0, 0, 2][:m])
        np.testing.assert_allclose(impact.v, joint_impact(D, J, v, friction).v, atol=1e-9)
        (heel, toe), slides, leaves = impact.impulse[:2], impact.slides[:2], impact.leaves[:2]
        found.add((slides, leaves))
        if not any(leaves):
            assert slides[0] == slides[1] and heel[0] * toe[1] == pytest.approx(toe[0] * heel[1], abs=1e-9)
    assert len(found) > 5
