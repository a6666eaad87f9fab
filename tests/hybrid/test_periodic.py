"""Periodic orbits: the return map and its multipliers against an independent closed loop."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import HoppingLaw, find_gait, hopping, simulate
from spear_pin.errors import NoGait
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.periodic import (
    chart,
    differentiate_return_map,
    eigenvalues,
    multipliers,
    residual,
    return_map,
)
from spear_pin.hybrid.result import EVALUATIONS
from tests.hybrid.by_hand import Hopper


def by_modulus(values):
    return sorted(values, key=lambda value: (-round(abs(value), 6), -value.imag))


def five_point_jacobian(function, x, step):
    """Differences of fourth order."""
    columns = []
    for unit in np.eye(len(x)):
        near, far = (function(x + n * step * unit) - function(x - n * step * unit) for n in (1, 2))
        columns.append((8 * near - far) / (12 * step))
    return np.transpose(columns)


@pytest.fixture(scope="module")
def hopper(hop):
    return Hopper(hop.system.law.stance_torque)


class TestAgainstTheClosedLoopByHand:
    @pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.005, 0.05, -0.05), (-0.003, 0.02, 0.05)], ids=str)
    def test_one_hop(self, hop, hopper, offset):
        """On the gait and beside it."""
        begin = chart(hop.system, hop.state).state(np.array(offset))
        end = np.concatenate(return_map(hop.system, begin).state)
        expected = hopper.hop(np.concatenate(begin))
        assert any(offset) == (np.abs(expected - np.concatenate(begin)).max() > 1e-3)
        np.testing.assert_allclose(end, expected, rtol=0, atol=1e-7)

    @pytest.mark.slow
    def test_multipliers(self, hop, hopper):
        """Of the return map at the apex, where a state has five coordinates, by other differences."""
        at_apex = hopper.to_apex(hopper.to_lift_off(np.concatenate(hop.state)))
        kept = [0, 1, 2, 4, 5]

        def mapped(x):
            y = np.zeros(6)
            y[kept] = x
            return hopper.from_apex_to_apex(y)[kept]

        np.testing.assert_allclose(mapped(at_apex[kept]), at_apex[kept], rtol=0, atol=1e-8)
        values = by_modulus(np.linalg.eigvals(five_point_jacobian(mapped, at_apex[kept], 3e-4)))
        assert len(hop.multipliers) == 3
        np.testing.assert_allclose(by_modulus(hop.multipliers), values[:3], rtol=0, atol=1e-4)
        np.testing.assert_allclose(values[3:], 0.0, atol=1e-4)


class TestFixedPoint:
    def test_returns_to_itself(self, hop):
        assert hop.residual < 1e-9
        trajectory = simulate(hop.system, hop.state, rtol=1e-11)
        np.testing.assert_allclose(trajectory.events[-1].q, hop.state[0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(trajectory.events[-1].v, hop.state[1], rtol=0, atol=1e-8)

    def test_residual_counts_velocities_and_positions(self, hop):
        local = chart(hop.system, hop.state)
        for unit in np.eye(local.dimension):
            begin = local.state(1e-3 * unit)
            end = return_map(hop.system, begin).state
            expected = np.abs(np.concatenate(end) - np.concatenate(begin)).max()
            assert residual(hop.system, begin) == pytest.approx(expected, rel=1e-12)
            assert expected > 1e-4

    def test_residual_is_infinite_where_the_cycle_does_not_close(self, robot):
        system = hopping(robot, HoppingLaw(stance_torque=0.0))
        assert residual(system, system.guess()) == math.inf
        assert return_map(system, system.guess()).reason == "no_event"

    def test_a_cycle_that_takes_too_much_is_given_up(self, hop, monkeypatch):
        result = return_map(hop.system, hop.state, 1e-13)
        assert result.cycles == 1 and 10 * result.evaluations < EVALUATIONS
        monkeypatch.setattr("spear_pin.hybrid.periodic.EVALUATIONS", 500)
        assert return_map(hop.system, hop.state).reason == "evaluation_cap"
        assert residual(hop.system, hop.state) == math.inf

    def test_translation_along_the_ground_changes_nothing(self, free_hop):
        q, v = free_hop.state
        shifted = q + np.array([3.0, 0.0, 0.0, 0.0])
        assert residual(free_hop.system, (shifted, v)) == pytest.approx(free_hop.residual, abs=1e-9)

    @pytest.mark.slow
    def test_converges_with_the_tolerance(self, hop, monkeypatch):
        """The reference engine's own, to which the one of the Taylor engine is as near as the finest of them."""
        monkeypatch.setattr(taylor, "available", lambda: False)
        reference = find_gait(hop.system, guess=hop.state, rtol=1e-13)
        np.testing.assert_allclose(np.concatenate(hop.state), np.concatenate(reference.state), rtol=0, atol=1e-11)
        errors = []
        for digits in range(6, 13):
            gait = find_gait(hop.system, guess=hop.state, rtol=10.0**-digits)
            errors.append(np.abs(np.subtract(np.concatenate(gait.state), np.concatenate(reference.state))).max())
        assert errors[4] < 1e-8  # at 1e-10
        assert all(finer < 0.7 * coarser for coarser, finer in zip(errors[:-1], errors[1:], strict=True)), errors
        assert errors[6] < 1e-4 * errors[0]


