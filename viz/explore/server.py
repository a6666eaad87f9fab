"""Local server of the page: loopback only, GET only, no file of the disk."""

from __future__ import annotations

import io
import json
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from socket import socket
from socketserver import ThreadingTCPServer
from typing import Any
from urllib.parse import parse_qsl

from spear_pin.errors import BadValue, NoGait, SpearError, UnknownName, brief
from spear_pin.studies.explore.carried import Underway
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knobs, Subject
from spear_pin.studies.explore.motion import Motion
from spear_pin.studies.explore.tangents import Tangents, tangents, tangents_of_multiplier
from spear_pin.studies.explore.views import views_of
from spear_pin.viz import template
from spear_pin.viz.explore.connections import Connections
from spear_pin.viz.explore.page import CLIENT, answer, page, slopes
from spear_pin.viz.explore.turns import Overloaded, Superseded, Turns

HOST = "127.0.0.1"
PATIENCE = 10.0  # s that a client may take to say what it wants
MOST = 256  # connections at once
BACKLOG = 4096  # that wait for one of these
HEAD = 2**17  # bytes of a request's head
KEPT = 64  # answers that are kept, for going back and forward
POLICY = f"{template.POLICY}; connect-src 'self'; frame-ancestors 'none'"


@dataclass(frozen=True)
class Answer:
    """Response to a request."""

    status: HTTPStatus
    kind: str
    body: bytes
    headers: Mapping[str, str]


def _text(status: HTTPStatus, text: str, kind: str = "text/plain", **headers: str) -> Answer:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return Answer(status, f"{kind}; charset=utf-8", text.encode(), named)


def _error(status: HTTPStatus, text: str, **headers: str) -> Answer:
    return _text(status, json.dumps({"error": text}), "application/json", **headers)


def _none(view: str, knobs: Knobs, error: NoGait) -> Answer:
    """Answers that there is no such motion, and why: the page keeps the last one, and asks again if that helps."""
    said = {
        "view": view,
        "knobs": knobs.values,
        "kept": knobs.kept,
        "verdict": "none",
        "message": f"{error.reason}.",
        "onward": isinstance(error, Underway),
    }
    return _text(HTTPStatus.OK, json.dumps(said), "application/json")


