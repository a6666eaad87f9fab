"""The page on which the hop's numbers are turned: to whom its server answers, what, and that it follows a slider."""

import base64
import json
import threading
import time
from http.client import HTTPConnection
from urllib.parse import urlencode

import numpy as np
import pytest
import umsgpack

from spear_pin import Gait
from spear_pin.studies.explore.bounds import bound_to_explore
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.figures import figures, script
from spear_pin.studies.explore.hops import settled
from spear_pin.studies.explore.legs import KNOBS, spear_ii_hop
from spear_pin.viz.chromium import find
from spear_pin.viz.explore.server import Explorer
from tests.viz.chromium import Browser
from tests.viz.explore.exploring import move, serving, visit


@pytest.fixture(scope="module")
def server():
    with serving(Explorer(spear_ii_hop(), best_engine())) as started:
        yield started


def ask(server, path, method="GET", hosts=None, **headers):
    """Status, headers and body of an answer; by default to the right host."""
    connection = HTTPConnection("127.0.0.1", server.port, timeout=60)
    connection.putrequest(method, path, skip_host=True)
    for host in [f"127.0.0.1:{server.port}"] if hosts is None else hosts:
        connection.putheader("Host", host)
    for name, value in headers.items():
        connection.putheader(name.replace("_", "-"), value.format(server.port))
    connection.endheaders()
    response = connection.getresponse()
    return response.status, response.headers, response.read()


def refusal(server, path, *arguments, **options):
    """Status and text of an answer that says what is wrong."""
    status, headers, body = ask(server, path, *arguments, **options)
    assert headers["Content-Type"].startswith("application/json")
    return status, json.loads(body)["error"]


