"""What a recorded page shows, against kinematics and the trajectory."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.hybrid.ground import Ground
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.playback.overlays import arrow_path, spring_path
from spear_pin.viz.playback.scene import ROBOT, joint_paths
from spear_pin.viz.playback.stage import STAGE, WORLD
from tests.model.round_feet import round_spear
from tests.viz import samples
from tests.viz.recording import Recording, read


def knee_spring(robot: Robot) -> str:
    return spring_path(joint_paths(robot.model)[robot.model.getJointId("hip")], "knee")


def away_from_events(trajectory: SimpleNamespace) -> np.ndarray[Any, Any]:
    """Samples that are not at an event."""
    times = np.array([event.time for event in trajectory.events])
    return np.flatnonzero(np.abs(trajectory.t[:, None] - times).min(axis=1) > 1e-6)


@pytest.mark.parametrize("name", ["spear_ii", "q_spear"])
def test_spring_is_visible_exactly_while_engaged(name: str) -> None:
    robot = load(name)
    trajectory = samples.hop() if name == "spear_ii" else samples.bound()
    record = read(player.page(robot, trajectory))
    paths = joint_paths(robot.model)
    for column, joint in enumerate(trajectory.spring_joints):
        parent = robot.model.parents[robot.model.getJointId(joint)]
        path = spring_path(paths[parent], joint)
        assert path in record.paths
        for sample in away_from_events(trajectory):
            shown = record.value(path, "visible", trajectory.t[sample])
            assert bool(shown[0]) == trajectory.engaged[sample, column]


def test_spring_spans_the_same_points_of_both_links(spear: Robot, recording: Recording, hop: SimpleNamespace) -> None:
    path = knee_spring(spear)
    knee = joint_paths(spear.model)[spear.model.getJointId("knee")]
    times, scale = recording.track(path, "scale") or pytest.fail("no scale")
    ends, lengths = [], []
    for time in times[5:-5:7]:
        end = recording.pose(path, time) @ [0, 0, recording.value(path, "scale", time)[2], 1]
        ends.append((np.linalg.inv(recording.pose(knee, time)) @ end)[:3])
        lengths.append(recording.value(path, "scale", time)[2])
    assert np.ptp(ends, axis=0).max() < 1e-6
    assert np.ptp(lengths) > 0.01
    # a coil that presses: shortest where the leg is
    assert np.argmin(lengths) == np.argmin([np.interp(t, hop.t - 3.0, hop.q[:, 1]) for t in times[5:-5:7]])


def test_arrow_is_as_long_as_the_force(spear: Robot, recording: Recording, hop: SimpleNamespace) -> None:
    path = arrow_path("toe")
    ratios = []
    for sample in away_from_events(hop)[1:]:
        time, force = hop.t[sample] - 3.0, hop.force[sample, 0]
        size = np.linalg.norm(force)
        shown = bool(recording.value(path, "visible", time)[0])
        if size == 0 or size > 1:
            assert shown == (size > 0)
        if size > 50:
            shaft = recording.value(f"{path}/shaft", "scale", time)[2]
            head = recording.value(f"{path}/head", "scale", time)[2]
            ratios.append((shaft + head) / size)
            pose = recording.pose(path, time)
            toe = spear.toe_position(np.array([np.interp(time, hop.t - 3.0, column) for column in hop.q.T]), "toe")
            base = np.linalg.inv(recording.pose(WORLD, time)) @ pose[:, 3]
            assert base[[0, 2]] == pytest.approx(toe, abs=2e-4)
            assert pose[[0, 2], 2] @ force / size == pytest.approx(1.0, abs=1e-4)
    assert np.ptp(ratios) < 0.01 * np.mean(ratios)
    assert len(ratios) > 50


@pytest.mark.parametrize("name", ["spear_ii", "q_spear", "locked"])
def test_links_are_where_kinematics_puts_them(name: str) -> None:
    robot = load("q_spear") if name == "q_spear" else load("spear_ii", locked=["boom_x"] if name == "locked" else ())
    trajectory = samples.bound(2) if name == "q_spear" else samples.hop()
    if name == "locked":
        trajectory.q = trajectory.q[:, 1:]
    record = read(player.page(robot, trajectory))
    paths = joint_paths(robot.model)
    times = (record.track(paths[-1], "quaternion") or pytest.fail("no track"))[0]
    data = robot.model.createData()
    for time in times[:: len(times) // 25]:
        q = np.array([np.interp(time, trajectory.t, column) for column in trajectory.q.T])
        pin.forwardKinematics(robot.model, data, q)
        world = np.linalg.inv(record.pose(WORLD, time))
        for joint in range(1, robot.model.njoints):
            assert world @ record.pose(paths[joint], time) == pytest.approx(data.oMi[joint].homogeneous, abs=1e-6)


def test_shapes_follow_the_reduced_model(spear: Robot) -> None:
    locked = load("spear_ii", locked=["boom_x"])
    trajectory = samples.hop()
    trajectory.q = trajectory.q[:, 1:]
    record = read(player.page(locked, trajectory))
    rails = [path for path in record.paths if path.startswith(f"{ROBOT}/shape")]
    assert sorted(record.matrix(path)[1, 3] for path in rails) == pytest.approx([0.14, 0.21])
    assert record.color(rails[0]) == 0xCCD1D9


def test_the_picture_follows_a_robot_that_runs() -> None:
    robot = load("q_spear")
    trajectory = samples.bound(6)
    record = read(player.page(robot, trajectory))
    times, shift = record.track(WORLD, "position") or pytest.fail("the world does not move")
    center = np.interp(times, trajectory.t, trajectory.q[:, 0])
    assert np.abs(shift[:, 0] + center).max() < 0.15
    assert np.ptp(np.diff(shift[:, 0])[np.diff(times) > 1e-3] / np.diff(times)[np.diff(times) > 1e-3]) < 0.5
    # and stays for one that hops in place
    assert read(player.page(load("spear_ii"), samples.hop())).track(WORLD, "position") is None
    assert record.track(STAGE, "position") is None


def test_on_a_slope(spear: Robot, hop: SimpleNamespace) -> None:
    """The plane is where the ground is, and forces that are in its axes are drawn in the world's."""
    ground = Ground(0.8, 0.2, 0.1)
    record = read(player.page(spear, SimpleNamespace(**{**vars(hop), "ground": ground})))
    pose = record.pose(f"{WORLD}/ground", 0.0)
    level = np.linalg.inv(record.pose(WORLD, 0.0))
    for along, across in ((0.0, 0.0), (2.0, -1.0), (-3.0, 1.0)):
        x, y, z, _ = level @ pose @ [along, across, 0.0, 1.0]
        assert y == pytest.approx(across) and z == pytest.approx(0.1 + x * np.tan(0.2), abs=1e-12)
    flat = read(player.page(spear, hop))
    arrow = arrow_path("toe")
    bears = away_from_events(hop)
    sample = bears[np.argmax(hop.force[bears, 0, 1])]
    shown, before = ((each.pose(arrow, hop.t[sample]) @ [0, 0, 1, 0])[[0, 2]] for each in (record, flat))
    turn = np.array([[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]])
    np.testing.assert_allclose(shown, turn @ before, atol=1e-3)


