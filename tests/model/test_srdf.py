"""SRDF files, read by Pinocchio beside the plain URDF."""

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from spear_pin import load
from spear_pin.errors import BadValue
from spear_pin.model.loading import ROBOTS
from spear_pin.model.srdf import to_srdf
from spear_pin.model.variants import vary

each_robot = pytest.mark.parametrize("name", ROBOTS)


def read_by_pinocchio(tmp_path, name, text):
    """The model of the plain URDF with the SRDF's rotors and postures."""
    path = tmp_path / f"{name}.srdf"
    path.write_text(text)
    model = pin.buildModelFromUrdf(str(ROBOTS[name].path))
    pin.loadRotorParameters(model, str(path), False)
    pin.loadReferenceConfigurations(model, str(path), False)
    return model


def entries(robot, model, size):
    """Where each number of the robot's q, or v, is in the plain model, whose forks are sorted by name."""
    found = []
    for name in robot.model.names[1:]:
        joint = model.joints[model.getJointId(name)]
        first, count = (joint.idx_q, joint.nq) if size == "q" else (joint.idx_v, joint.nv)
        found += range(first, first + count)
    return found


@each_robot
def test_urdf_and_srdf_give_the_mass_matrix(name, tmp_path):
    robot = load(name)
    model = read_by_pinocchio(tmp_path, name, to_srdf(robot))
    model.armature = model.rotorGearRatio**2 * model.rotorInertia  # as older versions leave to their users
    at, rows = entries(robot, model, "q"), entries(robot, model, "v")
    rng = np.random.default_rng(5)
    for _ in range(10):
        q = pin.integrate(robot.model, pin.neutral(robot.model), rng.uniform(-2, 2, robot.nv))
        there = np.empty(robot.nq)
        there[at] = q
        matrix = pin.crba(model, model.createData(), there)
        np.testing.assert_allclose(matrix[np.ix_(rows, rows)], robot.mass_matrix(q), rtol=0, atol=1e-9)


@each_robot
def test_this_pinocchio_sets_the_armature_itself(name, tmp_path):
    robot = load(name)
    model = read_by_pinocchio(tmp_path, name, to_srdf(robot))
    np.testing.assert_allclose(model.armature[entries(robot, model, "v")], robot.model.armature, rtol=1e-12)


@each_robot
def test_the_toes_of_home_are_on_the_ground(name, tmp_path):
    robot = load(name)
    model = read_by_pinocchio(tmp_path, name, to_srdf(robot))
    q = model.referenceConfigurations["home"][entries(robot, model, "q")]
    for toe in robot.toes:
        assert robot.toe_position(q, toe)[-1] == pytest.approx(0.0, abs=1e-12)


def test_postures_of_ones_own(tmp_path):
    robot = load("q_spear")
    q = np.linspace(0.1, 0.7, 7)
    model = read_by_pinocchio(tmp_path, "q_spear", to_srdf(robot, {"bent": q}))
    np.testing.assert_array_equal(model.referenceConfigurations["bent"][entries(robot, model, "q")], q)
    with pytest.raises(BadValue, match="posture 'bent'.*7 finite numbers"):
        to_srdf(robot, {"bent": q[:3]})


def test_legs():
    root = etree.fromstring(to_srdf(load("q_spear_full")))
    chains = {group.get("name"): dict(group.find("chain").attrib) for group in root.findall("group")[1:]}
    assert chains == {
        leg: {"base_link": "torso", "tip_link": f"{leg}_toe"}
        for leg in ("posterior_left", "posterior_right", "anterior_left", "anterior_right")
    }
    ends = {end.get("name"): (end.get("parent_link"), end.get("group")) for end in root.findall("end_effector")}
    assert ends["anterior_left_toe"] == ("anterior_left_shank", "anterior_left") and len(ends) == 4
    monopod = etree.fromstring(to_srdf(load("spear_ii")))
    assert monopod.find("group[@name='leg']/chain").attrib == {"base_link": "boom", "tip_link": "toe"}


def test_adjacent_links_may_touch():
    root = etree.fromstring(to_srdf(load("spear_ii")))
    pairs = [(pair.get("link1"), pair.get("link2")) for pair in root.findall("disable_collisions")]
    assert pairs == [
        ("world", "carriage"), ("carriage", "boom"), ("boom", "thigh"), ("thigh", "shank"), ("shank", "toe"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    "robot", [load("spear_ii", locked=["boom_x"]), vary(load("spear_ii"), knee_ratio=20.0)], ids=["locked", "varied"]
)
def test_only_what_the_urdf_has(robot):
    with pytest.raises(BadValue, match="as its URDF describes it"):
        to_srdf(robot)
