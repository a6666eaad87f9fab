"""Robots with other numbers: each number against a formula by hand, and what does not change."""

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.errors import BadValue, RobotWarning, UnknownName
from spear_pin.model.catalogue import mass_law, motor, size_motor
from spear_pin.model.loading import load
from spear_pin.model.monopod import monopod
from spear_pin.model.numbers import body_numbers
from spear_pin.model.robot import Robot
from spear_pin.model.variants import PARAMETERS, motor_size, value_of, vary, with_knee_motor

LEG_MASS = 1.72 + 0.47
EACH = [(name, robot) for name, parameter in PARAMETERS.items() for robot in parameter.robots]

each_parameter = pytest.mark.parametrize(("name", "source"), EACH)
each_robot = pytest.mark.parametrize("source", ["q_spear", "q_spear_full"])


def state(robot):
    """A configuration away from zero and rates."""
    v = np.linspace(-1.0, 1.5, robot.nv)
    return pin.integrate(robot.model, pin.neutral(robot.model), 0.3 * v + 0.1), v


def difference(source, q=None, **values):
    """What a variation adds to D, at a state or where all legs hang straight down."""
    robot = load(source)
    q = pin.neutral(robot.model) if q is None else q
    return vary(robot, **values).mass_matrix(q) - robot.mass_matrix(q)


def assert_adds(change, entries):
    """Entries by row and column, the rest zero."""
    expected = np.zeros_like(change)
    for (row, column), value in entries.items():
        expected[row, column] = expected[column, row] = value
    np.testing.assert_allclose(change, expected, rtol=0, atol=1e-12)


class TestParameters:
    @each_parameter
    def test_default_is_what_the_urdf_has(self, name, source):
        robot = load(source)
        assert vary(robot, **{name: PARAMETERS[name].default}).model == robot.model

    def test_are_described(self):
        for parameter in PARAMETERS.values():
            assert parameter.unit in ("m", "kg", "kg·m²", "1", "N·s/m") and parameter.summary
            assert parameter.provenance == "assumption" or "source Table" in parameter.provenance

    def test_are_fixed(self):
        with pytest.raises(TypeError):
            PARAMETERS["hip_distance"] = None

    @each_parameter
    def test_changes_the_robot(self, name, source):
        if name == "boom_damping":  # friction is no part of D, C and G
            robot = vary(load(source, locked=["boom_x"]), boom_damping=45.0)
            damping = [45.0, *[0.0] * (robot.nv - 1)]
            assert robot.model.damping.tolist() == damping and not load(source).model.damping.any()
            return
        assert np.abs(difference(source, state(load(source))[0], **{name: 1.3 * PARAMETERS[name].default})).max() > 1e-3


