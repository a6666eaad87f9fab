"""The numbers of the source's tables, typed here, against the loaded robots."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.model.loading import load

# Table 2.4 (SPEAR-II) and Section 5.3 (the boom); rotors reflected to the joint
SPEAR_II = {
    "boom mass": 4.6,
    "thigh mass": 1.72,
    "shank mass": 0.48,
    "thigh com": 0.008,
    "shank com": 0.14,
    "thigh inertia": 0.014,
    "shank inertia": 0.005,
    "shank inertia about the knee": 0.014,
    "length": 0.318,
    "hip ratio": 60.0,
    "knee ratio": 15.0,
    "hip rotor": 0.047,
    "knee rotor": 0.027,
}

# Table 5.1 (Q-SPEAR), for one physical leg
Q_SPEAR = {
    "torso mass": 35.0,
    "torso inertia": 2.1,
    "thigh mass": 1.72,
    "shank mass": 0.47,
    "thigh com": 0.008,
    "shank com": 0.144,
    "thigh inertia": 0.014,
    "shank inertia": 0.005,
    "length": 0.318,
    "hip ratio": 60.0,
    "knee ratio": 15.0,
    "hip rotor": 0.047,
    "knee rotor": 0.027,
    "total mass": 43.76,
}

# table, legs moving as one, robot, prefix of the leg's names
LEGS = {
    "spear_ii": (SPEAR_II, 1, "spear_ii", ""),
    "posterior": (Q_SPEAR, 2, "q_spear", "posterior_"),
    "anterior": (Q_SPEAR, 2, "q_spear", "anterior_"),
    "posterior left": (Q_SPEAR, 1, "q_spear_full", "posterior_left_"),
    "posterior right": (Q_SPEAR, 1, "q_spear_full", "posterior_right_"),
    "anterior left": (Q_SPEAR, 1, "q_spear_full", "anterior_left_"),
    "anterior right": (Q_SPEAR, 1, "q_spear_full", "anterior_right_"),
    "left of the biped": (SPEAR_II, 1, "biped", "left_"),
    "right of the biped": (SPEAR_II, 1, "biped", "right_"),
}

each_leg = pytest.mark.parametrize(("table", "count", "name", "prefix"), LEGS.values(), ids=LEGS)


def inertia(robot, joint):
    """Of everything that is fixed to the joint, in the joint's frame."""
    return robot.model.inertias[robot.model.getJointId(joint)]


@each_leg
class TestLegs:
    def test_masses(self, table, count, name, prefix):
        robot = load(name)
        assert inertia(robot, f"{prefix}hip").mass == pytest.approx(count * table["thigh mass"], rel=1e-12)
        assert inertia(robot, f"{prefix}knee").mass == pytest.approx(count * table["shank mass"], rel=1e-12)

    def test_centres_of_mass(self, table, count, name, prefix):
        robot = load(name)
        np.testing.assert_allclose(inertia(robot, f"{prefix}hip").lever, [0, 0, -table["thigh com"]], atol=1e-15)
        np.testing.assert_allclose(inertia(robot, f"{prefix}knee").lever, [0, 0, -table["shank com"]], atol=1e-15)

    def test_inertias_about_the_centres_of_mass(self, table, count, name, prefix):
        robot = load(name)
        thigh, shank = inertia(robot, f"{prefix}hip").inertia, inertia(robot, f"{prefix}knee").inertia
        assert thigh[1, 1] == pytest.approx(count * table["thigh inertia"], rel=1e-12)
        assert shank[1, 1] == pytest.approx(count * table["shank inertia"], rel=1e-12)

    def test_gear_ratios(self, table, count, name, prefix):
        robot = load(name)
        for joint in ("hip", "knee"):
            assert robot.model.rotorGearRatio[robot.index(f"{prefix}{joint}")] == table[f"{joint} ratio"]

    def test_reflected_rotor_inertias(self, table, count, name, prefix):
        robot = load(name)
        for joint in ("hip", "knee"):
            row = robot.index(f"{prefix}{joint}")
            reflected = count * table[f"{joint} rotor"]
            assert robot.model.armature[row] == pytest.approx(reflected, rel=1e-12)
            at_the_rotor = robot.model.rotorInertia[row]
            assert at_the_rotor * table[f"{joint} ratio"] ** 2 == pytest.approx(reflected, rel=1e-12)

    def test_link_lengths(self, table, count, name, prefix):
        robot = load(name)
        q = pin.integrate(robot.model, pin.neutral(robot.model), np.linspace(-1, 1, robot.nv))
        hip, knee, toe = (robot.frame_position(q, f"{prefix}{frame}") for frame in ("thigh", "shank", "toe"))
        assert np.linalg.norm(knee - hip) == pytest.approx(table["length"], rel=1e-12)
        assert np.linalg.norm(toe - knee) == pytest.approx(table["length"], rel=1e-12)


class TestMonopod:
    def test_boom(self):
        robot = load("spear_ii")
        assert inertia(robot, "boom_z").mass == SPEAR_II["boom mass"]
        np.testing.assert_array_equal(inertia(robot, "boom_z").lever, [0, 0, 0])
        assert inertia(robot, "boom_x").mass == 0.0

    def test_shank_about_the_knee(self):
        shank = inertia(load("spear_ii"), "knee")
        about_the_knee = shank.inertia[1, 1] + shank.mass * shank.lever[2] ** 2
        assert about_the_knee == pytest.approx(SPEAR_II["shank inertia about the knee"], abs=5e-4)


class TestQuadruped:
    @pytest.mark.parametrize(("name", "joint"), [("q_spear", "pitch"), ("q_spear_full", "base")])
    def test_torso(self, name, joint):
        torso = inertia(load(name), joint)
        assert torso.mass == Q_SPEAR["torso mass"]
        assert torso.inertia[1, 1] == Q_SPEAR["torso inertia"]
        np.testing.assert_array_equal(torso.lever, [0, 0, 0])

    @pytest.mark.parametrize("name", ["q_spear", "q_spear_full"])
    def test_total_mass(self, name):
        assert load(name).mass == pytest.approx(Q_SPEAR["total mass"], rel=1e-12)

    def test_hips_are_apart_by_the_assumed_distance(self):
        robot = load("q_spear")
        np.testing.assert_allclose(robot.frame_position(np.zeros(7), "posterior_thigh"), [-0.35, 0], atol=1e-15)
        np.testing.assert_allclose(robot.frame_position(np.zeros(7), "anterior_thigh"), [0.35, 0], atol=1e-15)
