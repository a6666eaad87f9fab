"""The command line, `spear`. A command is one module, whose `add` stands in COMMANDS; imports stand in its `run`."""

from __future__ import annotations

import argparse
import logging
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from spear_pin import __version__
from spear_pin.cli import (
    bound,
    compare,
    completion,
    design,
    doctor,
    dynamics,
    explore,
    export,
    family,
    fit,
    hop,
    identify,
    measures,
    payoff,
    push_test,
    references,
    replay,
    report,
    robots,
    search,
    sensitivity,
    sweep,
    trot,
    turn,
    uncertainty,
)
from spear_pin.cli.arguments import Commands, Parser, commands_of
from spear_pin.cli.durations import tell_duration
from spear_pin.cli.output import complain, draw, foretold, open_page, print_result, tell
from spear_pin.errors import LONGEST, RobotWarning, SpearError, UnknownName, one_line
from spear_pin.files import check_target, together

# the commands, by the heading of their group, as help, completion and docs list them
COMMANDS: dict[str, tuple[Callable[[Commands], None], ...]] = {
    "robot: list and inspect robots, ours or yours (URDF, MJCF, TOML)": (robots.add, dynamics.add),
    "gait: find a gait, print its multipliers (is it stable?), simulate it": (
        hop.add,
        bound.add,
        trot.add,
        turn.add,
        search.add,
    ),
    "study: vary, optimise and compare gaits": (
        *(measures.add, compare.add, sweep.add, family.add, sensitivity.add, uncertainty.add, design.add, payoff.add),
        references.add,
    ),
    "lab: push tests and logs of a leg, real or simulated": (push_test.add, identify.add, fit.add, replay.add),
    "look: web pages, films, tables, figures": (explore.add, export.add, report.add),
    "set-up: after the installation": (doctor.add, completion.add),
}

NOISE = (
    "mkdir -p failed",
    "Matplotlib created a temporary",
    "Matplotlib is building the font",
    "Could not save font_manager",
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Returns:
        0; 1 where the motion that it played was lost on the way, which it says; 2 with one line on stderr where it
        cannot be done. Without a command the help goes there.
    """
    for name in ("matplotlib", "matplotlib.font_manager"):
        logging.getLogger(name).addFilter(_is_no_noise)
    try:
        return _run(argv)
    except (SpearError, OSError) as error:
        most = 10 * LONGEST if isinstance(error, UnknownName) else LONGEST  # all names, if help asks for them
        complain(f"spear: {one_line(str(error), most)}")
        return 2
    except MemoryError:
        complain("spear: there is not enough memory for this; a smaller file or fewer cycles take less")
        return 2


def _is_no_noise(record: logging.LogRecord) -> bool:
    """Whether a message is none that Matplotlib has for want of a folder: it then takes another one."""
    return not str(record.msg).startswith(NOISE)


def _run(argv: Sequence[str] | None) -> int:
    parser = _parser()
    arguments, unknown = parser.parse_known_args(argv)
    if unknown:
        arguments.refuse(unknown)
    if arguments.run is None:
        parser.print_help(sys.stderr)
        return 2
    with together() as files:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", RobotWarning)
            with foretold(arguments.command, tell_duration(arguments)):
                result: dict[str, Any] = arguments.run(arguments)
        tell(caught)
        failed, pictures, opened = (result.pop(name, None) for name in ("failed", "pictures", "opened"))
        for path in pictures or {}:
            check_target(path)
        try:
            print_result(result, arguments.json)
        finally:  # also where nobody reads what is printed
            draw(pictures or {})
            files.place()
    if opened is not None and arguments.open:
        open_page(opened)
    return 2 if failed else 1 if result.get("lost") else 0


def _parser() -> Parser:
    about = "Simulate legs with switchable springs. `spear COMMAND --help` has an example."
    parser = Parser(prog="spear", description=about)
    parser._optionals.title = argparse.SUPPRESS  # all fits one screen
    parser.add_argument("--version", action="version", version=f"spear {__version__}", help="show the version and exit")
    parser.set_defaults(run=None, refuse=parser.refuse_unknown, every=parser)
    parser.add_subparsers(
        action=Commands,
        title=argparse.SUPPRESS,
        prog=parser.prog,
        dest="command",
        metavar="COMMAND",
        parser_class=Parser,
    )
    commands = commands_of(parser)
    for heading, declarations in COMMANDS.items():
        commands.begin(heading)
        for declare in declarations:
            declare(commands)
    return parser
