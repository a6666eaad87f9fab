"""Collocation against the exponential of a matrix."""

import numpy as np
import pytest
import scipy.linalg

from spear_pin.hybrid.tangent.collocation import POINTS, TAIL, carried, roughness, rule


@pytest.mark.parametrize("panels", [1, 3])
def test_carries_like_the_exponential(panels):
    random = np.random.default_rng(5)
    nv, c, length = 3, 2, 0.5
    by_state, drive, start = random.normal(size=(nv, 2 * nv)), random.normal(size=(nv, c)), random.normal(size=(6, c))
    whole = np.zeros((2 * nv + c, 2 * nv + c))
    whole[:nv, nv : 2 * nv], whole[nv : 2 * nv, : 2 * nv] = np.eye(nv), by_state
    whole[nv : 2 * nv, 2 * nv :] = drive
    A, B = (np.broadcast_to(each, (panels, POINTS, *each.shape)) for each in (by_state, drive))
    h = length / panels
    inside, end = carried(A, B, h, start)

    def exact(t):
        return (scipy.linalg.expm(whole * t) @ np.concatenate([start, np.eye(c)]))[: 2 * nv]

    assert end == pytest.approx(exact(length), rel=1e-12, abs=1e-12)
    times = (h * (np.arange(panels)[:, None] + rule().nodes)).ravel()
    for t, found in zip(times, inside.reshape(-1, 2 * nv, c), strict=True):
        assert found == pytest.approx(exact(t), rel=1e-12, abs=1e-12)


def test_rule_integrates_polynomials():
    gauss = rule()
    assert gauss.weights @ gauss.nodes**20 == pytest.approx(1.0 / 21.0, rel=1e-13)
    assert gauss.partial @ gauss.nodes**9 == pytest.approx(gauss.nodes**10 / 10.0, abs=1e-15)


def test_motion_is_smooth_where_polynomials_follow_it():
    t = rule().nodes[None, :, None]
    assert roughness(np.sin(2.0 * t)) < TAIL < roughness(np.sin(3.0 * t))
    assert roughness(np.abs(t - 0.3)) > 1e-3
