"""`spear design`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, check_out
from spear_pin.cli.gaits import VARY, add_gait, named_gait
from spear_pin.cli.motors import add_motors, check_motors, motors
from spear_pin.cli.output import aligned, listed, progress
from spear_pin.cli.pairs import RANGE, names, once, ranges, values

STEM = "design"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear design hop --minimize work --keep flight_time=0.2 --over stiffness=46:56",
        "find the stiffness with which the hop of 0.2 s of flight takes least work",
    )
    parser = add_command(commands, "design", run, "minimise a measure over parameters", example)
    add_gait(parser)
    parser.add_argument(
        "--over",
        type=ranges,
        action="extend",
        required=True,
        metavar=RANGE,
        help="parameters and their bounds, separated by commas",
    )
    parser.add_argument(
        "--minimize", required=True, metavar="MEASURE", help="such as energy, electricity or cost_of_transport"
    )
    parser.add_argument("--vary", type=names, action="extend", metavar="NAME", help=VARY)
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
    from spear_pin.files import write_text
    from spear_pin.gaits.codesign.optimize_design import optimize_design
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.design_by_gradient import optimised

    with progress() as show:
        show("looking for the gait to begin with")
        gait = named_gait(arguments.what)
        found = optimize_design(
            gait,
            arguments.minimize,
            once(arguments.over, "--over"),
            once(arguments.keep, "--keep"),
            vary=arguments.vary,
            at_most=once(arguments.at_most, "--at-most"),
            at_least=once(arguments.at_least, "--at-least"),
            largest_multiplier=arguments.largest_multiplier,
            motors=motors(arguments, gait.system.robot),
            iterations=arguments.iterations,
            on_iteration=lambda n, value, missed: show(
                f"iteration {n}: {arguments.minimize} {value:.6g}, bounds missed by {missed:.2g}"
            ),
        )
    files = [arguments.out / name for name in (f"{STEM}.json", f"{STEM}.svg", f"{STEM}_gait.json")]
    write_text(files[0], found.to_json() + "\n")
    save_figure(optimised(found), files[1])
    found.gait.save(files[2])
    told = listed(arguments.out, STEM, files)
    return {
        "minimize": found.minimize,
        "start": found.start,
        "objective": found.objective,
        "parameters": {name: each.value for name, each in found.parameters.items()},
        "bounds": {name: list(pair) for name, pair in found.bounds.items()},
        "margins": dict(found.margins),
        "active": dict(found.active),
        "assumptions": {name: found.elasticity(name) for name in found.ranked},
        "largest_multiplier": found.largest,
        "cycles": found.cycles,
        "missed": found.missed,
        "converged": found.converged,
        "reason": found.reason,
        "files": [str(path) for path in files],
        "opened": files[1],
        "text": f"{found}\n\n{aligned(told)}",
    }