class Explorer:
    """Answers to the page's questions, computed one at a time; of a client's waiting questions only the newest.

    Args:
        subject: motion whose numbers change.
        engine: engine that follows motions.
        script: writes a program that computes a motion again, which the page saves.
    """

    def __init__(self, subject: Subject, engine: Engine, script: Callable[[Motion], str]) -> None:
        self._turns, self._subject, self._write = Turns(), subject, script
        self._views = views_of(subject)
        self._motions = lru_cache(KEPT)(lambda view, knobs: self._views[view](knobs, engine))
        self._tangents = lru_cache(KEPT)(lambda of, view, knobs: of(self._motions(view, knobs)))
        self._page = page(subject, engine)
        for knobs in subject.thorough if engine.extra else ():  # compiled before somebody waits for it
            with suppress(SpearError):  # there is none
                self._tangents(tangents, next(iter(self._views)), knobs)
        self._routes: Mapping[str, Callable[[str, Knobs, str], Answer]] = {
            "/": lambda view, knobs, client: _text(HTTPStatus.OK, self._page, "text/html"),
            f"/{subject.kind}": self._motion,
            "/script": self._script,
            "/tangents": partial(self._slopes, tangents),
            "/tangents/multiplier": partial(self._slopes, tangents_of_multiplier),
        }

    def answer(self, target: str, client: str = "") -> Answer:
        """Answers a client's request for a path with a query.

        The status is 409 if the client asks again while it waits, and 503 if too many ask.
        """
        path, _, query = target.partition("#")[0].partition("?")
        if path not in self._routes:
            return _error(HTTPStatus.NOT_FOUND, f"there is no {brief(path)}; there are {', '.join(self._routes)}")
        try:
            view, knobs = self.read(query)
        except SpearError as error:
            if path == "/":  # the page says what is wrong
                return _text(HTTPStatus.BAD_REQUEST, self._page, "text/html")
            return _error(HTTPStatus.BAD_REQUEST, str(error))
        try:
            return self._routes[path](view, knobs, client)
        except NoGait as error:
            return _none(view, knobs, error)
        except Superseded:
            return _error(HTTPStatus.CONFLICT, "not computed: the same client has asked something newer")
        except Overloaded:
            text = "not computed: too many ask, and newer questions come first; ask again"
            return _error(HTTPStatus.SERVICE_UNAVAILABLE, text, Retry_After="1")
        except SpearError as error:
            return _error(HTTPStatus.INTERNAL_SERVER_ERROR, str(error))
        except Exception as error:  # a mistake of ours is told where the question was asked
            return _error(
                HTTPStatus.INTERNAL_SERVER_ERROR, f"not computed: {type(error).__name__}: {brief(str(error))}"
            )

    def close(self) -> None:
        """Waits for the present computation, and computes no more."""
        self._turns.end()

    def read(self, query: str) -> tuple[str, Knobs]:
        """Reads view and knobs from the query of an address, with defaults for the others.

        Raises:
            UnknownName: no knob or view has such a name.
            BadValue: a name occurs twice, or a value is out of its range; the text names the range.
        """
        words: dict[str, str] = {}
        for name, word in parse_qsl(query, keep_blank_values=True):
            if name in words:
                raise BadValue(name, word, "one value only")
            words[name] = word
        view = words.pop("view", next(iter(self._views)))
        if view not in self._views:
            raise UnknownName("view", view, self._views)
        keep = words.pop("keep", "no")
        valid = ("yes", "no") if self._subject.keeps else ("no",)
        if keep not in valid:
            raise BadValue("keep", keep, " or ".join(valid))
        return view, self._subject.read(words, keep == "yes")

    def _motion(self, view: str, knobs: Knobs, client: str) -> Answer:
        with self._turns.turn(client):
            begun = time.perf_counter()
            motion: Motion = self._motions(view, knobs)
            simulated = time.perf_counter()
            text = json.dumps(answer(view, motion), allow_nan=False, separators=(",", ":"))
        drawn = time.perf_counter()
        timing = f"simulate;dur={1e3 * (simulated - begun):.1f}, draw;dur={1e3 * (drawn - simulated):.1f}"
        return _text(HTTPStatus.OK, text, "application/json", Server_Timing=timing)

    def _slopes(self, of: Callable[[Motion], Tangents], view: str, knobs: Knobs, client: str) -> Answer:
        with self._turns.turn(client):
            begun = time.perf_counter()
            text = json.dumps(slopes(self._tangents(of, view, knobs)), allow_nan=False, separators=(",", ":"))
        timing = f"tangents;dur={1e3 * (time.perf_counter() - begun):.1f}"
        return _text(HTTPStatus.OK, text, "application/json", Server_Timing=timing)

    def _script(self, view: str, knobs: Knobs, client: str) -> Answer:
        with self._turns.turn(client):
            text = self._write(self._motions(view, knobs))
        named = f'attachment; filename="explored_{self._subject.kind}.py"'
        return _text(HTTPStatus.OK, text, "text/x-python", Content_Disposition=named)


class Server(ThreadingTCPServer):
    """Server of an explorer on a port of the loopback interface.

    Each connection gets an answer: 503 if the server cannot serve more, 408 if the client sends no request in time.

    Args:
        explorer: explorer that answers.
        port: port to listen on; 0 for any free one.
        most: largest number of connections at once; more wait to be accepted.
        patience: time in which a client must send its request, in s.

    Raises:
        BadValue: the server cannot listen on the port.
    """

    allow_reuse_address = True
    daemon_threads = True  # one that waits for a silent client does not keep the process
    request_queue_size = BACKLOG

    def __init__(self, explorer: Explorer, port: int = 0, most: int = MOST, patience: float = PATIENCE) -> None:
        self.explorer, self.connections = explorer, Connections(most, patience)
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            raise BadValue("port", port, f"one that is free ({error.strerror})") from None

    @property
    def port(self) -> int:
        """Port on which the server listens."""
        return int(self.server_address[1])

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://{HOST}:{self.port}/"

    def server_close(self) -> None:
        """Stops listening, after the present computation."""
        super().server_close()
        self.explorer.close()

    def service_actions(self) -> None:
        """Does what is due now and then."""
        self.connections.end_late()

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answers in a thread, once there is room."""
        self.connections.admit(request)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        """Ends a connection."""
        self.connections.end(request)
        self.close_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignores clients that go away, and writes a line for every other error."""
        if not isinstance(error := sys.exception(), OSError):
            print(f"spear: a request was not answered: {type(error).__name__}: {brief(str(error))}", file=sys.stderr)


