"""`spear fit`."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out
from spear_pin.cli.logged import add_leg_and_log, leg_and_logs, notes
from spear_pin.cli.output import align_lines, join_lines, progress
from spear_pin.cli.pairs import names
from spear_pin.cli.python_lines import Program

if TYPE_CHECKING:
    from spear_pin.studies.logs import LogPhase, MotionFit

STEM = "fit"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear fit crank_hopper hops.csv --over stiffness,hysteresis",
        "print stiffness and hysteresis of the leg's spring, each ± its standard deviation, from logged hops",
    )
    parser = add_command(commands, "fit", run, "fit numbers of a leg to logs of its hops", example)
    add_leg_and_log(parser, several=True)
    parser.add_argument(
        "--over",
        type=names,
        action="extend",
        required=True,
        metavar="NAME",
        help="numbers to fit, separated by commas: those of robot and springs, torque_scale, JOINT_friction,"
        " JOINT_zero, lag; help lists all",
    )
    parser.add_argument(
        "--phases", type=names, default=["stance", "flight"], metavar="NAME", help="stance, flight or both (default)"
    )
    add_out(parser, f"{STEM}.json and {STEM}.svg")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Read the logs, fit, and draw log and model."""
    from spear_pin.files import write_text
    from spear_pin.studies.logs import identify_motion
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.logs import fit_over_log

    program = Program()
    system, leg, logs, read = leg_and_logs(arguments, program)
    options = {"start": dict(arguments.set), "phases": tuple(arguments.phases), "settle": arguments.settle}
    with progress() as show:
        show("fitting")
        found = identify_motion(system, logs, arguments.over, **options)
    given: Any = read if len(read) > 1 else read[0]
    program.show(program.let("fit", program.call(identify_motion, leg, given, arguments.over, **options)))
    figures = _figures(found)
    kept = write_text(arguments.out / f"{STEM}.json", json.dumps(figures, indent=1) + "\n")
    picture = save_figure(fit_over_log(found), arguments.out / f"{STEM}.svg")
    rows = [(name, str(each)) for name, each in found.found.items()]
    rows += [("phases", f"{len(found.arcs)}"), ("rms", f"{found.rms:.3g} {found.unit}")]
    told = [*notes(system, logs, found.left_out, found.doubts), f"files: {kept}, {picture}"]
    return {
        **figures,
        "remarks": [remark for log in logs for remark in log.remarks],
        "files": [str(kept), str(picture)],
        "opened": picture,
        "text": "\n".join([align_lines(rows), join_lines(told)]),
        "python": str(program),
    }


def _figures(found: MotionFit) -> dict[str, Any]:
    return {
        "found": {name: vars(each) for name, each in found.found.items()},
        "correlation": found.correlation.tolist(),
        "phases": [_phase(arc.phase) for arc in found.arcs],
        "left_out": [{**_phase(phase), "why": phase.left_out} for phase in found.left_out],
        "rms": found.rms,
        "inflation": found.inflation,
        "converged": found.converged,
        "doubts": list(found.doubts),
    }


def _phase(phase: LogPhase) -> dict[str, Any]:
    return {"log": phase.source, "name": phase.name, "begin": phase.begin, "end": phase.end}
