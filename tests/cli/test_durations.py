"""How long commands take is told on a terminal before they begin, and is gone when they are done."""

import sys
import time

import pytest

from spear_pin.cli import _parser, output
from spear_pin.cli.durations import LASTING, tell_duration, usual
from tests.cli.calls import run


def asked(*words):
    return tell_duration(_parser().parse_args(words))


def test_the_rows_are_of_commands_and_of_their_options():
    for each in LASTING:
        words = [each.command] + ["--help"]
        with pytest.raises(SystemExit):
            _parser().parse_args(words)
    commands = {name for action in _parser()._actions for name in (action.choices or ())}
    assert {each.command for each in LASTING} <= commands


def test_what_lasts():
    assert asked("search", "long_stride") == usual("search")
    assert asked("bound", "--speed", "2.7") == usual("bound", "speed")
    assert asked("bound", "--robot", "solo12", "--speed", "1") == usual("bound", "robot")
    assert asked("export", "hop.npz", "--mp4") == usual("export", "mp4")


@pytest.mark.parametrize("words", [["hop"], ["bound"], ["export", "hop.npz", "--png"], ["report", "--list"]], ids=str)
def test_what_does_not(words):
    assert asked(*words) is None


@pytest.mark.parametrize("name", ["search", "report", "payoff"])
def test_help_says_the_same(capsys, name):
    _, out, _ = run(capsys, name, "--help")
    assert f"takes {usual(name)}" in " ".join(out.split())


def test_on_a_terminal(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    status, out, err = run(capsys, "export", "gone.npz", "--mp4", "--out", tmp_path)
    assert status == 2 and out == ""
    told, cleared, complaint = err.split("\r")[1:3] + [err.split("\033[K")[-1]]
    assert told == f"export: takes {usual('export', 'mp4')}\033[K"
    assert cleared.startswith("\033[K") and "gone.npz" in complaint


def test_nothing_at_once_elsewhere(capsys, tmp_path):
    _, _, err = run(capsys, "export", "gone.npz", "--mp4", "--out", tmp_path)
    assert "takes" not in err


def test_a_line_now_and_then_in_a_log(capsys, monkeypatch):
    now = iter([0.0, 10.0, 16.0, 16.0, 20.0, 32.0, 32.0])  # s: at the start, and where lines are due or written
    monkeypatch.setattr(output.time, "monotonic", lambda: next(now))
    with output.progress() as show:
        for search in range(1, 5):
            show(f"search {search} of 4")
    assert capsys.readouterr().err == "search 2 of 4\nsearch 4 of 4\n"


def test_in_a_log_a_command_that_lasts_says_so_after_a_while(capsys, monkeypatch):
    monkeypatch.setattr(output, "PAUSE", 0.01)
    with output.foretold("turn", "two minutes"):
        time.sleep(0.2)
    with output.foretold("hop", None):
        time.sleep(0.05)
    with output.foretold("trot", "a minute"):
        pass
    time.sleep(0.05)
    assert capsys.readouterr().err == "turn: takes two minutes\n"