class TestByHand:
    """Where the legs hang straight down, the formulas are short."""

    def test_hip_distance_of_the_pairs(self):
        """The legs' masses about the torso's centre: 4 m (d/2)² in pitch."""
        change = difference("q_spear", hip_distance=0.9)
        pitch, hip, knee = 2, (3, 5), (4, 6)
        drop = 1.72 * 0.008 + 0.47 * (0.318 + 0.144)
        assert_adds(change, {(pitch, pitch): 4 * LEG_MASS * (0.45**2 - 0.35**2)})
        # turned back to be level, the posterior leg couples with pitch by its centre of mass
        q = np.array([0, 0, 0, np.pi / 2, 0, 0, 0])
        change = difference("q_spear", q, hip_distance=0.9)
        assert change[pitch, hip[0]] == pytest.approx(-2 * 0.1 * drop, abs=1e-12)
        assert change[pitch, knee[0]] == pytest.approx(2 * 0.1 * 0.47 * 0.144, abs=1e-12)
        assert change[pitch, hip[1]] == pytest.approx(0.0, abs=1e-12)

    def test_hip_distance_of_four_legs(self):
        gain = 4 * LEG_MASS * (0.45**2 - 0.35**2)
        drop = 1.72 * 0.008 + 0.47 * (0.318 + 0.144)
        robot = load("q_spear_full")
        entries = {(4, 4): gain, (5, 5): gain}
        for leg in ("posterior_left", "posterior_right", "anterior_left", "anterior_right"):
            # yaw swings the hips sideways, as adduction swings the leg
            entries[5, robot.index(f"{leg}_adduction")] = 0.1 * drop * (1 if leg.startswith("anterior") else -1)
        assert_adds(difference("q_spear_full", hip_distance=0.9), entries)

    def test_hip_spacing(self):
        gain = 4 * LEG_MASS * (0.25**2 - 0.16**2)
        drop = 1.72 * 0.008 + 0.47 * (0.318 + 0.144)
        robot = load("q_spear_full")
        entries = {(3, 3): gain, (5, 5): gain}
        for leg in ("posterior_left", "posterior_right", "anterior_left", "anterior_right"):
            # yaw swings the left hips backward, hip and knee the leg forward and backward
            side = 1 if leg.endswith("left") else -1
            entries[5, robot.index(f"{leg}_hip")] = -0.09 * side * drop
            entries[5, robot.index(f"{leg}_knee")] = 0.09 * side * 0.47 * 0.144
        assert_adds(difference("q_spear_full", hip_spacing=0.5), entries)

    def test_torso_mass(self):
        for source, rows in (("q_spear", (0, 1)), ("q_spear_full", (0, 1, 2))):
            change = difference(source, state(load(source))[0], torso_mass=40.0)
            assert_adds(change, {(row, row): 5.0 for row in rows})
        assert vary(load("q_spear"), torso_mass=40.0).mass == pytest.approx(48.76)

    def test_torso_inertia(self):
        change = difference("q_spear", state(load("q_spear"))[0], torso_inertia=3.15)
        assert_adds(change, {(2, 2): 1.05})
        change = difference("q_spear_full", state(load("q_spear_full"))[0], torso_inertia=3.15)
        assert_adds(change, {(3, 3): 0.3, (4, 4): 1.05, (5, 5): 1.05})

    @pytest.mark.parametrize(
        ("name", "ratio", "reflected"),
        [
            ("hip_ratio", 30.0, 0.047 / 4),
            ("knee_ratio", 60.0, 0.027 * 16),
            ("adduction_ratio", 120.0, 0.047 * 4),
        ],
    )
    def test_ratio(self, name, ratio, reflected):
        before = {"hip_ratio": 0.047, "knee_ratio": 0.027, "adduction_ratio": 0.047}[name]
        rotors = {"q_spear": [2, 2], "q_spear_full": [1, 1, 1, 1], "biped": [1, 1]}  # others: one
        for source in PARAMETERS[name].robots:
            robot = load(source)
            rows = [i for i, joint in enumerate(robot.coordinates) if joint.endswith(name.removesuffix("_ratio"))]
            turned = rotors.get(source, [1])
            assert len(rows) == len(turned)
            change = difference(source, state(robot)[0], **{name: ratio})
            gain = reflected - before
            assert_adds(change, {(row, row): n * gain for row, n in zip(rows, turned, strict=True)})
            model = vary(robot, **{name: ratio}).model
            np.testing.assert_array_equal(model.rotorInertia, robot.model.rotorInertia)
            assert set(model.rotorGearRatio[rows]) == {ratio}

    @pytest.mark.parametrize("locked", [[], ["boom_x"]])
    def test_gears_of_the_monopod(self, locked):
        """N² J of each motor, whatever the order in which they are varied; 0 takes the motor off."""
        robot = load("spear_ii", locked=locked)
        varied = vary(vary(robot, knee_ratio=66.0, hip_rotor=2e-5), knee_rotor=1e-4, hip_ratio=50.0)
        expected = np.zeros(robot.nv)
        expected[robot.index("hip")], expected[robot.index("knee")] = 50.0**2 * 2e-5, 66.0**2 * 1e-4
        np.testing.assert_allclose(varied.model.armature, expected, rtol=1e-14)
        bare = vary(varied, knee_rotor=0.0)
        expected[robot.index("knee")] = 0.0
        np.testing.assert_allclose(bare.model.armature, expected, rtol=1e-14)
        assert vary(bare, knee_rotor=1e-4).model == varied.model
        assert varied.varied == {"knee_ratio": 66.0, "hip_rotor": 2e-5, "knee_rotor": 1e-4, "hip_ratio": 50.0}

    @pytest.mark.parametrize("distance", [0.4, 1.0])
    def test_hips_are_where_they_should_be(self, distance):
        robot = vary(load("q_spear_full"), hip_distance=distance, hip_spacing=0.2)
        q = pin.neutral(robot.model)
        np.testing.assert_allclose(robot.frame_position(q, "posterior_left_thigh"), [-distance / 2, 0.1, 0], atol=1e-15)
        np.testing.assert_allclose(robot.frame_position(q, "anterior_right_thigh"), [distance / 2, -0.1, 0], atol=1e-15)

    def test_a_size_of_motors_is_rotor_and_mass(self):
        """A knee's motor of the hip's axis adds its mass to slider and hip, and no inertia about the hip."""
        small, own = size_motor(motor("spear_ii_knee"), 0.5), motor("spear_ii_knee")
        rotor, mass = small.rotor_inertia - own.rotor_inertia, small.mass - own.mass
        assert_adds(
            difference("spear_ii", [0.0, 0.5, 0.4, 1.0], knee_motor_size=0.5),
            {(0, 0): mass, (1, 1): mass, (3, 3): 15.0**2 * rotor},
        )
        assert_adds(
            difference("spear_ii", [0.0, 0.5, 0.4, 1.0], knee_motor_size=0.5, hip_motor_mass=1.39),
            {(0, 0): mass + 1.0, (1, 1): mass + 1.0, (3, 3): 15.0**2 * rotor},
        )
        assert_adds(
            difference("spear_ii", [0.0, 0.5, 0.4, 1.0], knee_motor_mass=own.mass + 1.0), {(0, 0): 1.0, (1, 1): 1.0}
        )
        change = difference("q_spear", hip_motor_mass=1.39)  # at the hips, 0.35 m before and behind the torso's centre
        assert_adds(change, {(0, 0): 4.0, (1, 1): 4.0, (2, 2): 4.0 * 0.35**2})

    def test_another_knee_motor_brings_its_mass_or_a_warning(self):
        gears, robot = {"knee_ratio": 12.0, "knee_rotor": 5e-4}, load("spear_ii")
        large = with_knee_motor(robot, motor("ec_90_flat_260w"), **gears)
        assert large.model == vary(robot, **gears, knee_motor_mass=1.0).model
        with pytest.warns(RobotWarning, match="^the robot's mass stays: that of ec_60_flat_200w is not known$"):
            assert with_knee_motor(robot, motor("ec_60_flat_200w"), **gears).model == vary(robot, **gears).model
        cut = monopod(load("q_spear_full"), "anterior_left")
        with pytest.warns(RobotWarning, match="that of the own knee motor of .* is not known"):
            with_knee_motor(cut, motor("ec_90_flat_260w"), **gears)

    def test_a_size_multiplies_what_else_is_set_in_any_order(self):
        values = {"knee_motor_size": 2.0, "knee_rotor": 1e-4, "knee_motor_mass": 0.3, "knee_ratio": 20.0}
        robot = vary(load("spear_ii"), **values)
        again = load("spear_ii")
        for name, value in reversed(values.items()):
            again = vary(again, **{name: value})
        assert robot.model == again.model and motor_size(robot, "knee") == 2.0 and motor_size(robot, "hip") == 1.0
        assert robot.model.armature[robot.index("knee")] == pytest.approx(20.0**2 * 2.0 * 1e-4)
        assert robot.mass - load("spear_ii").mass == pytest.approx(0.3 * 2.0 ** mass_law().exponent - 0.47)

    def test_pairs_are_four_legs(self):
        """What both have, changed in both, changes them alike: the legs of the sagittal robot are pairs."""
        both = {name: value for name, value in PARAMETERS.items() if {"q_spear", "q_spear_full"} <= set(value.robots)}
        values = {name: 1.4 * parameter.default for name, parameter in both.items()}
        assert len(values) == 11
        pairs, legs = vary(load("q_spear"), **values), vary(load("q_spear_full"), **values)
        embedding = np.zeros((18, 7))
        embedding[0, 0] = embedding[2, 1] = 1.0
        embedding[4, 2] = -1.0
        q = np.array([0, 0, 0, 0.3, 0.7, -0.2, -0.5])
        full_q = pin.neutral(legs.model)
        for joint in pairs.actuated:
            for side in ("left", "right"):
                row = legs.index(joint.replace("_", f"_{side}_"))
                embedding[row, pairs.index(joint)] = 1.0
                full_q[row + 1] = q[pairs.index(joint)]
        np.testing.assert_allclose(
            embedding.T @ legs.mass_matrix(full_q) @ embedding, pairs.mass_matrix(q), rtol=0, atol=1e-12
        )


