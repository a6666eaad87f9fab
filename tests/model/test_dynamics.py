"""The dynamics of the shipped robots: against the symbolic Lagrangian, and by what mechanics demands."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from tests.lagrangian import biped, monopod, quadruped

ROBOTS = {
    "spear_ii": (load("spear_ii"), monopod),
    "spear_ii locked": (load("spear_ii", locked=["boom_x"]), monopod),
    "q_spear": (load("q_spear"), quadruped),
    "biped": (load("biped"), biped),
}
DEGREES_OF_FREEDOM = 7
STATES = 1000

each_robot = pytest.mark.parametrize("name", ROBOTS)
few = settings(max_examples=40, derandomize=True, deadline=None)


def vectors(bound):
    return st.lists(st.floats(-bound, bound), min_size=DEGREES_OF_FREEDOM, max_size=DEGREES_OF_FREEDOM).map(np.array)


positions, rates, inputs = vectors(2.0), vectors(5.0), vectors(50.0)


def derivative(function, step=1e-4):
    """Of a function of time at zero, by five points."""
    near, far = (function(n * step) - function(-n * step) for n in (1, 2))
    return (8 * near - far) / (12 * step)


def without_rotors(robot, **fields):
    """A copy of the robot with no armature and the given fields of its Pinocchio model."""
    model = robot.model.copy()
    model.armature = np.zeros(model.nv)
    for field, value in fields.items():
        setattr(model, field, value)
    return Robot(model, name=robot.name, toes=robot.toes, actuated=robot.actuated)


@cache
def random_states(name):
    """Random states (q, v), and what the Lagrangian gives at each."""
    robot, derive = ROBOTS[name]
    lagrangian = derive(robot.coordinates)
    rng = np.random.default_rng(20)
    states = [(rng.uniform(-2, 2, robot.nq), rng.uniform(-5, 5, robot.nv)) for _ in range(STATES)]
    return [(q, v, lagrangian.terms(q, v)) for q, v in states]


def assert_close(actual, expected):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-10)


@each_robot
class TestAgainstLagrangian:
    def test_mass_matrix(self, name):
        robot, _ = ROBOTS[name]
        for q, _, terms in random_states(name):
            assert_close(robot.mass_matrix(q), terms.mass_matrix)

    def test_coriolis(self, name):
        robot, _ = ROBOTS[name]
        for q, v, terms in random_states(name):
            assert_close(robot.coriolis_matrix(q, v) @ v, terms.coriolis)

    def test_gravity(self, name):
        robot, _ = ROBOTS[name]
        for q, _, terms in random_states(name):
            assert_close(robot.gravity(q), terms.gravity)

    def test_bias(self, name):
        robot, _ = ROBOTS[name]
        for q, v, terms in random_states(name):
            assert_close(robot.bias(q, v), terms.coriolis + terms.gravity)

    def test_energies(self, name):
        robot, _ = ROBOTS[name]
        for q, v, terms in random_states(name):
            assert_close(robot.kinetic_energy(q, v), terms.kinetic_energy)
            assert_close(robot.potential_energy(q), terms.potential_energy)

    def test_toes(self, name):
        robot, _ = ROBOTS[name]
        for q, v, terms in random_states(name):
            assert set(terms.toes) == set(robot.toes)
            for toe in robot.toes:
                assert_close(robot.toe_position(q, toe), terms.toes[toe])
                assert_close(robot.toe_jacobian(q, toe), terms.jacobians[toe])
                assert_close(robot.toe_drift(q, v, toe), terms.drifts[toe])


class TestCoordinates:
    def test_monopod(self):
        assert load("spear_ii").coordinates == ("boom_x", "boom_z", "hip", "knee")
        assert load("spear_ii", locked=["boom_x"]).coordinates == ("boom_z", "hip", "knee")

    def test_quadruped(self):
        coordinates = load("q_spear").coordinates
        assert coordinates[:3] == ("torso_x", "torso_z", "pitch")
        assert set(coordinates[3:]) == {"posterior_hip", "posterior_knee", "anterior_hip", "anterior_knee"}


class TestByHand:
    """SPEAR-II at x = 0, z = 0.55, the hip at 0.5 and the knee at 1.0 rad."""

    q = (0.0, 0.55, 0.5, 1.0)
    mass_matrix = load("spear_ii").mass_matrix(q)

    @pytest.mark.parametrize(
        ("row", "column", "value"), [(3, 3, 0.1471), (3, 4, -0.0260), (4, 4, 0.0414), (2, 3, 0.0476), (2, 4, 0.0322)]
    )
    def test_mass_matrix(self, row, column, value):
        assert self.mass_matrix[row - 1, column - 1] == pytest.approx(value, abs=5e-5)

    def test_weight(self):
        np.testing.assert_allclose(load("spear_ii").gravity(self.q)[:2], [0.0, 6.8 * 9.81], rtol=1e-12, atol=1e-12)

    def test_toe(self):
        x, z = load("spear_ii").toe_position(self.q, "toe")
        assert (x, z) == pytest.approx((0.0, 0.55 - 2 * 0.318 * np.cos(0.5)), abs=1e-12)


@each_robot
class TestMechanics:
    @few
    @given(positions)
    def test_mass_matrix_is_symmetric_positive_definite(self, name, q):
        robot, _ = ROBOTS[name]
        mass_matrix = robot.mass_matrix(q[: robot.nq])
        assert mass_matrix.shape == (robot.nv, robot.nv)
        np.testing.assert_array_equal(mass_matrix, mass_matrix.T)
        assert np.linalg.eigvalsh(mass_matrix)[0] > 1e-3

    @few
    @given(positions, rates)
    def test_rate_of_mass_matrix_minus_twice_coriolis_is_skew(self, name, q, v):
        robot, _ = ROBOTS[name]
        q, v = q[: robot.nq], v[: robot.nv]
        rate = derivative(lambda t: robot.mass_matrix(q + t * v))
        skew = rate - 2 * robot.coriolis_matrix(q, v)
        np.testing.assert_allclose(skew, -skew.T, rtol=0, atol=1e-8)

    @few
    @given(positions)
    def test_jacobian_is_derivative_of_position(self, name, q):
        robot, _ = ROBOTS[name]
        q = q[: robot.nq]
        for toe in robot.toes:
            columns = [derivative(lambda t, e=e, toe=toe: robot.toe_position(q + t * e, toe)) for e in np.eye(robot.nq)]
            np.testing.assert_allclose(robot.toe_jacobian(q, toe), np.transpose(columns), rtol=0, atol=1e-9)

    @few
    @given(positions, rates)
    def test_drift_is_derivative_of_jacobian(self, name, q, v):
        robot, _ = ROBOTS[name]
        q, v = q[: robot.nq], v[: robot.nv]
        for toe in robot.toes:
            rate = derivative(lambda t, toe=toe: robot.toe_jacobian(q + t * v, toe) @ v)
            np.testing.assert_allclose(robot.toe_drift(q, v, toe), rate, rtol=0, atol=1e-7)

    @few
    @given(positions)
    def test_gravity_is_gradient_of_potential_energy(self, name, q):
        robot, _ = ROBOTS[name]
        q = q[: robot.nq]
        gradient = [derivative(lambda t, e=e: robot.potential_energy(q + t * e)) for e in np.eye(robot.nq)]
        np.testing.assert_allclose(robot.gravity(q), gradient, rtol=0, atol=1e-7)

    @few
    @given(positions, rates)
    def test_kinetic_energy(self, name, q, v):
        robot, _ = ROBOTS[name]
        q, v = q[: robot.nq], v[: robot.nv]
        assert robot.kinetic_energy(q, v) == pytest.approx(v @ robot.mass_matrix(q) @ v / 2, rel=1e-12)

    @few
    @given(positions, rates, inputs)
    def test_energy_changes_by_the_power_of_the_motors(self, name, q, v, u):
        robot, _ = ROBOTS[name]
        q, v, u = q[: robot.nq], v[: robot.nv], u[: robot.nu]
        force = robot.actuation_matrix @ u
        acceleration = np.linalg.solve(robot.mass_matrix(q), force - robot.bias(q, v))

        def energy(t):
            return robot.kinetic_energy(q + t * v, v + t * acceleration) + robot.potential_energy(q + t * v)

        motors = v[[robot.index(joint) for joint in robot.actuated]]
        assert derivative(energy) == pytest.approx(motors @ u, rel=1e-6, abs=1e-4)

    @few
    @given(positions, rates)
    def test_energy_is_constant_without_motors(self, name, q, v):
        robot, _ = ROBOTS[name]
        q, v = q[: robot.nq], v[: robot.nv]
        acceleration = np.linalg.solve(robot.mass_matrix(q), -robot.bias(q, v))
        power = v @ (robot.mass_matrix(q) @ acceleration + robot.coriolis_matrix(q, v) @ v + robot.gravity(q))
        assert power == pytest.approx(0.0, abs=1e-8)


class TestActuationAndMass:
    def test_monopod(self):
        np.testing.assert_array_equal(load("spear_ii").actuation_matrix, [[0, 0], [0, 0], [1, 0], [0, 1]])

    def test_locked_monopod(self):
        np.testing.assert_array_equal(load("spear_ii", locked=["boom_x"]).actuation_matrix, [[0, 0], [1, 0], [0, 1]])

    def test_quadruped(self):
        robot = load("q_spear")
        joints = {"posterior_hip", "posterior_knee", "anterior_hip", "anterior_knee"}
        assert robot.nu == 4 and set(robot.actuated) == joints
        expected = [[float(row == column) for column in robot.actuated] for row in robot.coordinates]
        np.testing.assert_array_equal(robot.actuation_matrix, expected)

    @pytest.mark.parametrize(
        ("name", "mass"), [("spear_ii", 6.8), ("spear_ii locked", 6.8), ("q_spear", 43.76), ("biped", 9.0)]
    )
    def test_mass(self, name, mass):
        robot, _ = ROBOTS[name]
        assert robot.mass == pytest.approx(mass, abs=1e-12)
        assert robot.mass_matrix(np.ones(robot.nq))[0, 0] == pytest.approx(mass, abs=1e-12)

    def test_mass_counts_bodies_fixed_to_the_world(self):
        assert load("spear_ii", locked=["boom_x", "boom_z"]).mass == pytest.approx(6.8, abs=1e-12)


class TestRotors:
    @pytest.mark.parametrize(
        ("name", "reflected"),
        [
            ("spear_ii", {"hip": 0.047, "knee": 0.027}),
            ("spear_ii locked", {"hip": 0.047, "knee": 0.027}),
            (
                "q_spear",
                {"posterior_hip": 0.094, "posterior_knee": 0.054, "anterior_hip": 0.094, "anterior_knee": 0.054},
            ),
            ("biped", {"left_hip": 0.047, "left_knee": 0.027, "right_hip": 0.047, "right_knee": 0.027}),
        ],
    )
    def test_reflected_inertia_is_on_the_diagonal(self, name, reflected):
        robot, _ = ROBOTS[name]
        q = np.linspace(-1, 1, robot.nq)
        difference = robot.mass_matrix(q) - without_rotors(robot).mass_matrix(q)
        expected = np.diag([reflected.get(joint, 0.0) for joint in robot.coordinates])
        np.testing.assert_allclose(difference, expected, rtol=0, atol=1e-14)

    @each_robot
    def test_rotor_inertia_of_pinocchio_alone_changes_nothing(self, name):
        """The reason for setting the armature: Pinocchio's algorithms read no other rotor field."""
        robot, _ = ROBOTS[name]
        q, v = np.linspace(-1, 1, robot.nq), np.linspace(1, -2, robot.nv)
        bare = without_rotors(robot, rotorInertia=np.zeros(robot.nv), rotorGearRatio=np.zeros(robot.nv))
        fields = without_rotors(robot, rotorInertia=np.full(robot.nv, 5.0), rotorGearRatio=np.full(robot.nv, 60.0))
        np.testing.assert_array_equal(fields.mass_matrix(q), bare.mass_matrix(q))
        np.testing.assert_array_equal(fields.bias(q, v), bare.bias(q, v))
        assert np.abs(robot.mass_matrix(q) - fields.mass_matrix(q)).max() > 0.02

    def test_locking_keeps_the_armature(self):
        np.testing.assert_allclose(ROBOTS["spear_ii locked"][0].model.armature, [0.0, 0.047, 0.027], rtol=1e-12)

    def test_reduced_model_of_pinocchio_keeps_the_armature(self):
        model = load("spear_ii").model
        reduced = pin.buildReducedModel(model, [model.getJointId("boom_x")], pin.neutral(model))
        np.testing.assert_array_equal(reduced.armature, model.armature[1:])

    @each_robot
    def test_bias_does_not_depend_on_the_rotors(self, name):
        robot, _ = ROBOTS[name]
        q, v = np.linspace(-1, 1, robot.nq), np.linspace(1, -2, robot.nv)
        np.testing.assert_array_equal(robot.bias(q, v), without_rotors(robot).bias(q, v))
