"""What a page has of a motion in space: columns by leg, speeds along the heading, footfalls, the way from above."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.bench.samples import packed, samples_of
from spear_pin.viz.bench.space import ACROSS, AHEAD
from spear_pin.viz.playback.footfalls import COLORS
from tests.viz import chromium, samples
from tests.viz.recording import read

SPEED, RADIUS = 2.5, 4.0


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load("q_spear_full", base="chain")


@pytest.fixture(scope="module")
def turn(robot: Robot) -> SimpleNamespace:
    motion = samples.turn(6, RADIUS, SPEED)
    yaw = motion.q[:, 3]
    names = [*(f"q_{name}" for name in robot.coordinates), "v_torso_x", "v_torso_y"]
    names += [f"u_{joint}" for joint in robot.actuated]
    names += [f"force_{axis}_{toe}" for axis in "xyz" for toe in robot.toes]
    torques = np.tile(yaw[:, None], len(robot.actuated))
    forces = motion.force.swapaxes(1, 2).reshape(len(yaw), -1)
    table = np.column_stack((motion.q, SPEED * np.cos(yaw), SPEED * np.sin(yaw), torques, forces))
    return SimpleNamespace(**vars(motion), columns=lambda: (names, table))


def test_columns_by_leg(robot: Robot, turn: SimpleNamespace) -> None:
    found = {column.name: column for column in samples_of(robot, turn).columns}
    knee, torque = found["q_posterior_right_knee"], found["u_anterior_left_adduction"]
    assert (knee.kind, knee.label, knee.color) == ("knee position", "posterior right", COLORS[1])
    assert (torque.kind, torque.label, torque.color) == ("adduction motor torque", "anterior left", COLORS[2])
    assert [found[f"q_{name}"].kind for name in ("yaw", "roll", "torso_x")] == ["yaw", "roll", "position"]
    np.testing.assert_allclose(found[AHEAD].values, SPEED, atol=1e-12)
    np.testing.assert_allclose(found[ACROSS].values, 0.0, atol=1e-12)


def test_what_is_derived_is_in_no_table(robot: Robot, turn: SimpleNamespace) -> None:
    data = packed(samples_of(robot, turn))
    assert {AHEAD, ACROSS} <= {column["name"] for column in data["columns"]}
    assert not {AHEAD, ACROSS} & set(data["order"])
    assert data["plotted"][:3] == ["q_yaw", ACROSS, "u_posterior_left_adduction"], "what does not move is left out"


def test_footfalls_are_in_the_page(robot: Robot, turn: SimpleNamespace) -> None:
    data = read(player.page(robot, turn)).data
    assert [label for label, _, _ in data["footfalls"]] == [toe[:-4].replace("_", " ") for toe in robot.toes]
    assert [len(spans) for _, _, spans in data["footfalls"]] == [6] * 4
    assert len(data["prints"]) == 24
    pairs = read(player.page(load("q_spear"), samples.bound(2))).data
    assert [each[:2] for each in pairs["footfalls"]] == [["posterior", COLORS[0]], ["anterior", COLORS[2]]]
    assert pairs["prints"] == []


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Browser]:
    with chromium.Browser(1280, 800) as started:
        yield started


@pytest.fixture(scope="module")
def page(robot: Robot, turn: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return player.record(robot, turn, tmp_path_factory.mktemp("space") / "turn.html")


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
class TestBrowser:
    # of a point of the world, where it is in the picture, and its axis ahead
    SEEN = """(() => {
      const { viewer } = player;
      const world = viewer.scene_tree.find(["stage", "world"]).object;
      viewer.scene.updateMatrixWorld(true);
      const at = world.localToWorld(new MeshCat.THREE.Vector3(POINT)).toArray();
      const ahead = new MeshCat.THREE.Vector3(1, 0, 0).transformDirection(world.matrixWorld).toArray();
      return [...at, ...ahead];
    })()"""

    def seen(self, browser: chromium.Browser, place: tuple[float, float]) -> np.ndarray:
        return np.array(browser.run(self.SEEN.replace("POINT", f"{place[0]}, {place[1]}, 0")))

    def test_the_camera_goes_turns_and_stays(
        self, browser: chromium.Browser, page: Path, turn: SimpleNamespace
    ) -> None:
        def at(time: float) -> np.ndarray:
            browser.run(f"player.seek({time})")
            return self.seen(browser, tuple(np.interp(time, turn.t, column) for column in turn.q.T[:2]))

        browser.open(page, "#t=0.5&show=-plots")
        first, later = at(0.5), at(1.7)
        assert np.abs(later[:3] - first[:3]).max() < 0.15, "it follows"
        turned = SPEED * 1.2 / RADIUS
        assert first[3:] @ later[3:] == pytest.approx(np.cos(turned), abs=0.05), "it turns"
        browser.run("(player.seek(0.5), player.switches.set('turn', false))")
        first, later = at(0.5), at(1.7)
        assert np.abs(later[:3] - first[:3]).max() < 0.15
        np.testing.assert_allclose(later[3:], first[3:], atol=1e-3)
        browser.run("(player.seek(0.5), player.switches.set('turn', true), player.switches.set('follow', false))")
        first = self.seen(browser, (0.0, 0.0))
        text = browser.run("player.address.text()")
        browser.run("player.seek(1.7)")
        np.testing.assert_allclose(self.seen(browser, (0.0, 0.0)), first, atol=1e-3)
        browser.open(page, text)
        browser.run("player.seek(1.7)")
        np.testing.assert_allclose(self.seen(browser, (0.0, 0.0)), first, atol=2e-3)
        browser.run("document.getElementById('reset').click()")
        assert np.abs(self.seen(browser, (0.0, 0.0)) - first).max() > 0.5

    def test_footfalls_and_way_are_panels(self, browser: chromium.Browser, page: Path) -> None:
        browser.open(page, "#t=0.5&show=plots&plot=feet_on_the_ground,way_from_above")
        assert browser.errors == []
        heads = browser.run("[...document.querySelectorAll('.plot figcaption > :first-child')].map(e => e.textContent)")
        assert heads == ["feet on the ground", "from above (m)"]
        assert browser.run("document.querySelectorAll('.plan circle').length") == 24 + 1
        where = "[...document.querySelector('.plan .now').attributes].map(a => Number(a.value))"
        before = browser.run(where)
        assert browser.run(f"(player.seek(1.5), {where})") != before
        assert browser.run("[...document.querySelectorAll('#columnlist input:checked')].length") == 2
        assert "feet_on_the_ground" in browser.run("player.address.text()")

    def test_tracks_go_away(self, browser: chromium.Browser, page: Path) -> None:
        browser.open(page, "#t=1.5&show=-plots,-trails,-arrows")
        pictures = []
        for on in ("true", "false"):
            browser.run(f"(player.switches.set('tracks', {on}), player.viewer.render())")
            browser.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
            pictures.append(browser.screenshot().astype(int))
        assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 20).sum() > 500

    def test_angles_of_one_place_stand_above_each_other(self, browser: chromium.Browser, page: Path) -> None:
        browser.open(page, "#t=1.5&show=angles,-plots")
        browser.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
        script = """[...document.querySelectorAll('#labels .angle:not([hidden])')].map((e) => {
            const { left, top, right, bottom } = e.getBoundingClientRect();
            return [left, top, right, bottom, e.textContent]; })"""
        boxes = browser.run(script)
        assert sorted({text.split()[0] for *_, text in boxes}) == ["adduction", "hip", "knee", "pitch", "roll", "yaw"]
        for i, (left, top, right, bottom, _) in enumerate(boxes):
            for other_left, other_top, other_right, other_bottom, _ in boxes[:i]:
                beside = right <= other_left + 1 or other_right <= left + 1
                assert beside or bottom <= other_top + 1 or other_bottom <= top + 1
