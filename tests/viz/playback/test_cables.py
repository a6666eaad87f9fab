"""Cables of springs in a recorded page, against kinematics and the length of their path."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.path_springs import PathSprings
from spear_pin.model.cable import CHORDS, Anchor, Between, Over
from spear_pin.model.path import Joints, Path, Sum
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import RobotPosture
from spear_pin.viz import player
from spear_pin.viz.playback.cables import MOST_COLOR, SLACK_COLOR, cable_path, tints
from spear_pin.viz.playback.stage import WORLD
from spear_pin.viz.playback.trajectory import last
from tests.viz.playback.test_scene import knee_spring
from tests.viz.recording import read

STRAIGHT = Between(Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054)))
KNEE, BELOW = Anchor("shank", (0.0, 0.0, 0.0)), Anchor("shank", (0.05, 0.0, -0.12))
OVER = Over(Anchor("thigh", (0.05, 0.0, -0.12)), KNEE, BELOW, 0.03, -1.0)


def sprung(hop: SimpleNamespace, *paths: Path) -> SimpleNamespace:
    """The hop with springs on paths: each pulls in stance, first ever more and then less."""
    stance = hop.engaged[:, 0]
    pull = np.column_stack([stance * 100.0 * (i + 1) * np.sin(3.0 * hop.q[:, 2]) ** 2 for i in range(len(paths))])
    names = tuple(f"spring {i}" for i in range(len(paths)))
    acts = np.repeat(hop.engaged, len(paths), axis=1)
    springs = PathSprings(names, paths, len(paths) * ("m",), pull, 1e-4 * pull, pull, acts)
    return SimpleNamespace(**vars(hop), springs=springs)


def test_a_cable_runs_over_its_pulley_as_long_as_its_path_says(spear: Robot) -> None:
    posture = RobotPosture(spear, FLOATS)
    for knee in (0.0, 0.4, 1.0, 1.7):  # free of the pulley first
        posture.at(np.array([0.0, 0.5, 0.3, knee]))
        start, *between, end = (np.array(each) for each in OVER.course(posture))
        centre = np.array(OVER.centre.seen(posture).position)
        steps = np.linalg.norm(np.diff(between, axis=0), axis=1)
        straight = float(np.linalg.norm(between[0] - start) + np.linalg.norm(end - between[-1]))
        if np.linalg.norm(between[0] - centre) > 0.0301:
            assert straight + steps.sum() == pytest.approx(OVER.length(posture), abs=1e-12)
            continue
        for touched, tip in ((between[0], start), (between[-1], end)):
            assert np.linalg.norm(touched - centre) == pytest.approx(0.03, abs=1e-12)
            assert (touched - centre) @ (tip - touched) == pytest.approx(0.0, abs=1e-12)  # as a tangent
        angle = 2.0 * CHORDS * np.arcsin(steps[0] / 0.06)
        assert straight + 0.03 * angle == pytest.approx(OVER.length(posture), abs=1e-12)


def test_a_page_draws_cables_from_end_to_end(spear: Robot, hop: SimpleNamespace) -> None:
    moving = sprung(hop, STRAIGHT, OVER)
    record, posture = read(player.page(spear, moving)), RobotPosture(spear, FLOATS)
    for name, path, pieces in (("spring 0", STRAIGHT, 1), ("spring 1", OVER, CHORDS + 2)):
        drawn = [f"{cable_path(name)}/{i}" for i in range(pieces)]
        assert [each for each in record.paths if each.startswith(cable_path(name))] == [f"{p}/body" for p in drawn]
        for sample in (7, 60, 200):
            time, (start, *_, end) = hop.t[sample] - hop.t[0], path.course(posture.at(hop.q[sample]))
            ends, world = [], np.linalg.inv(record.pose(WORLD, time))
            for piece, at in ((drawn[0], 0.0), (drawn[-1], 1.0)):
                length = record.value(piece, "scale", time)[2]
                ends.append((world @ record.pose(piece, time) @ [0, 0, at * length, 1])[:3])
            away = np.array(ends) - [start, end]
            np.testing.assert_allclose(away[:, [0, 2]], 0.0, atol=2e-3)  # along y it is in the middle of the link


def test_the_colour_tells_the_pull(spear: Robot, hop: SimpleNamespace) -> None:
    moving = sprung(hop, STRAIGHT)
    record, pull = read(player.page(spear, moving)), moving.springs.pull[:, 0]
    color = f"{cable_path('spring 0')}/0/body/<object>"
    peak = hop.t[np.argmax(pull)] - hop.t[0]
    np.testing.assert_allclose(record.value(color, "material.color", peak), MOST_COLOR, atol=0.02)
    flying = hop.t[np.flatnonzero(hop.domain == "flight")[20]] - hop.t[0]
    np.testing.assert_allclose(record.value(color, "material.color", flying), SLACK_COLOR, atol=1e-6)
    assert [text for text, _ in record.data["legend"][:3]] == [
        *("spring, largest pull", "spring, small pull", "spring slack")
    ]


def test_a_taut_spring_that_is_not_engaged_is_grey() -> None:
    found = tints(np.array([0.0, 0.5, 1.0, 1.0]), np.array([True, True, True, False]))
    np.testing.assert_allclose(found[[0, 3]], [SLACK_COLOR, SLACK_COLOR])
    assert found[1, 1] > found[2, 1] and tuple(found[2]) == MOST_COLOR


class TestCoils:
    def test_give_way_to_a_cable(self, spear: Robot, hop: SimpleNamespace) -> None:
        assert knee_spring(spear) not in read(player.page(spear, sprung(hop, STRAIGHT))).paths

    def test_stay_for_a_spring_on_the_joint(self, spear: Robot, hop: SimpleNamespace) -> None:
        record = read(player.page(spear, sprung(hop, STRAIGHT, Joints({"knee": 0.03}))))
        assert {knee_spring(spear), f"{cable_path('spring 0')}/0/body"} <= {*record.paths}


def test_of_a_sum_each_cable_is_drawn(spear: Robot, hop: SimpleNamespace) -> None:
    record = read(player.page(spear, sprung(hop, Sum([(1.0, STRAIGHT), (0.5, OVER)]))))
    assert {f"{cable_path('spring 0')}/0/body", f"{cable_path('spring 0 1')}/0/body"} <= {*record.paths}


def test_a_part_of_a_motion_has_its_cables(spear: Robot, hop: SimpleNamespace) -> None:
    part = last(sprung(hop, STRAIGHT), 0.3)
    assert part.springs is not None and len(part.springs.pull) == len(part.t)
    assert f"{cable_path('spring 0')}/0/body" in read(player.page(spear, part)).paths


def test_a_path_that_does_not_fit_is_refused(spear: Robot, hop: SimpleNamespace) -> None:
    """As a file may say anything."""
    wide = Over(Anchor("thigh", (0.05, 0.0, -0.12)), KNEE, BELOW, 0.3, -1.0)
    with pytest.raises(BadValue, match="farther than the radius"):
        player.page(spear, sprung(hop, wide))
    with pytest.raises(UnknownName, match="thigh"):
        player.page(spear, sprung(hop, Between(Anchor("thig", (0.0, 0.0, 0.0)), BELOW)))
