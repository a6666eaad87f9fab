"""One leg cut out of a robot, against the leg where it was."""

import pickle

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import HoppingLaw, hopping, load, monopod
from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.legs import find_legs
from spear_pin.model.planar import Planar
from tests.model.legged import quadruped, slider
from tests.model.queries import refusal

SENSES = [(hip, knee, limits) for hip in (1, -1) for knee in (1, -1) for limits in ((-0.1, 2.5), (-2.4, 0.2))]
each_sense = pytest.mark.parametrize("hip, knee, limits", SENSES)
STATES = np.random.default_rng(5).uniform(-2, 2, (20, 2, 4))


def assert_same(actual, expected, atol=1e-12):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=atol)


class TestSpear:
    @pytest.mark.parametrize("locked", [(), ("boom_x",)])
    def test_is_itself(self, locked):
        robot = load("spear_ii", locked=locked)
        cut = monopod(load("spear_ii"), "leg", locked=locked)
        assert (cut.coordinates, cut.toes, cut.actuated) == (robot.coordinates, robot.toes, robot.actuated)
        assert cut.planar and cut.locked == locked
        for state in STATES:
            q, v = state[:, 4 - cut.nv :]
            assert_same(cut.mass_matrix(q), robot.mass_matrix(q))
            assert_same(cut.bias(q, v), robot.bias(q, v))
            assert_same(cut.toe_position(q, "toe"), robot.toe_position(q, "toe"))
            assert_same(cut.toe_jacobian(q, "toe"), robot.toe_jacobian(q, "toe"))
            assert_same(cut.toe_drift(q, v, "toe"), robot.toe_drift(q, v, "toe"))

    def test_motors_and_limits(self):
        robot, cut = load("spear_ii"), monopod(load("spear_ii"), "leg")
        for name in ("armature", "rotorInertia", "rotorGearRatio", "damping"):
            np.testing.assert_array_equal(getattr(cut.model, name), getattr(robot.model, name))
        for name in ("lowerPositionLimit", "upperPositionLimit", "lowerEffortLimit", "upperVelocityLimit"):
            np.testing.assert_array_equal(getattr(cut.model, name)[2:], getattr(robot.model, name)[2:])

    @pytest.mark.parametrize("name", ["biped", "q_spear", "q_spear_full"])
    def test_share(self, name):
        robot = load(name)
        torso = {"biped": 4.6, "q_spear": 35.0, "q_spear_full": 35.0}[name]
        for leg in robot.legs:
            cut = monopod(robot, leg)
            assert cut.cut.body == pytest.approx(torso / len(robot.legs), rel=1e-12)
            assert cut.mass == pytest.approx(robot.mass / len(robot.legs), rel=1e-12)

    def test_legs_of_q_spear_full_are_alike(self):
        """But for the way they point, and the limits of their hips and knees, which are symmetric."""
        robot = load("q_spear_full")
        cuts = [monopod(robot, leg) for leg in robot.legs]
        assert [each.cut.mirrored for each in cuts] == [False, False, True, True]
        for q, v in STATES:
            for each in cuts[1:]:
                assert_same(each.mass_matrix(q), cuts[0].mass_matrix(q))
                assert_same(each.bias(q, v), cuts[0].bias(q, v))