class TestPurity:
    @each_parameter
    def test_the_robot_is_left_alone(self, name, source):
        robot = load(source)
        q, v = state(robot)
        before = robot.mass_matrix(q), robot.bias(q, v)
        assert vary(robot, **{name: 2 * PARAMETERS[name].default}) is not robot
        assert robot.model == load(source).model and robot.varied == {}
        np.testing.assert_array_equal(robot.mass_matrix(q), before[0])
        np.testing.assert_array_equal(robot.bias(q, v), before[1])

    @each_robot
    def test_carries_what_was_changed(self, source):
        robot = vary(load(source), hip_distance=0.85)
        assert robot.varied == {"hip_distance": 0.85}
        assert "varied={'hip_distance': 0.85}" in repr(robot)
        plain = load(source)
        for attribute in ("name", "source", "toes", "actuated", "locked", "coordinates", "planar"):
            assert getattr(robot, attribute) == getattr(plain, attribute)
        with pytest.raises(TypeError):
            robot.varied["hip_distance"] = 0.7

    @each_robot
    def test_one_after_another_is_all_at_once(self, source):
        robot = load(source)
        steps = vary(vary(robot, hip_distance=0.85, torso_mass=30), torso_inertia=2.5, hip_distance=0.9)
        at_once = vary(robot, torso_inertia=2.5, torso_mass=30.0, hip_distance=0.9)
        assert steps.model == at_once.model and steps.varied == at_once.varied
        assert vary(steps, hip_distance=0.7, torso_mass=35, torso_inertia=2.1).model == robot.model

    def test_numbers_of_bodies_stay_when_others_are_varied(self):
        robot = load("q_spear_full", base="chain")
        steps = vary(vary(vary(robot, roll_inertia_xx=0.9), roll_inertia_xx=0.7), hip_spacing=0.4)
        at_once = vary(robot, hip_spacing=0.4, roll_inertia_xx=0.7)
        assert steps.model == at_once.model != robot.model and steps.varied == at_once.varied
        assert vary(steps, hip_spacing=0.32).model == vary(robot, roll_inertia_xx=0.7).model

    def test_a_number_that_was_set_is_not_changed_by_another(self):
        lighter = vary(load("spear_ii"), hip_mass=0.8)
        with pytest.raises(BadValue, match=r"hip_mass is 0\.8; .*, as knee_motor_mass sets it"):
            vary(lighter, knee_motor_mass=0.5)
        again = vary(lighter, knee_motor_mass=0.5, hip_mass=0.9)
        assert body_numbers(again)["hip_mass"].value == 0.9

    def test_a_number_that_vanishes(self):
        given = vary(load("spear_ii"), knee_armature=0.02)
        with pytest.raises(BadValue, match=r"knee_armature is 0\.02; .*, as knee_rotor sets it"):
            vary(given, knee_rotor=0.0)
        with pytest.raises(BadValue, match=r"knee_armature is 0\.02; expected a number that is not zero"):
            vary(given, knee_rotor=0.0, knee_armature=0.02)

    def test_nothing_to_vary(self):
        for source in ("spear_ii", "q_spear"):
            robot = load(source)
            assert vary(robot).model == robot.model

    @pytest.mark.parametrize(
        "duplicate", [lambda r: pickle.loads(pickle.dumps(r)), copy.deepcopy], ids=["pickle", "copy"]
    )
    @each_robot
    def test_duplicates(self, source, duplicate):
        robot = vary(load(source), hip_distance=0.85, knee_ratio=20)
        twin = duplicate(robot)
        assert twin.varied == robot.varied and twin.model == robot.model
        if source == "q_spear":
            lighter = vary(robot, anterior_knee_mass=1.0)
            assert vary(duplicate(lighter), hip_ratio=50.0).model == vary(lighter, hip_ratio=50.0).model
        q, v = state(robot)
        np.testing.assert_array_equal(twin.bias(q, v), robot.bias(q, v))
        assert vary(twin, torso_mass=30).varied == {"hip_distance": 0.85, "knee_ratio": 20.0, "torso_mass": 30.0}

    @pytest.mark.parametrize("locked", [["torso_x"], ["torso_x", "torso_z", "pitch"], ["posterior_hip", "pitch"]])
    def test_locked_joints(self, locked):
        """Locking merges links; the change is made to the whole robot."""
        values = {"hip_distance": 0.9, "torso_mass": 30.0, "torso_inertia": 3.0, "hip_ratio": 50.0}
        whole, robot = vary(load("q_spear"), **values), vary(load("q_spear", locked=locked), **values)
        assert robot.locked == tuple(locked)
        free = [whole.index(joint) for joint in robot.coordinates]
        q = np.where(np.isin(range(7), free), 0.4, 0.0)
        np.testing.assert_allclose(
            robot.mass_matrix(q[free]), whole.mass_matrix(q)[np.ix_(free, free)], rtol=0, atol=1e-12
        )

    def test_own_toes(self):
        robot = vary(load("q_spear", toes=["anterior_toe", "torso"]), hip_distance=0.9)
        assert robot.toes == ("anterior_toe", "torso")
        np.testing.assert_allclose(robot.toe_position(np.zeros(7), "anterior_toe"), [0.45, -0.636], atol=1e-15)


