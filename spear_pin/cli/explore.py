"""`spear explore`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command
from spear_pin.errors import BadValue


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    parser = add_command(commands, "explore", run, "turn the hop's numbers on a page of this machine, and watch it")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="of the page (default: any that is free)")
    parser.add_argument("--open", action="store_true", help="open the page in the browser")
    parser.add_argument("--robot", help=argparse.SUPPRESS)  # others have it: refused with the reason


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Serve the page until Ctrl-C or SIGTERM; what it prints, it prints when the page can be opened."""
    import signal
    import webbrowser

    from spear_pin.cli.output import print_result, progress
    from spear_pin.studies.explore.engines import best_engine
    from spear_pin.viz.explore.server import Explorer, Server

    if not 0 <= arguments.port <= 65535:
        raise BadValue("--port", arguments.port, "a port from 1 to 65535, or 0 for any that is free")

    def end(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    if arguments.robot is not None:
        expected = "none: the sliders have SPEAR-II's ranges; spear hop and sweep take another robot's leg"
        raise BadValue("--robot", arguments.robot, expected)
    engine = best_engine()
    with progress() as show:
        show("solving the default hop")
        explorer = Explorer(engine)
    try:
        with Server(explorer, arguments.port) as server:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, end)
            text = f"{server.url}  ({engine.name} engine; Ctrl-C ends it)"
            print_result({"url": server.url, "port": server.port, "engine": engine.name, "text": text}, arguments.json)
            if arguments.open:
                webbrowser.open(server.url)
            server.serve_forever()
    except KeyboardInterrupt:
        pass
    raise SystemExit(0)  # what there was to print is printed
