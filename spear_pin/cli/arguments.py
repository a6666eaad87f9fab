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

from spear_pin.cli.durations import LASTING
from spear_pin.cli.output import complain, emit
from spear_pin.errors import BadValue, UnknownName, one_line
from spear_pin.words import number, whole

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"

MOST_CYCLES = 10_000  # of a command; some thousand exhaust the evaluations that a run may take
FREE = math.inf  # what an option says for "free": the search chooses


class Parser(argparse.ArgumentParser):
    """Errors take one line, and what looks like a negative number is one, never an option.

    Attributes:
        more: name of the argument that words between and after options go to as well; None: they are refused.
    """

    more: str | None = None

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.register("type", float, number)
        self.register("type", int, whole)
        # argparse's own, which some releases have without an exponent, -.5 or -inf
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """The arguments, and those that are not known."""
        found, unknown = super().parse_known_args(args, namespace)
        if self.more is None or any(word.startswith("-") for word in unknown):
            return found, unknown
        getattr(found, self.more).extend(unknown)
        return found, []

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is none of an argument's choices, as other unknown names are refused."""
        if action.choices is not None and value not in action.choices:
            raise argparse.ArgumentError(action, str(UnknownName("choice", value, map(str, action.choices))))

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        complain(f"{self.prog}: {one_line(message)} (see {self.prog} --help)")
        raise SystemExit(2)

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help and version; argparse's own does not tell when that cannot be written."""
        complain(message.removesuffix("\n")) if file is sys.stderr else emit(message)


def add_command(
    commands: Commands, name: str, run: Callable[[argparse.Namespace], dict[str, Any]], summary: str
) -> Parser:
    """Declare a command.

    Args:
        commands: those of `spear`.
        name: the word that calls it.
        run: does it, and returns what is printed: the figures by name, and how they read under "text". With a true
            "failed" among them `spear` ends with status 2, with a sentence under "lost" with 1. What takes long to draw
            goes under "pictures", files and how each is written, for after that; under "opened" what --open then shows.
        summary: its line in the help.

    Returns:
        The parser of its arguments; it has --json.
    """
    takes = next((f"; takes {each.takes}" for each in LASTING if (each.command, each.option) == (name, "")), "")
    parser = commands.add_parser(name, help=summary, description=summary + takes)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run, refuse=parser.error)
    return parser


def add_loading(parser: Any) -> None:
    """Declare --lock, --toes, --base, --motors and --repair; `loading` reads them. None is said by default."""
    parser.add_argument("--lock", nargs="+", metavar="JOINT", help="joints held at zero")
    parser.add_argument("--toes", nargs="+", metavar="FRAME", help="toe frames of a file")
    parser.add_argument(
        "--base",
        choices=("free", "chain", "fixed"),
        help="let the root of the robot float, on a chain of joints, or not",
    )
    parser.add_argument(
        "--motors", nargs="+", metavar="JOINT", help="joints with a motor, or all (default: the file's)"
    )
    parser.add_argument("--repair", action="store_true", default=None, help="mend inertias that are not possible")


def loading(arguments: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of `load`, from what `add_loading` declares."""
    motors = "all" if arguments.motors == ["all"] else arguments.motors
    options = {"locked": arguments.lock, "repair": bool(arguments.repair)}
    return {"toes": arguments.toes, "base": arguments.base, "motors": motors, **options}


def add_out(parser: argparse.ArgumentParser, files: str) -> None:
    """Declare --out, the folder for these files; `check_out` goes with it."""
    parser.add_argument("--out", type=folder, default=Path(), metavar="DIR", help=f"folder for {files} (default: here)")


def folder(word: str) -> Path:
    """Read the path of a folder; of nothing it would be that of the current one."""
    if not word:
        raise argparse.ArgumentTypeError("'' is no folder; type . for the current one")
    return Path(word)


def add_open(parser: argparse.ArgumentParser, file: str) -> None:
    """Declare --open, which shows this file, that under "opened" of what the command returns."""
    parser.add_argument("--open", action="store_true", help=f"open {file} in the browser")


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
    """Declare --cycles, --rtol, --max-step, --out and --open; `check_simulation` goes with them.

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
    parser.add_argument(
        "--max-step", type=float, metavar="SECONDS", help="longest step of the integrator (default: as it finds fit)"
    )
    add_out(parser, "the files")
    add_open(parser, page)


def check_simulation(arguments: argparse.Namespace) -> None:
    """Refuse what cannot be simulated or written, before anything is solved for."""
    from spear_pin.hybrid.result import Options

    check_out(arguments)
    Options(rtol=arguments.rtol, max_step=arguments.max_step)
    if not 1 <= arguments.cycles <= MOST_CYCLES:
        raise BadValue("--cycles", arguments.cycles, f"a whole number from 1 to {MOST_CYCLES}")


def number_or_free(word: str) -> float:
    """Read an option that is a finite number, or FREE."""
    if word.strip() == "free":
        return FREE
    try:
        value = number(word)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word!r} is neither a number nor 'free'; give one of them") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{word!r} is not finite; expected a finite number")
    return value
