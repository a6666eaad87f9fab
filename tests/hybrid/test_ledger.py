"""The energy ledger: it closes, and each of its flows is the integral of a power, by Simpson's rule."""

import numpy as np
import pytest
from scipy.integrate import simpson

from spear_pin import Contact, hopping, simulate
from tests.hybrid.motions import SPRING_DAMPING, balance, terms_of
from tests.lagrangian import monopod


class TestLedger:
    def test_closes_every_hop(self, hops):
        assert hops.ledger.residual.shape == (11,)
        assert np.abs(hops.ledger.residual).max() < 1e-8

    def test_closes_over_eleven_hops_at_a_finer_tolerance(self, hop):
        fine = simulate(hop.system, hop.state, cycles=11, rtol=1e-11)
        assert abs(fine.ledger.residual.sum()) < 1e-8
        assert np.abs(fine.ledger.residual).sum() < 1e-8

    def test_residual_falls_with_the_tolerance(self, hop):
        left = [
            np.abs(simulate(hop.system, hop.state, cycles=3, rtol=rtol).ledger.residual).max()
            for rtol in (1e-6, 1e-8, 1e-10)
        ]
        assert left[0] > 3 * left[1] > 9 * left[2]
        assert left[2] < 1e-9

    def test_change_is_that_of_the_energies(self, hops):
        """By the Lagrangian; no spring is compressed at touchdown."""
        lagrangian = monopod(hops.coordinates)

        def energy(q, v):
            at = lagrangian.terms(q, v)
            return at.kinetic_energy + at.potential_energy

        sections = [(hops.q[0], hops.v[0])] + [(event.q, event.v) for event in hops.named("touchdown")]
        energies = [energy(q, v) for q, v in sections]
        np.testing.assert_allclose(hops.ledger.change, np.diff(energies), rtol=0, atol=1e-11)

    def test_each_flow_is_the_integral_of_its_power(self, hops):
        """Over the samples of each hop, by Simpson's rule."""
        powers = {
            "motor_hip": hops.u[:, 0] * hops.v[:, 1],
            "motor_knee": hops.u[:, 1] * hops.v[:, 2],
            "damping": -SPRING_DAMPING * hops.engaged[:, 0] * hops.v[:, 2] ** 2,
        }
        switches = np.flatnonzero(np.diff(hops.t) == 0) + 1
        pieces = np.split(np.arange(len(hops.t)), switches)
        for name, power in powers.items():
            for cycle in range(1, 12):
                inside = [piece for piece in pieces if hops.cycle[piece[0]] == cycle]
                work = sum(simpson(power[piece], x=hops.t[piece]) for piece in inside)
                assert hops.ledger[name][cycle - 1] == pytest.approx(work, rel=1e-3, abs=1e-3)

    def test_signs(self, hops):
        assert (hops.ledger["damping"] < -1.0).all()
        assert (hops.ledger["impact"] < -0.5).all()
        assert (hops.ledger["motor_knee"] > 1.0).all()
        assert (hops.ledger["released"] < 0.0).all()
        assert (hops.ledger["slip"] <= 0.0).all()
        assert not hops.ledger["friction"].any()

    @pytest.mark.slow
    def test_slip(self, slipping):
        assert (slipping.ledger["slip"] < -1e-6).all()
        assert np.abs(slipping.ledger.residual).max() < 1e-8

    def test_slip_is_the_integral_of_its_power(self, free_hop):
        """With the toe sliding for long on ice."""
        system = free_hop.system.build(free_hop.system.robot, free_hop.system.law, contact=Contact(0.05))
        trajectory = simulate(system, free_hop.state)
        speed = np.array([at.jacobians["toe"] @ v for at, v in zip(terms_of(trajectory), trajectory.v, strict=True)])
        power = trajectory.force[:, 0, 0] * speed[:, 0]
        assert power.max() < 1e-6
        pieces = np.split(np.arange(len(trajectory.t)), np.flatnonzero(np.diff(trajectory.t) == 0) + 1)
        work = sum(simpson(power[piece], x=trajectory.t[piece]) for piece in pieces)
        assert work < -1e-3
        assert trajectory.ledger["slip"][0] == pytest.approx(work, rel=1e-2)
        assert np.abs(trajectory.ledger.residual).max() < 1e-8

    def test_viscous_friction_of_the_slider(self, rubbing_robot, hop):
        trajectory = simulate(hopping(rubbing_robot, hop.system.law), hop.state, cycles=3)
        assert trajectory.complete
        expected = np.zeros_like(trajectory.v)
        expected[:, 0] = -2.5 * trajectory.v[:, 0]
        np.testing.assert_allclose(trajectory.friction, expected, rtol=0, atol=1e-13)
        assert np.abs(trajectory.friction).max() > 1.0
        assert (trajectory.ledger["friction"] < -0.1).all()
        assert np.abs(trajectory.ledger.residual).max() < 1e-8
        assert balance(trajectory, terms_of(trajectory)).max() < 1e-8
