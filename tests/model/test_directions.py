"""Directions of contact round a post: against differences of a toe's azimuth, and of its velocity along the circle."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load
from spear_pin.errors import BadFile
from spear_pin.model.directions import Axes, Round
from spear_pin.model.loading import path_of
from spear_pin.model.postures import home
from tests.model.queries import refusal

STATES = [np.random.default_rng(seed).normal(scale=0.7, size=(2, 4)) for seed in range(5)]
AWAY = (0.3, -0.2)
TEXT = path_of("hoppy").read_text(encoding="utf-8")


@pytest.fixture(scope="module", params=[(0.0, 0.0), AWAY], ids=["post at the origin", "post away from it"])
def robot(request, tmp_path_factory):
    """HOPPY, its post wherever."""
    path = tmp_path_factory.mktemp("post") / "hoppy.urdf"
    x, y = request.param
    path.write_text(TEXT.replace('xyz="0 0 0.1965"', f'xyz="{x} {y} 0.1965"'), encoding="utf-8")
    path.with_suffix(".toml").write_text('post = "boom_yaw"\n')
    robot = load(path, toes=["toe"])
    assert robot.post == request.param
    return robot


def polar(robot, q):
    """Azimuth and distance of the toe about the post, and its height."""
    x, y, z = robot.toe_position(q, "toe") - [*robot.post, 0.0]
    return np.array([np.arctan2(y, x), np.hypot(x, y), z])


def differences(function, q, step=1e-6):
    return np.array([(function(q + d) - function(q - d)) / (2 * step) for d in step * np.eye(len(q))]).T


@pytest.mark.parametrize(("q", "v"), STATES)
def test_jacobian(robot, q, v):
    turning, _, rising = differences(lambda q: polar(robot, q), q)
    J = robot.toe_jacobian(q, "toe")
    np.testing.assert_allclose(J, [polar(robot, q)[1] * turning, rising], atol=1e-8)
    np.testing.assert_allclose(J[:, 0], [polar(robot, q)[1], 0.0], atol=1e-14)  # to the left about the post


@pytest.mark.parametrize(("q", "v"), STATES)
def test_drift(robot, q, v):
    rate = differences(lambda t: robot.toe_jacobian(q + t[0] * v, "toe") @ v, np.zeros(1))[:, 0]
    np.testing.assert_allclose(robot.toe_drift(q, v, "toe"), rate, atol=1e-8)


@pytest.mark.parametrize(("q", "v"), STATES)
def test_forces_in_the_world(robot, q, v):
    """They do the work there that they do along the directions of contact."""
    data, index = pin.Data(robot.model), robot.toe_id("toe")
    whole = pin.computeFrameJacobian(robot.model, data, q, index, pin.LOCAL_WORLD_ALIGNED)[:3]
    force = np.array([3.0, -7.0])
    world = robot.directions.world(force, lambda: robot.toe_position(q, "toe"))
    assert world @ whole @ v == pytest.approx(force @ robot.toe_jacobian(q, "toe") @ v)
    assert np.linalg.norm(world) == pytest.approx(np.linalg.norm(force))


def test_home(robot):
    """Only the boom is tilted, until the toe is on the ground."""
    q = home(robot)
    assert robot.toe_position(q, "toe")[2] == pytest.approx(0.0, abs=1e-15) and (q != 0).tolist() == [0, 1, 0, 0]


def test_what_a_robot_has():
    hoppy, leg, full = (load(name) for name in ("hoppy", "hoppy_leg", "q_spear_full"))
    assert (hoppy.directions, hoppy.dimension, hoppy.planar) == (Round((0.0, 0.0)), 2, False)
    assert (leg.directions, leg.dimension, leg.planar, leg.post) == (Axes(2), 2, True, None)
    assert (full.directions, full.dimension, full.planar) == (Axes(3), 3, False)
    held = load("hoppy", locked=["boom_yaw", "boom_tilt"])
    assert (held.dimension, held.planar) == (2, False)  # its toe is on a circle all the same


def test_axes_fill_in_y():
    np.testing.assert_array_equal(Axes(2).world(np.array([[1.0, 2.0]]), dict), [[1.0, 0.0, 2.0]])
    np.testing.assert_array_equal(Axes(3).world(np.array([1.0, 2.0, 3.0]), dict), [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("joint", "why"),
    [
        ("post", "post: unknown joint 'post'; valid: boom_yaw, boom_tilt, hip, knee"),
        ("boom_tilt", "post: joint is 'boom_tilt'; expected a joint on the world, which turns about a vertical axis"),
    ],
)
def test_other_posts(tmp_path, joint, why):
    path = tmp_path / "hoppy.urdf"
    path.write_text(TEXT, encoding="utf-8")
    path.with_suffix(".toml").write_text(f'post = "{joint}"\n')
    assert why in str(refusal(BadFile, lambda: load(path, toes=["toe"])))


def test_a_post_that_floats(tmp_path):
    path = tmp_path / "hoppy.urdf"
    path.write_text(TEXT.replace('<link name="world">', '<link name="world">' + BALLAST, 1))
    path.with_suffix(".toml").write_text('post = "boom_yaw"\nbase = "free"\n')
    assert "expected a joint on the world, which turns about a vertical axis" in str(
        refusal(BadFile, lambda: load(path, toes=["toe"]))
    )


BALLAST = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
