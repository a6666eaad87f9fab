"""A base that floats or stays fixed, and motors where the file has none, against plain Pinocchio."""

import warnings

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.fitting import CannotFloat
from tests.model.looped import FIVE_BAR
from tests.model.looped import write as write_files
from tests.model.planar_arm import ARM as PLANAR
from tests.model.queries import refusal
from tests.model.spatial_arm import ARM, FLYING

FRAMES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
INERTIAL = '<inertial><mass value="3"/><inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial>'
TRUNK = ARM.replace('<link name="base"/>', f'<link name="trunk">{INERTIAL}</link>').replace(
    'parent link="base"', 'parent link="trunk"'
)


@pytest.fixture
def flying(write):
    """The arm on a trunk that floats."""
    return load(write(TRUNK), toes=["foot"], base="free")


def plain(text, root=None):
    """Pinocchio's own model of a URDF, and its data."""
    model = pin.buildModelFromXML(text, root) if root is not None else pin.buildModelFromXML(text)
    return model, model.createData()


class TestFree:
    def test_names(self, flying):
        assert flying.coordinates == ("base_vx", "base_vy", "base_vz", "base_wx", "base_wy", "base_wz", "yaw", "pitch")
        assert flying.configuration[:7] == tuple(f"base_{part}" for part in ("x", "y", "z", "qx", "qy", "qz", "qw"))
        assert flying.actuated == ("pitch",) and flying.toes == ("foot",)

    def test_dynamics(self, flying):
        model, data = plain(TRUNK, pin.JointModelFreeFlyer())
        rng = np.random.default_rng(1)
        q, v = pin.integrate(model, pin.neutral(model), rng.normal(size=8)), rng.normal(size=8)
        q, v = q[[0, 1, 2, 3, 4, 5, 6, 8, 7]], v[[0, 1, 2, 3, 4, 5, 7, 6]]  # Pinocchio's own order is the same chain
        np.testing.assert_allclose(flying.mass_matrix(q), pin.crba(model, data, q), rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose(flying.bias(q, v), pin.nonLinearEffects(model, data, q, v), rtol=1e-12)
        frame = model.getFrameId("foot")
        J = pin.computeFrameJacobian(model, data, q, frame, FRAMES)[:3]
        np.testing.assert_allclose(flying.toe_jacobian(q, "foot"), J, rtol=1e-13, atol=1e-14)

    def test_a_file_that_floats_already(self, write):
        path = write(FLYING)
        assert load(path, base="free").coordinates == load(path).coordinates

    def test_names_that_are_taken(self, write):
        text = TRUNK.replace('"trunk"', '"world"').replace('joint name="yaw"', 'joint name="base"')
        robot = load(write(text), base="free")
        assert robot.coordinates[0] == "base__vx" and "base" in robot.coordinates

    def test_a_trunk_called_as_the_joint(self, write):
        robot = load(write(TRUNK.replace('"trunk"', '"base"')), base="free", toes=["base"])
        assert robot.coordinates[0] == "base_vx"
        assert load(robot.model, base="free", motors=[]).coordinates == robot.coordinates

    def test_a_root_without_inertia_that_turns_as_its_only_joint_does(self, write):
        """Yaw of the base and of the column move the same."""
        assert "root 'base' has no inertia" in str(refusal(CannotFloat, lambda: load(write(ARM), base="free")))

    @pytest.mark.parametrize("repair", [False, True])
    @pytest.mark.parametrize("name", ["spear_ii", "biped", "q_spear"])
    def test_a_root_that_only_carries_rails(self, name, repair):
        """Neither an inertia of some link nor an armature would let it float."""
        problem = refusal(CannotFloat, lambda: load(name, base="free", repair=repair)).problem
        assert "root 'world'" in problem and "leave base out" in problem and "repair" not in problem


class TestFixed:
    def test_a_trunk_warns_once(self, write):
        with pytest.warns(RobotWarning) as caught:
            robot = load(write(TRUNK))
        assert robot.nv == 2 and robot.mass == pytest.approx(6.0)
        (text,) = [str(each.message) for each in caught]
        assert text.startswith("arm: its root 'trunk', of 3 kg, stays fixed: base=\"free\"") and '"fixed"' in text

    def test_it_is_silent_where_it_is_asked_for(self, write):
        assert load(write(TRUNK), base="fixed").nv == 2

    def test_a_root_that_is_the_world_is_meant(self, write):
        assert load(write(TRUNK.replace('"trunk"', '"world"'))).nv == 2

    def test_a_floating_joint_is_fixed(self, write):
        robot = load(write(FLYING), base="fixed")
        assert robot.coordinates == ("pitch",)

    @pytest.mark.parametrize("base", ["floating", "", 3, True])
    def test_another_base(self, base):
        assert "'free', 'chain' or 'fixed'" in str(refusal(BadValue, lambda: load("spear_ii", base=base)))


class TestMotors:
    def test_all(self, write):
        robot = load(write(TRUNK), base="free", motors="all")
        assert robot.actuated == ("yaw", "pitch")
        np.testing.assert_array_equal(robot.actuation_matrix, np.eye(8)[:, 6:])
        assert (robot.gear_ratio("yaw"), robot.gear_ratio("pitch")) == (1.0, 10.0)

    def test_names_are_in_the_order_of_the_robot(self, write):
        assert load(write(ARM), motors=["pitch", "yaw"]).actuated == ("yaw", "pitch")
        assert load(write(ARM), motors=iter(["yaw"])).actuated == load(write(ARM), motors="yaw").actuated == ("yaw",)

    def test_reflected_rotors_stay(self, write):
        path = write(PLANAR)
        q = np.array([0.1, 0.2])
        np.testing.assert_array_equal(load(path, motors="all").mass_matrix(q), load(path).mass_matrix(q))

    def test_locked_joints_have_none(self):
        assert load("spear_ii", locked=["knee"], motors=["hip", "knee"]).actuated == ("hip",)

    def test_none_warns_once(self, write):
        path = write(ARM.split("<transmission")[0] + "</robot>")
        with pytest.warns(RobotWarning, match='no joint has a motor: motors="all"') as caught:
            assert load(path).nu == 0
        assert len(caught) == 1
        assert load(path, motors=[]).nu == 0

    def test_unknown_joint(self, write):
        error = refusal(UnknownName, lambda: load(write(ARM), motors=["ankle"]))
        assert (error.value, error.valid) == ("ankle", ("yaw", "pitch"))

    def test_joint_of_six_degrees_of_freedom(self, write):
        error = refusal(BadValue, lambda: load(write(FLYING), motors=["yaw"]))
        assert error.name == "motors" and "pitch" in error.expected


class TestModel:
    def test_it_answers_like_the_file(self, write):
        path = write(PLANAR)
        robot, q = load(path), np.array([0.4, -0.9])
        again = load(robot.model, toes=["lower"], motors="all")
        np.testing.assert_array_equal(again.mass_matrix(q), robot.mass_matrix(q))
        assert again.model is not robot.model and again.actuated == ("shoulder", "elbow")

    def test_free_base(self, write):
        model, data = plain(TRUNK)
        robot = load(model, base="free", motors="all", toes=["foot"])
        reference, data = plain(TRUNK, pin.JointModelFreeFlyer())
        q = pin.integrate(reference, pin.neutral(reference), np.linspace(-1, 1, 8))
        np.testing.assert_allclose(robot.mass_matrix(q), pin.crba(reference, data, q), rtol=1e-13, atol=1e-14)
        assert robot.mass == pytest.approx(6.0) and robot.coordinates[0] == "base_vx"

    def test_fixed_base(self):
        model, _ = plain(TRUNK, pin.JointModelFreeFlyer())
        assert load(model, base="fixed", motors="all").nv == 2
        assert load(model, base="free", motors="all").nv == 8

    def test_what_it_warns_of(self):
        with pytest.warns(RobotWarning) as caught:
            load(plain(TRUNK)[0])
        assert [("stays fixed" in str(each.message), "no joint has" in str(each.message)) for each in caught] == [
            (True, False),
            (False, True),
        ]

    def test_the_model_is_left_alone(self):
        model, _ = plain(PLANAR)
        before = model.copy()
        load(model, motors="all")
        assert model == before


def test_silent_where_everything_is_said(write, capfd):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load(write(TRUNK), base="free", motors="all", repair=True)
    assert capfd.readouterr() == ("", "")


def test_a_model_on_a_base_that_floats_keeps_rotors_and_postures(write):
    path = write(TRUNK)
    model = load(path, base="fixed").model.copy()
    model.armature, model.rotorGearRatio = np.array([0.3, 0.2]), np.array([7.0, -9.0])
    model.referenceConfigurations["stand"] = np.array([0.4, 0.5])
    floating, without = load(model, base="free", motors="all"), load(path, base="free")
    q = pin.neutral(floating.model)
    added = model.armature - load(path, base="fixed").model.armature
    np.testing.assert_allclose(
        floating.mass_matrix(q) - without.mass_matrix(q), np.diag([0.0] * 6 + [*added]), atol=1e-12
    )
    assert [floating.gear_ratio(joint) for joint in floating.actuated] == [7.0, -9.0]
    np.testing.assert_array_equal(floating.model.referenceConfigurations["stand"], [0, 0, 0, 0, 0, 0, 1, 0.4, 0.5])


def test_a_joint_that_is_called_as_a_link_can_be_locked(tmp_path):
    toml = 'toes = ["toe"]\nmotors = ["back_hip"]\n'
    named = FIVE_BAR.replace('"front_upper"', '"front_hip"')
    alike, other = (
        load(write_files(tmp_path, name, text, toml), base="fixed", locked=["front_hip"])
        for name, text in (("alike", named), ("other", FIVE_BAR))
    )
    q = [0.4, 0.3, -0.2, 0.6]
    assert alike.coordinates == other.coordinates == ("boom_z", "front_knee", "back_hip", "back_knee")
    np.testing.assert_array_equal(alike.mass_matrix(q), other.mass_matrix(q))
    np.testing.assert_array_equal(alike.frame_position(q, "front_hip"), other.frame_position(q, "front_upper"))
