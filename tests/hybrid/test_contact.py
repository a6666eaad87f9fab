"""Contact: the plastic impact with friction, constrained accelerations, Painlevé's rod."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from spear_pin import Contact, load
from spear_pin.errors import BadValue
from spear_pin.hybrid.contact import constrained, joint_impact, plastic_impact

many = settings(max_examples=400, derandomize=True, deadline=None)
MODERATE = 2.0  # of velocities, in m/s and rad/s


@st.composite
def impacts(draw):
    """D, J, v with an approaching toe, and a coefficient of friction."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(2, 5))
    friction = draw(st.sampled_from([0.0, 0.1, 0.5, 0.8, 1.5, 3.0]))
    rotation, _ = np.linalg.qr(rng.normal(size=(n, n)))
    D = rotation @ np.diag(rng.uniform(0.1, 3.0, n)) @ rotation.T
    J = rng.normal(size=(2, n))
    v = rng.uniform(-MODERATE, MODERATE, n)
    v *= -np.sign((J @ v)[1])
    return 0.5 * (D + D.T), J, v, friction


def inverse_mass(D, J):
    """J D⁻¹ Jᵀ, tangential and normal."""
    return J @ np.linalg.inv(D) @ J.T


def comes_to_rest(D, J, v, friction):
    """Whether sliding stops before the impact ends and the toe can then stick."""
    (a_tt, a_tn), (_, a_nn) = inverse_mass(D, J)
    slide, approach = J @ v
    direction = math.copysign(1.0, slide)
    slide_rate, approach_rate = a_tn - friction * direction * a_tt, a_nn - friction * direction * a_tn
    to_stop = -slide / slide_rate if slide * slide_rate < 0 else math.inf
    to_end = -approach / approach_rate if approach_rate > 0 else math.inf
    return to_stop < to_end and abs(a_tn) <= friction * a_tt


def step_by_step(D, J, v, friction, steps=20000):
    """The same impact in small portions of normal impulse, and the work that friction does in it."""
    (a_tt, a_tn), (_, a_nn) = inverse_mass(D, J)
    slide, approach = J @ v
    portion = -approach / a_nn / steps
    tangential, normal, work = 0.0, 0.0, 0.0
    while approach < 0.0:
        stopping = -(slide / portion + a_tn) / a_tt
        ratio = min(max(stopping, -friction), friction)
        ahead = slide + portion * (a_tn + a_tt * ratio)
        work += portion * ratio * 0.5 * (slide + ahead)
        slide, approach = ahead, approach + portion * (a_nn + a_tn * ratio)
        tangential, normal = tangential + portion * ratio, normal + portion
    return np.array([tangential, normal]), work


def rod(angle, mass=2.0, half_length=0.5):
    """A slender rod at an angle to the ground, its lower end the toe: D and J in (x, z, rotation) of its centre."""
    D = np.diag([mass, mass, mass * half_length**2 / 3.0])
    lever = half_length * np.array([-math.cos(angle), -math.sin(angle)])  # from the centre to the toe
    return D, np.array([[1.0, 0.0, -lever[1]], [0.0, 1.0, lever[0]]])


