"""`spear design`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, check_out
from spear_pin.cli.gaits import VARY, add_gait, find_named_gait, write_gait
from spear_pin.cli.given import name_options
from spear_pin.cli.motors import add_motors, check_motors, motors
from spear_pin.cli.output import progress
from spear_pin.cli.pairs import RANGE, names, once, ranges, values
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import write_study

STEM = "design"
PLAIN = ("minimize", "start", "objective", "motor_masses", "cycles", "missed", "converged", "reason")  # as they are


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear design hop --minimize work --keep flight_time=0.2 --over stiffness=46:56",
        "find the stiffness with which the hop of 0.2 s of flight takes the least work",
    )
    parser = add_command(
        commands, "design", run, "optimise spring, gear ratio, ... for least energy or torque", example
    )
    add_gait(parser)
    parser.add_argument(
        "--over",
        type=ranges,
        action="extend",
        required=True,
        metavar=RANGE,
        help="parameters and their bounds, which include the gait's own values, separated by commas; help lists all",
    )
    parser.add_argument(
        "--minimize",
        required=True,
        metavar="MEASURE",
        help="measure such as work, peak_torque_knee, or electricity_knee with --motor and --bus; help lists all",
    )
    parser.add_argument("--vary", type=names, action="extend", metavar="NAME", help=f"{VARY}; separated by commas")
    for option, text in (
        ("--keep", "keep these measures at a value"),
        ("--at-most", "upper bounds of measures"),
        ("--at-least", "lower bounds of measures, such as margin_spring_switch=0.02"),
    ):
        parser.add_argument(
            option,
            type=values,
            action="extend",
            default=[],
            metavar="MEASURE=VALUE",
            help=f"{text}, separated by commas",
        )
    parser.add_argument("--largest-multiplier", type=float, metavar="X", help="upper bound of the multipliers' moduli")
    parser.add_argument("--iterations", type=int, default=100, metavar="N", help="most iterations (default: 100)")
    add_motors(parser)
    add_out(parser, f"{STEM}.json, {STEM}.svg and {STEM}_gait.json")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Optimise the design, write and draw it."""
    check_out(arguments)
    check_motors(arguments)
    from spear_pin.gaits.codesign.optimize_design import optimize_design
    from spear_pin.viz.plots.design_by_gradient import optimised

    with progress() as show:
        show("looking for the gait to begin with")
        gait = find_named_gait(arguments.what)
        options: dict[str, Any] = {
            "vary": arguments.vary,
            "at_most": once(arguments.at_most, "--at-most"),
            "at_least": once(arguments.at_least, "--at-least"),
            "largest_multiplier": arguments.largest_multiplier,
            "motors": motors(arguments, gait.system.robot),
            "iterations": arguments.iterations,
        }
        over, keep = once(arguments.over, "--over"), once(arguments.keep, "--keep")
        with name_options(over="--over"):
            found = optimize_design(
                gait,
                arguments.minimize,
                over,
                keep,
                **options,
                on_iteration=lambda n, value, missed: show(
                    f"iteration {n}: {arguments.minimize} {value:.6g}, bounds missed by {missed:.2g}"
                ),
            )
    program = Program()
    named = write_gait(program, arguments.what)
    program.let("design", program.call(optimize_design, named, arguments.minimize, over=over, keep=keep, **options))
    program.show(Code("design"))
    figures = {name: getattr(found, name) for name in PLAIN} | {
        "parameters": {name: each.value for name, each in found.parameters.items()},
        "bounds": {name: list(pair) for name, pair in found.bounds.items()},
        "margins": dict(found.margins),
        "active": dict(found.active),
        "assumptions": {name: found.elasticity(name) for name in found.ranked},
        "largest_multiplier": found.largest,
    }
    saved = [found.gait.save(arguments.out / f"{STEM}_gait.json")]
    texts = [str(found)]
    return write_study(arguments, STEM, found.to_json(), optimised(found), figures, texts, program=program, saved=saved)
