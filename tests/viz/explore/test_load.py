"""Many clients at once, clients that say nonsense, too much or nothing: each connection gets an answer of HTTP."""

import json
import resource
import socket
import threading
import time
from contextlib import contextmanager

import pytest

from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.legs import spear_ii_hop
from spear_pin.viz.explore.page import CLIENT
from spear_pin.viz.explore.server import Explorer, Server
from tests.viz.explore.exploring import serving

SERVER = "spear_pin.viz.explore.server"


@pytest.fixture
def explorer(monkeypatch):
    """Answers after a moment, without a robot; fails where it is asked for a friction of 0.5."""

    def view(knobs, engine):
        time.sleep(0.005)
        return 1 / (knobs.values["friction"] - 0.5)

    monkeypatch.setattr(f"{SERVER}.views_of", lambda subject: {"settled": view})
    monkeypatch.setattr(f"{SERVER}.page", lambda subject, engine: "<form></form>")
    monkeypatch.setattr(f"{SERVER}.answer", lambda view, motion: {"motion": motion})
    monkeypatch.setattr("spear_pin.studies.explore.legs.Leg.thorough", ())
    return Explorer(spear_ii_hop(), best_engine(), write_script)


@contextmanager
def served(explorer, **options):
    """A server with other limits, in a thread."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tests.viz.explore.exploring.Server", lambda explorer: Server(explorer, **options))
        with serving(explorer) as server:
            yield server


def talk(server, *pieces, pause=0.0, shut=False):
    """What the server answers to these bytes until it ends the connection; it must not reset it."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=30) as client:
        for piece in pieces:
            try:
                client.sendall(piece)
            except BrokenPipeError:  # it has ended the connection; its answer is there
                break
            time.sleep(pause)
        if shut:
            client.shutdown(socket.SHUT_WR)
        heard = b""
        while more := client.recv(2**16):
            heard += more
    return heard


def status_of(heard):
    """Status of an answer of HTTP that is whole, and its JSON if it is that."""
    head, _, body = heard.partition(b"\r\n\r\n")
    first, *headers = head.decode("ascii").split("\r\n")
    named = dict(line.split(": ", 1) for line in headers)
    assert first.startswith("HTTP/1.0 ") and int(named["Content-Length"]) == len(body)
    if named["Content-Type"].startswith("application/json"):
        body = json.loads(body)
        assert len(str(body)) < 500
    return int(first.split()[1]), body


def get(server, target, *headers):
    return b"\r\n".join([b"GET " + target + b" HTTP/1.1", b"Host: localhost:%d" % server.port, *headers, b"", b""])


HOST = b"Host: localhost:%d\r\n"
NONSENSE = {
    "nothing": (b"", 400),
    "an empty line": (b"\r\n\r\n", 400),
    "a line of spaces": (b" \xa0\x85 \r\n\r\n", 400),
    "one word": (b"GET\r\n\r\n", 400),
    "four words": (b"GET / / HTTP/1.1\r\n\r\n", 400),
    "no version": (b"GET /\r\n\r\n", 403),
    "half a line": (b"GET /ho", 400),
    "half a head": (b"GET / HTTP/1.1\r\nHost: loc", 400),
    "a version of words": (b"GET / HTTP/x.y\r\n\r\n", 400),
    "a version of digits": (b"GET / HTTP/1." + b"1" * 5000 + b"\r\n\r\n", 400),
    "a version to come": (b"GET / HTTP/2.0\r\n\r\n", 505),
    "TLS": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 400),
    "zeros": (bytes(1000) + b"\r\n\r\n", 400),
    "all bytes": (bytes(range(256)) + b"\r\n\r\n", 400),
    "a long line": (b"GET /" + b"x" * 70_000 + b" HTTP/1.1\r\n\r\n", 414),
    "a long line without an end": (b"x" * 300_000, 414),
    "a long header": (b"GET / HTTP/1.1\r\nA: " + b"x" * 70_000 + b"\r\n\r\n", 431),
    "many headers": (b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 200 + b"\r\n", 431),
    "headers that have no end": (b"GET / HTTP/1.1\r\n" + 60 * (b"a: " + b"b" * 5000 + b"\r\n"), 400),
    "a header without a name": (b"GET / HTTP/1.1\r\n: x\r\nnonsense\r\n" + HOST + b"\r\n", 403),
    "a header of all bytes": (b"GET / HTTP/1.1\r\nA: " + bytes(range(128, 256)) + b"\r\n" + HOST + b"\r\n", 200),
    "an odd client": (b"GET / HTTP/1.1\r\nSpear-Client: \xff\xfe\x00" + b"x" * 9999 + b"\r\n" + HOST + b"\r\n", 200),
    "a method of its own": (b"FLY / HTTP/1.1\r\n" + HOST + b"\r\n", 405),
    "a method in small letters": (b"get / HTTP/1.1\r\n" + HOST + b"\r\n", 405),
    "a method of underscores": (b"__init__ / HTTP/1.1\r\n" + HOST + b"\r\n", 405),
    "a method of many letters": (b"X" * 9000 + b" / HTTP/1.1\r\n" + HOST + b"\r\n", 405),
    "a method of a foreign page": (b"FLY / HTTP/1.1\r\nOrigin: null\r\n" + HOST + b"\r\n", 403),
    "a body": (b"POST / HTTP/1.1\r\nContent-Length: 5\r\n" + HOST + b"\r\nx=1&y", 405),
    "a huge body": (b"POST / HTTP/1.1\r\nContent-Length: 8000000\r\n" + HOST + b"\r\n" + bytes(8_000_000), 405),
    "a body of a wrong length": (b"GET / HTTP/1.1\r\nContent-Length: -1e99\r\n" + HOST + b"\r\n", 200),
    "pieces without an end": (b"PUT / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n" + HOST + b"\r\nffffffff\r\n", 405),
    "a promise": (b"POST / HTTP/1.1\r\nExpect: 100-continue\r\n" + HOST + b"\r\n", 405),
}
TARGETS = {
    **dict.fromkeys((b"//[", b"//[/hop", b"http://[", b"/[::1", b"//]", b"hop", b"*", b"?", b"/hop;a=1"), 404),
    **dict.fromkeys((b"/\xff\xfe", b"/%ff%fe", b"/%", b"/%00", b"/hop%00", b"/\x00", b"/" + b"a/" * 5000), 404),
    **dict.fromkeys((b"/hop#x", b"/hop?", b"/hop?#?x", b"/hop?&&&", b"//hop"), 200),
    **dict.fromkeys((b"/hop?stiffness=%ff", b"/hop?%ff=1", b"/hop?=", b"/hop?;", b"/hop?{}", b"/hop?view=%00"), 400),
    **dict.fromkeys((b"/hop?stiffness=1e999", b"/hop?stiffness=-0x1", b"/hop?stiffness=" + b"9" * 5000), 400),
    **dict.fromkeys((b"/hop?stiffness=[1]", b"/hop?stiffness=1e-999", b"/hop?" + b"&".join([b"a=1"] * 9999)), 400),
    b"/hop?friction=0.5": 500,
}


