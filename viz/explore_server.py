"""Serve the page of `explore_page` to this machine alone: loopback, GET, no file of the disk."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from socketserver import ThreadingTCPServer
from threading import Lock
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from spear_pin.errors import BadValue, SpearError, UnknownName
from spear_pin.studies.explore import VIEWS, Hops
from spear_pin.studies.explore_engines import Engine
from spear_pin.studies.explore_figures import script
from spear_pin.studies.explore_knobs import Knobs
from spear_pin.viz.explore_page import answer, page

HOST = "127.0.0.1"
PATIENCE = 10.0  # s that a client may take to say what it wants
KEPT = 64  # answers that are kept, for going back and forward
COMPILED = (Knobs(knee_touchdown=1.15), Knobs(knee_touchdown=0.5))  # between them in every domain there is
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self'; frame-ancestors 'none'"
)


@dataclass(frozen=True)
class Answer:
    """What is sent back."""

    status: HTTPStatus
    kind: str
    body: bytes
    headers: Mapping[str, str]


def _text(status: HTTPStatus, text: str, kind: str = "text/plain", **headers: str) -> Answer:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return Answer(status, f"{kind}; charset=utf-8", text.encode(), named)


def _error(status: HTTPStatus, text: str, **headers: str) -> Answer:
    return _text(status, json.dumps({"error": text}), "application/json", **headers)


class Explorer:
    """Answers to the page's questions; computed one at a time, for compiled integrators have one state.

    Args:
        engine: that hops are followed with.
    """

    def __init__(self, engine: Engine) -> None:
        self._lock = Lock()
        self._hops = lru_cache(KEPT)(lambda view, knobs: VIEWS[view](knobs, engine))
        self._page = page(engine)
        for knobs in COMPILED if engine.extra else ():  # before somebody waits for it
            self._hops("settled", knobs)
        self._routes: Mapping[str, Callable[[str, Knobs], Answer]] = {
            "/": lambda view, knobs: _text(HTTPStatus.OK, self._page, "text/html"),
            "/hop": self._hop,
            "/script": self._script,
        }

    def answer(self, target: str) -> Answer:
        """The answer to a request for a path with a query."""
        parts = urlsplit(target)
        if parts.path not in self._routes or not target.startswith("/"):
            return _error(HTTPStatus.NOT_FOUND, f"there is no {parts.path}; there are {', '.join(self._routes)}")
        try:
            view, knobs = read(parts.query)
        except SpearError as error:
            if parts.path == "/":  # the page says what is wrong
                return _text(HTTPStatus.BAD_REQUEST, self._page, "text/html")
            return _error(HTTPStatus.BAD_REQUEST, str(error))
        try:
            return self._routes[parts.path](view, knobs)
        except SpearError as error:
            return _error(HTTPStatus.INTERNAL_SERVER_ERROR, str(error))

    def close(self) -> None:
        """Wait for what is being computed, and compute no more."""
        self._lock.acquire()

    def _hop(self, view: str, knobs: Knobs) -> Answer:
        with self._lock:
            begun = time.perf_counter()
            hops: Hops = self._hops(view, knobs)
            simulated = time.perf_counter()
            text = json.dumps(answer(view, hops), allow_nan=False, separators=(",", ":"))
        drawn = time.perf_counter()
        timing = f"simulate;dur={1e3 * (simulated - begun):.1f}, draw;dur={1e3 * (drawn - simulated):.1f}"
        return _text(HTTPStatus.OK, text, "application/json", Server_Timing=timing)

    def _script(self, view: str, knobs: Knobs) -> Answer:
        with self._lock:
            text = script(self._hops(view, knobs))
        return _text(HTTPStatus.OK, text, "text/x-python", Content_Disposition='attachment; filename="explored_hop.py"')


def read(query: str) -> tuple[str, Knobs]:
    """View and knobs from the query of an address; what is not named is at its default.

    Raises:
        UnknownName: there is no such knob or view.
        BadValue: a name stands there twice, or a value is out of its range; the text names the range.
    """
    words: dict[str, str] = {}
    for name, word in parse_qsl(query, keep_blank_values=True):
        if name in words:
            raise BadValue(name, word, "one value only")
        words[name] = word
    view = words.pop("view", next(iter(VIEWS)))
    if view not in VIEWS:
        raise UnknownName("view", view, VIEWS)
    return view, Knobs.read(words)


class Server(ThreadingTCPServer):
    """Serves an explorer on a port of the loopback interface.

    Args:
        explorer: answers.
        port: to listen on; 0 for any that is free.

    Raises:
        BadValue: the port cannot be listened on.
    """

    allow_reuse_address = True
    daemon_threads = True  # one that waits for a silent client does not keep the process

    def __init__(self, explorer: Explorer, port: int = 0) -> None:
        self.explorer = explorer
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            raise BadValue("port", port, f"one that is free ({error.strerror})") from None

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self.server_address[1])

    @property
    def url(self) -> str:
        """The address of the page."""
        return f"http://{HOST}:{self.port}/"

    def server_close(self) -> None:
        """Stop listening, after what is being computed."""
        super().server_close()
        self.explorer.close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that goes away is no error."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: Server
    server_version, sys_version = "spear", ""
    timeout = PATIENCE

    def do_GET(self) -> None:
        self._send(self.server.explorer.answer(self.path) if self._is_meant() else self._foreign())

    def _refuse(self) -> None:
        refusal = _error(HTTPStatus.METHOD_NOT_ALLOWED, f"{self.command} is not answered; GET is", Allow="GET")
        self._send(refusal if self._is_meant() else self._foreign())

    do_HEAD = do_POST = do_PUT = do_PATCH = do_DELETE = do_OPTIONS = do_TRACE = do_CONNECT = _refuse

    def _is_meant(self) -> bool:
        """Whether the request names this machine: a foreign name that leads here is another site's."""
        hosts = self.headers.get_all("Host", [])
        port = self.server.port
        suffix = "" if port == 80 else f":{port}"
        return len(hosts) == 1 and hosts[0].strip().lower() in {HOST + suffix, "localhost" + suffix}

    def _foreign(self) -> Answer:
        return _error(HTTPStatus.FORBIDDEN, f"Host has to be {HOST}:{self.server.port} or localhost:{self.server.port}")

    def _send(self, what: Answer) -> None:
        always = {
            "Content-Type": what.kind,
            "Content-Length": str(len(what.body)),
            "Content-Security-Policy": POLICY,
            "Cross-Origin-Resource-Policy": "same-origin",
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cache-Control": "no-store",
        }
        try:
            self.send_response(what.status)
            for name, value in {**always, **what.headers}.items():
                self.send_header(name, value)
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(what.body)
        except ConnectionError:  # it no longer listens
            self.close_connection = True

    def log_message(self, format: str, *arguments: object) -> None:
        """Stay silent."""
