"""The arguments that commands share: how they are declared, read and refused."""

from __future__ import annotations

import argparse
import math
import re
import shlex
import sys
import tempfile
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeAlias

from spear_pin.cli.durations import LASTING
from spear_pin.cli.output import complain, emit
from spear_pin.errors import BadValue, UnknownName, nearest, one_line
from spear_pin.words import number, whole

MOST_CYCLES = 10_000  # of a command; some thousand exhaust the evaluations that a run may take
FREE = math.inf  # what an option says for "free": the search chooses
ROBOT = "name of a robot (`spear robots` lists them), or path of a URDF, MJCF or TOML file"
WRAP: Any = {"break_on_hyphens": False, "break_long_words": False}  # options are not torn apart
MOST_LETTERS = 80  # of a folder's name that is repeated
MARGIN = 15  # columns of a command's name in the help

if TYPE_CHECKING:
    Subparsers: TypeAlias = argparse._SubParsersAction["Parser"]
else:
    Subparsers = argparse._SubParsersAction


class Commands(Subparsers):
    """Holds the commands of `spear`, in groups.

    Attributes:
        groups: names of commands by the heading of their group, as the help lists them.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.groups: dict[str, list[str]] = {}

    def begin(self, heading: str) -> None:
        """Begin a group, to which the commands belong that are declared next."""
        self.groups[heading] = []

    def add_parser(self, name: str, **options: Any) -> Parser:
        """Declare a command in the last group."""
        next(reversed(self.groups.values())).append(name)
        return super().add_parser(name, **options)


class HelpFormatter(argparse.HelpFormatter):
    """Lists commands in groups, keeps lines of descriptions apart, and writes usage in one line."""

    def _format_action(self, action: argparse.Action) -> str:
        if not isinstance(action, Commands):
            return super()._format_action(action)
        said = {each.dest: each.help or "" for each in action._get_subactions()}
        groups = (
            "\n".join([heading, *(f"  {name:<{MARGIN - 2}}{said[name]}" for name in names)])
            for heading, names in action.groups.items()
        )
        return "\n\n".join(groups) + "\n"

    def _format_usage(self, usage: Any, actions: Any, groups: Any, prefix: Any) -> str:
        """Write the usage of a command with what is required; the list of its options follows anyway."""
        if any(isinstance(each, Commands) for each in actions):
            return super()._format_usage(usage, actions, groups, prefix)
        first = super()._format_usage(usage, [each for each in actions if not each.option_strings], [], prefix)
        needed = [
            f" {each.option_strings[-1]} {each.metavar}" for each in actions if each.option_strings and each.required
        ]
        return f"{first.rstrip()}{''.join(needed)} [options]\n\n"  # as the examples do: an option of a list takes words

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        """Fill each line by itself; what is indented stays as it is."""
        lines = text.splitlines()
        return "\n".join(each if each.startswith(" ") else textwrap.fill(each, width, **WRAP) for each in lines)

    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(" ".join(text.split()), width, **WRAP)


class Parser(argparse.ArgumentParser):
    """Errors take one line, and what looks like a negative number is one, never an option.

    Attributes:
        more: name of the argument that words between and after options go to as well; None: they are refused.
        output: its group of options that say where and how results are written, the last one of its help.
    """

    more: str | None = None

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **{"formatter_class": HelpFormatter} | options)
        self.register("type", float, number)
        self.register("type", int, whole)
        # argparse's own, which some releases have without an exponent, -.5 or -inf
        self._negative_number_matcher = re.compile(r"-(\.?\d|inf|nan)", re.IGNORECASE)
        self.output: argparse._ArgumentGroup = self.add_argument_group("output")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """Parse the arguments, and return those that are not known besides."""
        found, unknown = super().parse_known_args(args, namespace)
        if self.more is None or any(word.startswith("-") for word in unknown):
            return found, unknown
        getattr(found, self.more).extend(unknown)
        return found, []

    def format_help(self) -> str:
        """Write the help, which ends with the options of the output, or those of `spear` itself."""
        last = (self._optionals if self._subparsers else None, self.output)
        self._action_groups.sort(key=lambda group: group in last)
        return super().format_help()

    def refuse_unknown(self, words: Sequence[str]) -> NoReturn:
        """Exit with status 2 for arguments that are not known, with the nearest options."""
        said = f"unknown arguments: {' '.join(words)}"
        option = next((word.partition("=")[0] for word in words if word.startswith("--")), None)
        if option is not None:
            names = [name for name in self._option_string_actions if name.startswith("--")]
            near = nearest(option, names)
            said = f"{one_line(said, 400)}; nearest options: {', '.join(near)}"
        self.error(said)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is none of an argument's choices, as other unknown names are refused."""
        if action.choices is not None and value not in action.choices:
            kind = "command" if isinstance(action, Commands) else "choice"
            raise argparse.ArgumentError(action, str(UnknownName(kind, value, map(str, action.choices))))

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        complain(f"{self.prog}: {one_line(message)} (see {self.prog} --help)")
        raise SystemExit(2)

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help and version; argparse's own does not tell when that cannot be written."""
        complain(message.removesuffix("\n")) if file is sys.stderr else emit(message)


