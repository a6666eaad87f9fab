"""An oscillator kicked once a period by its position and rate: its Neimark-Sacker point in closed form.

Between kicks it is linear, z ↦ Φ z with det Φ = exp(-2 ζ ω T) = δ; a kick changes the rate by b - β x + μ v - c v³ of the
state before it. So the map's determinant is δ (1 + μ - 3 c v²). A kick J is that of a fixed point where the state before
is J g, g = (1 - Φ)⁻¹ Φ (0, 1), and J = b - β g₁ J + μ g₂ J - c (g₂ J)³. That gives μ by J; with it, determinant 1 is a
cubic in J.
"""

import numpy as np
import pytest
import scipy

from spear_pin.gaits.continuation.signs import TORUS
from tests.gaits.continuation.plain import Plain, kinds

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


def closed_form():
    """Gain and kick of the Neimark-Sacker points."""
    constant = 1.0 + (1.0 + BETA * G1) / G2 - 1.0 / DELTA
    kicks = np.roots([-2.0 * C * G2**2, 0.0, constant, -B / G2])
    return [(gain(kick), kick) for kick in kicks[np.abs(kicks.imag) < 1e-12].real]


def multipliers(mu, kick):
    rate = G2 * kick
    kick_map = np.array([[1.0, 0.0], [-BETA, 1.0 + mu - 3 * C * rate**2]])
    return np.linalg.eigvals(kick_map @ PHI)


def test_the_closed_form_has_a_pair_on_the_circle():
    for mu, kick in closed_form():
        assert kicked(state(kick), mu)[0] == pytest.approx(state(kick), abs=1e-12)
        assert np.prod(multipliers(mu, kick)).real == pytest.approx(1.0)


def test_neimark_sacker_points_are_where_the_determinant_is_one():
    kick = 0.2
    plain = Plain(kicked, np.ones(3))
    ways = plain.both_ways(state(kick), gain(kick), (-3.0, 3.0))
    found = sorted(
        float(met.point.local.u[-1]) for way in ways for _, met in way.met if met.kind == TORUS
    )
    expected = sorted(mu for mu, kick in closed_form() if abs(multipliers(mu, kick)[0].imag) > 0 and abs(mu) < 3)
    print([kinds(way) for way in ways], [way.end for way in ways], [p.local.u for w in ways for p in w.points][:3], closed_form())
    assert found == pytest.approx(expected, abs=1e-8)
