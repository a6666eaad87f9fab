"""`spear sensitivity`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, check_out
from spear_pin.cli.gaits import add_gait, add_kept, named_gait
from spear_pin.cli.motors import add_motors, check_motors, motors
from spear_pin.cli.output import aligned, listed, progress
from spear_pin.cli.pairs import names

STEM = "sensitivity"
OVER = ("stiffness", "damping", "knee_ratio", "hip_ratio", "friction")


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear sensitivity hop --over stiffness,knee_mass",
        "print how spring and shank change the hop's energy, speed, multipliers and other measures",
    )
    summary = "differentiate a gait's measures with respect to parameters"
    parser = add_command(commands, "sensitivity", run, summary, example)
    add_gait(parser)
    parser.add_argument(
        "--over",
        type=names,
        action="extend",
        metavar="NAME",
        help="parameters, separated by commas (default: those of springs, gears and ground)",
    )
    add_kept(parser)
    add_motors(parser)
    add_out(parser, f"{STEM}.json and {STEM}.svg")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Differentiate the gait, write the table and draw it."""
    check_out(arguments)
    check_motors(arguments)
    from spear_pin.files import write_text
    from spear_pin.hybrid.parameters import nonzero
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.sensitivity import elasticities

    with progress() as show:
        show("looking for the gait")
        gait = named_gait(arguments.what)
        show("differentiating")
        over = arguments.over or nonzero(gait.system, OVER)
        found = gait.sensitivity(over, arguments.vary, arguments.keep, motors(arguments, gait.system.robot))
    files = [arguments.out / f"{STEM}{suffix}" for suffix in (".json", ".svg")]
    write_text(files[0], found.to_json() + "\n")
    save_figure(elasticities(found), files[1])
    told = listed(arguments.out, STEM, files)
    return {
        "parameters": dict(zip(found.parameters, found.given.tolist(), strict=True)),
        "solved": {name: values.tolist() for name, values in found.solved.items()},
        "values": dict(found.outputs),
        "units": dict(found.output_units),
        "derivatives": {name: each.tolist() for name, each in found.derivatives.items()},
        "elasticities": {name: found.elasticity(name) for name in found.measures},
        "one_sided": list(found.one_sided),
        "files": [str(path) for path in files],
        "opened": files[1],
        "text": f"{found}\n\n{aligned(told)}",
    }
