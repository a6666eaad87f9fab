"""`spear family`."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, add_rtol, check_out
from spear_pin.cli.gaits import add_gait, add_wanted, find_named_gait, solved_for, write_gait
from spear_pin.cli.given import name_options, refuse
from spear_pin.cli.legs import add_leg, one_leg, rests_on, write_leg
from spear_pin.cli.output import align_lines, progress
from spear_pin.cli.pairs import RANGE, one_range
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import write_study
from spear_pin.errors import ALL, BadValue

if TYPE_CHECKING:
    from collections.abc import Callable

    from spear_pin.gaits.continuation import Branch
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.model.robot import Robot

STEM = "family"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear family hop --over stance_torque=6:10",
        "follow the hop from 6 to 10 N·m, and list folds, flips and why the branch ends",
    )
    parser = add_command(
        commands, "family", run, "follow a gait and its multipliers over a parameter or the speed", example
    )
    add_gait(parser)
    parser.add_argument(
        "--over",
        type=one_range,
        required=True,
        metavar=RANGE,
        help="parameter, or measure such as mean_speed; the range includes the gait's own value, or that of --at",
    )
    parser.add_argument("--at", type=float, metavar="VALUE", help="begin a hop at this value (default: its own value)")
    add_wanted(parser)
    parser.add_argument(
        "--step", type=float, default=0.05, metavar="X", help="longest step, as a fraction of the range (default: 0.05)"
    )
    parser.add_argument(
        "--points", type=int, default=500, metavar="N", help="most points in each direction (default: 500)"
    )
    add_rtol(parser)
    add_leg(parser, "one of its legs hops")
    add_out(parser, f"{STEM}.json and {STEM}.svg")
    add_open(parser, f"the picture, {STEM}.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Follow the branch, write and draw it."""
    _check(arguments)
    from spear_pin.gaits.continuation import continue_gait
    from spear_pin.hybrid.result import Options
    from spear_pin.viz.plots.family import family

    Options(rtol=arguments.rtol)
    over, bounds = arguments.over
    program = Program()
    with progress() as show:
        show("looking for the gait to begin with")
        gait, vary, target = _begun(arguments, program)
        count = 0

        def tell(value: float) -> None:
            nonlocal count
            count += 1
            show(f"following: {over} {value:.6g}, {count} points")

        with name_options(within=f"--over {over}"):
            branch = continue_gait(
                gait, over, bounds, vary, target,
                step=arguments.step, points=arguments.points, rtol=arguments.rtol, on_point=tell,
            )  # fmt: skip
    options = {"step": arguments.step, "points": arguments.points, "rtol": arguments.rtol}
    solved = {"vary": vary, "target": target or None}
    program.let("branch", program.call(continue_gait, Code("gait"), over, bounds, **solved, **options))
    program.show(Code("branch"))
    robot = branch.family.system.robot
    summary = _figures(branch) | ({"cut": str(robot.cut)} if robot.cut is not None else {})
    texts, told = [align_lines(_rows(branch)), str(branch)], rests_on(robot)
    return write_study(arguments, STEM, branch.to_json(), family(branch), summary, texts, program=program, told=told)


def _check(arguments: argparse.Namespace) -> None:
    """Refuse what makes no sense, before anything is solved for."""
    check_out(arguments)
    over, (low, high) = arguments.over
    for option, value in (("--over", low), ("--over", high), ("--at", arguments.at)):
        if value is not None and not math.isfinite(value):
            raise BadValue(option, value, "a finite number")
    if not low < high:
        raise BadValue("--over", high, f"a number above the least value, {low:g}")
    if over != ALL and arguments.at is not None and not low <= arguments.at <= high:
        raise BadValue("--at", arguments.at, f"a number from {low:g} to {high:g}")
    if arguments.what != "hop":
        refuse(arguments, "only with hop", "robot", "at")


