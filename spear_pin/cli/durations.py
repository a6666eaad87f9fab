"""How long a command takes that takes more than ten seconds; measured on two processors of a server."""

from __future__ import annotations

import argparse
from typing import NamedTuple


class Lasting(NamedTuple):
    """A command that lasts.

    Attributes:
        command: its name.
        option: without which it is soon done; "" if there is none.
        takes: how long, in words.
    """

    command: str
    option: str
    takes: str


LASTING = (
    Lasting("bound", "robot", "15 s to a minute, in space some minutes"),
    Lasting("bound", "space", "15 to 30 s"),
    Lasting("bound", "speed", "15 s to minutes, the further from a gait's own speed"),
    Lasting("turn", "", "two to five minutes; of a turn.json, seconds"),
    Lasting("trot", "", "half a minute to a minute; of a trot_steady.json, seconds"),
    Lasting("search", "", "half a minute"),
    Lasting("payoff", "", "some 40 searches of 15 s to a minute each, shared by the processors"),
    Lasting("family", "", "some seconds to a minute of a hop, minutes of a bound"),
    Lasting("sensitivity", "", "some seconds, of a bound half a minute"),
    Lasting("design", "", "some seconds, of a bound a minute"),
    Lasting("uncertainty", "monte_carlo", "some seconds, and of a hop half a minute to a minute for 10000 samples"),
    Lasting("uncertainty", "", "some seconds, of a bound half a minute"),
    Lasting("report", "", "about a minute, less once its results are kept"),
    Lasting("export", "mp4", "half a second a frame"),
)
"""The first that fits is told."""


def expected(arguments: argparse.Namespace) -> str | None:
    """How long a command that is asked for takes, in words; None if it is soon done."""
    if getattr(arguments, "list", False):
        return None
    for each in LASTING:
        if each.command == arguments.command and (not each.option or getattr(arguments, each.option)):
            return each.takes
    return None


def usual(command: str, option: str = "") -> str:
    """What the help says of a command, or of it with an option."""
    return next(each.takes for each in LASTING if (each.command, each.option) == (command, option))
