"""A floating base as a chain of six joints: the same robot as with a quaternion, in other coordinates."""

import math

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import from_chain, load, to_chain
from spear_pin.errors import BadValue
from spear_pin.model.chain import CHAIN, on_chain

RNG = np.random.default_rng(1)
STATES = [(0.7 * RNG.normal(size=18), RNG.normal(size=18)) for _ in range(20)]


@pytest.fixture(scope="module")
def free():
    return load("q_spear_full")


@pytest.fixture(scope="module")
def chain():
    return load("q_spear_full", base="chain")


def rates(chain, q):
    """T of v_free = T v_chain, by columns."""
    return np.column_stack([from_chain(chain, q, unit).v for unit in np.eye(18)])


class TestSameRobot:
    def test_names(self, free, chain):
        assert chain.coordinates[:6] == CHAIN and chain.coordinates[6:] == free.coordinates[6:]
        assert (chain.toes, chain.actuated, chain.nq) == (free.toes, free.actuated, chain.nv)
        assert chain.units == (*3 * ("m",), *15 * ("rad",))
        assert chain.limits["posterior_left_knee"] == free.limits["posterior_left_knee"]
        assert {*map(chain.gear_ratio, chain.actuated)} == {*map(free.gear_ratio, free.actuated)} == {60.0, 15.0}

    def test_nothing_drives_the_base(self, chain):
        assert load("q_spear_full", base="chain", motors="all").actuated == chain.actuated

    @pytest.mark.parametrize("state", STATES)
    def test_dynamics_after_the_change_of_velocities(self, free, chain, state):
        (q, v), turned = state, from_chain(chain, *state)
        T = rates(chain, q)
        mass_matrix = chain.mass_matrix(q)
        np.testing.assert_allclose(
            T.T @ free.mass_matrix(turned.q) @ T, mass_matrix, atol=1e-14 * abs(mass_matrix).max()
        )
        np.testing.assert_allclose(T.T @ free.gravity(turned.q), chain.gravity(q), rtol=0, atol=1e-12)
        np.testing.assert_allclose(T @ v, turned.v, rtol=0, atol=1e-14)
        for toe in chain.toes:
            np.testing.assert_allclose(free.toe_position(turned.q, toe), chain.toe_position(q, toe), atol=1e-14)
            np.testing.assert_allclose(free.toe_jacobian(turned.q, toe) @ T, chain.toe_jacobian(q, toe), atol=1e-13)

    @pytest.mark.parametrize("state", STATES[:5])
    def test_bias_by_the_acceleration_in_free_fall(self, free, chain, state):
        """The same motion: the toes' accelerations under no torque but gravity's do not depend on coordinates."""
        (q, v), turned = state, from_chain(chain, *state)
        for toe in chain.toes:
            here, there = (
                robot.toe_jacobian(a, toe) @ np.linalg.solve(robot.mass_matrix(a), -robot.bias(a, b))
                + robot.toe_drift(a, b, toe)
                for robot, a, b in ((chain, q, v), (free, *turned))
            )
            np.testing.assert_allclose(here, there, rtol=0, atol=2e-10 * max(1.0, abs(here).max()))


class TestConversion:
    @pytest.mark.parametrize("state", STATES)
    def test_round_trip(self, free, chain, state):
        q, v = to_chain(free, *from_chain(chain, *state))
        np.testing.assert_allclose(q, state[0], rtol=0, atol=2e-14)
        np.testing.assert_allclose(v, state[1], rtol=0, atol=2e-13)

    def test_signs(self, chain):
        """Yaw to the left, pitch nose up, roll to the right side."""
        for name, axis in (("yaw", (0, 0, 1)), ("pitch", (0, -1, 0)), ("roll", (1, 0, 0))):
            q = np.zeros(18)
            q[chain.index(name)] = 0.3
            turned = pin.Quaternion(from_chain(chain, q, np.zeros(18)).q[3:7].reshape(4, 1)).toRotationMatrix()
            np.testing.assert_allclose(turned, pin.exp3(0.3 * np.array(axis, dtype=float)), atol=1e-15)

    def test_pitch_of_90_degrees_is_refused(self, free, chain):
        q = np.zeros(18)
        q[CHAIN.index("pitch")] = 0.5 * math.pi
        with pytest.raises(BadValue, match="singular"):
            to_chain(free, *from_chain(chain, q, np.zeros(18)))

    def test_other_robots_are_refused(self, free, chain):
        with pytest.raises(BadValue, match="chain"):
            from_chain(free, pin.neutral(free.model), np.zeros(18))
        with pytest.raises(BadValue, match="floating"):
            to_chain(chain, np.zeros(18), np.zeros(18))


class TestLoading:
    def test_base_that_does_not_float_is_refused(self):
        with pytest.raises(BadValue, match="not its only floating joint"):
            on_chain(load("spear_ii").model)

    def test_other_words_are_refused(self):
        with pytest.raises(BadValue, match="'free', 'chain' or 'fixed'"):
            load("q_spear_full", base="float")  # type: ignore[arg-type]