def commands_of(parser: argparse.ArgumentParser) -> Commands:
    """Find the commands of `spear`, in their groups, for completion and docs."""
    return next(action for action in parser._actions if isinstance(action, Commands))


def add_command(
    commands: Commands,
    name: str,
    run: Callable[[argparse.Namespace], dict[str, Any]],
    summary: str,
    example: tuple[str, str],
) -> Parser:
    """Declare a command.

    Args:
        commands: those of `spear`.
        name: the word that calls it.
        run: does it, and returns what is printed: the figures by name, how they read under "text", and Python that does
            the same under "python". With a true "failed" among them `spear` ends with status 2, with a sentence under
            "lost" with 1. What takes long to draw goes under "pictures", files and how each is written, for after that;
            under "opened" what --open then shows.
        summary: a sentence that begins with a verb, without capital and full stop: its line in the help.
        example: a call, and what it does, written alike.

    Returns:
        The parser of its arguments; it has --json.
    """
    takes = next((f" It takes {each.takes}." for each in LASTING if (each.command, each.option) == (name, "")), "")
    call, does = example
    description = f"{summary[0].upper()}{summary[1:]}.{takes}\n\nExample: {does}.\n  {call}"
    parser = commands.add_parser(name, help=summary, description=description)
    parser.output.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    parser.set_defaults(run=run, refuse=parser.refuse_unknown)
    return parser


def add_repair(parser: Any) -> None:
    """Declare --repair; None unless it is given."""
    parser.add_argument("--repair", action="store_true", default=None, help="mend inertias that no body can have")


def add_loading(parser: Any) -> None:
    """Declare --lock, --toes, --base, --motors and --repair, None unless given; `gather_loading` reads them."""
    parser.add_argument("--lock", nargs="+", metavar="JOINT", help="hold these joints at zero")
    parser.add_argument("--toes", nargs="+", metavar="FRAME", help="let these frames of the file touch the ground")
    parser.add_argument(
        "--base",
        choices=("free", "chain", "fixed"),
        help="let the robot's root float, let it float on a chain of six joints, or fix it (default: as the file says)",
    )
    parser.add_argument(
        "--motors", nargs="+", metavar="JOINT", help="give these joints, or all, a motor (default: as the file says)"
    )
    add_repair(parser)


