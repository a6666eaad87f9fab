"""`spear explore`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open
from spear_pin.cli.gaits import BOUND, WHAT, find_named_gait
from spear_pin.cli.given import refuse
from spear_pin.cli.legs import OPTIONS, add_leg, name_robot, one_leg
from spear_pin.cli.pairs import names
from spear_pin.cli.python_lines import Program
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.studies.explore.knobs import Subject

HELP = f"motion to change: a leg's hop in place, the bound {BOUND}, or a gait by name or path"
OVER = (
    "numbers with a slider, separated by commas, such as a trot's roll_inertia_xx; help lists all (default: those of"
    " springs, ground and law)"
)


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear explore --open", "change SPEAR-II's spring and gains, and watch it hop")
    parser = add_command(commands, "explore", run, "change a gait with sliders in a local web page", example)
    parser.add_argument("what", metavar=WHAT, nargs="?", default="hop", help=f"{HELP} (default: hop)")
    parser.add_argument("--over", type=names, action="extend", metavar="NAME", help=OVER)
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port of the page (default: any free one)")
    add_leg(parser, "one of its legs hops, and sliders change its size")
    add_open(parser, "the page")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Serve the page until Ctrl-C or SIGTERM; what it prints, it prints when the page can be opened."""
    import signal
    import webbrowser

    from spear_pin.cli.explored import write_script
    from spear_pin.cli.output import print_result, progress
    from spear_pin.studies.explore.engines import best_engine
    from spear_pin.viz.explore.server import Explorer, Server

    if not 0 <= arguments.port <= 65535:
        raise BadValue("--port", arguments.port, "a port from 1 to 65535, or 0 for any that is free")
    _check(arguments)

    def end(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    engine = best_engine()
    with progress() as show:
        show(f"solving the default {arguments.what}")
        explorer = Explorer(_subject(arguments), engine, write_script)
    try:
        with Server(explorer, arguments.port) as server:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, end)
            text = f"{server.url}  ({engine.name} engine; Ctrl-C ends it)"
            told = {"url": server.url, "port": server.port, "engine": engine.name, "motion": arguments.what}
            program = Program()
            program.say_functions(Explorer, Server)
            print_result(told | {"text": text, "python": str(program)}, arguments.json)
            if arguments.open:
                webbrowser.open(server.url)
            server.serve_forever()
    except KeyboardInterrupt:
        pass
    raise SystemExit(0)  # what there was to print is printed


def _check(arguments: argparse.Namespace) -> None:
    """Refuse what does not go together, before anything is computed."""
    if arguments.what == "hop":
        refuse(arguments, "only with a gait's name or path: a hop has its own sliders", "over")
    else:
        expected = "only with hop: a gait has its robot; `spear bound --robot NAME --save` writes one"
        refuse(arguments, expected, "robot", *OPTIONS)


def _subject(arguments: argparse.Namespace) -> Subject:
    """What is turned."""
    from spear_pin.studies.explore.gaits import bound_to_explore, gait_to_explore
    from spear_pin.studies.explore.legs import hop_of_leg, spear_ii_hop

    if arguments.what == "hop":
        robot = one_leg(arguments, ["boom_x"])
        return spear_ii_hop() if robot is None else hop_of_leg(robot, f"{name_robot(robot)} hopping")
    gait, source = find_named_gait(arguments.what), BOUND if arguments.what == "bound" else arguments.what
    if Path(source).exists():  # a program is saved elsewhere
        source = str(Path(source).resolve())
    moving = gait.system.kind.replace("_", " ")
    title = f"{name_robot(gait.system.robot)} {moving}"
    if gait.system.kind == "bounding" and not arguments.over:
        return bound_to_explore(gait, title, source)
    return gait_to_explore(gait, title, arguments.over or (), source)
