"""The leg on a pinned toe: against positions written out by hand, Pinocchio's constrained dynamics and energies."""

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.loading import ROBOTS
from spear_pin.model.pinned import Series, pin_toe
from tests.lagrangian import Leg, monopod
from tests.push_by_hand import Push

ANGLES = np.linspace(-0.2, 2.8, 301)
STATES = np.random.default_rng(5).uniform((-0.2, -8.0, -90.0), (2.8, 8.0, 90.0), (200, 3))  # θ, θ̇, θ̈
LINK = """<link name="{0}"><inertial><origin xyz="{1} 0 {2}"/><mass value="{3}"/>
  <inertia ixx="{4}" iyy="{4}" izz="{4}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/>
  <origin xyz="{4}" rpy="0 {5} 0"/><axis xyz="{6}"/><limit lower="{7}" upper="{8}" effort="9" velocity="9"/></joint>"""
MOTOR = """<transmission name="{0}_drive"><joint name="{0}"/><actuator name="{0}_motor">
  <mechanicalReduction>{1}</mechanicalReduction><drake:rotor_inertia value="{2}"/></actuator></transmission>"""
OWN = "\n".join(
    [
        '<robot name="own" xmlns:drake="http://drake.mit.edu"><link name="world"/>',
        LINK.format("boom", 0, 0, 2.3, 0.003),
        LINK.format("thigh", 0.03, -0.12, 0.9, 0.006),
        LINK.format("shank", -0.02, -0.07, 0.4, 0.002),
        '<link name="toe"/>',
        JOINT.format("rail", "prismatic", "world", "boom", "0 0 0", 0, "0 0 1", -1, 10),
        JOINT.format("upper", "revolute", "boom", "thigh", "0 0 0", 0.1, "0 1 0", -3, 3),
        JOINT.format("lower", "revolute", "thigh", "shank", "0.02 0 -0.29", -0.2, "0 -1 0", -2.4, 0.3),
        JOINT.format("tip", "fixed", "shank", "toe", "0.01 0 -0.2", 0, "1 0 0", 0, 0),
        MOTOR.format("upper", 50, 1e-5),
        MOTOR.format("lower", 20, 1e-4),
        "</robot>",
    ]
)


