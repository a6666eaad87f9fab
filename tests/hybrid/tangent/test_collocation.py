"""The derivative of a flow by collocation, against the exponential of a matrix."""

import numpy as np
import pytest
import scipy

from spear_pin.hybrid.tangent.collocation import POINTS, carried, rule, smooth


def test_the_rule_is_exact_for_polynomials():
    gauss = rule()
    assert gauss.partial @ gauss.nodes**5 == pytest.approx(gauss.nodes**6 / 6.0, abs=1e-15)
    assert gauss.weights @ gauss.nodes**20 == pytest.approx(1.0 / 21.0, rel=1e-14)


def test_a_linear_flow_with_a_constant_drive():
    rng = np.random.default_rng(1)
    A, b = 5.0 * rng.normal(size=(2, 4)), rng.normal(size=(2, 3))
    shape, start = (3, POINTS), rng.normal(size=(4, 3))
    _, end = carried(np.broadcast_to(A, (*shape, 2, 4)), np.broadcast_to(b, (*shape, 2, 3)), 0.2, start)
    slopes = np.concatenate([np.eye(2, 4, 2), A])  # of (q, v)
    driven = np.concatenate([np.zeros((2, 3)), b])
    whole = scipy.linalg.expm(0.6 * np.block([[slopes, driven], [np.zeros((3, 7))]]))
    assert end == pytest.approx(whole[:4, :4] @ start + whole[:4, 4:], rel=1e-11)


def test_what_is_not_smooth_is_told():
    t = rule().nodes[None, :, None]
    assert smooth(np.sin(3.0 * t)) and not smooth(np.sin(60.0 * t)) and not smooth(np.abs(t - 0.4))