def test_an_arrow_round_a_post_is_along_the_circle_that_the_toe_is_on() -> None:
    robot = load("hoppy")
    q = np.array([[yaw, 0.05, 0.6, 1.5] for yaw in (0.0, 1.0, 2.0)])
    force = np.array([[[3.0, 4.0]]] * 3)
    played = SimpleNamespace(
        t=np.arange(3.0), q=q, domain=3 * ["stance"], force=force, events=(), spring_joints=(), engaged=np.zeros((3, 0))
    )
    record = read(player.page(robot, played))
    for time, posture in enumerate(q):
        x, y, _ = robot.toe_position(posture, "toe")
        ahead = np.array([-y, x, 0.0]) / np.hypot(x, y)
        expected = 0.6 * ahead + [0.0, 0.0, 0.8]
        arrow = np.linalg.inv(record.pose(WORLD, time)) @ record.pose(arrow_path("toe"), time) @ [0, 0, 1, 0]
        np.testing.assert_allclose(arrow[:3], expected, atol=1e-3)


def test_an_arrow_begins_where_a_round_foot_touches(tmp_path: Any) -> None:
    robot = round_spear(tmp_path, "[feet.toe]\nradius = 0.05\n")
    q = np.array([[0.0, height, 0.6, 1.2] for height in (0.7, 0.8, 0.9)])[:, -robot.nq :]
    played = SimpleNamespace(
        t=np.arange(3.0),
        q=q,
        domain=3 * ["stance"],
        force=np.array([[[0.0, 5.0]]] * 3),
        events=(),
        spring_joints=(),
        engaged=np.zeros((3, 0)),
    )
    record = read(player.page(robot, played))
    data, frame = pin.Data(robot.model), robot.toe_id("toe")
    for time, posture in enumerate(q):
        pin.framesForwardKinematics(robot.model, data, posture)
        base = np.linalg.inv(record.pose(WORLD, time)) @ record.pose(arrow_path("toe"), time)[:, 3]
        assert base[2] == pytest.approx(data.oMf[frame].translation[2] - 0.05, abs=1e-4)