def _begun(arguments: argparse.Namespace, program: Program) -> tuple[Gait, list[str], dict[str, float]]:
    """The gait to begin with, what is solved for, and the target."""
    from spear_pin.gaits.targets import measures_of

    gait = None if arguments.what == "hop" else find_named_gait(arguments.what)
    asked = solved_for(arguments, gait)
    target = {} if asked.value is None else {asked.measure: asked.value}
    if gait is None:
        gait = _hop(arguments, target, program)
    else:
        write_gait(program, arguments.what)
    measured = arguments.over[0] in measures_of(gait.system, sampled=True)
    if measured and target:
        raise BadValue(
            "--over",
            arguments.over[0],
            f"a parameter; for a measure leave out {asked.option}",
        )
    if target and arguments.what != "hop":
        gait = _at(gait, asked.solved, target, program)
    return gait, [asked.solved] if measured or target else [], target


def _at(gait: Gait, solved: str, target: dict[str, float], program: Program) -> Gait:
    """Find the gait beside another one that has the target, and write the Python for it."""
    from spear_pin import find_gait

    call = program.call(find_gait, Code("gait.system"), [solved], target, guess=Code("gait.state"))
    program.let("gait", call)
    return find_gait(gait.system, [solved], dict[Any, float](target), guess=gait.state)


def _hop(arguments: argparse.Namespace, target: dict[str, float], program: Program) -> Gait:
    """Find the hop to begin with, and write the Python for it."""
    from spear_pin import find_gait, hopping, load
    from spear_pin.gaits.targets import measures_of
    from spear_pin.hybrid.parameters import with_parameters
    from spear_pin.model.variants import parameters_of, vary
    from spear_pin.studies.hop_of_another import scaled_hopping

    leg, over = one_leg(arguments, ["boom_x"]), arguments.over[0]
    robot = load("spear_ii", locked=["boom_x"]) if leg is None else leg
    make: Callable[[Robot], HybridSystem] = hopping if leg is None else scaled_hopping
    at = {} if arguments.at is None else {over: arguments.at}
    if leg is None and not at and not target and over not in measures_of(make(robot), sampled=True):
        write_gait(program, "hop")
        return find_named_gait("hop")
    named = write_leg(program, arguments, robot, ["boom_x"])
    if at and over in parameters_of(robot):
        named = program.let("robot", program.call(vary, named, **at))
        robot, at = vary(robot, **at), {}
    system = make(robot)
    if over in measures_of(system, sampled=True):
        target, at = {**target, **at}, {}
    written = program.let("system", program.call(make, named))
    if at:
        written = program.let("system", program.call(with_parameters, written, at))
    solved: dict[str, Any] = {"vary": ["stance_torque"] if target else [], "target": dict[Any, float](target) or None}
    program.let("gait", program.call(find_gait, written, **solved))
    return find_gait(with_parameters(system, at), **solved)


def _figures(branch: Branch) -> dict[str, Any]:
    return {
        "over": branch.over,
        "points": len(branch),
        "stable": int(branch.stable.sum()),
        "from": float(branch.values.min()),
        "to": float(branch.values.max()),
        "events": [{"parameter": each.parameter, "kind": each.kind, "text": str(each)} for each in branch.events],
        "folds": [each.parameter for each in branch.folds],
        "flips": [each.parameter for each in branch.flips],
        "neimark_sacker": [each.parameter for each in branch.neimark_sacker],
        "borders": [{"parameter": each.parameter, "kind": each.kind, "text": str(each)} for each in branch.borders],
        "ends": [{"parameter": each.parameter, "reason": each.reason, "text": str(each)} for each in branch.ends],
    }


def _rows(branch: Branch) -> list[tuple[str, str]]:
    rows = [
        ("points", f"{len(branch)}, {branch.stable.sum()} of them stable"),
        (branch.over.replace("_", " "), f"{branch.values.min():.6g} to {branch.values.max():.6g}"),
        ("largest multiplier", f"{branch.largest.min():.4f} to {branch.largest.max():.4f}"),
    ]
    for name, values in branch.solved.items():
        rows.append((name.replace("_", " "), f"{values.min():.4f} to {values.max():.4f}"))
    return rows