def changed(text, *pairs):
    """A text with some parts, each found once, replaced."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


# the same without offsets and tilts, its joints turning as SPEAR-II's
PLAIN = changed(
    OWN,
    ('"0.03 0 -0.12"', '"0 0 -0.12"'),
    ('"-0.02 0 -0.07"', '"0 0 -0.07"'),
    ('"0.02 0 -0.29" rpy="0 -0.2 0"', '"0 0 -0.29" rpy="0 0 0"'),
    ('"0.01 0 -0.2"', '"0 0 -0.2"'),
    ('rpy="0 0.1 0"/><axis xyz="0 1 0"', 'rpy="0 0 0"/><axis xyz="0 -1 0"'),
    ('<axis xyz="0 -1 0"/><limit lower="-2.4" upper="0.3"', '<axis xyz="0 1 0"/><limit lower="-0.3" upper="2.4"'),
)


@pytest.fixture(scope="module")
def spear():
    return pin_toe(load("spear_ii", locked=["boom_x"]))


@pytest.fixture
def write(tmp_path):
    def write(text, **options):
        path = tmp_path / "own.urdf"
        path.write_text(text, encoding="utf-8")
        return load(path, toes=["toe"], **options)

    return write


def by_hand(name, push=None):
    """A quantity at all angles."""
    return np.array([getattr((push or Push()).at(angle), name) for angle in ANGLES])


def close(actual, expected, tolerance=1e-11):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance)


class TestByHand:
    def test_equation_of_motion(self, spear):
        close(spear.effective_inertia(ANGLES), by_hand("inertia"), 1e-12)
        close(spear.motion(ANGLES)[1], by_hand("half_slope"), 1e-12)
        close(spear.gravity(ANGLES), by_hand("gravity"))

    def test_configuration(self, spear):
        """(4.2) and (4.3); SPEAR-II's limbs are equally long, so its thigh is at half the knee's angle."""
        height, hip, knee = spear.configuration(ANGLES)
        close(height, 2 * 0.318 * np.cos(ANGLES / 2), 1e-12)
        close(spear.hip_height(ANGLES), by_hand("height"), 1e-12)
        close(hip, ANGLES / 2, 1e-12)
        close(hip, by_hand("thigh"), 1e-12)
        close(knee, ANGLES, 1e-12)

    def test_slopes_of_the_configuration(self, spear):
        """S and S' of (4.4)."""
        slopes, bends = spear.configuration.derivative(), spear.configuration.derivative().derivative()
        for i, name in enumerate(("height", "thigh")):
            close(slopes(ANGLES)[i], by_hand(f"{name}_slope"), 3e-10)
            close(bends(ANGLES)[i], by_hand(f"{name}_bend"), 1e-7)
        close(slopes(ANGLES)[2], 1.0, 3e-10)

    def test_ground_force(self, spear):
        expected = np.array([Push().ground_force(*state) for state in STATES]).T
        close(spear.ground_force(*STATES.T), expected, 3e-11)
        assert spear.ground_force(1.0, 0.0, 0.0).shape == (2,)
        close(spear.ground_force(*STATES[0]), expected[:, 0], 3e-11)

    @pytest.mark.parametrize("rotor", [0.0, 0.108, 0.52272])
    def test_other_rotors(self, spear, robot, rotor):
        leg, push = spear.with_rotor(rotor), Push(rotor=rotor)
        values = {"knee_ratio": (rotor / 1.2e-4) ** 0.5} if rotor else {"knee_rotor": 0.0}
        for other in (leg, pin_toe(leg.robot), pin_toe(vary(robot, **values))):
            assert other.rotor == pytest.approx(rotor, rel=1e-14, abs=0)
            close(other.effective_inertia(ANGLES), by_hand("inertia", push), 1e-12)
            close(other.motion(ANGLES), leg.motion(ANGLES), 1e-12)
            close(other.motion_with_slopes(ANGLES), leg.motion_with_slopes(ANGLES), 1e-10)
            close(other.ground_force(*STATES.T), spear.ground_force(*STATES.T), 1e-12)
        assert spear.rotor == 0.027 and leg.with_rotor(0.027).rotor == 0.027
        close(leg.with_rotor(0.027).motion(ANGLES), spear.motion(ANGLES), 1e-15)

    def test_check_values(self, spear):
        """At 1 rad, with and without motor: 0.193 and 0.166 kg·m²."""
        assert float(spear.effective_inertia(1.0)) == pytest.approx(0.193, abs=5e-4)
        assert float(spear.with_rotor(0.0).effective_inertia(1.0)) == pytest.approx(0.166, abs=5e-4)
        assert float(spear.gravity(1.0)) < 0.0


class TestSlopes:
    def test_are_those_of_the_rows(self, spear):
        rows, step = spear.motion_with_slopes(ANGLES), 1e-3
        inside = ANGLES[5:-5]
        near, far = (spear.motion(inside + n * step) - spear.motion(inside - n * step) for n in (1, 2))
        close(rows[:3], spear.motion(ANGLES), 1e-13)
        close(rows[3:6, 5:-5], (8 * near - far) / (12 * step), 1e-9)
        close(rows[3], 2 * rows[1], 3e-10)  # the factor of θ̇² is half the slope of the inertia

    def test_series(self):
        """1, x and 2x² - 1 on -1 … 1, put on 2 … 6."""
        series = Series((2.0, 6.0), np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 1.0]]))
        x = np.array([-1.0, -0.3, 0.0, 0.5, 1.0])
        close(series(4 + 2 * x), [1 + 2 * x + 3 * (2 * x**2 - 1), 2 * x**2 - 1], 1e-14)
        close(series.derivative()(4 + 2 * x), [(2 + 12 * x) / 2, 4 * x / 2], 1e-14)
        close(series([1.0, 7.0]), series([2.0, 6.0]), 0)  # beyond the span: its end
        assert series(3.0).shape == (2,)


