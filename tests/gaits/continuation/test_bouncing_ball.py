"""A ball on a table that moves as Γ sin θ bounces once a period: its fold and its flip in closed form.

In units of the table's frequency and of gravity, with u just after an impact and restitution e: a period-one bounce
has u = π, which is what the impact gives where the table's velocity is Γ cos θ = π (1 - e) / (1 + e), so that there is
none where Γ is less. The Jacobian of the map (θ, u) has the determinant e² and the trace 1 + e² - (1 + e)² Γ sin θ: a
multiplier is 1 where sin θ = 0, and -1 where Γ sin θ = 2 (1 + e²) / (1 + e)².
"""

import numpy as np
import pytest
import scipy

from spear_pin.gaits.continuation.signs import FLIP, FOLD
from tests.gaits.continuation.plain import Plain, kinds

E = 0.5
ALONG, ACROSS = np.pi * (1 - E) / (1 + E), 2 * (1 + E**2) / (1 + E) ** 2  # Γ cos θ, and Γ sin θ at the flip


def bounce(x, gamma):
    theta, u = x

    def gap(time):
        return gamma * np.sin(theta) + u * time - 0.5 * time**2 - gamma * np.sin(theta + time)

    time = scipy.optimize.brentq(gap, 4.0, 9.0, xtol=1e-15, rtol=1e-15)
    later = theta + time
    return np.array([later - 2 * np.pi, (1 + E) * gamma * np.cos(later) - E * (u - time)]), (("air", "impact"),)


def branch():
    gamma = 1.3
    return Plain(bounce, np.array([1.0, 1.0, 1.0])).both_ways([np.arccos(ALONG / gamma), np.pi], gamma, (0.5, 2.0))


def test_the_fold_is_where_the_bounce_ceases_to_exist():
    down, _ = branch()
    assert kinds(down)[0] == FOLD
    special = down.met[0][1]
    assert special.point.local.u[-1] == pytest.approx(ALONG, abs=1e-8)
    assert special.point.local.u[0] == pytest.approx(0.0, abs=1e-6)
    assert special.critical[0] == pytest.approx(1.0, abs=1e-5)


def test_behind_the_fold_it_goes_on_as_a_saddle_to_the_end_of_the_range():
    down, _ = branch()
    assert down.end == "range"
    assert down.points[-1].local.u[-1] == pytest.approx(2.0)
    assert down.points[-1].local.u[0] == pytest.approx(-np.arccos(ALONG / 2.0), abs=1e-8)
    assert down.points[-1].local.multipliers[0].real > 1.0


def test_the_flip_is_where_the_trace_says():
    _, up = branch()
    assert kinds(up) == [FLIP]
    special = up.met[0][1]
    assert special.point.local.u[-1] == pytest.approx(np.hypot(ALONG, ACROSS), abs=1e-8)
    assert special.critical[0] == pytest.approx(-1.0, abs=1e-6)
    assert up.end == "range"


def test_the_determinant_is_the_square_of_the_restitution_all_along():
    for way in branch():
        for point in way.points:
            assert np.prod(point.local.multipliers).real == pytest.approx(E**2, abs=1e-7)