class TestLegOnSlider:
    """Against the model in three dimensions, its trunk on rails, its abduction locked."""

    def pair(self, write, hip, knee, limits, ahead=0.0, **others):
        text = slider(hip=hip, knee=knee, knee_limits=limits, ahead=ahead)
        whole = load(write(text), toes=["one_foot"], locked=["one_swing"])
        (leg,) = whole.legs
        turn = -1.0 if leg.bends < 0 else 1.0
        scale = np.array([turn, 1.0, turn * leg.hip_sign, turn * leg.knee_sign])
        zero = np.array([0.0, 0.0, leg.hip_zero, leg.knee_zero])
        return monopod(load(write(text)), "one", **others), whole, scale, zero

    @each_sense
    @pytest.mark.parametrize("ahead", [0.0, 0.04])
    def test_dynamics(self, write, hip, knee, limits, ahead):
        cut, whole, scale, zero = self.pair(write, hip, knee, limits, ahead)
        assert cut.cut.body == pytest.approx(2.4, rel=1e-14)
        for q, v in STATES:
            there, rates = scale * q + zero, scale * v
            assert_same(cut.mass_matrix(q), scale[:, None] * whole.mass_matrix(there) * scale)
            assert_same(cut.bias(q, v), scale * whole.bias(there, rates))
            assert_same(cut.gravity(q), scale * whole.gravity(there))

    @each_sense
    @pytest.mark.parametrize("ahead", [0.0, 0.04])
    def test_toe(self, write, hip, knee, limits, ahead):
        cut, whole, scale, zero = self.pair(write, hip, knee, limits, ahead)
        for q, v in STATES:
            there, rates = scale * q + zero, scale * v
            below = whole.frame_position(zero, "one_pitch")
            planes = scale[:2]
            assert_same(cut.toe_position(q, "toe"), planes * (whole.toe_position(there, "one_foot") - below))
            jacobian = whole.toe_jacobian(there, "one_foot")
            assert_same(cut.toe_jacobian(q, "toe"), planes[:, None] * jacobian * scale)
            assert_same(cut.toe_drift(q, v, "toe"), planes * whole.toe_drift(there, rates, "one_foot"))

    @each_sense
    def test_convention(self, write, hip, knee, limits):
        """The hip brings the knee forward, the knee flexes to positive angles, both from straight down."""
        cut, *_ = self.pair(write, hip, knee, limits, 0.04)
        (leg,) = cut.legs
        assert_same(cut.toe_position(np.zeros(4), "toe"), [0.0, -leg.thigh - leg.shank])
        rates = cut.toe_jacobian(np.zeros(4), "toe")[0]
        assert_same(rates, [1.0, 0.0, leg.thigh + leg.shank, -leg.shank])
        assert (leg.side, leg.bends) == (1, 1)
        assert cut.model.upperPositionLimit[3] > 2.0 and cut.model.lowerPositionLimit[3] > -0.6

    @each_sense
    def test_limits_and_motors(self, write, hip, knee, limits):
        cut, whole, scale, zero = self.pair(write, hip, knee, limits, 0.04)
        for row in (2, 3):
            ends = sorted(
                scale[row] * (limit[row] - zero[row])
                for limit in (whole.model.lowerPositionLimit, whole.model.upperPositionLimit)
            )
            assert_same([cut.model.lowerPositionLimit[row], cut.model.upperPositionLimit[row]], ends)
        assert_same(cut.model.upperEffortLimit[2:], [25.0, 30.0])
        assert_same(cut.model.lowerEffortLimit[2:], [-25.0, -30.0])
        assert_same(cut.model.upperVelocityLimit[2:], [15.0, 15.0])
        assert_same(cut.model.damping, [0.0, 0.0, 0.03, 0.03])
        assert_same(cut.model.armature, [0.0, 0.0, 49e-4, 64e-4])
        assert cut.actuated == ("hip", "knee") and cut.gear_ratio("hip") == 7.0 and cut.gear_ratio("knee") == 8.0

    @pytest.mark.filterwarnings("ignore:made. not taken over. friction")
    def test_dry_friction(self, write):
        cut = monopod(load(write(quadruped(friction=0.2))), "FL")
        assert_same(cut.model.upperDryFrictionLimit[2:], [0.2, 0.2])

    def test_planar_equations(self, write):
        """The same from the equations that symbols are put into."""
        cut, *_ = self.pair(write, 1, 1, (-2.5, 0.1), 0.04)
        terms = Planar(cut).terms(*STATES[0], np)
        assert_same(np.array(terms.mass_matrix, dtype=float), cut.mass_matrix(STATES[0, 0]))
        assert_same(np.array(terms.bias, dtype=float), cut.bias(*STATES[0]))

    def test_given_mass(self, write):
        cut, *_ = self.pair(write, 1, 1, (-0.1, 2.5), body=7.5)
        assert cut.mass == pytest.approx(7.5 + 0.9 + 0.2 + 0.06, rel=1e-12)
        assert cut.cut.body == 7.5


class TestHops:
    @pytest.mark.parametrize("locked", [(), ("boom_x",)])
    def test_as_a_system(self, write, locked):
        leg = monopod(load(write(quadruped())), "FL", locked=locked)
        system = hopping(leg, HoppingLaw(knee_touchdown=1.0))
        assert system.phases == ("stance", "flight")

    def test_survives_pickling(self, write):
        leg = pickle.loads(pickle.dumps(monopod(load(write(quadruped())), "FL")))
        assert leg.cut.angles["hip"][0].joint == "FL_pitch" and leg.legs[0].name == "leg"