class TestEquationsWithTheConstraint:
    """The multiplier of the pin solved for, all coordinates kept."""

    def test_symbolic_lagrangian(self, spear):
        lagrangian = monopod(("boom_z", "hip", "knee"))
        slopes, bends = spear.configuration.derivative(), spear.configuration.derivative().derivative()
        for angle, rate, torque in STATES:
            along, bend = slopes(angle), bends(angle)
            at = lagrangian.terms(spear.configuration(angle), along * rate)
            close(at.toes["toe"], 0.0, 1e-13)
            close(at.jacobians["toe"] @ along, 0.0, 3e-10)
            close(at.drifts["toe"].ravel() + rate**2 * at.jacobians["toe"] @ bend, 0.0, 1e-5)  # bends amplify rounding
            D, J = at.mass_matrix, at.jacobians["toe"]
            matrix = np.block([[D, -J.T], [J, np.zeros((2, 2))]])
            right = np.concatenate([[0.0, 0.0, torque] - at.coriolis - at.gravity, -at.drifts["toe"].ravel()])
            *_, acceleration, x, z = np.linalg.solve(matrix, right)
            inertia, centrifugal, gravity = spear.motion(angle)
            mine = (torque - gravity - centrifugal * rate**2) / inertia
            assert mine == pytest.approx(acceleration, rel=1e-10, abs=1e-10)
            close(spear.ground_force(angle, rate, mine), [x, z], 1e-9)

    @pytest.mark.parametrize("joint", ["lower", "upper"])
    def test_a_robot_of_ones_own(self, write, joint):
        """Unequal limbs, centres of mass off their axes, joints that turn the other way, a tilted frame."""
        robot = write(OWN if joint == "lower" else OWN.replace('lower="-3" upper="3"', 'lower="-0.5" upper="0.4"'))
        leg, row = pin_toe(robot, joint), robot.index(joint)
        slopes, data = leg.configuration.derivative(), robot.model.createData()
        rng, close_to = np.random.default_rng(3), dict(rel=1e-10, abs=1e-10)
        for angle in rng.uniform(*leg.span, 60):
            rate, torque = rng.uniform(-6, 6), rng.uniform(-30, 30)
            q, v = leg.configuration(angle), slopes(angle) * rate
            close(robot.toe_position(q, "toe"), 0.0, 1e-13)
            assert robot.kinetic_energy(q, v) == pytest.approx(0.5 * leg.effective_inertia(angle) * rate**2, **close_to)
            J, drift = robot.toe_jacobian(q, "toe"), robot.toe_drift(q, v, "toe")
            pin.computeAllTerms(robot.model, data, q, v)
            accelerations = pin.forwardDynamics(robot.model, data, torque * np.eye(3)[row], J, drift)
            inertia, centrifugal, gravity = leg.motion(angle)
            mine = (torque - gravity - centrifugal * rate**2) / inertia
            assert mine == pytest.approx(accelerations[row], **close_to)
            close(leg.ground_force(angle, rate, mine), data.lambda_c, 1e-9)

    def test_friction_in_the_joints(self):
        """As a force -d q̇ on every coordinate; the pin bears what does not move the knee."""
        robot = vary(load("spear_ii", locked=["boom_x"]), boom_damping=45.0)
        robot.model.damping = np.array([45.0, 0.4, 0.1])
        leg, data = pin_toe(robot), robot.model.createData()
        slopes = leg.configuration.derivative()
        for angle, rate, torque in STATES:
            q, v = leg.configuration(angle), slopes(angle) * rate
            J, drift = robot.toe_jacobian(q, "toe"), robot.toe_drift(q, v, "toe")
            pin.computeAllTerms(robot.model, data, q, v)
            applied = torque * np.eye(3)[2] - robot.model.damping * v
            accelerations = pin.forwardDynamics(robot.model, data, applied, J, drift)
            inertia, centrifugal, gravity = leg.motion(angle)
            mine = (torque - gravity - centrifugal * rate**2 - leg.drag(angle)[0] * rate) / inertia
            assert mine == pytest.approx(accelerations[2], rel=1e-9, abs=1e-9)
            close(leg.ground_force(angle, rate, mine), data.lambda_c, 1e-8)

    def test_friction_of_the_slider_by_hand(self):
        """The hip sinks by L sin(θ/2) a radian, so the slider's friction is worth 1.04 N·m·s/rad at 1 rad."""
        leg = pin_toe(vary(load("spear_ii", locked=["boom_x"]), boom_damping=45.0))
        close(leg.drag(ANGLES)[0], 45.0 * (0.318 * np.sin(ANGLES / 2)) ** 2, 1e-11)
        assert float(leg.drag(1.0)[0]) == pytest.approx(1.04, abs=0.01)

    def test_energies_of_a_robot_of_ones_own(self, write):
        """Gravity is the slope of the potential energy."""
        robot, step = write(OWN), 1e-3
        leg = pin_toe(robot, "lower")
        assert leg.span == (-2.4, 0.3) and leg.rotor == pytest.approx(0.04)
        for angle in np.linspace(-2.3, 0.25, 30):
            near, far = (
                robot.potential_energy(leg.configuration(angle + n * step))
                - robot.potential_energy(leg.configuration(angle - n * step))
                for n in (1, 2)
            )
            assert float(leg.gravity(angle)) == pytest.approx((8 * near - far) / (12 * step), abs=1e-9)

    @pytest.mark.slow
    def test_unequal_limbs_by_hand(self, write):
        """The same formulas as SPEAR-II's, where the limbs differ."""
        leg = pin_toe(write(PLAIN), "lower")
        numbers = Leg((0.9, 0.4), (0.12, 0.07), (0.006, 0.002), (0.29, 0.2), (0.025, 0.04))
        push, angles = Push(leg=numbers, hip_mass=2.3, rotor=0.04), np.linspace(*leg.span, 100)
        for angle in angles:
            at = push.at(angle)
            close(leg.configuration(angle), [at.height, at.thigh, angle], 1e-12)
            close(leg.motion(angle), [at.inertia, at.half_slope, at.gravity], 1e-12)
            close(leg.reaction(angle).reshape(4, 2)[:3], at.forces, 1e-11)

    def test_another_joint(self, write):
        """The hip of SPEAR-II bends half as far as its knee; its limits here, where the toe can be below it."""
        text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
        text = changed(text, ('lower="-3.14" upper="3.14"', 'lower="-0.1" upper="1.2"'))
        robot = write(text, locked=["boom_x"])
        leg, by_hip = pin_toe(robot), pin_toe(robot, "hip")
        assert by_hip.rotor == pytest.approx(0.047) and by_hip.joint == "hip"
        angles = np.linspace(-0.1, 1.2, 50)
        close(by_hip.configuration(angles), leg.configuration(2 * angles), 1e-12)
        close(by_hip.motion(angles) / [[4], [8], [2]], leg.motion(2 * angles), 1e-11)