class TestServer:
    @pytest.mark.slow
    def test_it_listens_on_the_loopback_alone(self, server):
        assert server.server_address[0] == "127.0.0.1" and server.url == f"http://127.0.0.1:{server.port}/"

    @pytest.mark.parametrize("path", ["/", "/hop", "/script"])
    def test_it_answers_its_own_names(self, server, path):
        for name in ("127.0.0.1", "localhost", "LocalHost"):
            assert ask(server, path, hosts=[f"{name}:{server.port}"])[0] == 200

    @pytest.mark.parametrize("path", ["/", "/hop", "/script", "/nothing"])
    @pytest.mark.parametrize(
        "host", ["evil.example", "127.0.0.1", "localhost:1", "localhost.evil.example:{}", "[::1]:{}"]
    )
    def test_it_answers_no_other_name(self, server, path, host):
        status, text = refusal(server, path, hosts=[host.format(server.port)])
        assert status == 403 and f"localhost:{server.port}" in text

    def test_it_answers_neither_no_name_nor_two(self, server):
        own = f"localhost:{server.port}"
        assert refusal(server, "/hop", hosts=[])[0] == refusal(server, "/hop", hosts=[own, own])[0] == 403

    @pytest.mark.parametrize("path", ["/", "/hop", "/script", "/nothing"])
    @pytest.mark.parametrize(
        "header",
        [
            {"Origin": "http://evil.example"},
            {"Origin": "null"},
            {"Origin": "http://localhost:1"},
            {"Origin": "https://127.0.0.1:{}"},
            {"Sec_Fetch_Site": "cross-site"},
            {"Sec_Fetch_Site": "same-site"},
        ],
        ids=str,
    )
    def test_it_answers_no_other_page(self, server, path, header):
        assert refusal(server, path, **header)[0] == 403

    @pytest.mark.parametrize(
        "header",
        [
            {"Origin": "http://127.0.0.1:{}"},
            {"Origin": "http://LocalHost:{}", "Sec_Fetch_Site": "same-origin"},
            {"Sec_Fetch_Site": "none"},
        ],
        ids=str,
    )
    def test_it_answers_its_own_page(self, server, header):
        assert ask(server, "/hop", **header)[0] == 200

    @pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"])
    def test_it_answers_get_alone(self, server, method):
        status, headers, _ = ask(server, "/hop", method)
        assert status == 405 and headers["Allow"] == "GET"

    def test_a_head_has_no_body(self, server):
        assert ask(server, "/", "HEAD")[::2] == (405, b"")

    @pytest.mark.parametrize(
        "path", ["/etc/passwd", "/../pyproject.toml", "/hop/", "/%2e%2e/", "/player.js", "http://127.0.0.1/hop"]
    )
    def test_there_is_nothing_else(self, server, path):
        status, text = refusal(server, path)
        assert status == 404 and "/hop, /script" in text

    @pytest.mark.parametrize("path", ["/hop", "/script"])
    @pytest.mark.parametrize("name", KNOBS)
    def test_a_number_out_of_its_range_is_refused_by_naming_it(self, server, path, name):
        status, text = refusal(server, f"{path}?{name}=1e6")
        assert status == 400 and text.startswith(f"{name} is ")
        assert f"from {KNOBS[name].low:g} to {KNOBS[name].high:g}" in text

    @pytest.mark.parametrize(
        ("query", "word"),
        [
            ("stiffness=50&stiffness=51", "one value only"),
            ("stiffness=nan", "expected"),
            ("stiffness=", "expected"),
            ("stiffness=5_0", "stiffness is '5_0'"),
            ("stiffness=%D9%A5%D9%A0", "stiffness is '٥٠'"),
            ("mass=1", "unknown knob"),
            ("view=all", "valid: settled, transient"),
            ("keep=maybe", "yes or no"),
        ],
    )
    def test_what_cannot_be_read_is_refused(self, server, query, word):
        status, text = refusal(server, f"/hop?{query}")
        assert status == 400 and word in text

    @pytest.mark.parametrize("path", ["/hop?{}=1", "/hop?stiffness={}", "/hop?view={}", "/{}"])
    def test_an_error_repeats_little_of_what_was_asked(self, server, path):
        status, text = refusal(server, path.format("x" * 60_000))
        assert status in (400, 404) and "xxx..." in text and len(text) < 500

    def test_the_page_itself_comes_to_say_what_is_wrong(self, server):
        status, headers, body = ask(server, "/?stiffness=1000")
        assert status == 400 and headers["Content-Type"].startswith("text/html") and b"<form" in body

    def test_a_page_may_load_and_be_framed_by_nothing_else(self, server):
        policy = ask(server, "/")[1]["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "connect-src 'self'" in policy and "frame-ancestors 'none'" in policy


class TestAnswers:
    def test_a_hop_is_what_the_study_computes(self, server):
        knobs = spear_ii_hop().at(stiffness=52.0, stance_torque=8.2)
        hops = settled(knobs, best_engine())
        shown = json.loads(ask(server, f"/hop?{urlencode({'stiffness': 52, 'stance_torque': 8.2})}")[2])
        assert shown["knobs"] == knobs.values and shown["view"] == "settled"
        assert shown["verdict"] == hops.verdict and shown["message"] == hops.message
        assert shown["figures"] == pytest.approx(figures(hops))
        assert shown["duration"] == pytest.approx(hops.gait.period)
        series = {name: np.array(values) for name, values in shown["series"].items()}
        assert {len(values) for values in series.values()} == {len(hops.trajectory.t)}
        np.testing.assert_allclose(series["normal"], hops.trajectory.force[:, 0, 1], atol=0.01)
        total = series["motor"] + series["spring"] + series["damper"]
        np.testing.assert_allclose(total, hops.trajectory.tau[:, 1], atol=0.002)

    def test_the_playback_keeps_the_robot_and_the_ground(self, server):
        shown = json.loads(ask(server, "/hop?friction=0.3")[2])
        commands = [umsgpack.unpackb(base64.b64decode(command)) for command in shown["commands"]]
        drawn = [command["path"].split("/")[3] for command in commands if command["type"] == "set_object"]
        assert {name.split(" ")[0] for name in drawn} <= {"robot", "path", "force"}
        assert not any("/shape " in command["path"] for command in commands if command["type"] == "set_object")
        assert not any(command["path"].startswith("/Cameras") for command in commands)
        assert commands[-1]["type"] == "set_animation"

    def test_the_same_address_gives_the_same_answer(self, server):
        assert ask(server, "/hop?damping=1.2")[2] == ask(server, "/hop?damping=1.2")[2]

    @pytest.mark.slow
    def test_the_script_is_a_download(self, server):
        _, headers, body = ask(server, "/script?friction=0.5")
        assert headers["Content-Disposition"] == 'attachment; filename="explored_hop.py"'
        assert body.decode() == script(settled(spear_ii_hop().at(friction=0.5), best_engine()))


class Slow:
    """Views that take until they are let go on, and say which were computed."""

    def __init__(self, monkeypatch):
        self.computed, self.begun, self.go_on = [], threading.Event(), threading.Event()
        monkeypatch.setattr("spear_pin.viz.explore.server.views_of", lambda subject: {"settled": self.view})
        monkeypatch.setattr("spear_pin.viz.explore.server.page", lambda subject, engine: "")
        monkeypatch.setattr("spear_pin.viz.explore.server.answer", lambda view, hops: hops)
        monkeypatch.setattr("spear_pin.studies.explore.legs.Leg.thorough", ())

    def view(self, knobs, engine):
        self.computed.append(knobs.values["friction"])
        self.begun.set()
        assert self.go_on.wait(30)
        return knobs.values["friction"]


def test_of_each_client_that_waits_only_the_newest_question_is_computed(monkeypatch):
    slow = Slow(monkeypatch)
    explorer, answers = Explorer(spear_ii_hop(), best_engine()), {}

    def ask_for(friction, client):
        answers[friction] = explorer.answer(f"/hop?friction={friction}", client).status

    def start(friction, client, waiting):
        thread = threading.Thread(target=ask_for, args=(friction, client))
        thread.start()
        deadline = time.monotonic() + 30
        while not slow.begun.is_set() or len(explorer._turns._newest) + len(answers) < waiting:
            assert time.monotonic() < deadline
            time.sleep(1e-3)
        return thread

    threads = [start(0.2, "one", 0)]
    threads += [start(0.3, "one", 1), start(0.4, "two", 2), start(0.5, "one", 3), start(0.6, "two", 4)]
    assert answers == {0.3: 409, 0.4: 409}
    slow.go_on.set()
    for thread in threads:
        thread.join(30)
    assert slow.computed[0] == 0.2 and sorted(slow.computed) == [0.2, 0.5, 0.6]
    assert answers == {0.2: 200, 0.3: 409, 0.4: 409, 0.5: 200, 0.6: 200}
    explorer.close()


@pytest.fixture(scope="module")
def browser():
    with Browser(1280, 900) as started:
        yield started


def text(browser, id):
    """What an element says."""
    return browser.run(f"document.getElementById('{id}').textContent")


@pytest.mark.browser
@pytest.mark.skipif(find() is None, reason="no Chromium here")
class TestPage:
    def test_it_needs_nothing_but_its_server(self, browser, server):
        browser.errors.clear()
        browser.requests.clear()
        visit(browser, server)
        assert browser.errors == []
        assert all(address.startswith((server.url, "data:", "blob:", "about:")) for address in browser.requests)
        assert text(browser, "verdict").startswith("Periodic and stable")

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
        expected = figures(settled(spear_ii_hop().at(stance_torque=9.0), best_engine()))["apex_height"]
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
KEYS = {"ArrowRight": ("ArrowRight", 39), "Escape": ("Escape", 27)}


def press(browser, *keys):
    """Press keys, one after the other, and wait for what follows."""
    for key in keys:
        code, number = KEYS.get(key, ("", 0))
        said = {"key": key, "code": code, "windowsVirtualKeyCode": number} | ({} if number else {"text": key})
        browser.send("Input.dispatchKeyEvent", page=True, type="keyDown", **said)
        browser.send("Input.dispatchKeyEvent", page=True, type="keyUp", key=key, code=code)
        browser.run("explorer.idle()")


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.skipif(find() is None, reason="no Chromium here")
def test_a_bound_follows_a_slider_and_the_last_stays_where_there_is_none(browser):
    subject = bound_to_explore(Gait.load("long_stride"), "Q-SPEAR bounding")
    with serving(Explorer(subject, best_engine())) as server:
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
