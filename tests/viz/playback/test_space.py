"""A motion in space on its page: the picture goes and turns with the robot, forces have three parts, tracks stay."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.playback import following
from spear_pin.viz.playback.footfalls import footfalls
from spear_pin.viz.playback.overlays import arrow_path
from spear_pin.viz.playback.scene import joint_paths
from spear_pin.viz.playback.stage import WORLD
from spear_pin.viz.playback.tracks import CORNERS, WAY, footprints_path
from tests.viz import samples
from tests.viz.recording import Recording, read

STRIDES, RADIUS, BANK = 8, 4.0, 0.1


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load("q_spear_full", base="chain")


@pytest.fixture(scope="module")
def turn() -> SimpleNamespace:
    return samples.turn(STRIDES, RADIUS, bank=BANK)


@pytest.fixture(scope="module")
def text(robot: Robot, turn: SimpleNamespace) -> str:
    return player.page(robot, turn)


@pytest.fixture(scope="module")
def page(text: str) -> Recording:
    return read(text)


def times(turn: SimpleNamespace) -> np.ndarray:
    """Some, none of them an event's."""
    return np.array([time for time in np.linspace(0.31, turn.t[-1] - 0.31, 23)])


def test_the_picture_goes_and_turns_with_the_robot(robot: Robot, turn: SimpleNamespace, page: Recording) -> None:
    torso = joint_paths(robot.model)[following.base_joint(robot.model)]
    assert page.data["follows"] and page.data["turns"]
    for time in times(turn):
        pose = page.pose(torso, time)
        left = pose[:3, 1]
        assert np.arctan2(-left[0], left[1]) == pytest.approx(0.0, abs=0.02), "it heads along the picture's x"
        assert np.linalg.norm(pose[:2, 3] - page.matrix("/stage")[:2, 3]) < 0.2


def test_it_leans_as_it_rolls(robot: Robot, turn: SimpleNamespace, page: Recording) -> None:
    torso = joint_paths(robot.model)[following.base_joint(robot.model)]
    for time in times(turn):
        assert np.arcsin(page.pose(torso, time)[2, 1]) == pytest.approx(-BANK, abs=0.01)


def test_forces_lean_inward(turn: SimpleNamespace, page: Recording) -> None:
    for number, toe in enumerate(load("q_spear_full").toes):
        bearing = np.flatnonzero(turn.force[:, number, 2] > 300.0)[::97]
        for sample in bearing:
            world = np.linalg.inv(page.pose(WORLD, turn.t[sample]))
            ahead = (world @ page.pose(arrow_path(toe), turn.t[sample]))[:3, 2]
            force = turn.force[sample, number]
            assert ahead @ force / np.linalg.norm(force) == pytest.approx(1.0, abs=1e-4)


def test_footprints_are_where_toes_came_down(robot: Robot, turn: SimpleNamespace, page: Recording) -> None:
    found = footfalls(robot.toes, turn.t, turn.force)
    assert [len(each.spans) for each in found] == [STRIDES] * 4
    assert [each.label for each in found][:2] == ["posterior left", "posterior right"]
    assert set(page.data["tracks"]) == {WAY, *(footprints_path(toe) for toe in robot.toes)}
    for number, each in enumerate(found):
        own = f"{footprints_path(each.toe)}/<object>"
        for time in times(turn):
            down = sum(begin <= time - 0.01 for begin, _ in each.spans)
            drawn = page.value(own, "geometry[drawRange].count", time)[0]
            if all(abs(time - begin) > 0.01 for begin, _ in each.spans):
                assert drawn == 3 * (CORNERS - 2) * down, (number, time)


def test_the_way_of_the_torso_grows(turn: SimpleNamespace, page: Recording) -> None:
    drawn = [page.value(f"{WAY}/<object>", "geometry[drawRange].count", time)[0] for time in times(turn)]
    assert np.all(np.diff(drawn) > 0)


def test_the_ground_reaches_around_the_circle(turn: SimpleNamespace, page: Recording) -> None:
    plane = next(c for c in page.commands if c.get("path") == f"{WORLD}/ground/plane" and c["type"] == "set_object")
    data = plane["object"]["geometries"][0]["data"]["attributes"]["position"]["array"].data
    corners = np.frombuffer(data, "<f4").reshape(-1, 3)[:, :2]
    assert (corners.min(axis=0) <= turn.q[:, :2].min(axis=0) - 8.0).all()
    assert (corners.max(axis=0) >= turn.q[:, :2].max(axis=0) + 8.0).all()


def test_a_straight_run_is_seen_from_one_side(robot: Robot) -> None:
    page = read(player.page(robot, samples.turn(3, radius=1e6)))
    assert page.data["follows"] and not page.data["turns"]


def test_the_plane_has_neither() -> None:
    page = read(player.page(load("q_spear"), samples.bound(2)))
    assert not page.data["turns"] and page.data["tracks"] == []


def test_there_is_more_room_in_space(text: str) -> None:
    assert len(text.encode()) < player.IN_SPACE * player.MOST_BYTES
