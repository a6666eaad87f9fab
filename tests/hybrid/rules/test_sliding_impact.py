"""Keller's impact of one toe in space: its law, energy, the plane's, Moreau's, and another way to integrate it."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.hybrid.rules.impact import plastic_impact
from spear_pin.hybrid.rules.sliding_impact import sliding_impact
from spear_pin.hybrid.rules.spatial_impact import spatial_impact
from spear_pin.hybrid.strikes import Overlap, strike_toes
from tests.hybrid.rules.test_spatial_impact import ROBOT


def states(seed, count):
    """Random states of Q-SPEAR in which one toe strikes, and a coefficient of friction."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        q, v = rng.uniform(-0.6, 0.6, ROBOT.nv), rng.normal(size=ROBOT.nv)
        jacobian = ROBOT.toe_jacobian(q, ROBOT.toes[int(rng.integers(4))])
        v *= -np.sign((jacobian @ v)[2])
        yield ROBOT.mass_matrix(q), jacobian, v, float(rng.uniform(0.2, 1.2))


def check(count, seed):
    """How often Moreau's law says something else, and the differences relative to the change of velocity."""
    off = []
    for D, J, v, friction in states(seed, count):
        impact, other = sliding_impact(D, J, v, friction), spatial_impact(D, J, v, friction)
        after, (x, y, z) = J @ impact.v, impact.impulse[0]
        speed = np.abs(J @ v).max()
        assert abs(after[2]) < 1e-9 * speed and z > 0.0 and np.hypot(x, y) <= friction * z * (1.0 + 1e-9)
        assert impact.slides[0] == (np.hypot(after[0], after[1]) > 1e-9 * speed)
        kinetic = 0.5 * v @ D @ v - 0.5 * impact.v @ D @ impact.v
        assert impact.loss == pytest.approx(kinetic, abs=1e-11 * (1.0 + v @ D @ v)) and impact.loss > 0.0
        off.append(np.abs(impact.v - other.v).max() / np.abs(other.v - v).max())
        if not impact.slides[0] and not other.slides[0]:
            assert off[-1] < 1e-9
        assert not (other.slides[0] and not impact.slides[0])  # Moreau's sticks where it can
    return np.array(off)


def test_law_and_energy():
    off = check(20, 1)
    assert np.median(off) < 0.05 < off.max()


@pytest.mark.slow
def test_law_and_energy_of_many():
    off = check(300, 2)
    assert np.median(off) < 0.02 and 0.05 < off.max() < 1.5


def planar(seed):
    """A toe in the plane, and the same one in space where y is a coordinate of its own."""
    rng = np.random.default_rng(seed)
    root, J, v = rng.normal(size=(3, 3)), rng.normal(size=(2, 3)), rng.normal(size=3)
    D = root @ root.T + 0.1 * np.eye(3)
    v *= -np.sign((J @ v)[1])
    whole, rows = np.eye(4), np.zeros((3, 4))
    whole[:3, :3], rows[[0, 2], :3], rows[1, 3] = D, J, 1.0
    return (D, J, v), (whole, rows, np.append(v, 0.0))


def test_in_a_plane_it_is_rouths():
    """Also where the toe stops and slides back."""
    ways = set()
    for seed in range(60):
        flat, whole = planar(seed)
        for friction in (0.1, 0.4, 1.5):
            wanted, found = plastic_impact(*flat, friction), sliding_impact(*whole, friction)
            np.testing.assert_allclose(found.v, [*wanted.v, 0.0], rtol=0, atol=1e-8 * np.abs(wanted.v).max())
            assert found.slides[0] == wanted.slides
            turned = (flat[1] @ wanted.v)[0] * (flat[1] @ flat[2])[0] < 0.0
            ways.add("sticks" if not wanted.slides else "slides back" if turned else "slides on")
    assert ways == {"sticks", "slides back", "slides on"}


def test_where_it_slides_to_the_end_it_is_keller_by_the_normal_impulse():
    """His equation as he has it, over l, where nothing is singular as long as the toe slides."""
    compared = 0
    for D, J, v, friction in states(5, 12):
        A, before = J @ np.linalg.solve(D, J.T), J @ v

        def slope(_, u, A=A, friction=friction):
            return A @ np.append(-friction * u[:2] / np.hypot(*u[:2]), 1.0)

        def ends(_, u):
            return u[2]

        def stops(_, u, before=before):
            return np.hypot(*u[:2]) - 0.05 * np.hypot(*before[:2])

        ends.terminal = stops.terminal = True
        ends.direction = 1.0
        path = scipy.integrate.solve_ivp(
            slope, (0.0, 1e3), before, "Radau", events=(ends, stops), rtol=1e-9, atol=1e-11
        )
        if len(path.t_events[0]):
            impact = sliding_impact(D, J, v, friction)
            np.testing.assert_allclose(J @ impact.v, path.y[:, -1], rtol=0, atol=1e-6 * np.abs(before).max())
            assert impact.impulse[0, 2] == pytest.approx(path.t[-1], rel=1e-6) and impact.slides == (True,)
            compared += 1
    assert compared >= 4


def test_a_toe_that_leaves_is_not_struck():
    D, J, v, friction = next(states(7, 1))
    impact = sliding_impact(D, J, -v, friction)
    assert not impact.impulse.any() and impact.leaves == (True,) and np.array_equal(impact.v, -v)


def test_what_cannot_be_followed_is_said(monkeypatch):
    monkeypatch.setattr("spear_pin.hybrid.rules.sliding_impact.LONGEST", 1e-6)
    D, J, v, friction = next(states(7, 1))
    with pytest.raises(ArithmeticError, match="neither stops nor ends"):
        sliding_impact(D, J, v, friction)


def test_a_system_has_it_for_one_toe_alone():
    gait = Gait.load("turn_4")
    domain, guard = next(
        (domain, guard)
        for domain in gait.system.domains
        for guard in domain.guards
        if guard.reset is not None and len(guard.reset.impact) == 1 and not any(c != "open" for c in domain.contacts)
    )
    (q, v), (toe,) = gait.state, guard.reset.impact
    jacobian = gait.system.ground.foot(gait.system.robot, q, toe)[1]
    v = v - 0.5 * np.abs(jacobian[2] @ v) * np.eye(len(v))[2] + np.eye(len(v))[1] * 0.7
    found = {}
    for law in ("moreau", "keller"):
        system = replace(gait.system, impact_law=law)
        found[law] = strike_toes(system, domain, guard.reset, q + 1.0 * np.eye(len(q))[2], v, Overlap(0.0), 0.0)
    friction = gait.system.contact.friction
    D = gait.system.robot.mass_matrix(q)
    np.testing.assert_allclose(found["keller"].v, sliding_impact(D, jacobian, v, friction).v, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["moreau"].v, spatial_impact(D, jacobian, v, friction).v, rtol=0, atol=1e-9)
    with pytest.raises(BadValue, match="impact_law"):
        replace(gait.system, impact_law="newton")
