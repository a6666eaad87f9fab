"""`spear sensitivity`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, check_out
from spear_pin.cli.gaits import add_gait, add_kept, find_named_gait, write_gait
from spear_pin.cli.motors import add_motors, check_motors, motors
from spear_pin.cli.output import progress
from spear_pin.cli.pairs import names
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import write_study

STEM = "sensitivity"
OVER = ("stiffness", "damping", "knee_ratio", "hip_ratio", "friction")


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear sensitivity hop --over stiffness,knee_mass",
        "print how spring and shank change the hop's energy, speed, multipliers and other measures",
    )
    summary = "compute how parameters change cost, torques, heat and more"
    parser = add_command(commands, "sensitivity", run, summary, example)
    add_gait(parser)
    parser.add_argument(
        "--over",
        type=names,
        action="extend",
        metavar="NAME",
        help="parameters, separated by commas, such as a bound's torso_mass; help lists all (default: those of springs,"
        " gears and ground)",
    )
    add_kept(parser)
    add_motors(parser)
    add_out(parser, f"{STEM}.json and {STEM}.svg")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Differentiate the gait, write the table and draw it."""
    check_out(arguments)
    check_motors(arguments)
    from spear_pin.hybrid.parameters import nonzero
    from spear_pin.viz.plots.sensitivity import elasticities

    with progress() as show:
        show("looking for the gait")
        gait = find_named_gait(arguments.what)
        show("differentiating")
        over = arguments.over or nonzero(gait.system, OVER)
        driven = motors(arguments, gait.system.robot)
        found = gait.sensitivity(over, arguments.vary, arguments.keep, driven)
    program = Program()
    named = write_gait(program, arguments.what)
    options = {"vary": arguments.vary, "keep": arguments.keep, "motors": driven}
    program.let("table", program.method(named, "sensitivity", list(over), **options))
    program.show(Code("table"))
    figures = {
        "parameters": dict(zip(found.parameters, found.given.tolist(), strict=True)),
        "solved": {name: values.tolist() for name, values in found.solved.items()},
        "values": dict(found.outputs),
        "units": dict(found.output_units),
        "derivatives": {name: each.tolist() for name, each in found.derivatives.items()},
        "elasticities": {name: found.elasticity(name) for name in found.measures},
        "one_sided": list(found.one_sided),
    }
    return write_study(arguments, STEM, found.to_json(), elasticities(found), figures, [str(found)], program=program)
