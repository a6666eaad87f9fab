"""Limits of joints, as the file has them, whatever is locked, floats or is put in another order."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, hopping, load
from spear_pin.errors import BadValue
from spear_pin.model.limits import Limits
from spear_pin.model.loading import ROBOTS
from tests.model.planar_arm import ARM, edited
from tests.model.queries import refusal

# a fork whose joints Pinocchio would put in another order, each with limits of its own
FORK = """<robot name="fork">{links}
  <joint name="zulu" type="revolute"><parent link="trunk"/><child link="a"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/></joint>
  <joint name="alpha" type="continuous"><parent link="trunk"/><child link="b"/><axis xyz="0 1 0"/>
    <limit effort="5" velocity="6"/></joint>
  <joint name="mike" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/>
    <limit lower="-7" upper="8" effort="9" velocity="10"/></joint>
  <joint name="free" type="continuous"><parent link="c"/><child link="d"/><axis xyz="0 1 0"/></joint>
</robot>""".format(
    links="".join(
        f'<link name="{name}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        for name in ("trunk", *"abcd")
    )
)
EXPECTED = {
    "zulu": Limits((-1.0, 2.0), 4.0, 3.0),
    "alpha": Limits(velocity=6.0, effort=5.0),
    "mike": Limits((-7.0, 8.0), 10.0, 9.0),
    "free": Limits(),
}


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_they_are_those_of_the_file(write, base):
    robot = load(write(FORK), base=base, motors="all")
    assert robot.limits == EXPECTED and list(robot.limits) == list(EXPECTED)


def test_they_survive_locking(write):
    robot = load(write(FORK), locked=["alpha"], base="fixed", motors=[])
    assert robot.limits == {name: limits for name, limits in EXPECTED.items() if name != "alpha"}


def test_a_model_keeps_them(write):
    model = load(write(FORK), base="fixed", motors=[]).model
    assert load(model, base="free", motors="all").limits == EXPECTED


def test_of_a_shipped_robot():
    assert load("spear_ii", locked=["boom_x"]).limits["knee"] == Limits((-0.2, 2.8), 20.0, 60.0)
    assert "base" not in load("q_spear_full").limits


def test_limits_of_pinocchio_follow(write):
    robot = load(write(ARM))
    np.testing.assert_array_equal(robot.model.upperEffortLimit, [10, 10])
    np.testing.assert_array_equal(robot.model.upperVelocityLimit, [5, 5])
    assert load(write(edited('effort="10"', 'effort="0"'))).limits["elbow"].effort == 0.0


class TestOptions:
    """How a robot was loaded is kept with it, and with its gaits."""

    @pytest.fixture
    def copied(self, tmp_path):
        path = tmp_path / "leg.urdf"
        path.write_text(ROBOTS["spear_ii"].path.read_text(encoding="utf-8"), encoding="utf-8")
        return load(path, toes=["toe"], locked=["boom_x"], base="fixed", motors=["knee", "hip"])

    def test_a_robot_knows_them(self, copied):
        assert copied.options == {"base": "fixed", "motors": ("knee", "hip")}
        assert pickle.loads(pickle.dumps(copied)).options == copied.options
        assert copied.with_model(copied.model).options == copied.options
        assert load("spear_ii").options == {}

    def test_a_gait_is_loaded_with_them(self, copied, tmp_path, hop):
        gait = replace(hop, system=hopping(copied, hop.system.law))
        again = Gait.load(gait.save(tmp_path / "gait.json")).system.robot
        assert again.options == copied.options and again.actuated == ("hip", "knee")

    def test_a_gait_of_a_model_is_in_no_file(self, copied, tmp_path, hop):
        gait = replace(hop, system=hopping(load(copied.model, toes=["toe"], motors=["hip", "knee"])))
        assert "a robot that was no file" in str(refusal(BadValue, lambda: gait.save(tmp_path / "gait.json")))
