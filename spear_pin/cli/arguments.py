"""The arguments that commands share: how they are declared, read and refused."""

from __future__ import annotations

import argparse
import math
import re
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from spear_pin.errors import BadValue

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"

FREE = math.inf  # what an option says for "free": the search chooses


class Parser(argparse.ArgumentParser):
    """Errors take one line, and what looks like a negative number is one, never an option."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        # argparse's own, which some releases have without an exponent, -.5 or -inf
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        print(f"{self.prog}: {message} (see {self.prog} --help)", file=sys.stderr)
        raise SystemExit(2)


def add_command(
    commands: Commands, name: str, run: Callable[[argparse.Namespace], dict[str, Any]], summary: str
) -> Parser:
    """Declare a command.

    Args:
        commands: those of `spear`.
        name: the word that calls it.
        run: does it, and returns what is printed: the figures by name, and how they read under "text". With a
            true "failed" among them `spear` ends with status 2.
        summary: its line in the help.

    Returns:
        The parser of its arguments; it has --json.
    """
    parser = commands.add_parser(name, help=summary, description=summary)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run, refuse=parser.error)
    return parser


def add_out(parser: argparse.ArgumentParser, files: str) -> None:
    """Declare --out, the folder for these files; `check_out` goes with it."""
    parser.add_argument("--out", type=Path, default=Path(), metavar="DIR", help=f"folder for {files} (default: here)")


def check_out(arguments: argparse.Namespace) -> None:
    """Refuse a folder that is not there, or in which nothing can be written, before there is something to write."""
    check_folder(arguments.out, str(arguments.out), "an existing folder")


def check_folder(folder: Path, given: str, expected: str) -> None:
    """Refuse a folder that is none, or in which nothing can be written; nothing is left in it.

    Args:
        folder: the folder.
        given: what --out says.
        expected: what it should be.
    """
    if not folder.is_dir():
        raise BadValue("--out", given, expected)
    try:
        tempfile.TemporaryFile(dir=folder).close()  # permissions alone do not tell: /proc has them
    except OSError:
        raise BadValue("--out", given, f"{expected}, in which files can be written") from None


def add_simulation(parser: argparse.ArgumentParser, cycles: int, called: str, page: str) -> None:
    """Declare --cycles, --rtol, --out and --open; `check_simulation` goes with them.

    Args:
        parser: of the command.
        cycles: how many, unless it is said.
        called: what cycles are to this command.
        page: name of the file that --open shows.
    """
    parser.add_argument(
        "--cycles", type=int, default=cycles, metavar="N", help=f"{called} to simulate (default: {cycles})"
    )
    parser.add_argument("--rtol", type=float, default=1e-9, help="relative tolerance (default: 1e-9)")
    add_out(parser, "the files")
    parser.add_argument("--open", action="store_true", help=f"open {page} in the browser")


def check_simulation(arguments: argparse.Namespace) -> None:
    """Refuse what cannot be simulated or written, before anything is solved for."""
    from spear_pin.hybrid.record import Options

    check_out(arguments)
    Options(rtol=arguments.rtol)
    if arguments.cycles < 1:
        raise BadValue("--cycles", arguments.cycles, "a whole number, at least 1")


def number_or_free(word: str) -> float:
    """Read an option that is a finite number, or FREE."""
    if word.strip() == "free":
        return FREE
    try:
        number = float(word)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word!r} is neither a number nor 'free'") from None
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"{word!r} is not a finite number")
    return number
