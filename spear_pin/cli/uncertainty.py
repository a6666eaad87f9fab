"""`spear uncertainty`."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, add_seed, check_out
from spear_pin.cli.gaits import add_gait, add_kept, find_named_gait, write_gait
from spear_pin.cli.motors import add_motors, check_motors, motors
from spear_pin.cli.output import progress
from spear_pin.cli.pairs import once, one_pair, words
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import write_study

if TYPE_CHECKING:
    from spear_pin.gaits.sensitivity.sensitivity import Sensitivity
    from spear_pin.gaits.sensitivity.uncertainty import Uncertainty

STEM = "uncertainty"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear uncertainty hop --sigma stiffness=1%,damping=0.05",
        "print the standard deviation of each measure, and which parameter to measure better",
    )
    summary = "tell how sure cost and torques are for parameters known to 3 %"
    parser = add_command(commands, "uncertainty", run, summary, example)
    add_gait(parser)
    parser.add_argument(
        "--sigma",
        action="extend",
        required=True,
        type=words,
        metavar="NAME=VALUE",
        help="standard deviations of parameters, in their units or in %%, separated by commas;"
        " help=1%% lists all parameters",
    )
    parser.add_argument(
        "--correlation",
        action="append",
        default=[],
        type=one_pair,
        metavar="NAME,NAME=R",
        help="correlation of two parameters' errors (default: 0)",
    )
    add_kept(parser)
    add_motors(parser)
    parser.add_argument(
        "--monte-carlo",
        type=int,
        metavar="N",
        help="also find the gait for N random samples, and compare with first order",
    )
    add_seed(parser, "samples")
    add_out(parser, f"{STEM}.json, {STEM}.svg and monte_carlo.svg")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Differentiate the gait, spread its numbers, write the tables and draw them."""
    from spear_pin.errors import BadValue
    from spear_pin.gaits.sensitivity.uncertainty import MOST
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.uncertainty import drawable, monte_carlo, variance_shares

    check_out(arguments)
    check_motors(arguments)
    samples = arguments.monte_carlo
    if samples is not None and not 2 <= samples <= MOST:
        raise BadValue("--monte-carlo", samples, f"a whole number from 2 to {MOST}")
    if arguments.seed < 0:
        raise BadValue("--seed", arguments.seed, "a whole number >= 0")
    sigma = once(arguments.sigma, "--sigma")
    with progress() as show:
        show("looking for the gait")
        gait = find_named_gait(arguments.what)
        show("differentiating")
        driven = motors(arguments, gait.system.robot)
        table = gait.sensitivity([*sigma], arguments.vary, arguments.keep, driven)
        program = Program()
        options = {"vary": arguments.vary, "keep": arguments.keep, "motors": driven}
        named = write_gait(program, arguments.what)
        written = program.let("table", program.method(named, "sensitivity", [*sigma], **options))
        spread = _spread(table, sigma, arguments.correlation, program, written)
        program.show(Code("spread"))
        drawn = None
        if samples is not None:
            show(f"finding it {samples} times")
            drawn = spread.monte_carlo(samples, arguments.seed)
            program.show(program.method(Code("spread"), "monte_carlo", samples, arguments.seed))
    figures = {"uncertainty": json.loads(spread.to_json())}
    figures |= {} if drawn is None else {"monte_carlo": drawn.plain()}
    more, texts = list[Path](), [str(each) for each in (spread, drawn) if each is not None]
    if drawn is not None and drawable(drawn):
        more = [save_figure(monte_carlo(drawn), arguments.out / "monte_carlo.svg")]
    text = json.dumps(figures, indent=1, allow_nan=False)
    return write_study(arguments, STEM, text, variance_shares(spread), figures, texts, program=program, saved=more)


def _spread(
    table: Sensitivity,
    sigma: Mapping[str, str],
    correlation: Sequence[tuple[str, str]],
    program: Program,
    written: Code,
) -> Uncertainty:
    """Find the uncertainty that is asked for, and write the Python for it."""
    import numpy as np

    from spear_pin.errors import BadValue, UnknownName
    from spear_pin.words import number

    spread = table.uncertainty(sigma)
    if not spread.covariance.any():
        raise BadValue("--sigma", dict(sigma), "at least one standard deviation other than 0")
    if not correlation:
        program.let("spread", program.method(written, "uncertainty", dict(sigma)))
        return spread
    matrix = np.eye(len(table.parameters))
    for pair, word in correlation:
        names = [name.strip() for name in pair.split(",")]
        for name in names:
            if name not in table.parameters:
                raise UnknownName("parameter", name, table.parameters)
        try:
            value = number(word)
        except ValueError:
            value = float("nan")
        if len(set(names)) != 2 or not abs(value) <= 1.0:
            raise BadValue("--correlation", f"{pair}={word}", "two parameters and a number from -1 to 1, as in k,b=0.3")
        i, j = (table.parameters.index(name) for name in names)
        if matrix[i, j]:
            raise BadValue("--correlation", pair, "each pair of parameters once")
        matrix[i, j] = matrix[j, i] = value
    deviations = spread.parameter_deviations
    covariance = matrix * np.outer(deviations, deviations)
    program.let("spread", program.method(written, "uncertainty", covariance.tolist()))
    return table.uncertainty(covariance)