@pytest.mark.parametrize(
    ("source", "first", "then", "values"),
    [
        ("q_spear_full", {}, {"roll_mass": 40.0, "roll_inertia_yy": 2.2}, {"torso_mass": 40.0, "torso_inertia": 2.2}),
        ("q_spear", {"torso_mass": 41.0}, {"pitch_inertia": 2.5}, {"torso_mass": 41.0, "torso_inertia": 2.5}),
        ("q_spear", {"hip_motor_mass": 1.0}, {"pitch_mass": 40.0}, {"hip_motor_mass": 1.0, "torso_mass": 37.56}),
        ("q_spear", {}, {"pitch_to_anterior_hip": 0.4, "pitch_to_posterior_hip": 0.4}, {"hip_distance": 0.8}),
        ("spear_ii", {"boom_damping": 1.0}, {"boom_z_viscous": 2.0}, {"boom_damping": 2.0}),
    ],
)
def test_value_that_a_number_of_a_body_set(source, first, then, values):
    """It is the same number under another name, if no motor adds to it."""
    robot = load(source, base="chain") if source == "q_spear_full" else load(source)
    robot = vary(vary(robot, **first), **then)
    assert {name: value_of(robot, name) for name in values} == pytest.approx(values, rel=1e-12)


class TestRefusals:
    @pytest.mark.parametrize("name", ["hip_spacing", "adduction_ratio", "hip_width", ""])
    def test_unknown_name(self, name):
        with pytest.raises(UnknownName) as caught:
            vary(load("q_spear"), **{name: 1.0})
        assert (caught.value.kind, caught.value.value) == ("parameter", name)
        assert caught.value.valid == (
            *("hip_distance", "torso_mass", "torso_inertia"),
            *("hip_ratio", "knee_ratio", "hip_rotor", "knee_rotor"),
            *("hip_motor_mass", "knee_motor_mass", "hip_motor_size", "knee_motor_size"),
            *body_numbers(load("q_spear")),
        )

    def test_of_another_robot(self):
        """The monopod has motors, but no torso."""
        with pytest.raises(UnknownName, match="^unknown parameter 'hip_distance'; nearest of 21: ") as caught:
            vary(load("spear_ii"), hip_distance=0.9)
        assert caught.value.valid == (
            *("hip_ratio", "knee_ratio", "hip_rotor", "knee_rotor"),
            *("hip_motor_mass", "knee_motor_mass", "hip_motor_size", "knee_motor_size", "boom_damping"),
            *body_numbers(load("spear_ii")),
        )

    @each_parameter
    @pytest.mark.parametrize("value", [-1, -1e-9, np.nan, np.inf, -np.inf, 1e200, 1j, "1", None, True, [1.0]])
    def test_bad_value(self, name, source, value):
        with pytest.raises(BadValue) as caught:
            vary(load(source), **{name: value})
        assert caught.value.name == name
        sign = ">=" if name.endswith(("_rotor", "_damping")) else ">"
        unit = "" if PARAMETERS[name].unit == "1" else f", in {PARAMETERS[name].unit}"
        assert caught.value.expected == f"a finite number {sign} 0{unit}"

    @each_parameter
    def test_zero(self, name, source):
        """Of a rotor or of friction only: none."""
        if name == "boom_damping":
            assert not vary(load(source), boom_damping=0.0).model.damping.any()
        elif name.endswith("_rotor"):
            rows = [i for i, c in enumerate(load(source).coordinates) if c.endswith(name.removesuffix("_rotor"))]
            assert rows and not vary(load(source), **{name: 0.0}).model.armature[rows].any()
        else:
            with pytest.raises(BadValue, match="> 0"):
                vary(load(source), **{name: 0.0})

    @pytest.mark.parametrize("value", [1, np.float64(1), np.float32(1), np.int64(1)])
    def test_numbers(self, value):
        robot = vary(load("q_spear"), hip_distance=value)
        assert robot.varied == {"hip_distance": 1.0} and type(robot.varied["hip_distance"]) is float

    def test_model_changed_by_other_means(self):
        """It would be lost without a word."""
        robot = load("q_spear")
        model = robot.model.copy()
        model.armature = 2 * model.armature
        changed = Robot(model, name=robot.name, toes=robot.toes, actuated=robot.actuated, source=robot.source)
        with pytest.raises(BadValue, match="^robot is "):
            vary(changed, hip_distance=0.9)


def test_a_parameter_of_a_joint_that_is_locked():
    assert value_of(load("spear_ii", locked=["boom_z"]), "boom_damping") == 0.0
