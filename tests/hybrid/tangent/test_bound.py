"""Derivatives of bounds: springs that go slack, slips, lift-offs at once."""

import numpy as np
import pytest

from spear_pin import Gait
from tests.hybrid.tangent.oracle import derivative

pytest.importorskip("heyoka")


@pytest.mark.parametrize("name", ["long_stride", "least_effort", "force_lift_off"])
def test_multipliers_are_those_of_the_gait(name):
    gait = Gait.load(name)
    result, around, _ = derivative(gait.system, np.concatenate(gait.state))
    nv = gait.system.robot.nv
    M = np.concatenate([around.q_basis.T @ result.dy[:nv], around.v_basis.T @ result.dy[nv:]])
    moduli = np.sort(np.abs(np.linalg.eigvals(M)))
    assert moduli == pytest.approx(np.sort(np.abs(gait.multipliers)), abs=1e-5)
