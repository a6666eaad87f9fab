"""Headless Chromium over its DevTools pipe: it opens pages from disk, without any network.

It does not use playwright, which needs Node.js and browsers of its own, nor selenium, which talks over a port.
"""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from spear_pin.errors import MissingProgram, SpearError

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",  # it does not start as root with one; it shows our own pages only
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-dev-shm-usage",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost",  # no network but this machine
    "--hide-scrollbars",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--remote-debugging-pipe",
)
PATIENCE = 120.0  # s


def find() -> str | None:
    """Returns the path of a Chromium on this machine."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """A headless browser with one page; a context manager, which leaves neither process nor profile behind.

    Args:
        width: width of the page, in pixels.
        height: height of the page, in pixels.

    Attributes:
        errors: errors logged to the console, exceptions, and refusals of the security policy.
        requests: addresses the page asked for.

    Raises:
        MissingProgram: there is no Chromium.
        SpearError: Chromium ends or does not answer (in every method).
    """

    def __init__(self, width: int = 1280, height: int = 720) -> None:
        program = find()
        if program is None:
            raise MissingProgram("chromium", "pictures of the player", "chromium")
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._count, self._buffer = 0, b""
        with ExitStack() as stack:
            profile = stack.enter_context(tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True))
            self._start(stack, [program, *FLAGS, f"--user-data-dir={profile}", "about:blank"])
            self._attach(width, height)
            self._stack = stack.pop_all()

    def _start(self, stack: ExitStack, command: list[str]) -> None:
        here_read, there_write = os.pipe()
        there_read, here_write = os.pipe()
        self._read, self._write = here_read, here_write
        stack.callback(os.close, here_read)
        stack.callback(os.close, here_write)
        # the browser reads from 3 and writes to 4; the shell can put any descriptor there
        script = f'exec "$@" 3<&{there_read} 4>&{there_write}'
        try:
            self._process = subprocess.Popen(
                ["bash", "-c", script, "bash", *command],
                pass_fds=(there_read, there_write),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is for us, who then close it
            )
        finally:
            os.close(there_read)
            os.close(there_write)
        stack.callback(self._end)

    def _end(self) -> None:
        """Ends the browser with all its processes: first by a request, then by force."""
        try:
            self.send("Browser.close")
            self._process.wait(20)
        except (SpearError, OSError, subprocess.TimeoutExpired):
            pass
        finally:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()

    def _attach(self, width: int, height: int) -> None:
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", page=True, **size)
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable", page=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the browser and removes its profile."""
        self._stack.close()

    def open(self, path: Path, fragment: str = "") -> None:
        """Opens a file and waits until its player has started."""
        self.send("Page.navigate", page=True, url="about:blank")
        self.send("Page.navigate", page=True, url=path.absolute().as_uri() + fragment)
        self._wait_for("document.readyState === 'complete' && 'player' in window")
        # the size is set one frame later, and drawn another one later
        self.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(r))))")

    def run(self, script: str) -> Any:
        """Returns the value of a JavaScript expression, awaited."""
        answer = self.send("Runtime.evaluate", page=True, expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise SpearError(f"the page failed: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def capture(self) -> bytes:
        """Returns a picture of the page as a PNG."""
        return base64.b64decode(self.send("Page.captureScreenshot", page=True, format="png")["data"])

    def send(self, method: str, *, page: bool = False, **params: Any) -> dict[str, Any]:
        """Sends a DevTools command and returns the answer."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": params}
        if page:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self._receive(deadline)
            if answer.get("id") == self._count:
                if "error" in answer:
                    raise SpearError(f"{method}: {answer['error']}")
                return dict(answer["result"])
            self._note(answer)

    def _wait_for(self, condition: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while not self.run(condition):
            if time.monotonic() > deadline:
                raise SpearError(f"the page is not ready: {'; '.join(self.errors) or condition}")
            time.sleep(0.1)

    def _receive(self, deadline: float) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._read], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise SpearError("the browser does not answer")
            chunk = os.read(self._read, 1 << 16)
            if not chunk:
                raise SpearError("the browser has ended")
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
