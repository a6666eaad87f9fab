"""Recorded pages in a real browser, opened from disk."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from spear_pin.model.loading import load
from spear_pin.model.monopod import monopod
from spear_pin.viz import player
from spear_pin.viz.playback.scene import ROBOT, joint_paths
from tests.model.legged import quadruped
from tests.viz import chromium, samples
from tests.viz.playback import solids

pytestmark = [pytest.mark.browser, pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")]

STANCE, FLIGHT = 0.11, 0.36
HOP = samples.hop()


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Browser]:
    with chromium.Browser() as started:
        yield started


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("two words") / "a hop.html"
    return player.record(load("spear_ii"), HOP, path, title="SPEAR-II hopping in place")


def show(browser: chromium.Browser, page: Path, time: float) -> None:
    """The page at a time, opened if another one is open, for that takes long."""
    if browser.run("location.href").partition("#")[0] != page.as_uri():
        browser.open(page, f"#t={time!r}")
    browser.run(f"player.seek({time!r})")
    browser.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")


def coil_pixels(picture: NDArray[np.uint8]) -> int:
    red, green, blue = scene_of(picture)
    return int(((red > 190) & (green > 60) & (green < 200) & (blue < 90)).sum())


def arrow_pixels(picture: NDArray[np.uint8]) -> int:
    red, green, blue = scene_of(picture)
    return int(((red > 180) & (green < 50) & (blue > 70) & (blue < 150)).sum())


def scene_of(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The middle of the scene, without legend, plots and controls, colours first."""
    return np.moveaxis(picture[100:620, 100:860], 2, 0)


def test_page_plays_from_disk_alone(browser: chromium.Browser, page: Path) -> None:
    browser.errors.clear()
    browser.requests.clear()
    browser.open(page)
    assert browser.run("new Promise(r => setTimeout(() => r(player.playing && player.time > 0), 1500))")
    assert browser.run("document.getElementById('play').click(), player.playing") is False
    assert browser.run("document.querySelector('#speeds button[value=\"0.1\"]').click(), player.speed") == 0.1
    assert browser.errors == []
    assert browser.requests
    assert all(address.split(":")[0] in ("file", "data", "blob") for address in browser.requests)


@pytest.mark.slow
def test_spring_and_force_show_in_stance_only(browser: chromium.Browser, page: Path, tmp_path: Path) -> None:
    browser.open(page, f"#t={STANCE}")
    stance = browser.screenshot(tmp_path / "stance.png")
    assert browser.run("document.getElementById('domain').textContent") == "stance"
    assert browser.run("document.getElementById('time').textContent") == f"{STANCE:.3f} s"
    show(browser, page, FLIGHT)
    flight = browser.screenshot(tmp_path / "flight.png")
    assert browser.run("document.getElementById('domain').textContent") == "flight"
    assert coil_pixels(stance) > 800
    assert coil_pixels(flight) == 0
    assert arrow_pixels(stance) > 1500
    assert arrow_pixels(flight) == 0


@pytest.mark.parametrize("sample", [40, 200, 400])
@pytest.mark.slow
def test_the_viewer_puts_the_toe_where_kinematics_does(browser: chromium.Browser, page: Path, sample: int) -> None:
    robot, time = load("spear_ii"), float(HOP.t[sample])
    show(browser, page, time)
    chain = joint_paths(robot.model)[-1].strip("/").split("/")
    robot_chain = ROBOT.strip("/").split("/")
    script = f"""(() => {{
        const tree = player.viewer.scene_tree;
        player.viewer.scene.updateMatrixWorld(true);
        const toe = tree.find({chain}).object.localToWorld(new MeshCat.THREE.Vector3(0, 0, -0.318));
        return tree.find({robot_chain}).object.worldToLocal(toe).toArray();
    }})()"""
    toe = np.array(browser.run(script))
    assert toe[[0, 2]] == pytest.approx(robot.toe_position(HOP.q[sample], "toe"), abs=1e-4)


@pytest.mark.slow
def test_scrubbing_moves_the_robot(browser: chromium.Browser, page: Path) -> None:
    show(browser, page, FLIGHT)
    scrub = "(s => (s.value = 0.11, s.dispatchEvent(new Event('input')), player.time))"
    assert browser.run(f"{scrub}(document.getElementById('scrubber'))") == pytest.approx(0.11)
    browser.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
    assert coil_pixels(browser.screenshot()) > 800


@pytest.mark.slow
def test_meshes_of_another_robot(browser: chromium.Browser, tmp_path: Path) -> None:
    """A leg whose links are cubes of an orange COLLADA file, and a faint trunk."""
    (tmp_path / "cube.dae").write_text(solids.dae())
    cube = '<visual><geometry><mesh filename="cube.dae" scale="0.1 0.1 -0.15"/></geometry></visual></link>'
    (tmp_path / "dog.urdf").write_text(quadruped().replace("</inertial></link>", f"</inertial>{cube}"))
    leg = monopod(load(tmp_path / "dog.urdf", motors="all"), "FL")
    path = player.record(leg, HOP, tmp_path / "leg.html")
    browser.errors.clear()
    browser.open(path, f"#t={FLIGHT}")
    red, green, blue = scene_of(browser.screenshot(tmp_path / "leg.png")).astype(int)
    assert ((red > 150) & (green < 80) & (blue < 40)).sum() > 10_000
    assert ((red > 190) & (green > 120) & (blue > 100) & (red > blue + 40)).sum() > 3000
    assert browser.errors == []


@pytest.mark.slow
def test_a_narrow_window_still_shows_the_whole_robot(browser: chromium.Browser, tmp_path: Path) -> None:
    trajectory: SimpleNamespace = samples.bound(2)
    path = player.record(load("q_spear"), trajectory, tmp_path / "bound.html")
    metrics = {"deviceScaleFactor": 1, "mobile": False}
    browser.send("Emulation.setDeviceMetricsOverride", page=True, width=420, height=800, **metrics)
    try:
        browser.open(path, "#t=0.06")
        picture = browser.screenshot().astype(int)
    finally:
        browser.send("Emulation.setDeviceMetricsOverride", page=True, width=1280, height=720, **metrics)
    shell = (picture[:, :, 2] > picture[:, :, 0] + 50) & (picture[:, :, 2] < 190)
    columns = np.flatnonzero(shell[200:450].any(axis=0))
    assert columns.min() > 10 and columns.max() < 410
    assert np.ptp(columns) > 150