def gather_loading(arguments: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of `load`, from what `add_loading` declares."""
    motors = "all" if arguments.motors == ["all"] else arguments.motors
    options = {"locked": arguments.lock, "repair": bool(arguments.repair)}
    return {"toes": arguments.toes, "base": arguments.base, "motors": motors, **options}


def add_options(parser: Any, kind: Callable[[str], Any], **rows: tuple[str, Any, str]) -> None:
    """Declare options of one kind, by their names: what stands for the value, the default, None for none, and help."""
    for name, (metavar, default, text) in rows.items():
        said = text if default is None else f"{text} (default: {default:g})"
        parser.add_argument(f"--{name.replace('_', '-')}", type=kind, default=default, metavar=metavar, help=said)


def add_out(parser: Parser, files: str) -> None:
    """Declare --out, the folder for these files; `check_out` goes with it."""
    text = f"write {files} into this folder (default: the current one)"
    parser.output.add_argument("--out", type=folder, default=Path(), metavar="DIR", help=text)


def folder(word: str) -> Path:
    """Read the path of a folder; of nothing it would be that of the current one."""
    if not word:
        raise argparse.ArgumentTypeError("'' is no folder; type . for the current one")
    return Path(word)


def add_open(parser: Parser, file: str) -> None:
    """Declare --open, which shows this file, that under "opened" of what the command returns."""
    parser.output.add_argument("--open", action="store_true", help=f"open {file} in the browser")


def add_seed(parser: Any, numbers: str, default: int | None = 0) -> None:
    """Declare --seed of random numbers.

    Args:
        parser: of the command, or a group of its options.
        numbers: what is random, in words.
        default: unless it is given; None is taken for 0, and tells that it was not given.
    """
    text = f"seed of the random {numbers} (default: 0)"
    parser.add_argument("--seed", type=int, default=default, metavar="N", help=text)


def add_rtol(parser: Any) -> None:
    """Declare --rtol."""
    text = "relative tolerance of the integrator (default: 1e-9)"
    parser.add_argument("--rtol", type=float, default=1e-9, metavar="TOL", help=text)


def add_workers(parser: Any, workers: int | None, said: str) -> None:
    """Declare --workers, with what it is by default, and how the help says that."""
    text = f"number of processes (default: {said})"
    parser.add_argument("--workers", type=int, default=workers, metavar="N", help=text)


def add_robot(parser: Any) -> None:
    """Declare a robot, which has to be given."""
    parser.add_argument("robot", metavar="ROBOT", help=ROBOT)


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
        command = "" if folder.exists() else _mkdir(folder)
        raise BadValue("--out", given, expected + command)
    try:
        tempfile.TemporaryFile(dir=folder).close()  # permissions alone do not tell: /proc has them
    except OSError:
        raise BadValue("--out", given, f"{expected}, in which files can be written") from None


def _mkdir(folder: Path) -> str:
    """The command that makes a folder, as the end of a sentence; none for a name that is too long to be meant."""
    name = str(folder)
    if len(name) > MOST_LETTERS or not name.isprintable():
        return ""
    options = ("" if folder.parent.is_dir() else "-p ") + ("-- " if name.startswith("-") else "")
    return f"; `mkdir {options}{shlex.quote(name)}` makes it"


def add_simulation(parser: Parser, cycles: int, called: str, files: str, page: str) -> None:
    """Declare --cycles, --rtol, --max-step, --out and --open; `check_simulation` goes with them.

    Args:
        parser: of the command.
        cycles: how many, unless it is said.
        called: what cycles are to this command.
        files: what is written, in words.
        page: name of the file that --open shows.
    """
    group = parser.add_argument_group("simulation")
    add_cycles(group, cycles, called)
    add_rtol(group)
    group.add_argument("--max-step", type=float, metavar="S", help="longest step of the integrator (default: no limit)")
    add_out(parser, files)
    add_open(parser, page)


def add_cycles(parser: Any, cycles: int, called: str) -> None:
    """Declare --cycles."""
    text = f"number of {called} to simulate (default: {cycles})"
    parser.add_argument("--cycles", type=int, default=cycles, metavar="N", help=text)


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