class TestMultipliers:
    def test_by_decreasing_modulus(self, hop, free_hop):
        for gait in (hop, free_hop):
            assert (np.diff(np.abs(gait.multipliers)) < 1e-9).all()

    def test_locked_hop_is_stable(self, hop):
        assert hop.multipliers.shape == (3,) and hop.stable
        assert np.abs(hop.multipliers).max() < 0.6

    def test_do_not_depend_on_the_step(self, hop):
        for step in (3e-6, 1e-4):
            other = eigenvalues(differentiate_return_map(hop.system, hop.state, rtol=1e-11, step=step))
            np.testing.assert_allclose(other, hop.multipliers, rtol=0, atol=1e-4)

    def test_the_largest_is_what_the_power_method_finds(self, hop):
        """A small disturbance, brought back to its size after every hop, grows by the leading multiplier."""
        local = chart(hop.system, hop.state)
        xi = np.array([1.0, 1.0, -1.0])
        for _ in range(16):
            xi *= 1e-4 / np.linalg.norm(xi)
            after = local.coordinates(return_map(hop.system, local.state(xi)).state)
            xi, growth = after, after @ xi / (xi @ xi)
        assert growth == pytest.approx(hop.multipliers[0].real, abs=1e-3)

    def test_hopping_freely_is_unstable(self, free_hop):
        assert free_hop.multipliers.shape == (4,) and not free_hop.stable
        moduli = np.abs(free_hop.multipliers)
        assert 2.0 < moduli[0] < 3.0 and moduli[1] < 1.0

    def test_foot_placement_makes_it_stable(self, free_hop):
        """The speed it acts on is zero in this gait, so that the gait stays as it is."""
        law = replace(free_hop.system.law, foot_placement=0.15)
        system = free_hop.system.build(free_hop.system.robot, law, free_hop.system.spring, free_hop.system.contact)
        placed = find_gait(system, guess=free_hop.state)
        np.testing.assert_allclose(placed.state[1], free_hop.state[1], rtol=0, atol=1e-6)
        assert placed.stable and np.abs(placed.multipliers).max() < 0.8

    def test_the_wrong_sign_of_foot_placement_makes_it_worse(self, free_hop):
        law = replace(free_hop.system.law, foot_placement=-0.1)
        system = free_hop.system.build(free_hop.system.robot, law, free_hop.system.spring, free_hop.system.contact)
        assert (
            np.abs(eigenvalues(differentiate_return_map(system, free_hop.state))[0])
            > np.abs(free_hop.multipliers[0]) + 0.5
        )

    def test_a_perturbed_cycle_that_does_not_close(self, robot, hop):
        system = hopping(robot, HoppingLaw(stance_torque=0.0))
        with pytest.raises(NoGait, match="does not close"):
            multipliers(system, hop.state)


class TestEigenvalues:
    PAIR, TRIPLE = np.array([[0.3, -0.4], [0.4, 0.3]]), np.diag([0.1, -2.0, 0.5])

    def test_their_order(self):
        np.testing.assert_allclose(eigenvalues(self.PAIR), [0.3 + 0.4j, 0.3 - 0.4j], rtol=0, atol=1e-15)
        np.testing.assert_allclose(eigenvalues(self.TRIPLE), [-2.0, 0.5, 0.1], rtol=0, atol=1e-15)

    def test_of_many_matrices_are_those_of_each(self):
        matrices = np.random.default_rng(0).normal(size=(64, 4, 4))
        np.testing.assert_array_equal(eigenvalues(matrices), [eigenvalues(matrix) for matrix in matrices])