def test_nonsense_is_answered(explorer, capfd):
    with serving(explorer) as server:
        told = {}
        for what, (said, _) in NONSENSE.items():
            told[what] = status_of(talk(server, said.replace(HOST, HOST % server.port), shut=True))[0]
        for target in TARGETS:
            told[target] = status_of(talk(server, get(server, target)))[0]
    assert told == {what: status for what, (_, status) in NONSENSE.items()} | TARGETS
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("said", [[], [b"GET /hop HT"], [b"GET / HTTP/1.1\r\n", b"A: b\r\n"], [b"x"] * 20], ids=len)
@pytest.mark.slow
def test_a_client_that_takes_too_long_is_told_so(explorer, said):
    with served(explorer, patience=0.1) as server:
        status, body = status_of(talk(server, *said, pause=0.01))
        assert status == 408 and "blank line" in body["error"]


def test_silent_clients_leave_room_for_others(explorer):
    with served(explorer, most=8) as server:
        silent = [socket.create_connection(("127.0.0.1", server.port), timeout=30) for _ in range(30)]
        assert status_of(talk(server, get(server, b"/")))[0] == 200
        assert status_of(silent[0].recv(2**16))[0] == 408
        for client in silent:
            client.close()


def test_one_that_reads_nothing_is_left(explorer):
    with served(explorer) as server:
        client = socket.create_connection(("127.0.0.1", server.port))
        client.sendall(get(server, b"/hop"))
        client.close()
        assert status_of(talk(server, get(server, b"/hop?friction=0.7")))[0] == 200


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.slow
def test_many_clients_at_once_have_answers_soon(explorer, named):
    """Each asks three times; without names they are one client, whose newest question is computed alone."""
    said, begin = [], threading.Barrier(150)

    def ask(server, n):
        begin.wait(30)
        begun = time.monotonic()
        header = [CLIENT.encode() + b": %d" % (n % 50)] * named
        said.append(
            (status_of(talk(server, get(server, b"/hop?friction=0.6%03d" % n, *header)))[0], time.monotonic() - begun)
        )

    with serving(explorer) as server:
        threads = [threading.Thread(target=ask, args=(server, n)) for n in range(150)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
    statuses = [status for status, _ in said]
    assert len(said) == 150 and set(statuses) == ({200, 409, 503} if named else {200, 409})
    assert statuses.count(200) >= 2 and max(took for _, took in said) < 5


@pytest.mark.slow
def test_a_thousand_requests_leave_memory_as_it_was(explorer):
    def ask(server, first, many):
        for n in range(first, first + many):
            for target in (b"/hop?friction=0.6%04d", b"/hop?stiffness=x%d", b"//[%d"):
                talk(server, get(server, target % n, CLIENT.encode() + b": %d" % n))

    with serving(explorer) as server:
        ask(server, 0, 100)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        ask(server, 100, 400)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        end = time.monotonic() + 10.0  # the server lets go of the last ones soon after they are answered
        while len(server.connections._until) > 1 and time.monotonic() < end:
            time.sleep(0.05)
        assert not explorer._turns._waiting and len(server.connections._until) <= 1
    assert grown < 4096  # kB
