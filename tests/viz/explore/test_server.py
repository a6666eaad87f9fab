"""To whom the server of `spear explore` answers, and what it refuses."""

import threading
import time

import pytest

from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.legs import KNOBS, spear_ii_hop
from spear_pin.viz.explore.server import Explorer
from tests.viz.explore.exploring import ask, refusal


class TestServer:
    @pytest.mark.slow
    def test_it_listens_on_the_loopback_alone(self, server):
        assert server.server_address[0] == "127.0.0.1" and server.url == f"http://127.0.0.1:{server.port}/"

    @pytest.mark.parametrize("path", ["/", "/hop", "/script", "/tangents"])
    def test_it_answers_its_own_names(self, server, path):
        for name in ("127.0.0.1", "localhost", "LocalHost"):
            assert ask(server, path, hosts=[f"{name}:{server.port}"])[0] == 200

    @pytest.mark.parametrize("path", ["/", "/hop", "/script", "/tangents", "/nothing"])
    @pytest.mark.parametrize(
        "host", ["evil.example", "127.0.0.1", "localhost:1", "localhost.evil.example:{}", "[::1]:{}"]
    )
    def test_it_answers_no_other_name(self, server, path, host):
        status, text = refusal(server, path, hosts=[host.format(server.port)])
        assert status == 403 and f"localhost:{server.port}" in text

    def test_it_answers_neither_no_name_nor_two(self, server):
        own = f"localhost:{server.port}"
        assert refusal(server, "/hop", hosts=[])[0] == refusal(server, "/hop", hosts=[own, own])[0] == 403

    @pytest.mark.parametrize("path", ["/", "/hop", "/script", "/tangents", "/nothing"])
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

    @pytest.mark.parametrize("path", ["/hop", "/script", "/tangents"])
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
    explorer, answers = Explorer(spear_ii_hop(), best_engine(), write_script), {}

    def ask_for(friction, client):
        answers[friction] = explorer.answer(f"/hop?friction={friction}", client).status

    def start(friction, client, waiting):
        thread = threading.Thread(target=ask_for, args=(friction, client))
        thread.start()
        deadline = time.monotonic() + 30
        while not slow.begun.is_set() or len(explorer._turns._waiting) + len(answers) < waiting:
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
