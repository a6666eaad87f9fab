"""Motion, ground forces and impacts of the hop: the symbolic Lagrangian's equations at every sample and event."""

import numpy as np
import pytest
from scipy.integrate import simpson

from tests.hybrid.motions import balance, stances, stretches, terms_of
from tests.lagrangian import monopod

FRICTION = 0.8


class TestEquationsOfMotion:
    def test_balance_at_every_sample(self, hops, terms):
        assert balance(hops, terms).max() < 1e-8

    def test_balance_while_slipping(self, slipping, slipping_terms):
        assert (slipping.domain == "stance slip+").any() or (slipping.domain == "stance slip-").any()
        assert balance(slipping, slipping_terms).max() < 1e-8

    def test_the_sticking_toe_does_not_accelerate(self, hops, terms):
        sticking = np.flatnonzero(hops.domain == "stance")
        assert len(sticking) > 1000
        for i in sticking:
            acceleration = terms[i].jacobians["toe"] @ hops.a[i] + terms[i].drifts["toe"]
            assert np.abs(acceleration).max() < 1e-8 * max(1.0, np.abs(hops.a[i]).max())

    def test_the_slipping_toe_stays_on_the_ground(self, slipping, slipping_terms):
        for i in np.flatnonzero(np.char.startswith(slipping.domain, "stance slip")):
            acceleration = slipping_terms[i].jacobians["toe"] @ slipping.a[i] + slipping_terms[i].drifts["toe"]
            assert abs(acceleration[1]) < 1e-8 * max(1.0, np.abs(slipping.a[i]).max())

    @pytest.mark.parametrize("name", ["hops", "slipping"])
    def test_the_toe_is_at_height_zero_in_stance_and_above_in_flight(self, name, request):
        trajectory = request.getfixturevalue(name)
        heights = np.array([at.toes["toe"][1] for at in terms_of(trajectory)])
        stance = trajectory.phase == "stance"
        assert np.abs(heights[stance]).max() < 1e-8
        assert heights[~stance].min() > -1e-8
        assert heights[~stance].max() > 0.02

    def test_the_toe_does_not_move_while_it_sticks(self, hops, terms):
        for part in stances(hops):
            indices = [i for i in range(part.start, part.stop) if hops.domain[i] == "stance"]
            places = np.array([terms[i].toes["toe"][0] for i in indices])
            assert np.ptp(places) < 1e-9

    def test_velocity_and_acceleration_are_derivatives(self, hops):
        flight = next(part for part in stretches(hops) if hops.phase[part][0] == "flight")
        t, q, v, a = hops.t[flight], hops.q[flight], hops.v[flight], hops.a[flight]
        np.testing.assert_allclose(q[-1] - q[0], simpson(v, x=t, axis=0), rtol=0, atol=1e-5)
        np.testing.assert_allclose(v[-1] - v[0], simpson(a, x=t, axis=0), rtol=0, atol=1e-3)


class TestForces:
    def test_cone_and_unilateral_contact_while_sticking(self, hops):
        tangential, normal = hops.force[hops.domain == "stance", 0].T
        assert normal.min() >= -1e-6
        assert (np.abs(tangential) - FRICTION * normal).max() <= 1e-6

    def test_coulomb_friction_while_slipping(self, slipping, slipping_terms):
        seen = set()
        for i in np.flatnonzero(np.char.startswith(slipping.domain, "stance slip")):
            tangential, normal = slipping.force[i, 0]
            side = 1.0 if slipping.domain[i].endswith("+") else -1.0
            assert normal >= -1e-6
            assert tangential == pytest.approx(-side * 0.3 * normal, rel=1e-12, abs=1e-12)
            speed = (slipping_terms[i].jacobians["toe"] @ slipping.v[i])[0]
            assert side * speed > -2e-7
            seen.add(side if abs(speed) > 1e-3 else 0.0)
        assert seen & {1.0, -1.0}

    def test_flight_has_neither_ground_force_nor_spring(self, hops):
        flight = hops.phase == "flight"
        assert not hops.force[flight].any()
        assert not hops.spring[flight].any()
        assert not hops.engaged[flight].any()
        assert hops.engaged[~flight].all()

    def test_no_friction_where_the_robot_has_none(self, hops):
        assert not hops.friction.any()


class TestImpact:
    def test_lands_plastically(self, hops):
        lagrangian = monopod(hops.coordinates)
        for event in hops.named("touchdown"):
            at = lagrangian.terms(event.q, event.v_before)
            jacobian = at.jacobians["toe"]
            assert (jacobian @ event.v_before)[1] < -0.5
            np.testing.assert_allclose(jacobian @ event.v, 0.0, atol=1e-12)
            momentum = at.mass_matrix @ (event.v - event.v_before)
            np.testing.assert_allclose(momentum, jacobian.T @ event.impulse[0], rtol=0, atol=1e-11)
            tangential, normal = event.impulse[0]
            assert normal > 0 and abs(tangential) <= FRICTION * normal
            lost = at.kinetic_energy - lagrangian.terms(event.q, event.v).kinetic_energy
            assert event.work["impact"] == pytest.approx(-lost, rel=0, abs=1e-12)
        assert event.work["impact"] < -0.5

    def test_no_other_event_changes_the_velocity(self, hops):
        for event in hops.events:
            if event.name != "touchdown":
                np.testing.assert_array_equal(event.v, event.v_before)
                assert not event.impulse.any()
