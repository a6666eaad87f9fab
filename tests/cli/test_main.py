"""`spear`: its version, and one line for every mistake."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from spear_pin import __version__
from tests.cli.calls import refused, run, words


def test_version(capsys):
    assert run(capsys, "--version") == (0, f"spear {__version__}\n", "")


class TestMistakes:
    @pytest.mark.parametrize("arguments", [["fly"], ["--json"], ["robots", "spear_ii"]], ids=words)
    def test_commands(self, capsys, arguments):
        refused(capsys, *arguments)

    @pytest.mark.parametrize(
        ("arguments", "text"),
        [
            (["hop", "--stifness", "50"], "unknown arguments: --stifness 50; nearest options: --stiffness,"),
            (["hop", "fast"], "spear hop: unknown arguments: fast (see spear hop --help)"),
            (["hopp"], "unknown command 'hopp'; nearest of 25: hop,"),
            (["hop", "--cycles", "1.5"], "invalid int value: '1.5'"),
            (["hop", "--cycles", "-1.5e1"], "invalid int value: '-1.5e1'"),
            (["hop", "--stance-torque", "-inf", "--out", "-1"], "--out is '-1'"),
        ],
        ids=words,
    )
    def test_say_what_was_written(self, capsys, tmp_path, monkeypatch, arguments, text):
        monkeypatch.chdir(tmp_path)
        assert text in refused(capsys, *arguments)

    def test_as_a_process(self):
        process = subprocess.run(
            [sys.executable, "-m", "spear_pin", "dynamics", "spear_iii"],
            capture_output=True,
            text=True,
            cwd=Path(__file__).parents[2],
        )
        assert process.returncode == 2 and process.stdout == ""
        assert process.stderr.count("\n") == 1 and "spear_iii" in process.stderr

    def test_a_reader_that_stops_reading(self):
        """As `spear dynamics q_spear | head -1` does."""
        process = subprocess.Popen(
            [sys.executable, "-m", "spear_pin", "dynamics", "q_spear"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=Path(__file__).parents[2],
        )
        process.stdout.close()
        error = process.stderr.read()
        process.stderr.close()
        process.wait()
        assert b"Traceback" not in error and b"Exception" not in error


def test_every_number_is_json(capsys):
    """Neither NaN nor infinity is ever printed."""
    status, out, _ = run(capsys, "dynamics", "spear_ii", "--json")
    assert status == 0

    def refuse(name):
        raise AssertionError(name)

    assert math.isfinite(json.loads(out, parse_constant=refuse)["D"][0][0])


def test_want_of_memory_is_one_line(capsys, monkeypatch):
    def without(arguments):
        raise MemoryError

    monkeypatch.setattr("spear_pin.cli._run", without)
    from spear_pin.cli import main

    assert main(["robots"]) == 2
    assert capsys.readouterr().err == (
        "spear: there is not enough memory for this; a smaller file or fewer cycles take less\n"
    )
