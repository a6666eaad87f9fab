"""The page of `spear explore` in a real browser: it follows a slider, says what it shows, and is played by keys."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.gaits import bound_to_explore
from spear_pin.studies.explore.hops import settle_hops
from spear_pin.studies.explore.legs import KNOBS, spear_ii_hop
from spear_pin.viz.chromium import find
from spear_pin.viz.explore.server import Explorer
from tests.viz.explore.exploring import move, press, refusal, serving, text, visit

PARTS = ("scene", "panel")
OVERFLOWING = """(() => {
    const width = document.documentElement.clientWidth;
    const out = (element) => {
        const { left, right } = element.getBoundingClientRect();
        const clips = getComputedStyle(element).overflowX !== "visible";
        const hidden = clips && element.scrollWidth > element.clientWidth + 1;
        return right > left && (left < -1 || right > width + 1 || hidden);
    };
    return [...document.querySelectorAll("body *")]
        .filter((element) => !element.closest("dialog, .chart, #pane") && out(element))
        .map((element) => element.outerHTML);
})()"""


@pytest.mark.browser
@pytest.mark.skipif(find() is None, reason="no Chromium here")
class TestPage:
    @pytest.mark.slow
    def test_it_needs_nothing_but_its_server(self, browser, server):
        browser.errors.clear()
        browser.requests.clear()
        visit(browser, server)
        assert browser.errors == []
        assert all(address.startswith((server.url, "data:", "blob:", "about:")) for address in browser.requests)
        assert text(browser, "verdict").startswith("Periodic and stable")

    @pytest.mark.slow
    def test_picture_plots_and_figures_follow_a_slider(self, browser, server):
        visit(browser, server, "#t=0.15")
        before, plot, apex = (
            browser.screenshot().astype(int),
            text_of_plots(browser),
            text(browser, "figure_apex_height"),
        )
        shown = move(browser, "stance_torque", 9)
        assert shown["knobs"] == spear_ii_hop().at(stance_torque=9.0).values
        assert text_of_plots(browser) != plot
        expected = figures(settle_hops(spear_ii_hop().at(stance_torque=9.0), best_engine()))["apex_height"]
        assert text(browser, "figure_apex_height") == f"{expected:.4f} m" != apex
        after = browser.screenshot().astype(int)
        assert (np.abs(after - before)[70:630, 350:900].max(axis=2) > 60).sum() > 500

    @pytest.mark.slow
    def test_a_move_is_timed(self, browser, server):
        """From the slider to the picture; how long that takes `benchmarks.explore` measures."""
        visit(browser, server, "#t=0.15")
        timed = [move(browser, "stiffness", 47 + 0.6 * n) for n in range(3)]
        assert [each["knobs"]["stiffness"] for each in timed] == [47.0, 47.6, 48.2]
        assert all(0.0 < each["simulate"] < each["total"] for each in timed)

    @pytest.mark.slow
    def test_while_an_answer_is_awaited_only_the_latest_wish_is_kept(self, browser, server):
        visit(browser, server, "#t=0.15")
        asked = browser.run("""(async () => {
            const slider = document.querySelector("input[type=range][name=friction]");
            const before = explorer.timings.length;
            for (let n = 0; n < 30; n++) {
                slider.value = 0.5 + 0.01 * n;
                slider.dispatchEvent(new Event("input"));
            }
            await explorer.idle();
            return [explorer.timings.length - before, explorer.state.hop.knobs.friction];
        })()""")
        assert asked == [2, 0.79]

    @pytest.mark.slow
    def test_the_address_holds_the_state_and_goes_back_and_forward(self, browser, server):
        visit(browser, server, "#t=0.15")
        move(browser, "friction", 0.4)
        browser.run("new Promise((done) => setTimeout(done, 1100))")
        move(browser, "stiffness", 52)
        address = browser.run("location.search")
        assert "stiffness=52&" in address and "friction=0.4&" in address and "view=settled" in address
        wait = "new Promise((done) => addEventListener('popstate', () => setTimeout(() => done(explorer.idle()))))"
        for go, stiffness in (("back", 48.84), ("forward", 52)):
            browser.run(f"(() => {{ const gone = {wait}; history.{go}(); return gone; }})()")
            assert browser.run("explorer.state.hop.knobs.stiffness") == stiffness
            assert float(browser.run("document.getElementById('number_stiffness').value")) == stiffness
        visit(browser, server, address)
        assert browser.run("explorer.state.hop.knobs") == spear_ii_hop().at(stiffness=52.0, friction=0.4).values

    @pytest.mark.slow
    def test_a_shared_address_out_of_range_is_refused_in_words(self, browser, server):
        visit(browser, server, "?stiffness=1000")
        assert "expected a number from 20 to 100, in N·m/rad" in text(browser, "problem")
        assert browser.run("explorer.state.hop.knobs.stiffness") == 48.84
        move(browser, "friction", 0.5)
        assert browser.run("document.getElementById('problem').hidden") is True

    @pytest.mark.slow
    def test_a_refused_number_greys_the_figures_and_fits_its_field(self, browser, server):
        visit(browser, server, "#t=0.15")
        seen = "[...['readouts', 'said_of_it'].map(id => getComputedStyle(document.getElementById(id)).opacity)]"
        assert browser.run(seen) == ["1", "1"]
        browser.run("""(async () => {
            const field = document.getElementById("number_stiffness");
            field.value = "1234.5678901";
            for (const kind of ["input", "change"]) field.dispatchEvent(new Event(kind));
            await explorer.idle();
        })()""")
        assert "expected a number from 20 to 100" in text(browser, "problem")
        assert all(float(opacity) < 0.6 for opacity in browser.run(seen))
        fields = "[...document.querySelectorAll('.knob input[type=number]')].map(e => e.scrollWidth - e.clientWidth)"
        assert max(browser.run(fields)) <= 0
        move(browser, "stiffness", 50)
        assert browser.run(seen) == ["1", "1"]

    @pytest.mark.slow
    def test_the_kind_of_a_hop_stands_beside_its_verdict(self, browser, server):
        """As a bounce comes in, the peak torque goes from 9 to 28 N·m."""
        visit(browser, server, "#t=0.15")
        assert "Kind: torque switch, slip, lift off, apex, touchdown." in text(browser, "verdict")
        assert text(browser, "kind") == ""
        move(browser, "stiffness", 60)
        assert "Kind: the toe bounces once: lift off, retouch" in text(browser, "verdict")
        assert text(browser, "kind").startswith("Of another kind than A, the default, which is: torque switch")
        browser.run("explorer.pin()")
        assert text(browser, "kind") == ""
        browser.run("explorer.unpin()")

    @pytest.mark.slow
    def test_where_there_is_no_hop_it_says_why(self, browser, server):
        visit(browser, server, "?stance_torque=10.5#t=0.15")
        assert "the run ends 2 hops after the default hop" in text(browser, "verdict")
        assert text(browser, "multipliers") == "–"

    @pytest.mark.slow
    def test_the_script_is_that_of_what_is_shown_and_reset_goes_home(self, browser, server):
        visit(browser, server, "?friction=0.5#t=0.15")
        assert "friction=0.5&" in browser.run("document.getElementById('script').getAttribute('href')")
        browser.run("document.getElementById('reset').click(), explorer.idle()")
        assert browser.run("explorer.state.hop.knobs") == spear_ii_hop().at().values

    @pytest.mark.slow
    def test_a_pinned_motion_is_drawn_beside_and_measured_against(self, browser, server):
        visit(browser, server, "?stiffness=52#t=0.15")
        browser.run("explorer.pin()")
        pinned = browser.run("explorer.state.a.figures.peak_force")
        move(browser, "stiffness", 54)
        change = browser.run("explorer.state.hop.figures.peak_force") - pinned
        assert text(browser, "change_peak_force") == f"{change:+.1f}".replace("-", "−")
        label = browser.run("document.querySelector('.u-over').getAttribute('aria-label')")
        assert label == "Height of the hip in m over time in s: hip; dashed: A, pinned"
        browser.run("document.getElementById('back').click(), explorer.idle()")
        assert browser.run("explorer.state.hop.knobs.stiffness") == 52 and text(browser, "change_peak_force") == "0.0"
        browser.run("explorer.unpin()")
        assert browser.run("explorer.state.a.knobs.stiffness") == 48.84

    @pytest.mark.slow
    def test_the_flight_time_is_kept_where_that_is_asked_for(self, browser, server):
        visit(browser, server, "#t=0.15")
        press(browser, "f")
        shown = move(browser, "stiffness", 54)
        assert "keep=yes" in browser.run("location.search")
        assert browser.run("explorer.state.hop.figures.flight_time") == pytest.approx(0.2, abs=1e-6)
        assert shown["knobs"]["stance_torque"] != 7.8262
        assert browser.run("document.getElementById('number_stance_torque').disabled") is True
        before = text(browser, "figure_flight_time")
        move(browser, "stiffness", 20)
        assert "0.2 s of flight" in text(browser, "verdict") and text(browser, "figure_flight_time") == before
        assert browser.run("document.body.classList.contains('stale')") is True
        press(browser, "0")
        assert browser.run("document.body.classList.contains('stale')") is False

    @pytest.mark.slow
    def test_an_address_without_a_motion_says_so_beside_the_default(self, browser, server):
        visit(browser, server, "?keep=yes&stiffness=20#t=0.15")
        assert "0.2 s of flight" in text(browser, "verdict") and browser.run("explorer.state.knobs.stiffness") == 20
        assert browser.run("document.body.classList.contains('stale')") is True
        assert browser.run("explorer.state.hop.knobs") == spear_ii_hop().at().values
        assert browser.run("document.getElementById('script').getAttribute('href')") == "/script"

    @pytest.mark.slow
    def test_it_is_used_by_the_keyboard_alone(self, browser, server):
        visit(browser, server, "#t=0.15")
        press(browser, "j")
        assert browser.run("document.activeElement.name") == "stiffness"
        press(browser, "ArrowRight", "ArrowRight")
        assert browser.run("explorer.state.hop.knobs.stiffness") > 48.84
        press(browser, "p")
        assert browser.run("explorer.state.a.name") == "A, pinned"
        press(browser, "?")
        rows = browser.run("[...document.querySelectorAll('#keylist tr')].map((row) => row.textContent)")
        assert browser.run("document.getElementById('help').open") and any("pin the present" in row for row in rows)
        press(browser, "Escape")
        browser.run("document.getElementById('number_friction').focus()")
        press(browser, "0")  # a digit of the number
        assert browser.run("explorer.state.hop.knobs.stiffness") > 48.84

    @pytest.mark.slow
    def test_it_is_played_by_the_keys_of_every_page(self, browser, server):
        visit(browser, server, "#t=0.15")
        duration = browser.run("explorer.state.hop.duration")
        frame = 1 / 60
        later = 0.15 + frame
        for key, time in ((".", later), (",", 0.15), ("ArrowRight", later), ("End", duration), ("Home", 0)):
            press(browser, key)
            assert browser.run("explorer.clock.time") == pytest.approx(time), key
        press(browser, ".", "[", "-")
        assert browser.run("[explorer.clock.loop, explorer.clock.speed]") == [pytest.approx([frame, duration]), 0.25]
        press(browser, "l")
        assert browser.run("[explorer.clock.loop, explorer.clock.playing]") == [None, False]

    @pytest.mark.slow
    def test_a_slider_that_has_the_focus_keeps_its_keys(self, browser, server):
        visit(browser, server, "#t=0.15")
        press(browser, "j", "End")
        low, high = KNOBS["stiffness"].low, KNOBS["stiffness"].high
        assert browser.run("explorer.state.knobs.stiffness") == high
        press(browser, "Home")
        assert browser.run("[explorer.state.knobs.stiffness, explorer.clock.time]") == [low, pytest.approx(0.15)]

    @pytest.mark.slow
    def test_an_event_says_its_name_where_the_pointer_is(self, browser, server):
        visit(browser, server, "#t=0.15")
        left, width, top = browser.run(
            "(b => [b.left, b.width, b.top])(document.getElementById('bar').getBoundingClientRect())"
        )
        name, time = browser.run("explorer.state.hop.events[0]")
        x = left + width * time / browser.run("explorer.state.hop.duration")
        browser.send("Input.dispatchMouseEvent", page=True, type="mouseMoved", x=x + 2, y=top + 10)
        assert text(browser, "tip") == f"{name}, {time:.3f} s"
        assert browser.run("document.getElementById('tip').hidden") is False

    @pytest.mark.slow
    def test_the_name_of_a_button_has_the_words_on_it(self, browser, server):
        visit(browser, server, "#t=0.15")
        named = browser.run("""[...document.querySelectorAll("button[aria-label]")]
            .map((button) => [button.textContent.trim(), button.getAttribute("aria-label")])
            .filter(([words]) => words.length > 1)""")
        assert len(named) == len(KNOBS) and all(words in name for words, name in named)

    @pytest.mark.slow
    def test_samples_and_picture_are_saved(self, browser, server):
        visit(browser, server, "?stiffness=52#t=0.15")
        saved = browser.run("""(async () => {
            const kept = [];
            URL.createObjectURL = (blob) => (kept.push(blob), "data:,");
            for (const id of ["csv", "png"]) document.getElementById(id).click();
            while (kept.length < 2) await new Promise((done) => setTimeout(done, 20));
            const [table, picture] = kept;
            return [await table.text(), picture.type, picture.size];
        })()""")
        head, *rows = saved[0].splitlines()
        assert head.startswith("t [s],domain,phase,cycle,q_boom_z [m],") and len(rows) > 50
        assert saved[1] == "image/png" and saved[2] > 5000

    @pytest.mark.slow
    @pytest.mark.parametrize("theme", ["light", "dark"])
    @pytest.mark.parametrize("size", [(640, 480), (375, 667), (844, 390), (1280, 800), (1920, 1080)], ids=str)
    def test_nothing_is_cut_or_overflows(self, browser, server, size, theme):
        frame = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False}
        browser.send("Emulation.setDeviceMetricsOverride", page=True, **frame)
        features = [{"name": "prefers-color-scheme", "value": theme}]
        browser.send("Emulation.setEmulatedMedia", page=True, features=features)
        try:
            visit(browser, server, "?stiffness=52#t=0.15")
            assert browser.run(OVERFLOWING) == []
            robot, panel = (browser.run(f"document.getElementById('{id}').getBoundingClientRect().top") for id in PARTS)
            assert 0 <= robot < 0.5 * size[1] and (size[0] >= 620 or robot < panel)
        finally:
            frame |= {"width": 1280, "height": 900}
            browser.send("Emulation.setDeviceMetricsOverride", page=True, **frame)
            browser.send("Emulation.setEmulatedMedia", page=True, features=[])


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.skipif(find() is None, reason="no Chromium here")
def test_a_bound_follows_a_slider_and_the_last_stays_where_there_is_none(browser):
    subject = bound_to_explore(Gait.load("long_stride"), "Q-SPEAR bounding")
    with serving(Explorer(subject, best_engine(), write_script)) as server:
        browser.errors.clear()
        visit(browser, server, "#t=0.1")
        assert "unstable: the largest multiplier is 1.067" in text(browser, "verdict")
        shown = move(browser, "speed", 2.55)
        assert shown["knobs"]["speed"] == 2.55 and text(browser, "figure_speed") == "2.550 m/s"
        assert text(browser, "change_speed") == "+0.050"
        move(browser, "friction", 0.1)
        assert "none was found beyond" in text(browser, "verdict")
        assert browser.run("document.body.classList.contains('stale')") is True
        assert text(browser, "figure_speed") == "2.550 m/s" and browser.errors == []
        assert refusal(server, "/bound?keep=yes")[0] == 400


def text_of_plots(browser):
    """What the plots draw."""
    return browser.run("[...document.querySelectorAll('#plots canvas')].map((canvas) => canvas.toDataURL()).join()")
