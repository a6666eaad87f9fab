"""The page of a comparison: what it holds, and in a real browser what buttons and keys do."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from spear_pin import compare
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot
from spear_pin.viz.compare import Comparison, page
from spear_pin.viz.playback import scene
from spear_pin.viz.playback.frames import Frames
from spear_pin.viz.playback.scene import Scene
from tests.viz import chromium

SIZES = [(640, 480), (375, 667), (1280, 800)]


@pytest.fixture(scope="module")
def bounds() -> Comparison:
    return compare("long_stride", "long_stride_3.00", names=["slow", "fast <b>"], cycles=2)


@pytest.fixture(scope="module")
def path(bounds: Comparison, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bounds.save(tmp_path_factory.mktemp("compare") / "compare.html")


@pytest.fixture(scope="module")
def browser() -> Iterator[chromium.Browser]:
    with chromium.Browser(1280, 800) as started:
        yield started


def data(text: str):
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


@pytest.mark.slow
def test_the_page_is_small_and_asks_for_nothing(bounds: Comparison) -> None:
    text = bounds.page
    assert len(text.encode()) < page.MOST_BYTES
    assert "default-src 'none'" in text
    assert "fast &lt;b&gt;" in text and "<b>" not in text.partition('<script id="data"')[0].partition("<main>")[2]


@pytest.mark.slow
def test_the_page_tells_measures_parameters_and_multipliers(bounds: Comparison) -> None:
    text = bounds.page
    assert "mean speed" in text and "+20.0" in text
    assert "law: posterior hip torque" in text
    gait = bounds.sides[0].gait
    assert gait is not None
    assert len(re.findall(r"<title>slow: [^<]*modulus", text)) == len(gait.multipliers)


@pytest.mark.browser
@pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
@pytest.mark.slow
def test_tables_that_scroll_show_that_they_do(path: Path) -> None:
    """On a telephone the page does not scroll sideways, its tables do, with shadows that stay where they are."""
    with chromium.Browser(360, 740) as browser:
        browser.open(path)
        found = browser.run("""[...document.querySelectorAll(".wide")].map((wide) => {
          const style = getComputedStyle(wide);
          return [wide.scrollWidth > wide.clientWidth, style.overflowX, style.backgroundAttachment];
        })""")
        assert browser.run("document.documentElement.scrollWidth") == 360
    assert any(scrolls for scrolls, *_ in found)
    assert all(rest == ["auto", "local, local, scroll, scroll"] for _, *rest in found)


@pytest.mark.slow
def test_regions_have_names_of_their_own(bounds: Comparison) -> None:
    names = re.findall(r'role="region"[^>]*aria-label="([^"]*)"', bounds.page)
    assert len(names) >= 3 and len(set(names)) == len(names)


def test_sides_of_the_same_robot_have_the_first_as_a_ghost(bounds: Comparison) -> None:
    first, second = data(bounds.page)["sides"]
    assert first["ghost"] is None and second["ghost"]["path"].endswith("ghost")
    assert len(first["bounds"]) == 3 and first["bounds"][0] == 0.0


def test_arrows_of_the_same_robot_are_of_one_scale(bounds: Comparison) -> None:
    first, second = data(bounds.page)["sides"]
    assert first["newtons"] == second["newtons"] > 0.0


def test_each_motion_is_drawn_once_for_its_arrows_and_once_for_the_page(
    bounds: Comparison, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[float] = []

    def moving(robot: Robot, frames: Frames, *given: Any) -> Scene:
        drawn.append(frames.duration)
        return scene.moving(robot, frames, *given)

    monkeypatch.setattr(page, "moving", moving)
    page.render(bounds.sides, bounds.measures, bounds.differences, bounds.said)
    assert len(drawn) == 2 * len(bounds.sides)


def test_other_robots_have_no_ghost_and_robots_stand() -> None:
    sides = data(compare("spear_ii", "q_spear").page)["sides"]
    assert [side["ghost"] for side in sides] == [None, None]
    assert all(side["stands"] for side in sides)


@pytest.mark.slow
def test_what_does_not_fit_has_fewer_frames_or_is_refused(bounds: Comparison, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = bounds.sides, bounds.measures, bounds.differences, bounds.said
    monkeypatch.setattr(page, "MOST_BYTES", len(bounds.page.encode()) - 1)
    assert data(page.render(*parts))["rate"] < data(bounds.page)["rate"]
    monkeypatch.setattr(page, "MOST_BYTES", 1000)
    with pytest.raises(BadValue, match="motions is .* s'; expected shorter motions"):
        page.render(*parts)


def test_a_notebook_shows_the_page(bounds: Comparison) -> None:
    assert bounds._repr_html_().startswith("<iframe srcdoc=")
    assert repr(bounds).startswith("Comparison(slow, fast <b>: ")


def test_the_table_has_differences(bounds: Comparison) -> None:
    table = bounds.to_pandas()
    assert table.loc[("motion", "mean speed"), "fast <b>, difference"] == pytest.approx(0.5, abs=1e-6)


def test_a_label_takes_no_column_away(bounds: Comparison) -> None:
    first, second = bounds.sides
    odd = replace(bounds, sides=(replace(first, label="unit"), replace(second, label="unit, %")))
    table = odd.to_pandas()
    columns = ["unit", "unit (2)", "unit, %", "unit, %, difference", "unit, %, %"]
    assert list(table) == columns
    assert table.loc[("motion", "mean speed"), "unit"] == "m/s"
    assert table.loc[("motion", "mean speed"), "unit (2)"] == pytest.approx(2.5, abs=1e-6)


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
class TestInABrowser:
    def test_keys_and_buttons(self, browser: chromium.Browser, path: Path) -> None:
        browser.open(path)

        def press(key: str) -> None:
            browser.run(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: {key!r}, bubbles: true}}))")

        assert browser.run("player.clock.playing") is True
        press(" ")
        press("Home")
        assert browser.run("[player.clock.time, player.clock.playing]") == [0, False]
        browser.run("player.clock.seek(0.3)")
        bounds_of = [side["bounds"] for side in data(path.read_text(encoding="utf-8"))["sides"]]
        press("s")
        assert browser.run("player.alignment") == "share"
        assert browser.run("player.clock.time") == pytest.approx(0.3 / bounds_of[0][1])
        assert browser.run("document.getElementById('plots-time').hidden") is True
        press("g")
        assert browser.run("player.over") is True
        assert browser.run("document.querySelectorAll('.motion:not([hidden])').length") == 1
        press("s")
        assert browser.run("player.clock.time") == pytest.approx(0.3)
        press("?")
        assert browser.run("document.getElementById('help').open") is True
        browser.run("document.querySelector('#help button').click()")
        assert browser.errors == [] and all(url.startswith(("file:", "about:")) for url in browser.requests)

    def test_by_share_sides_and_ghosts_are_at_the_same_share(self, browser: chromium.Browser, path: Path) -> None:
        browser.open(path)
        browser.run("(player.align('share'), player.place(true), player.clock.pauseAt(1.25), 1)")
        slow, fast = (side["bounds"] for side in data(path.read_text(encoding="utf-8"))["sides"])
        times = browser.run(
            "(side => [false, true].map((ghost) => side.viewer.animator.actions"
            ".find((action) => side.haunting.has(action) === ghost).time))(player.shown[1])"
        )
        expected = [bounds[1] + 0.25 * (bounds[2] - bounds[1]) for bounds in (fast, slow)]
        assert times == pytest.approx(expected, rel=1e-6)

    def test_speed_and_loop_stay_where_the_alignment_changes(self, browser: chromium.Browser, path: Path) -> None:
        browser.open(path)
        first = data(path.read_text(encoding="utf-8"))["sides"][0]["bounds"][1]
        browser.run("(player.setSpeed(0.25), player.clock.setLoop([0.1, 0.3]), player.align('share'), 1)")
        assert browser.run("player.clock.loop") == pytest.approx([0.1 / first, 0.3 / first])
        assert browser.run("document.querySelector('#speeds [aria-pressed=true]').value") == "0.25"
        browser.run("(player.clock.setPlaying(false), player.clock.seek(0.1), player.clock.pass(0.1), 1)")
        assert browser.run("player.clock.time") == pytest.approx(0.1 + 0.1 / first, rel=1e-2)
        browser.run("document.getElementById('noloop').click()")
        assert browser.run("[player.clock.loop, document.getElementById('noloop').hidden]") == [None, True]

    def test_columns_are_chosen_for_all(self, browser: chromium.Browser, path: Path) -> None:
        browser.open(path)
        plots = "document.querySelectorAll('#plots-time .plot').length"
        before = browser.run(plots)
        browser.run("document.querySelector('#columnlist input[value=q_pitch]').click()")
        assert browser.run(plots) == before + 1
        assert browser.run("player.plots.names()")[-1] == "q_pitch"
        assert browser.run("document.querySelectorAll('#plots-time .plot:last-child output').length") == 2

    @pytest.mark.parametrize(("width", "height"), SIZES)
    def test_it_fits_windows(self, browser: chromium.Browser, path: Path, width: int, height: int) -> None:
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        browser.send("Emulation.setDeviceMetricsOverride", page=True, **size)
        browser.open(path)
        assert browser.run("document.documentElement.scrollWidth") <= width
        boxes = browser.run(
            "[...document.querySelectorAll('.pane, #controls')].map((e) => e.getBoundingClientRect())"
            ".map((box) => [box.width, box.top, box.bottom])"
        )
        assert all(box[0] >= 120 for box in boxes)
        assert boxes[-1][2] <= height + 1, "controls are in sight"
        assert boxes[0][2] <= boxes[-1][1] + 1, "the first motion is not below them"
