"""The server of `spear explore` asked, and its page in a headless Chromium: opened, its sliders moved, keys pressed."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPMessage
from typing import Any

from spear_pin.viz.explore.server import Explorer, Server
from tests.viz.chromium import Browser

KEYS = {"ArrowRight": ("ArrowRight", 39), "Escape": ("Escape", 27), "Home": ("Home", 36), "End": ("End", 35)}


@contextmanager
def serving(explorer: Explorer) -> Iterator[Server]:
    """A server in a thread, for as long as the block lasts."""
    with Server(explorer) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


def visit(browser: Browser, server: Server, rest: str = "") -> None:
    """Open the page and wait until it shows something."""
    browser.send("Page.navigate", page=True, url="about:blank")
    browser.send("Page.navigate", page=True, url=server.url + rest)
    deadline = time.monotonic() + 120
    while not browser.run("'explorer' in window"):
        assert time.monotonic() < deadline, browser.errors
        time.sleep(0.1)
    browser.run("explorer.opened")


def move(browser: Browser, name: str, value: float) -> dict[str, Any]:
    """Move a slider, as a hand does, and wait for what follows: what is shown then, and what took how long, in ms."""
    return browser.run(f"""(async () => {{
        const slider = document.querySelector("input[type=range][name={name}]");
        slider.value = {value};
        slider.dispatchEvent(new Event("input"));
        slider.dispatchEvent(new Event("change"));
        await explorer.idle();
        const {{ knobs, verdict }} = explorer.state.hop;
        return {{ knobs, verdict, ...explorer.timings.at(-1) }};
    }})()""")


def ask(
    server: Server, path: str, method: str = "GET", hosts: Sequence[str] | None = None, **headers: str
) -> tuple[int, HTTPMessage, bytes]:
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


def refusal(server: Server, path: str, *arguments: Any, **options: Any) -> tuple[int, str]:
    """Status and text of an answer that says what is wrong."""
    status, headers, body = ask(server, path, *arguments, **options)
    assert headers["Content-Type"].startswith("application/json")
    return status, json.loads(body)["error"]


def text(browser: Browser, id: str) -> str:
    """What an element says."""
    return str(browser.run(f"document.getElementById('{id}').textContent"))


def press(browser: Browser, *keys: str) -> None:
    """Press keys, one after the other, and wait for what follows."""
    for key in keys:
        code, number = KEYS.get(key, ("", 0))
        said = {"key": key, "code": code, "windowsVirtualKeyCode": number} | ({} if number else {"text": key})
        browser.send("Input.dispatchKeyEvent", page=True, type="keyDown", **said)
        browser.send("Input.dispatchKeyEvent", page=True, type="keyUp", key=key, code=code)
        browser.run("explorer.idle()")
