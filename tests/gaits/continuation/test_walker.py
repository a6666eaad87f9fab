"""The simplest walking model, of Garcia, Chatterjee, Ruina and Coleman (1998): its period doubles at a slope of 0.0151.

In units of leg and gravity: θ'' = sin(θ - γ), φ'' = θ'' + θ'² sin φ - cos(θ - γ) sin φ; the foot strikes where φ = 2 θ,
and then θ ← -θ, θ' ← cos 2θ θ', φ ← -2θ, φ' ← cos 2θ (1 - cos 2θ) θ'.
"""

import numpy as np
import pytest
import scipy

from spear_pin.gaits.continuation.problem import NoValue
from spear_pin.gaits.continuation.signs import FLIP
from tests.gaits.continuation.plain import Plain, kinds

LONG = np.array([0.200310900544287, -0.199832473004977])  # θ, θ' at the slope 0.009, as printed
STEP = (("swing", "heel_strike"),)


def motion(t, y, gamma):
    theta, phi, theta_rate, phi_rate = y
    turn = np.sin(theta - gamma)
    return [theta_rate, phi_rate, turn, turn + (theta_rate**2 - np.cos(theta - gamma)) * np.sin(phi)]


def heel_strike(t, y, gamma):
    return y[1] - 2 * y[0] if y[0] < -0.05 else -1.0  # before, the foot scuffs as the legs pass each other


heel_strike.terminal, heel_strike.direction = True, 1


def strides(x, gamma):
    theta, rate = x
    begin = [theta, 2 * theta, rate, (1 - np.cos(2 * theta)) * rate]
    run = scipy.integrate.solve_ivp(
        motion, (0.0, 6.0), begin, "DOP853", events=heel_strike, rtol=1e-12, atol=1e-13, args=(gamma,)
    )
    if not run.t_events[0].size:
        raise NoValue("falls")
    theta, _, rate, _ = run.y_events[0][0]
    return np.array([-theta, np.cos(2 * theta) * rate]), STEP


def test_the_published_gait_is_a_fixed_point():
    assert strides(LONG, 0.009)[0] == pytest.approx(LONG, abs=1e-6)


@pytest.mark.slow
def test_its_period_doubles_at_the_published_slope():
    plain = Plain(strides, np.array([1.0, 1.0, 0.02]))
    x = scipy.optimize.fsolve(lambda x: strides(x, 0.009)[0] - x, LONG, xtol=1e-12)
    _, up = plain.both_ways(x, 0.009, (0.008, 0.016))
    assert kinds(up) == [FLIP]
    assert up.met[0][1].point.local.u[-1] * 0.02 == pytest.approx(0.0151, abs=5e-5)
