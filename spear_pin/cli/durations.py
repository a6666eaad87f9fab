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
    Lasting("bound", "robot", "15 s to a minute, and in 3-D some minutes"),
    Lasting("bound", "space", "one to two minutes, or half a minute for a gait with feedback"),
    Lasting("bound", "speed", "15 s to minutes, longer far from the gait's own speed"),
    Lasting("turn", "", "two to five minutes, or seconds for a gait that turns already"),
    Lasting("trot", "", "half a minute to a minute, or seconds for a gait with feedback"),
    Lasting("search", "", "half a minute"),
    Lasting(
        "payoff",
        "",
        "about three searches for each knee at each speed or flight time (a knee without a spring, and a fixed and a"
        " switched one for each stiffness), 5 s to a minute each, shared by the processors",
    ),
    Lasting(
        "sweep",
        "",
        "some seconds, half a minute for a bound, and in 3-D 5 to 30 s for each gait, or minutes where there is none",
    ),
    Lasting("family", "", "some seconds to a minute for a hop, and minutes for a bound"),
    Lasting("sensitivity", "", "some seconds, and half a minute for a bound or a trot"),
    Lasting("design", "", "some seconds, and a minute or two for a bound or a trot"),
    Lasting("uncertainty", "monte_carlo", "some seconds, and for 10000 samples of a hop half a minute to a minute"),
    Lasting("uncertainty", "", "some seconds, and half a minute for a bound"),
    Lasting("fit", "", "some seconds, and without heyoka a minute or more"),
    Lasting("report", "", "about a minute, and less once its results are stored"),
    Lasting("export", "mp4", "half a second for each frame"),
)
"""The first that fits is told."""


def tell_duration(arguments: argparse.Namespace) -> str | None:
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