class _Head(io.BufferedReader):
    """Lines of a request's head, which ends with a blank line."""

    ended, _left = False, HEAD

    def readline(self, size: int | None = -1, /) -> bytes:
        """Reads a line; returns nothing once there are too many bytes."""
        line = super().readline(self._left if size is None or size < 0 else min(size, self._left))
        self._left -= len(line)
        self.ended = line in (b"\r\n", b"\n")
        return line


class _Handler(BaseHTTPRequestHandler):
    server: Server
    connection: socket
    rfile: _Head
    raw_requestline: bytes
    server_version, sys_version = "spear", ""
    default_request_version = "HTTP/1.0"  # with an older one answers have no status
    rbufsize = 0
    timeout = 2 * PATIENCE  # s for all that is sent
    answered, command, requestline, request_version = False, "", "", default_request_version

    def setup(self) -> None:
        super().setup()
        self.rfile = _Head(self.rfile)

    def handle(self) -> None:
        self.handle_one_request()
        if not self.answered and self.server.connections.stop_clock(self.connection):
            self.send_error(HTTPStatus.BAD_REQUEST)
        elif not self.answered:
            self.send_error(HTTPStatus.REQUEST_TIMEOUT)

    def parse_request(self) -> bool:
        if not (self.raw_requestline.endswith(b"\n") and super().parse_request() and self.rfile.ended):
            return False
        self.server.connections.stop_clock(self.connection)
        return True

    def do_GET(self) -> None:
        meant = self._is_meant()
        self._send(self.server.explorer.answer(self.path, self.headers.get(CLIENT, "")) if meant else self._foreign())

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Says what is wrong with a request; repeats only the method of its words."""
        if code == HTTPStatus.NOT_IMPLEMENTED:
            self._refuse()
            return
        expected = "a request is GET, a path and HTTP/1.1, a line with Host, and a blank line"
        self._send(_error(HTTPStatus(code), f"{HTTPStatus(code).phrase}: {expected}"))

    def _refuse(self) -> None:
        refusal = _error(HTTPStatus.METHOD_NOT_ALLOWED, f"{brief(self.command)} is not answered; GET is", Allow="GET")
        self._send(refusal if self._is_meant() else self._foreign())

    def _is_meant(self) -> bool:
        """Tells whether the request names this machine and comes from its page, not from another site.

        A foreign name may lead here, and a foreign page may ask. A browser says so by the Origin or, if it has none to
        send, by the site that fetches.
        """
        port = self.server.port
        suffix = "" if port == 80 else f":{port}"
        names = {HOST + suffix, "localhost" + suffix}
        allowed = {
            "Host": names,
            "Origin": {f"http://{name}" for name in names},
            "Sec-Fetch-Site": {"same-origin", "none"},
        }
        given = {name: [word.strip().lower() for word in self.headers.get_all(name, [])] for name in allowed}
        return len(given["Host"]) == 1 and all(set(words) <= allowed[name] for name, words in given.items())

    def _foreign(self) -> Answer:
        names = f"{HOST}:{self.server.port} or localhost:{self.server.port}"
        return _error(HTTPStatus.FORBIDDEN, f"Host has to be {names}, and the request no other page's")

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
        self.answered = True
        try:
            self.send_response(what.status)
            for name, value in {**always, **what.headers}.items():
                self.send_header(name, value)
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(what.body)
        except OSError:  # it no longer listens, or too slowly
            self.close_connection = True

    def log_message(self, format: str, *arguments: object) -> None:
        """Stays silent."""