class TestImpactProperties:
    @many
    @given(impacts())
    def test_momentum(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        np.testing.assert_allclose(D @ (impact.v - v), J.T @ impact.impulse, rtol=0, atol=1e-12)

    @many
    @given(impacts())
    def test_loss_is_the_work_of_the_impulse_and_the_kinetic_energy_lost(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        work = -0.5 * impact.impulse @ (J @ impact.v + J @ v)
        difference = 0.5 * v @ D @ v - 0.5 * impact.v @ D @ impact.v
        assert impact.loss == pytest.approx(work, rel=0, abs=1e-12)
        assert impact.loss == pytest.approx(difference, rel=0, abs=1e-12)
        assert impact.loss >= -1e-12

    @many
    @given(impacts())
    def test_the_toe_neither_approaches_nor_leaves(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        assert (J @ impact.v)[1] == pytest.approx(0.0, abs=1e-11)

    @many
    @given(impacts())
    def test_the_impulse_lies_in_the_friction_cone(self, case):
        D, J, v, friction = case
        tangential, normal = plastic_impact(D, J, v, friction).impulse
        assert normal > 0.0
        assert abs(tangential) <= friction * normal * (1 + 1e-12)

    @many
    @given(impacts())
    def test_sticks_just_when_sliding_stops_first_and_the_cone_allows(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        assert impact.slides != comes_to_rest(D, J, v, friction)
        if not impact.slides:
            sticking = -np.linalg.solve(inverse_mass(D, J), J @ v)
            np.testing.assert_allclose(impact.impulse, sticking, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(J @ impact.v, 0.0, rtol=0, atol=1e-11)
            assert abs(sticking[0]) <= friction * sticking[1] * (1 + 1e-12)

    @many
    @given(impacts())
    def test_friction_opposes_the_sliding_that_is_left(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        if not impact.slides or friction == 0.0:
            return
        before, after = (J @ v)[0], (J @ impact.v)[0]
        tangential, normal = impact.impulse
        if before * after > 0.0:  # it never stopped
            assert tangential == pytest.approx(-math.copysign(friction * normal, after), rel=1e-12)
        else:  # it slides back, against friction both ways
            assert abs(tangential) < friction * normal

    @settings(max_examples=25, derandomize=True, deadline=None)
    @given(impacts())
    def test_the_same_in_small_portions(self, case):
        D, J, v, friction = case
        impact = plastic_impact(D, J, v, friction)
        impulse, tangential_work = step_by_step(D, J, v, friction)
        np.testing.assert_allclose(impact.impulse, impulse, rtol=0, atol=1e-3 * (1 + np.abs(impulse).max()))
        assert tangential_work <= 1e-12


class TestKnownImpacts:
    mass = 2.0
    particle = mass * np.eye(2), np.eye(2)

    def test_a_particle_sticks(self):
        impact = plastic_impact(*self.particle, np.array([0.3, -1.0]), 0.5)
        np.testing.assert_allclose(impact.v, 0.0, atol=1e-15)
        np.testing.assert_allclose(impact.impulse, [-0.6, 2.0], rtol=1e-15)
        assert not impact.slides and impact.loss == pytest.approx(0.5 * self.mass * 1.09, rel=1e-14)

    def test_a_particle_slides_on(self):
        impact = plastic_impact(*self.particle, np.array([-1.0, -1.0]), 0.5)
        np.testing.assert_allclose(impact.v, [-0.5, 0.0], atol=1e-15)
        np.testing.assert_allclose(impact.impulse, [1.0, 2.0], rtol=1e-15)
        assert impact.slides

    def test_a_particle_that_leaves_is_not_struck(self):
        v = np.array([1.0, 0.2])
        impact = plastic_impact(*self.particle, v, 0.5)
        np.testing.assert_array_equal(impact.v, v)
        np.testing.assert_array_equal(impact.impulse, [0.0, 0.0])
        assert impact.loss == 0.0

    def test_without_friction(self):
        D, J = rod(1.0)
        v = np.array([0.7, -1.0, 0.4])
        impact = plastic_impact(D, J, v, 0.0)
        normal = -(J @ v)[1] / inverse_mass(D, J)[1, 1]
        np.testing.assert_allclose(impact.impulse, [0.0, normal], rtol=0, atol=1e-15)
        assert impact.v[0] == v[0] and impact.slides

    @pytest.mark.parametrize("angle", [0.3, 0.8, 1.2])
    def test_a_rod_dropped_without_sliding(self, angle):
        """Its end sticks from μ = 3 sin cos / (1 + 3 sin²) on, and slides outwards below that."""
        D, J = rod(angle)
        sine, cosine = math.sin(angle), math.cos(angle)
        threshold = 3 * sine * cosine / (1 + 3 * sine**2)
        v = np.array([0.0, -1.0, 0.0])
        rough = plastic_impact(D, J, v, 1.01 * threshold)
        assert not rough.slides
        # angular momentum about the end is kept: ω = 3 v cos / (2 L), with 1 m of length and 1 m/s
        assert rough.v[2] == pytest.approx(-1.5 * cosine, rel=1e-12)
        smooth = plastic_impact(D, J, v, 0.99 * threshold)
        assert smooth.slides and (J @ smooth.v)[0] < 0.0
        assert smooth.impulse[0] == pytest.approx(0.99 * threshold * smooth.impulse[1], rel=1e-12)

    def test_reverse_sliding(self):
        """It slides forward for 0.4 N·s, is turned round by the coupling, and slides back for 0.1 N·s."""
        D = np.linalg.inv([[1.0, -2.0], [-2.0, 5.0]])
        impact = plastic_impact(D, np.eye(2), np.array([1.0, -2.8]), 0.5)
        np.testing.assert_allclose(impact.impulse, [-0.5 * 0.4 + 0.5 * 0.1, 0.5], rtol=1e-12)
        np.testing.assert_allclose(impact.v, [-0.15, 0.0], rtol=0, atol=1e-14)
        assert impact.slides

    def test_it_may_slide_back_though_the_impulse_that_stops_it_lies_in_the_cone(self):
        D = np.linalg.inv([[1.0, -2.0], [-2.0, 5.0]])
        v = np.array([1.0, -2.8])
        sticking = -np.linalg.solve(np.linalg.inv(D), v)
        assert abs(sticking[0]) <= 1.5 * sticking[1]
        assert plastic_impact(D, np.eye(2), v, 1.5).slides

    def test_a_rod_in_which_the_sliding_toe_digs_in(self):
        """Beyond Painlevé's friction the normal impulse speeds the approach up, until sliding has stopped."""
        D, J = rod(math.atan(2.0))
        v = np.array([0.4, -1.0, 0.0])
        for direction in (-1.0, 1.0):
            v[0] = 0.4 * direction
            impact = plastic_impact(D, J, v, 3.0)
            assert not impact.slides
            np.testing.assert_allclose(J @ impact.v, 0.0, atol=1e-13)


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
        a, multiplier, schur = constrained(D, force, A, G, drift)
        np.testing.assert_allclose(D @ a, force + G @ multiplier, rtol=0, atol=1e-9)
        np.testing.assert_allclose(A @ a + drift, 0.0, rtol=0, atol=1e-9)
        np.testing.assert_allclose(schur, A @ np.linalg.inv(D) @ G, rtol=0, atol=1e-9)

    @pytest.mark.parametrize(("friction", "sign"), [(4 / 3 - 1e-6, 1.0), (4 / 3 + 1e-6, -1.0)])
    def test_painleve_begins_at_four_thirds_for_the_rod_at_tangent_two(self, friction, sign):
        """The pivot (1 + 3 cos² - 3 μ sin cos) / m of a rod pushed ahead vanishes there, for no lower friction."""
        D, J = rod(math.atan(2.0))
        forward, backward = (
            float(constrained(D, np.zeros(3), J[1:], (J[1] - friction * s * J[0])[:, None], np.zeros(1))[2][0, 0])
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
        pivot = constrained(D, np.zeros(3), J[1:], (J[1] - friction * side * J[0])[:, None], np.zeros(1))[2][0, 0]
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