class TestRefusals:
    @pytest.mark.parametrize(
        ("name", "locked"),
        [
            ("spear_ii", []),
            ("spear_ii", ["boom_x", "hip"]),
            ("q_spear", ["torso_x", "pitch", "anterior_hip", "anterior_knee"]),
            ("q_spear_full", []),
        ],
    )
    def test_not_a_leg(self, name, locked):
        robot = load(name, locked=locked)
        with pytest.raises(BadValue, match="^robot is .* expected a planar leg with one toe.*locked="):
            pin_toe(robot, next(c for c in robot.coordinates if c.endswith("knee")))

    def test_not_the_height(self):
        """It slides along the ground; or downward."""
        with pytest.raises(BadValue, match="first coordinate is the height"):
            pin_toe(load("spear_ii", locked=["boom_z"]))

    def test_downward(self, write):
        with pytest.raises(BadValue, match="first coordinate is the height"):
            pin_toe(write(OWN.replace('xyz="0 0 1"', 'xyz="0 0 -1"')), "lower")

    def test_joint(self, robot):
        with pytest.raises(UnknownName, match="unknown joint 'ankle'; valid: boom_z, hip, knee"):
            pin_toe(robot, "ankle")
        with pytest.raises(BadValue, match="^robot is "):
            pin_toe(robot, "boom_z")

    @pytest.mark.filterwarnings("ignore:.*which leave it no room")
    @pytest.mark.parametrize("limits", ["-7 1", "0 6.3", "1 1"])
    def test_limits(self, write, limits):
        low, high = limits.split()
        robot = write(OWN.replace('lower="-2.4" upper="0.3"', f'lower="{low}" upper="{high}"'))
        with pytest.raises(BadValue, match="^limits of lower is .* expected two angles.*span=") as caught:
            pin_toe(robot, "lower")
        assert caught.value.value == (float(low), float(high))

    def test_toe_that_cannot_reach(self, robot, write):
        """A hip turned by more than a right angle; a rail too far from the toe."""
        with pytest.raises(BadValue):
            pin_toe(robot, "hip")
        there = 'child link="boom"/>\n  <origin xyz="'
        far = changed(OWN, (there + "0 0 0", there + "0.7 0 0"))
        with pytest.raises(BadValue):
            pin_toe(write(far), "lower")

    @pytest.mark.parametrize("inertia", [-0.1, np.nan, np.inf, None, "much"])
    def test_rotor(self, spear, inertia):
        with pytest.raises(BadValue, match="^inertia is .*kg·m²"):
            spear.with_rotor(inertia)


@pytest.mark.parametrize("duplicate", [lambda leg: pickle.loads(pickle.dumps(leg)), copy.deepcopy])
def test_duplicates(spear, duplicate):
    """Studies hand legs to other processes."""
    twin = duplicate(spear.with_rotor(0.1))
    assert (twin.rotor, twin.span, twin.joint) == (0.1, spear.span, "knee")
    np.testing.assert_array_equal(twin.motion(ANGLES), spear.with_rotor(0.1).motion(ANGLES))
