"""The plastic impact of one toe with friction: its laws at random, small portions, and cases known in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

from spear_pin.hybrid.rules.impact import caught, plastic_impact
from tests.hybrid.impacts import impacts, inverse_mass, many, rod


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

    @pytest.mark.slow
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


class TestCaught:
    @many
    @given(impacts())
    def test_stops_the_toe_whatever_it_takes(self, case):
        D, J, v, _ = case
        impact = caught(D, J, v)
        np.testing.assert_allclose(J @ impact.v, 0.0, atol=1e-9)
        np.testing.assert_allclose(D @ (impact.v - v), J.T @ impact.impulse, rtol=0, atol=1e-9)
        difference = 0.5 * v @ D @ v - 0.5 * impact.v @ D @ impact.v
        assert impact.loss == pytest.approx(difference, rel=0, abs=1e-9) and impact.loss >= -1e-12

    @many
    @given(impacts())
    def test_where_friction_suffices_it_is_a_plastic_impact(self, case):
        D, J, v, friction = case
        if comes_to_rest(D, J, v, friction):
            np.testing.assert_allclose(caught(D, J, v).v, plastic_impact(D, J, v, friction).v, atol=1e-9)

    def test_rows_that_depend_on_each_other(self):
        D, J, v = rod(0.3)[0], np.array([[0.0, 1.0, 0.2]]), np.array([1.0, -2.0, 0.5])
        twice = caught(D, np.vstack([J, J]), v)
        np.testing.assert_allclose(twice.v, caught(D, J, v).v, atol=1e-12)
        assert twice.impulse[0] == pytest.approx(twice.impulse[1])