class TestSaid:
    def test_report(self, write):
        cut = monopod(load(write(quadruped(ahead=0.03))), "FL").cut
        lines = str(cut).splitlines()
        assert lines[0] == "monopod of made, body 1.9 kg, x to the rear"
        assert lines[1] == "angles: hip = FL_pitch, knee = -(FL_bend - 0.1419)"
        assert lines[2] == "held at zero: FL_swing"
        assert lines[3].startswith("neglected: toe out of the hip's plane by 0.034 m; centres of mass by 0.03")
        assert {each.unit for each in cut.neglected} == {"m", "kg·m²"}

    def test_source_is_no_robot(self):
        leg = monopod(load("spear_ii"), "leg")
        assert leg.source == "monopod('spear_ii', 'leg')" and leg.name == "spear_ii_leg"

    def test_nothing_of_a_robot_that_is_loaded(self):
        assert load("spear_ii").cut is None


class TestHeld:
    """What of the robot is held at zero."""

    def test_what_several_legs_hang_from(self):
        assert monopod(load("q_spear"), "anterior").cut.held == ("pitch",)
        assert monopod(load("spear_ii"), "leg").cut.held == ()

    def test_what_was_locked(self, write):
        feet = [f"{name}_sole" for name in ("FL", "FR", "HL", "HR")]
        made = load(write(quadruped(ankle=True)), locked=feet)
        assert monopod(made, "FL").cut.held == ("FL_swing", *feet)
        assert monopod(load("spear_ii", locked=["boom_x"]), "leg").cut.held == ()  # it moves again


class TestLimits:
    """One rule: what does not leave room is no limit."""

    @pytest.mark.parametrize("limits", [(0, 0), (0.5, 0.5)])
    @pytest.mark.filterwarnings("ignore:made. joint 'one_bend' has the limits 0.5 and 0.5")
    def test_that_are_none(self, write, limits):
        whole = load(write(slider(knee_limits=limits)))
        (leg,) = find_legs(whole, sides=1)
        assert whole.limits["one_bend"].position == (-np.inf, np.inf)
        assert monopod(whole, leg).limits["knee"].position == (-np.inf, np.inf)


class TestRefused:
    def test_ankle(self, write):
        made = load(write(quadruped(ankle=True)))
        assert "FL_sole" in str(refusal(BadValue, lambda: monopod(made, "FL")))
        locked = load(write(quadruped(ankle=True)), locked=[f"{leg.name}_sole" for leg in made.legs])
        assert monopod(locked, "FL").nv == 4

    def test_side_that_is_not_known(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        assert "sides" in str(refusal(BadValue, lambda: monopod(made, "FL")))
        (leg, *_) = find_legs(made, sides=1)
        assert not monopod(made, leg).cut.mirrored

    def test_unknown_leg(self):
        assert refusal(UnknownName, lambda: monopod(load("q_spear"), "front")).valid == ("posterior", "anterior")

    def test_leg_of_another_robot(self):
        (leg,) = load("spear_ii").legs
        refusal(UnknownName, lambda: monopod(load("q_spear"), leg))

    @pytest.mark.parametrize("body", [-1.0, np.nan, np.inf, True, "all", None])
    def test_mass(self, body):
        refusal(BadValue, lambda: monopod(load("q_spear"), "anterior", body=body))

    def test_unknown_joint_to_lock(self):
        refusal(UnknownName, lambda: monopod(load("spear_ii"), "leg", locked=["boom_y"]))


def test_what_is_projected_stays_a_body(write):
    """Its inertia is positive definite."""
    leg = monopod(load(write(quadruped())), "HR")
    for inertia in list(leg.model.inertias)[3:]:
        assert np.linalg.eigvalsh(inertia.inertia)[0] > 0
    data = pin.Data(leg.model)
    assert pin.computeTotalMass(leg.model, data) == pytest.approx(leg.mass)


def test_joints_to_lock_are_read_once():
    leg = monopod(load("q_spear_full"), "anterior_left", locked=(joint for joint in ["boom_x"]))
    assert leg.locked == ("boom_x",) and leg.coordinates == ("boom_z", "hip", "knee")
    assert leg.limits["boom_z"].effort == float("inf")


def test_a_joint_that_is_held_has_no_motor():
    leg = monopod(load("spear_ii"), "leg", locked=["boom_x", "knee"])
    assert leg.actuated == ("hip",) and leg.actuation_matrix.shape == (2, 1)


def test_gravity_that_is_not_along_z(write):
    """The cut's axes would not be the robot's: a leg whose x points to the rear would fall the wrong way."""
    robot = load(write(quadruped()))
    model = robot.model.copy()
    model.gravity = pin.Motion(np.array([1.0, 0.0, -9.81]), np.zeros(3))
    with pytest.raises(BadValue, match="gravity of .*expected along z"):
        monopod(robot.with_model(model), "FL")
