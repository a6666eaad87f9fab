"""Collocation against the exponential of a matrix."""

import numpy as np
import pytest
import scipy.linalg

from spear_pin.hybrid.tangent.collocation import POINTS, TAIL, carry_along, roughness, rule


@pytest.mark.parametrize("shares", [[1.0], [0.2, 0.3, 0.5]], ids=["one panel", "panels of different lengths"])
def test_carries_like_the_exponential(shares):
    random = np.random.default_rng(5)
    nv, c, length = 3, 2, 0.5
    by_state, drive, start = random.normal(size=(nv, 2 * nv)), random.normal(size=(nv, c)), random.normal(size=(6, c))
    whole = np.zeros((2 * nv + c, 2 * nv + c))
    whole[:nv, nv : 2 * nv], whole[nv : 2 * nv, : 2 * nv] = np.eye(nv), by_state
    whole[nv : 2 * nv, 2 * nv :] = drive
    lengths = length * np.array(shares)
    same = np.broadcast_to(np.hstack([by_state, drive]), (len(lengths), POINTS, nv, 2 * nv + c))
    found = carry_along(same, lengths, start)

    def exact(t):
        return (scipy.linalg.expm(whole * t) @ np.concatenate([start, np.eye(c)]))[: 2 * nv]

    assert found.end == pytest.approx(exact(length), rel=1e-12, abs=1e-12)
    times = ((np.cumsum(lengths) - lengths)[:, None] + np.outer(lengths, rule().nodes)).ravel()
    for t, S in zip(times, found.inside().swapaxes(0, 1), strict=True):
        assert S == pytest.approx(exact(t), rel=1e-12, abs=1e-12)


def test_carries_what_changes_over_time():
    """Against an integrator of another method, of coefficients that are waves."""
    random = np.random.default_rng(11)
    nv, c, h, panels = 2, 3, 0.2, 3
    of_state, beside = random.normal(size=(2, nv, 2 * nv)), random.normal(size=(2, nv, c))

    def at(parts, t):
        return parts[0] * np.cos(3.0 * t) + parts[1] * np.sin(2.0 * t)

    times = (h * (np.arange(panels)[:, None] + rule().nodes))[..., None, None]
    slopes = np.concatenate([at(parts[:, None, None], times) for parts in (of_state, beside)], axis=-1)
    start = random.normal(size=(2 * nv, c))

    def slope(t, y):
        S = y.reshape(2 * nv, c)
        return np.concatenate([S[nv:], at(of_state, t) @ S + at(beside, t)]).ravel()

    points = times.ravel()
    expected = scipy.integrate.solve_ivp(
        slope, (0.0, h * panels), start.ravel(), "DOP853", [*points, h * panels], rtol=1e-12, atol=1e-13
    ).y.reshape(2 * nv, c, -1)
    found = carry_along(slopes, np.full(panels, h), start)
    np.testing.assert_allclose(found.end, expected[..., -1], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.inside(), expected[..., :-1].swapaxes(1, 2), rtol=0, atol=1e-10)


def test_equations_that_are_singular_are_refused():
    """At the first point all v count alike, and so much that 1 in 1 - h a_00 A is lost: two equations are one."""
    slopes = np.zeros((1, POINTS, 2, 5))
    slopes[0, 0, :, 2:4] = 1e30
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        carry_along(slopes, np.ones(1), np.zeros((4, 1)))


def test_ends_have_twice_as_many_digits():
    """S'' = -400 S over one panel of ten radians; at the points errors are those of polynomials."""
    h, k = 0.5, rule().nodes
    found = carry_along(np.full((1, POINTS, 1, 3), [-400.0, 0.0, 0.0]), np.array([h]), np.array([[1.0], [0.0]]))
    at_points = np.abs(found.inside()[0, :, 0] - np.cos(20.0 * h * k)).max()
    at_end = abs(found.end[0, 0] - np.cos(20.0 * h))
    assert 1e-9 < at_points < 1e-6 and at_end < 1e-12


def test_rule_integrates_polynomials():
    gauss = rule()
    assert gauss.weights @ gauss.nodes**20 == pytest.approx(1.0 / 21.0, rel=1e-13)
    assert gauss.partial @ gauss.nodes**9 == pytest.approx(gauss.nodes**10 / 10.0, abs=1e-15)


def test_motion_is_smooth_where_polynomials_follow_it():
    t = rule().nodes[None, :, None]
    assert roughness(np.sin(3.0 * t)) < TAIL < roughness(np.sin(5.0 * t))
    assert roughness(np.abs(t - 0.3)) > 1e-3


def test_a_panel_is_rough_by_itself():
    t = rule().nodes[:, None] + np.arange(2)[:, None, None]
    smooth, rough = roughness(np.abs(t - 1.3))
    assert smooth < TAIL < 1e-3 < rough
