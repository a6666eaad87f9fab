"""`spear completion`."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, commands_of
from spear_pin.cli.gaits import WHAT
from spear_pin.errors import import_extra

SHELLS = ("bash", "zsh", "fish")
# metavars, or names of arguments without any, of what is a folder, a file, a robot's name or path, and a gait's
FOLDERS, FILES = ("DIR",), ("FILE", "PATH")
ROBOTS, GAITS = ("ROBOT", "WHAT"), ("GAIT", "A B")


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        'eval "$(spear completion bash)"',
        "complete commands in this shell; put the line into ~/.bashrc to keep this",
    )
    summary = "print a script for Tab completion in your shell"
    parser = add_command(commands, "completion", run, summary, example)
    parser.add_argument("shell", choices=SHELLS, help="your shell")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Write the shell's script, from the parser of all commands."""
    shtab = import_extra("shtab", "completion", "completing commands")
    from spear_pin.gaits import library
    from spear_pin.model.loading import ROBOTS as SHIPPED

    kinds = {
        **dict.fromkeys(FOLDERS, shtab.DIRECTORY),
        **dict.fromkeys(FILES, shtab.FILE),
        **dict.fromkeys(ROBOTS, named("robot", SHIPPED)),
        **dict.fromkeys(GAITS, named("gait", library.names())),
        WHAT: named("family", ("hop", "bound", *library.names())),
    }
    commands = commands_of(arguments.every)
    for name in (name for names in commands.groups.values() for name in names):
        for action in commands.choices[name]._actions:  # argparse has no other way to them
            if action.nargs != 0 and not action.choices:
                kind = kinds.get(str(action.metavar or action.dest))
                if kind is not None:
                    action.complete = kind  # type: ignore[attr-defined]
    script = shtab.complete(arguments.every, arguments.shell)
    return {"shell": arguments.shell, "script": script, "text": script.rstrip("\n")}


def named(kind: str, names: Iterable[str]) -> Mapping[str, Any]:
    """What shells complete to a name of a kind, or to a file."""
    words, function = " ".join(names), f"_spear_{kind}"
    return {
        **dict.fromkeys(("bash", "zsh"), function),
        "fish": f"({function})",
        "preamble": {
            "bash": f'{function}() {{ compgen -W "{words}" -- "$1"; compgen -f -- "$1"; }}',
            "zsh": f'{function}() {{ _alternative "names:{kind}:({words})" "files:file:_files" }}',
            "fish": f"function {function}; printf '%s\\n' {words}; __fish_complete_path (commandline -ct); end",
        },
    }
