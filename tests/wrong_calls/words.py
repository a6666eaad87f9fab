"""Words that no option and no argument takes, given to each of them: the parsers themselves say which there are."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from spear_pin.cli import _parser
from tests.wrong_calls.case import Command
from tests.wrong_calls.commands import prepared

WORDS = {
    "": "nothing",
    " ": "a blank",
    "\x1b]0;x\x07": "an escape",
    "\udcff": "a byte",
    "\u202e": "an override",
    "x" * 5000: "many letters",
    "\u0665": "a digit",
}
# what a command needs beside the option, and arguments that are right
NEEDED = {
    "dynamics": ("spear_ii",),
    "explore": ("bound",),
    "identify": ("lab.csv", "--volts-per-rad=1"),
    "fit": ("crank_hopper", "hops.csv", "--over=stiffness"),
    "replay": ("crank_hopper", "hops.csv"),
    "payoff": ("q_spear",),
    "sweep": ("hop", "--over=stiffness=47,48"),
    "family": ("hop", "--over=stance_torque=7.7:7.9"),
    "sensitivity": ("hop",),
    "uncertainty": ("hop", "--sigma=stiffness=1%"),
    "design": ("hop", "--minimize=energy", "--over=stiffness=45:55"),
    "compare": ("spear_ii", "q_spear"),
    "export": ("hop.npz", "--png"),
}
FREE = {("push-test", "--write-csv", "\u0665")}  # names of files


def cases() -> Iterator[Command]:
    """Every option and argument with each word."""
    for name, parser in commands().items():
        given = NEEDED.get(name, ())
        for action in parser._actions:
            if action.nargs == 0 or action.dest in ("help", "json"):
                continue
            for word in WORDS:
                if action.option_strings:
                    option = action.option_strings[-1]
                    if (name, option, word) in FREE:
                        continue
                    kept = tuple(each for each in given if not each.startswith(f"{option}="))
                    words = (name, *kept, f"{option}={word}")
                else:
                    places = [each.dest for each in parser._actions if not each.option_strings]
                    place = places.index(action.dest)
                    words = (name, *given[:place], word, *given[place + 1 :])
                yield Command(words, prepared((*words, "lab.csv", "hop.npz", "hops.csv")))


def commands() -> dict[str, argparse.ArgumentParser]:
    """Parsers of the commands by their names."""
    found = next(each for each in _parser()._actions if isinstance(each, argparse._SubParsersAction))
    return dict(found.choices)
