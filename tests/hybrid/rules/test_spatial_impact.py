"""Impacts of one to four toes in space: Moreau's law is kept, energy is never gained, and the plane is a part of it."""

import numpy as np
import pytest

from spear_pin import load
from spear_pin.hybrid.rules.impact import joint_impact
from spear_pin.hybrid.rules.spatial_impact import spatial_impact, violation

ROBOT = load("q_spear_full", base="chain")


def states(seed, count):
    """Random states of Q-SPEAR with some toes that strike, and a coefficient of friction."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        q, v = rng.uniform(-0.6, 0.6, ROBOT.nv), rng.normal(size=ROBOT.nv)
        chosen = [toe for toe in ROBOT.toes if rng.random() < 0.6] or [ROBOT.toes[0]]
        jacobian = np.concatenate([ROBOT.toe_jacobian(q, toe) for toe in chosen])
        if not ((jacobian @ v)[2::3] < 0.0).any():
            v = -v
        yield ROBOT.mass_matrix(q), jacobian, v, float(rng.uniform(0.2, 1.2))


def check(count, seed):
    worst = gained = 0.0
    for D, J, v, friction in states(seed, count):
        impact = spatial_impact(D, J, v, friction)
        A = J @ np.linalg.solve(D, J.T)
        worst = max(worst, violation(A, J @ v, impact.impulse, friction))
        gained = max(gained, -impact.loss)
        kinetic = 0.5 * v @ D @ v - 0.5 * impact.v @ D @ impact.v
        assert impact.loss == pytest.approx(kinetic, abs=1e-11 * (1.0 + v @ D @ v))
    assert worst <= 1e-9 and gained <= 1e-12


def test_law_and_energy():
    check(300, 1)


@pytest.mark.slow
def test_law_and_energy_of_many():
    check(10_000, 2)


def test_symmetric_impact_of_two_is_the_planes():
    """What is symmetric stays so, and both toes of a pair have half of the plane's impulse."""
    planar, q = load("q_spear"), np.array([0.0, 0.6, 0.05, 0.6, 1.0, -0.4, -1.0])
    rng = np.random.default_rng(3)
    for friction in (0.3, 0.8):
        for _ in range(20):
            v = rng.normal(size=7)
            v[1] = -2.0
            there = np.zeros(18), np.zeros(18)
            for whole, part in zip(there, (q, v), strict=True):
                whole[[0, 2, 4]] = part[:3]
                whole[[7, 10]], whole[[8, 11]], whole[[13, 16]], whole[[14, 17]] = part[3:]
            J = np.concatenate([ROBOT.toe_jacobian(there[0], toe) for toe in ROBOT.toes[:2]])
            found = spatial_impact(ROBOT.mass_matrix(there[0]), J, there[1], friction)
            wanted = joint_impact(planar.mass_matrix(q), planar.toe_jacobian(q, "posterior_toe"), v, friction)
            np.testing.assert_allclose(2.0 * found.impulse[:, [0, 2]], 2 * [wanted.impulse[0]], rtol=0, atol=1e-10)
            np.testing.assert_allclose(found.impulse[:, 1].sum(), 0.0, atol=1e-12)
            np.testing.assert_allclose(found.v[[0, 2, 4, 7, 8, 13, 14]], wanted.v, rtol=0, atol=1e-10)
            assert found.loss == pytest.approx(wanted.loss, abs=1e-10)


def test_an_impact_in_two_parts_is_that_at_once_while_the_sum_pushes():
    """Left, then right with the left still struck: the sum of the impulses is that of both together."""
    for D, J, v, _ in states(4, 200):
        if len(J) != 6:
            continue
        both = spatial_impact(D, J, v, 5.0)
        if any(both.slides) or any(both.leaves):
            continue
        first = spatial_impact(D, J[:3], v, 5.0)
        received = np.vstack([first.impulse, np.zeros(3)])
        second = spatial_impact(D, J, first.v, 5.0, received)
        np.testing.assert_allclose(second.v, both.v, rtol=0, atol=1e-9)
        np.testing.assert_allclose(received + second.impulse, both.impulse, rtol=0, atol=1e-9)
        assert second.loss >= -1e-12
