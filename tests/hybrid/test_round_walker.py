"""A walker with round feet: a step of another program, its mistake at heelstrike, and an integration by SciPy."""

import numpy as np
import pytest

from spear_pin import find_gait, simulate
from spear_pin.hybrid.batch import simulate_many
from tests.hybrid.test_walkers import central, until
from tests.walkers import ROUND, example, round_state

HIP, LEG, INERTIA, HALF, RADIUS, SLOPE = 1.0, 0.5, 0.02, 0.5, 0.2, 0.01
STEP = 1e-30


def velocities(a, b):
    """How hip and legs' centres of mass move per unit of both rates, (3, 2, 2), with the first leg on the ground."""
    hip = np.array([[-RADIUS - np.cos(a), 0.0], [-np.sin(a), 0.0]])
    first = hip + HALF * np.array([[np.cos(a), 0.0], [np.sin(a), 0.0]])
    second = hip + HALF * np.array([[0.0, np.cos(b)], [0.0, np.sin(b)]])
    return np.array([hip, first, second])


MASSES = np.array([HIP, LEG, LEG])


def inertia(a, b):
    return np.einsum("i,ijk,ijl->kl", MASSES, *[velocities(a, b)] * 2) + INERTIA * np.eye(2)


def energy(a, b):
    """Potential energy; x leads down the slope, where gravity is 1."""
    hip = np.array([-RADIUS * a - np.sin(a), RADIUS + np.cos(a)])
    first, second = (hip + HALF * np.array([np.sin(each), -np.cos(each)]) for each in (a, b))
    return (HIP * hip + LEG * (first + second)) @ [-np.sin(SLOPE), np.cos(SLOPE)]


def slope(t, y):
    """Lagrange's equations, with derivatives by complex steps."""
    w = y[2:]
    ahead = [(y[0] + 1j * STEP, y[1]), (y[0], y[1] + 1j * STEP)]
    bends = [inertia(*each).imag / STEP for each in ahead]
    force = [0.5 * w @ bend @ w - energy(*each).imag / STEP for bend, each in zip(bends, ahead, strict=True)]
    turning = sum(rate * bend for rate, bend in zip(w, bends, strict=True))
    return [*w, *np.linalg.solve(inertia(y[0], y[1]), force - turning @ w)]


def reached(numbers):
    """Angles and rates of both legs just before heelstrike."""
    angle, rate, between, opening = numbers
    y = until(slope, [angle, angle - between, rate, rate - opening], lambda y: y[0] - y[1], -1, skip=0.2)
    return until(slope, y, lambda y: y[0] + y[1], -1, skip=0.2)


def struck(y, mistaken=False):
    """After heelstrike: no virtual motion about the foot that lands changes momentum.

    In that program the inertia of the leg that leaves turns at the rate of the other leg.
    """
    a, b, rate, other = y
    before = np.einsum("ijk,k->ij", velocities(a, b), [rate, other])[[0, 2, 1]]
    after, (landing, leaving) = velocities(b, a), (other, rate)
    momentum = np.einsum("i,ijk,ij->k", MASSES, after, before) + INERTIA * np.array([landing, leaving])
    if mistaken:
        momentum += INERTIA * (landing - leaving) * np.array([-1.0, 1.0])
    stance, swing = np.linalg.solve(inertia(b, a), momentum)
    return np.array([b, stance, b - a, stance - swing])


@pytest.fixture(scope="module")
def strike():
    """The first heelstrike from the published state, and the legs' angles and rates before it."""
    system = example().round_walker()
    found = simulate(system, round_state(system, ROUND), cycles=1, rtol=1e-12).named("right_strike")[0]
    return found, np.array([*found.q[2:], *found.v_before[2:]])


class TestPublished:
    def test_a_step_begins_and_ends_at_the_published_angle(self, strike):
        """And the published rates follow with the mistake of the program, with which its fixed point was found."""
        _, y = strike
        np.testing.assert_allclose(y[:2], [-ROUND[0], ROUND[0]], rtol=0, atol=1e-11)
        np.testing.assert_allclose(struck(y, mistaken=True), ROUND, rtol=0, atol=1e-11)

    def test_the_impact_is_that_of_the_momenta(self, strike):
        found, y = strike
        _, stance, _, opening = struck(y)
        np.testing.assert_allclose(found.v[2:], [stance - opening, stance], rtol=0, atol=1e-12)
        assert 1e-4 < abs(stance - ROUND[1]) < 2e-4


@pytest.mark.slow
class TestGait:
    def test_is_that_of_an_integration_by_scipy(self):
        gait = find_gait(example().round_walker())
        step = lambda numbers: struck(reached(numbers))  # noqa: E731
        q, v = gait.state
        found = np.array([q[2], v[2], q[2] - q[3], v[2] - v[3]])
        np.testing.assert_allclose(step(found), found, rtol=0, atol=1e-9)
        of_step = np.linalg.eigvals(central(step, found))
        of_stride = np.sort_complex(of_step**2)
        np.testing.assert_allclose(np.sort_complex(gait.multipliers), of_stride, rtol=0, atol=1e-7)
        assert gait.stable

    @pytest.mark.extra("heyoka")
    def test_lanes_walk_alike(self):
        system = example().round_walker()
        start = round_state(system, ROUND)
        lanes = simulate_many(system, *(part[None] for part in start), cycles=2)
        last = simulate(system, start, cycles=2, rtol=1e-12).named("left_strike")[-1]
        np.testing.assert_allclose(lanes.q[0], last.q, atol=1e-9)
        np.testing.assert_allclose(lanes.v[0], last.v, atol=1e-9)
