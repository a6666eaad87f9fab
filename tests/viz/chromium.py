"""Headless Chromium over its DevTools pipe: what a page logs, requests and looks like."""

from __future__ import annotations

import base64
import io
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-dev-shm-usage",
    "--disable-sync",
    "--hide-scrollbars",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--remote-debugging-pipe",
)


def find() -> str | None:
    """Path of a Chromium on this machine."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """One headless browser with one page; a context manager.

    Attributes:
        errors: errors logged to the console, exceptions, and what the security policy refused.
        requests: addresses the page asked for.
    """

    def __init__(self, width: int = 1280, height: int = 720) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._count, self._buffer = 0, b""
        self._profile = tempfile.mkdtemp(prefix="chromium-")
        here_read, there_write = os.pipe()
        there_read, here_write = os.pipe()
        self._read, self._write = here_read, here_write
        # the browser reads from 3 and writes to 4; the shell can put any descriptor there
        script = f'exec "$@" 3<&{there_read} 4>&{there_write}'
        profile = f"--user-data-dir={self._profile}"
        self._process = subprocess.Popen(
            ["bash", "-c", script, "bash", str(find()), *FLAGS, profile, "about:blank"],
            pass_fds=(there_read, there_write),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(there_read)
        os.close(there_write)
        try:
            self._attach(width, height)
        except BaseException:
            self.close()
            raise

    def _attach(self, width: int, height: int) -> None:
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", page=True, **size)
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable", page=True)

    def __enter__(self) -> Browser:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the browser and remove its profile."""
        try:
            self.send("Browser.close")
            self._process.wait(20)
        except (AssertionError, OSError, EOFError, TimeoutError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        os.close(self._read)
        os.close(self._write)
        shutil.rmtree(self._profile, ignore_errors=True)

    def open(self, path: Path, fragment: str = "") -> None:
        """Open a file and wait until its player has started."""
        self.send("Page.navigate", page=True, url="about:blank")
        self.send("Page.navigate", page=True, url=path.absolute().as_uri() + fragment)
        self._wait_for("document.readyState === 'complete' && 'player' in window")
        # the size is set one frame later, and drawn another one later
        self.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(r))))")

    def run(self, script: str) -> Any:
        """Value of a JavaScript expression, awaited."""
        answer = self.send("Runtime.evaluate", page=True, expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise AssertionError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def screenshot(self, save_to: Path | None = None) -> NDArray[np.uint8]:
        """What the page looks like, (height, width, 3)."""
        image = base64.b64decode(self.send("Page.captureScreenshot", page=True, format="png")["data"])
        if save_to is not None:
            save_to.write_bytes(image)
        return np.asarray(Image.open(io.BytesIO(image)).convert("RGB"))

    def send(self, method: str, *, page: bool = False, **params: Any) -> dict[str, Any]:
        """The answer to a DevTools command."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": params}
        if page:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + 120
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self._count:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return dict(answer["result"])
            self._note(answer)

    def _wait_for(self, condition: str) -> None:
        deadline = time.monotonic() + 120
        while not self.run(condition):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{condition}; errors: {self.errors}")
            time.sleep(0.1)

    def _receive(self, deadline: float) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._read], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            chunk = os.read(self._read, 1 << 16)
            if not chunk:
                raise EOFError("the browser has ended")
            self._buffer += chunk
        text, _, self._buffer = self._buffer.partition(b"\0")
        return dict(json.loads(text))

    def _note(self, event: dict[str, Any]) -> None:
        method, params = event.get("method"), event.get("params", {})
        if method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.errors.append(str(params["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "assert"):
            self.errors.append(str(params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(params["entry"]["text"])
