"""`spear family`."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, add_rtol, check_out
from spear_pin.cli.gaits import BOUND, add_gait, add_wanted, named_gait
from spear_pin.cli.legs import add_leg, one_leg, rests_on
from spear_pin.cli.output import aligned, listed, progress
from spear_pin.cli.pairs import RANGE, one_range
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.continuation import Branch
    from spear_pin.gaits.gait import Gait

STEM = "family"


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear family hop --over stance_torque=6:10",
        "follow the hop from 6 to 10 N·m, and list folds, flips and why the branch ends",
    )
    parser = add_command(commands, "family", run, "follow a gait while one parameter changes", example)
    add_gait(parser)
    parser.add_argument(
        "--over", type=one_range, required=True, metavar=RANGE, help="the parameter, or a measure such as mean_speed"
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
    from spear_pin.files import write_text
    from spear_pin.gaits.continuation import continue_gait
    from spear_pin.hybrid.result import Options
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.family import family

    Options(rtol=arguments.rtol)
    over, bounds = arguments.over
    with progress() as show:
        show("looking for the gait to begin with")
        gait, vary, target = _begun(arguments)
        count = 0

        def tell(value: float) -> None:
            nonlocal count
            count += 1
            show(f"following: {over} {value:.6g}, {count} points")

        branch = continue_gait(
            gait, over, bounds, vary, target,
            step=arguments.step, points=arguments.points, rtol=arguments.rtol, on_point=tell,
        )  # fmt: skip
    files = [arguments.out / f"{STEM}{suffix}" for suffix in (".json", ".svg")]
    write_text(files[0], branch.to_json() + "\n")
    save_figure(family(branch), files[1])
    robot = branch.family.system.robot
    summary = _figures(branch) | ({"cut": str(robot.cut)} if robot.cut is not None else {})
    told = [*rests_on(robot), *listed(arguments.out, STEM, files)]
    text = "\n".join([aligned(_rows(branch)), "", str(branch), "", aligned(told)])
    return summary | {"files": [str(path) for path in files], "opened": files[1], "text": text}


def _check(arguments: argparse.Namespace) -> None:
    """Refuse what makes no sense, before anything is solved for."""
    check_out(arguments)
    _, (low, high) = arguments.over
    for option, value in (("--over", low), ("--over", high), ("--at", arguments.at)):
        if value is not None and not math.isfinite(value):
            raise BadValue(option, value, "a finite number")
    if not low < high:
        raise BadValue("--over", high, f"a number above the least value, {low:g}")
    if arguments.at is not None and not low <= arguments.at <= high:
        raise BadValue("--at", arguments.at, f"a number from {low:g} to {high:g}")
    if arguments.what != "hop":
        for option in ("robot", "flight_time", "at"):
            if getattr(arguments, option) is not None:
                raise BadValue(f"--{option.replace('_', '-')}", getattr(arguments, option), "to go with hop")
    if arguments.what == "hop" and arguments.speed is not None:
        raise BadValue("--speed", arguments.speed, "to go with a bound; a hop takes --flight-time")


def _begun(arguments: argparse.Namespace) -> tuple[Gait, list[str], dict[str, float]]:
    """The gait to begin with, what is solved for, and the target."""
    from spear_pin.gaits.bounding import SPEED_BY
    from spear_pin.gaits.gait import Gait

    gait = None if arguments.what == "hop" else Gait.load(BOUND if arguments.what == "bound" else arguments.what)
    if gait is not None and arguments.speed is not None and gait.system.kind != "bounding":
        raise BadValue("--speed", arguments.speed, f"to go with a bound; this is of the kind {gait.system.kind!r}")
    bounds = gait is not None and gait.system.kind == "bounding"
    solved, measure = (SPEED_BY, "mean_speed") if bounds else ("stance_torque", "flight_time")
    value = arguments.speed if bounds else arguments.flight_time
    target = {} if value is None else {measure: value}
    gait = gait or _hop(arguments, target)
    measured = arguments.over[0] in gait.system.measures
    if measured and target:
        raise BadValue("--over", arguments.over[0], f"another name, or no --{measure.replace('_', '-')}")
    return gait, [solved] if measured or target else [], target


def _hop(arguments: argparse.Namespace, target: dict[str, float]) -> Gait:
    """The hop to begin with."""
    from spear_pin import find_gait, hopping, load
    from spear_pin.hybrid.parameters import with_parameters
    from spear_pin.model.variants import parameters_of, vary
    from spear_pin.studies.hop_of_another import scaled_hopping

    leg, over = one_leg(arguments, ["boom_x"]), arguments.over[0]
    robot = load("spear_ii", locked=["boom_x"]) if leg is None else leg
    at = {} if arguments.at is None else {over: arguments.at}
    if at and over in parameters_of(robot):
        robot, at = vary(robot, **at), {}
    system = hopping(robot) if leg is None else scaled_hopping(robot)
    if over in system.measures:
        target, at = {**target, **at}, {}
    elif leg is None and arguments.at is None and not target:
        return named_gait("hop")
    return find_gait(with_parameters(system, at), ["stance_torque"] if target else [], dict[Any, float](target))


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
