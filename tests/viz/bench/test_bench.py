"""The bench in a real browser: what keys, pointer and address do, and that the feet stay in sight."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spear_pin.model.loading import load
from spear_pin.viz import player
from spear_pin.viz.playback.scene import joint_paths
from tests.viz import chromium, samples

pytestmark = [pytest.mark.browser, pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")]

HOP = samples.hop(start=3.0)
LIFTOFF = 0.22  # s after the start
SIZES = [(640, 480), (375, 667), (844, 390), (1280, 800), (1920, 1080)]
FRAMES = "new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(r))))"
# where on the screen the toes are, and what lies over them
TOES = """player.camera && (() => {
  const { viewer } = player;
  viewer.scene.updateMatrixWorld(true);
  const { left, top, width, height } = viewer.renderer.domElement.getBoundingClientRect();
  const boxes = ["header h1", "header p", "aside", "#plots", "footer"].map((name) => document.querySelector(name))
    .map((element) => element.getBoundingClientRect());
  return PATHS.map((path) => {
    const toe = viewer.scene_tree.find(path.split("/").filter(Boolean)).object
      .localToWorld(new MeshCat.THREE.Vector3(0, 0, -0.318)).project(viewer.camera);
    const [x, y] = [left + (1 + toe.x) / 2 * width, top + (1 - toe.y) / 2 * height];
    const over = boxes.filter((box) => x > box.left && x < box.right && y > box.top && y < box.bottom);
    return [x - left, y - top, left + width - x, top + height - y, over.length,
      document.elementFromPoint(x, y).tagName];
  });
})()"""


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Browser]:
    with chromium.Browser(1280, 800) as started:
        yield started


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bench") / "hop.html"
    return player.record(load("spear_ii"), HOP, path, title="A hop", ghost=samples.hop(hops=1))


@pytest.fixture(scope="module")
def bound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bench") / "bound.html"
    return player.record(load("q_spear"), samples.bound(1), path, title="Q-SPEAR bounding")


def press(browser: chromium.Browser, key: str) -> None:
    browser.run(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: {key!r}, bubbles: true}}))")


def mouse(browser: chromium.Browser, kind: str, x: float, y: float, button: str = "left") -> None:
    browser.send("Input.dispatchMouseEvent", page=True, type=kind, x=x, y=y, button=button, clickCount=1)


def box(browser: chromium.Browser, selector: str) -> list[float]:
    """Left, top, width and height of an element."""
    script = f"(b => [b.left, b.top, b.width, b.height])(document.querySelector({selector!r}).getBoundingClientRect())"
    return list(browser.run(script))


def state(browser: chromium.Browser, name: str) -> Any:
    return browser.run(f"player.clock.{name}")


@pytest.mark.parametrize("size", [(360, 740), (320, 568), (1280, 800)])
@pytest.mark.slow
def test_the_title_is_seen_whole(tmp_path: Path, size: tuple[int, int]) -> None:
    """A long one, on a telephone too: nothing lies over it, with the legend open and sentences in it."""
    title, notes = (
        "Q-SPEAR turning left by 35.0°/s at 2.59 m/s",
        [f"torque of joint {i}: 158, its limit 120 N·m" for i in range(30)],
    )
    path = player.record(load("spear_ii"), samples.hop(hops=1), tmp_path / "hop.html", title=title, notes=notes)
    with chromium.Browser(*size) as browser:
        browser.open(path)
        browser.run("document.getElementById('legendbox').open = true")
        found = browser.run("""(() => {
          const [head, side] = ["h1", "aside"].map((name) => document.querySelector(name).getBoundingClientRect());
          const apart = head.right <= side.left || head.bottom <= side.top;
          return [apart, head.left >= 0, head.right <= innerWidth, side.bottom <= innerHeight,
            document.querySelector("h1").scrollWidth <= document.querySelector("h1").clientWidth,
            document.getElementById("notes").textContent];
        })()""")
    assert found[:5] == [True] * 5 and found[5].startswith(notes[0]) and notes[-1] in found[5]


@pytest.mark.slow
def test_the_address_tells_what_is_shown_and_shows_what_it_tells(browser: chromium.Browser, page: Path) -> None:
    told = "#t=3.2&speed=0.25&loop=3.1,3.4&camera=side&show=angles,-trails&plot=q_knee,force_z_toe"
    browser.open(page, told)
    assert state(browser, "time") == pytest.approx(0.2) and state(browser, "playing") is False
    assert state(browser, "speed") == 0.25 and state(browser, "loop") == pytest.approx([0.1, 0.4])
    assert browser.run("document.querySelectorAll('.plot').length") == 2
    assert browser.run("document.getElementById('view').value") == "side"
    names = "[...document.querySelectorAll('#labels .angle:not([hidden])')].map(e => e.textContent)"
    assert [name.split()[0] for name in browser.run(names)] == ["hip", "knee"]
    assert browser.run("location.hash") == told, "what was read is not written"
    assert browser.run("player.address.text()") == told
    browser.run("player.seek(0.3)")
    browser.run("new Promise(r => setTimeout(r, 400))")
    assert browser.run("location.hash") == told.replace("3.2", "3.3", 1)
    assert browser.run("(location.hash = '#t=3.05', new Promise(r => setTimeout(() => r(player.time), 50)))") == (
        pytest.approx(0.05)
    )


@pytest.mark.slow
def test_what_nobody_touched_leaves_the_address_alone(browser: chromium.Browser, page: Path) -> None:
    browser.open(page)
    browser.run("new Promise(r => setTimeout(r, 600))")
    assert browser.run("location.hash") == "" and state(browser, "playing") is True


@pytest.mark.slow
def test_keys(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.1")
    frame = 1 / 120
    for key, time in ((".", 0.1 + frame), (",", 0.1), ("End", float(np.ptp(HOP.t))), ("Home", 0.0)):
        press(browser, key)
        assert state(browser, "time") == pytest.approx(time, abs=1e-6), key
    press(browser, "-")
    assert state(browser, "speed") == 0.25
    press(browser, " ")
    assert state(browser, "playing") is True
    press(browser, " ")
    for key, view in (("2", "side"), ("4", "top"), ("r", "three-quarter")):
        press(browser, key)
        assert browser.run("player.camera.read()") == view
    press(browser, "p")
    assert browser.run("document.getElementById('plots').hidden") is True
    press(browser, "?")
    assert browser.run("document.getElementById('help').open") is True
    assert browser.run("document.querySelectorAll('#keylist tr').length") >= 20
    press(browser, ".")
    assert state(browser, "playing") is False


@pytest.mark.slow
def test_a_click_in_a_plot_seeks_and_a_drag_loops(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.0")
    left, top, width, height = box(browser, ".u-over")
    duration = float(np.ptp(HOP.t))
    x = left + 0.25 * width
    for kind in ("mousePressed", "mouseReleased"):
        mouse(browser, kind, x, top + height / 2)
    assert state(browser, "time") == pytest.approx(0.25 * duration, abs=0.01)
    cursor = box(browser, ".u-over i")
    assert cursor[0] == pytest.approx(x, abs=2), "the cursor is at the present time"
    mouse(browser, "mousePressed", left + 0.5 * width, top + 20)
    mouse(browser, "mouseMoved", left + 0.6 * width, top + 20)
    mouse(browser, "mouseMoved", left + 0.75 * width, top + 20)
    mouse(browser, "mouseReleased", left + 0.75 * width, top + 20)
    assert state(browser, "loop") == pytest.approx([0.5 * duration, 0.75 * duration], abs=0.01)
    browser.run("(player.clock.setPlaying(true), player.clock.pass(100))")
    begin, end = state(browser, "loop")
    assert begin <= state(browser, "time") <= end


@pytest.mark.slow
def test_what_does_not_repeat_holds_at_its_end(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.0")
    passed = browser.run("""(() => {
        const clock = makeClock();
        clock.setMotion({ duration: 1, rate: 2, hold: 0.5 });
        clock.seek(0.9);
        return [0.1, 0.15, 0.1].map((seconds) => (clock.pass(seconds), clock.time));
    })()""")
    assert passed == pytest.approx([1.0, 1.0, 0.1])


@pytest.mark.slow
def test_an_event_says_its_name_where_the_pointer_is(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.0")
    left, top, width, height = box(browser, "#spans")
    mouse(browser, "mouseMoved", left + width * LIFTOFF / float(np.ptp(HOP.t)) + 3, top + height / 2, "none")
    assert browser.run("document.getElementById('tip').hidden") is False
    assert browser.run("document.getElementById('tip').textContent") == "liftoff, 3.220 s"
    tip = box(browser, "#tip")
    assert tip[1] + tip[3] <= top + 8, "it stands above the bar"


@pytest.mark.slow
def test_columns_are_chosen_and_their_values_shown(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.11&plot=q_hip")
    browser.run("document.querySelector('#columnlist input[value=q_knee]').click()")
    assert browser.run("player.plots.names()") == ["q_hip", "q_knee"]
    caption = browser.run("document.querySelector('.plot figcaption').textContent")
    knee = float(np.interp(3.11, HOP.t, HOP.q[:, 3]))
    assert caption.startswith("position (rad)") and f"knee {knee:.3f}" in caption


@pytest.mark.slow
def test_forces_tell_their_newtons(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.11&show=forces")
    browser.run(FRAMES)
    force = float(np.linalg.norm([np.interp(3.11, HOP.t, HOP.force[:, 0, axis]) for axis in (0, 1)]))
    number = browser.run("document.querySelector('#labels .force').textContent")
    assert float(number.removesuffix(" N")) == pytest.approx(force, abs=0.51)  # whole newtons
    browser.run("player.seek(0.3)")
    browser.run(FRAMES)
    assert browser.run("document.querySelector('#labels .force').hidden") is True


@pytest.mark.slow
def test_downloads(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.11")
    browser.run("""window.saved = []; const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => (window.saved.push(blob), make(blob));
        HTMLAnchorElement.prototype.click = function () { window.names = [...(window.names || []), this.download]; }""")
    browser.run("(document.getElementById('csv').click(), document.getElementById('png').click())")
    browser.run("new Promise(r => setTimeout(r, 800))")
    assert browser.run("window.names") == ["A_hop.csv", "A_hop_3.110s.png"]
    head, *rows = browser.run("window.saved[0].text()").strip().split("\n")
    assert head == (
        "t [s],domain,q_boom_x [m],q_boom_z [m],q_hip [rad],q_knee [rad],force_x_toe [N],force_z_toe [N],engaged_knee"
    )
    cells = np.array([row.split(",") for row in rows])
    assert cells[:, 1].tolist() == HOP.domain.tolist()
    assert cells[:, -1].tolist() == [str(on) for on in HOP.engaged[:, 0]]
    table = np.delete(cells, [1, 8], axis=1).astype(float)
    expected = np.column_stack((HOP.t, HOP.q, HOP.force[:, 0]))
    np.testing.assert_allclose(table, expected, rtol=1e-6, atol=1e-5)
    assert browser.run("[window.saved[1].type, window.saved[1].size > 20000]") == ["image/png", True]


@pytest.mark.slow
def test_a_ghost_can_be_seen_and_turned_off(browser: chromium.Browser, page: Path) -> None:
    browser.open(page, "#t=3.4&show=-plots")
    browser.run("(player.viewer.scene_tree.find(['stage', 'world', 'ghost']).object.position.x = 0.4, 0)")
    pictures = []
    for on in ("true", "false"):
        browser.run(f"(player.switches.set('ghost', {on}), player.viewer.render())")
        browser.run(FRAMES)
        pictures.append(browser.screenshot().astype(int))
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 20).sum() > 1500


@pytest.mark.slow
def test_the_body_may_run_off(browser: chromium.Browser, tmp_path: Path) -> None:
    path = player.record(load("q_spear"), samples.bound(2), tmp_path / "bound.html")
    browser.open(path, "#t=0.2")
    press(browser, "f")
    tree = "player.viewer.scene_tree.find"
    world = f"{tree}(['stage']).object.position.x + {tree}(['stage', 'world']).object.position.x"
    before, held_at = browser.run(world), browser.run("player.camera.here()[0]")
    assert browser.run(f"(player.seek(0.6), {world})") == pytest.approx(before, abs=1e-9)
    held = re.search(r"held=([-.\d]+)&show=-follow", browser.run("player.address.text()"))
    assert held and float(held[1]) == pytest.approx(held_at, abs=1e-4) and abs(held_at) > 0.1
    press(browser, "r")
    assert browser.run(f"(player.seek(0.6), {world})") < before - 0.9


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_hides_the_feet(
    browser: chromium.Browser, page: Path, bound: Path, size: tuple[int, int], theme: str
) -> None:
    width, height = size
    metrics = {"deviceScaleFactor": 1, "mobile": False}
    feature = [{"name": "prefers-color-scheme", "value": theme}]
    browser.send("Emulation.setDeviceMetricsOverride", page=True, width=width, height=height, **metrics)
    browser.send("Emulation.setEmulatedMedia", page=True, features=feature)
    try:
        for path, name, time in ((page, "spear_ii", 3.1), (bound, "q_spear", 0.06)):
            model = load(name).model
            shanks = [path for path in joint_paths(model) if path.endswith("knee")]
            for shown in ("", "&show=plots", "&show=-plots"):
                browser.errors.clear()
                browser.open(path, f"#t={time}{shown}")
                for left, top, right, bottom, over, tag in browser.run(TOES.replace("PATHS", str(shanks))):
                    assert min(left, top, right, bottom) > 4 and over == 0 and tag == "CANVAS", (path.name, shown)
                assert browser.run("document.documentElement.scrollWidth <= innerWidth")
                assert browser.errors == []
                picture = browser.screenshot()
                assert (picture[-3:].mean() < 100) == (picture[:60, width // 2].mean() < 120) == (theme == "dark")
    finally:
        browser.send("Emulation.setDeviceMetricsOverride", page=True, width=1280, height=800, **metrics)
        browser.send("Emulation.setEmulatedMedia", page=True, features=[])
