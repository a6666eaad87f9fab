"""The page of `spear explore` in a headless Chromium: opened, and its sliders moved."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from spear_pin.viz.explore.server import Explorer, Server
from tests.viz.chromium import Browser


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
