"""`spear explore`: it says where its page is, serves it, and ends on request without a trace."""

import json
import signal
import socket
import subprocess
import sys
from http.client import HTTPConnection
from pathlib import Path

import pytest

from tests.cli.calls import refused


def children(pid):
    """Numbers of a process's children."""
    return [int(word) for path in Path(f"/proc/{pid}/task").glob("*/children") for word in path.read_text().split()]


SOON = "import sys; sys.modules['heyoka'] = None; from spear_pin.__main__ import main; main()"  # nothing is compiled


def start(*arguments):
    """The command in a process of its own, and the line that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-c", SOON, "explore", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
        preexec_fn=heeds_interrupts,
    )
    return process, process.stdout.readline()


def heeds_interrupts():
    """What a shell starts in the background ignores them, and so does what that starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=lambda number: number.name)
def test_it_answers_and_ends_cleanly(number):
    process, line = start("--json")
    try:
        told = json.loads(line)
        connection = HTTPConnection("127.0.0.1", told["port"], timeout=60)
        connection.request("GET", "/hop?friction=0.5")
        response = connection.getresponse()
        assert response.status == 200 and json.load(response)["knobs"]["friction"] == 0.5
        assert told["url"] == f"http://127.0.0.1:{told['port']}/" and told["engine"] == "reference"
        assert children(process.pid) == []
        process.send_signal(number)
        assert process.communicate(timeout=30) == ("", "")
        assert process.returncode == 0
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", told["port"]), timeout=5)
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize("port", ["-1", "65536"])
def test_a_port_that_does_not_exist_is_refused(capsys, port):
    assert "--port" in refused(capsys, "explore", "--port", port)


@pytest.mark.slow
def test_a_port_that_is_taken_is_refused(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert "one that is free" in refused(capsys, "explore", "--port", taken.getsockname()[1])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("hop", "--over", "friction"), "--over is ['friction']"),
        (("nope",), "unknown gait 'nope'"),
        (("trot", "--over", "nope"), "unknown parameter 'nope'"),
        (("trot", "--over", "slope"), "slope is 0.0; expected a number other than zero"),
        (("bound", "--robot", "solo12"), "--robot is 'solo12'; expected only with hop"),
        (("--body", "2"), "only with --robot"),
    ],
)
def test_what_does_not_go_together_is_refused(capsys, arguments, said):
    assert said in refused(capsys, "explore", *arguments)
