"""`spear replay`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_options, add_out
from spear_pin.cli.logged import add_leg_and_log, leg_and_logs, notes
from spear_pin.cli.output import join_lines
from spear_pin.cli.python_lines import Program

STEM = "replay"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear replay crank_hopper hops.csv --set stiffness=1386",
        "print how far the model's compression, stance and push-off are off a log whose torques drive it",
    )
    parser = add_command(commands, "replay", run, "let the torques of a log drive a model of the leg", example)
    add_leg_and_log(parser, several=False)
    add_options(parser, float, window=("S", 0.04, "time on which the first state is fitted"))
    parser.add_argument("--law", action="store_true", help="let the law of LEG act, not the torques of the log")
    add_out(parser, f"{STEM}.svg")
    add_open(parser, f"{STEM}.svg")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Read the log, replay it, and draw log and model."""
    from spear_pin.studies.logs import replay
    from spear_pin.studies.logs.replaying import MEASURES, NONE
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.logs import replay_over_log

    program = Program()
    system, leg, logs, (read,) = leg_and_logs(arguments, program)
    values = dict(arguments.set)
    motors = "law" if arguments.law else "measured"
    options = {"motors": motors, "window": arguments.window, "settle": arguments.settle}
    found = replay(system, logs[0], values, **options)
    program.show(program.let("replayed", program.call(replay, leg, read, *([values] if values else []), **options)))
    picture = save_figure(replay_over_log(found), arguments.out / f"{STEM}.svg")
    lines = [f"{'':<32}{'model':>9}{'log':>9}{'off':>9}"]
    for hop in found.hops:
        for name, (model, log) in hop.measures.items():
            what = f"{name} from {hop.stance.begin:.3f} s, {MEASURES[name]}"
            cells = f"{model:.4f}", f"{log:.4f}", f"{100.0 * hop.off(name):+.1f} %"
            shown = [NONE if "nan" in cell else cell for cell in cells]
            lines.append(f"{what:<32}{shown[0]:>9}{shown[1]:>9}{shown[2]:>9}")
    if any(NONE in line for line in lines):
        lines.append(f"note: {NONE} where a leg never gets as long as it is when it lifts off in the log")
    return {
        "hops": [
            {
                "begin": hop.stance.begin,
                "lift_off": hop.lift_off,
                "rms": hop.rms,
                "measures": {name: {"model": each[0], "log": each[1]} for name, each in hop.measures.items()},
            }
            for hop in found.hops
        ],
        "remarks": list(logs[0].remarks),
        "files": [str(picture)],
        "opened": picture,
        "text": join_lines([*lines, *notes(system, logs, found.left_out), f"picture: {picture}"]),
        "python": str(program),
    }
