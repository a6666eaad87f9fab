"""An oscillator kicked once a period by its position and rate: its Neimark-Sacker point and fold in closed form.

Between kicks it is linear, z ↦ Φ z with det Φ = exp(-2 ζ ω T) = δ; a kick changes the rate by b - β x + μ v - c v³ of
the state before it. So the map's determinant is δ (1 + μ - 3 c v²). A kick J is that of a fixed point where the state
before it is J g, g = (1 - Φ)⁻¹ Φ (0, 1), and J = b - β g₁ J + μ g₂ J - c (g₂ J)³. That gives μ by J, with a fold where
its derivative is zero; with it, the determinant is 1 where a cubic in J is zero.
"""

import numpy as np
import pytest
import scipy

from spear_pin.gaits.continuation.signs import FLIP, FOLD, TORUS
from tests.gaits.continuation.plain import Plain

OMEGA, ZETA, T = 1.0, 0.1, 2.0
B, BETA, C = 0.3, 0.2, 0.4
PHI = scipy.linalg.expm(np.array([[0.0, 1.0], [-(OMEGA**2), -2 * ZETA * OMEGA]]) * T)
DELTA = np.exp(-2 * ZETA * OMEGA * T)
G1, G2 = np.linalg.solve(np.eye(2) - PHI, PHI @ [0.0, 1.0])


def kicked(x, mu):
    position, rate = PHI @ x
    return np.array([position, rate + B - BETA * position + mu * rate - C * rate**3]), (("swing", "kick"),)


def gain(kick):
    """μ of the fixed point with a kick."""
    return (kick - B + BETA * G1 * kick + C * (G2 * kick) ** 3) / (G2 * kick)


def state(kick):
    """Its state behind the kick."""
    return np.array([G1, G2]) * kick + [0.0, kick]


def multipliers(kick):
    rate = G2 * kick
    return np.linalg.eigvals(np.array([[1.0, 0.0], [-BETA, 1.0 + gain(kick) - 3 * C * rate**2]]) @ PHI)


def torus():
    """The kick where two multipliers have the product 1: the only one."""
    constant = 1.0 + (1.0 + BETA * G1) / G2 - 1.0 / DELTA
    roots = np.roots([-2.0 * C * G2**2, 0.0, constant, -B / G2])
    (kick,) = roots[np.abs(roots.imag) < 1e-12].real
    return kick


def fold():
    """The kick where μ is least or greatest: B + 2 c g₂³ J³ = 0."""
    return np.cbrt(-B / (2.0 * C * G2**3))


def flip():
    """The kick where a multiplier is -1, beyond that."""

    def determinant(kick):
        return np.prod(multipliers(kick) + 1.0).real

    return scipy.optimize.brentq(determinant, fold(), 2.0 * fold())


@pytest.fixture(scope="module")
def met():
    """What the branch meets, from a small kick on."""
    plain = Plain(kicked, np.ones(3))
    ways = plain.both_ways(state(0.2), gain(0.2), (-3.0, 3.0))
    return {found.kind: found for way in ways for _, found in way.met}


def test_the_closed_form_is_one():
    for kick in (torus(), fold(), flip()):
        assert kicked(state(kick), gain(kick))[0] == pytest.approx(state(kick), abs=1e-12)
    assert np.abs(multipliers(torus())) == pytest.approx([1.0, 1.0])
    assert np.abs(multipliers(torus()).imag).min() > 0.1
    assert np.abs(multipliers(fold()) - 1.0).min() < 1e-12


@pytest.mark.parametrize(("kind", "kick"), [(TORUS, torus), (FOLD, fold), (FLIP, flip)])
def test_it_is_found_where_the_closed_form_says(met, kind, kick):
    assert met[kind].point.local.u[-1] == pytest.approx(gain(kick()), abs=1e-7)
    assert met[kind].point.local.more[:2] == pytest.approx(state(kick()), abs=1e-5)


def test_the_pair_is_on_the_circle(met):
    first, second = met[TORUS].critical
    assert first == pytest.approx(second.conjugate())
    assert abs(first) == pytest.approx(1.0, abs=1e-7)


def test_nothing_else_is_found(met):
    assert set(met) == {TORUS, FOLD, FLIP}
