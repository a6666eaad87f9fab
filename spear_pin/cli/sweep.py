"""`spear sweep`."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import (
    Commands,
    add_command,
    add_open,
    add_rtol,
    add_seed,
    add_workers,
    check_folder,
    folder,
)
from spear_pin.cli.gaits import add_gait, add_wanted, find_named_gait, solved_for, write_gait
from spear_pin.cli.given import refuse
from spear_pin.cli.legs import add_leg, one_leg, rests_on, write_leg
from spear_pin.cli.output import align_lines
from spear_pin.cli.pairs import once
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import ALL, BadFile, BadValue, SpearError, UnknownName
from spear_pin.words import number

if TYPE_CHECKING:
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.hybrid.result import State

NAME = "sweep.zarr"
OUT = "an existing folder, or NAME.zarr in one"
Axes = dict[str, tuple[float, ...]]
MOST = 1_000_000  # values of a parameter


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear sweep hop --over stiffness=46:52:21 --flight-time 0.2",
        "find the hop and its multipliers for 21 stiffnesses, with the same flight time",
    )
    parser = add_command(commands, "sweep", run, "find gaits on a grid, or a random sample, of parameters", example)
    add_gait(parser)
    parser.add_argument(
        "--over",
        action="append",
        required=True,
        metavar="NAME=VALUES",
        help="a parameter and its values: LOW:HIGH:NUMBER, or A,B,..., or LOW:HIGH with --sobol or --latin; repeatable;"
        " help lists all parameters",
    )
    add_wanted(parser)
    sampled = parser.add_mutually_exclusive_group()
    sampled.add_argument("--sobol", type=int, metavar="N", help="take N points of a Sobol sequence instead of a grid")
    sampled.add_argument("--latin", type=int, metavar="N", help="take N points of a Latin hypercube instead of a grid")
    add_seed(parser, "points")
    parser.add_argument(
        "--chunk", type=int, metavar="N", help="number of points in a batch (default: 512, and 1 in 3-D)"
    )
    add_rtol(parser)
    add_workers(parser, 1, "1")
    parser.add_argument("--resume", action="store_true", help="continue a sweep that was interrupted")
    add_leg(parser, "one of its legs hops")
    parser.output.add_argument(
        "--out",
        type=folder,
        default=Path(),
        metavar="DIR",
        help=f"write {NAME} and its map into this folder (default: the current one);"
        " give DIR/NAME.zarr for another name",
    )
    add_open(parser, "the map, sweep.svg,")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Find the gaits, and draw the map."""
    _check(arguments)
    number, method = (arguments.latin, "latin") if arguments.latin else (arguments.sobol, "sobol")
    axes = once((_axis(word, number is not None) for word in arguments.over), "--over")

    from tqdm import tqdm

    from spear_pin.gaits.targets import check_wanted, measures_of
    from spear_pin.hybrid.result import Options
    from spear_pin.studies.sweep import grid, reasons, sample, store, sweep
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.sweep import sweep_map

    Options(rtol=arguments.rtol)
    program = Program()
    system, guess, vary, target = _asked(arguments, set(axes), program)
    _check_names(system, axes)
    points = (
        grid(axes)
        if number is None
        else sample({k: (v[0], v[1]) for k, v in axes.items()}, number, method, arguments.seed)
    )
    check_wanted(system, {**target, **{name: axes[name] for name in axes if name in measures_of(system)}})
    store.require()  # its extra has the engine's too
    with tqdm(total=1, unit="gait", delay=1.0, disable=None, leave=False) as bar:

        def tell(done: int, total: int) -> None:
            if bar.total != total:  # what was done before is no measure of the rate
                bar.total, bar.initial = total, done
                bar.n = done
            bar.update(done - bar.n)

        dataset = sweep(
            system, points, arguments.out, vary, target,
            guess=guess, rtol=arguments.rtol, chunk=arguments.chunk, n_jobs=arguments.workers, resume=arguments.resume,
            on_points=tell,
        )  # fmt: skip
    _write(arguments, program, axes, vary, target, Code("gait.state") if guess else None)
    why = reasons(dataset).tolist()
    counts = {reason: why.count(reason) for reason in sorted(set(why), key=lambda each: -why.count(each))}
    opened, files, found = None, [str(arguments.out)], counts.get("converged", 0)
    if found:
        opened = save_figure(sweep_map(dataset), arguments.out.with_suffix(".svg"))
        files.append(str(opened))
    summary = {"points": len(why), "converged": found, "stable": int(dataset["stable"].sum()), "reasons": counts}
    if system.robot.cut is not None:
        summary["cut"] = str(system.robot.cut)
    told = [*rests_on(system.robot), ("files", ", ".join(files))]
    text = _text(summary, vary, told, dataset)
    return summary | {"vary": vary, "files": files, "opened": opened, "text": text, "python": str(program)}


def _write(
    arguments: argparse.Namespace,
    program: Program,
    axes: Axes,
    vary: list[str],
    target: dict[str, float],
    guess: Code | None,
) -> None:
    """Write the Python of a sweep of the system that is called "system"."""
    from numpy import linspace

    from spear_pin.studies.sweep import grid, sample, sweep

    number, method = (arguments.latin, "latin") if arguments.latin else (arguments.sobol, "sobol")
    if number is None:
        spread = {word.partition("=")[0] for word in arguments.over if ":" in word}
        lines = {name: program.call(linspace, v[0], v[-1], len(v)) if name in spread else v for name, v in axes.items()}
        points = program.let("points", program.call(grid, lines))
    else:
        points = program.let("points", program.call(sample, axes, number, method=method, seed=arguments.seed))
    options = {"guess": guess, "rtol": arguments.rtol, "chunk": arguments.chunk, "n_jobs": arguments.workers}
    solved = {"vary": vary, "target": target or None}
    program.let("dataset", program.call(sweep, Code("system"), points, arguments.out, **solved, **options))


def _check(arguments: argparse.Namespace) -> None:
    """Refuse what makes no sense, before anything is solved for."""
    if arguments.out.suffix != ".zarr" and arguments.out.is_dir():
        arguments.out /= NAME
    if arguments.out.suffix != ".zarr":
        raise BadValue("--out", str(arguments.out), OUT)
    check_folder(arguments.out.parent, str(arguments.out), OUT)
    if arguments.out.exists() and not arguments.resume:
        raise BadFile(arguments.out, "exists already: give another --out, delete it, or --resume")
    for option, least in (("workers", 1), ("chunk", 1), ("seed", 0), ("sobol", 1), ("latin", 1)):
        value = getattr(arguments, option)
        if value is not None and value < least:
            raise BadValue(f"--{option}", value, f"a whole number, at least {least}")
    if arguments.what != "hop":
        typed = "`spear bound --robot NAME --save`, then `spear sweep bound.json`"
        refuse(arguments, f"only with hop; for a bound of this robot type {typed}", "robot")
    if arguments.speed is not None and not 0.0 < arguments.speed < math.inf:
        raise BadValue("--speed", arguments.speed, "a number > 0")


def _axis(word: str, sampled: bool) -> tuple[str, tuple[float, ...]]:
    """A parameter and its values, or its range."""
    if word == ALL:
        return ALL, (1.0,)
    name, _, values = word.partition("=")
    colons = values.count(":")
    try:
        numbers = tuple(number(part) for part in values.split(":" if colons else ","))
    except ValueError:
        numbers = ()
    read = name and numbers and all(map(math.isfinite, numbers))
    if not read or colons > 2 or (sampled and colons != 1):
        form = "NAME=LOW:HIGH" if sampled else "NAME=LOW:HIGH:NUMBER or NAME=A,B,..."
        raise BadValue("--over", word, form)
    if sampled or not colons:
        return name, numbers
    if colons == 1:
        raise BadValue(
            "--over", word, f"the number of values too, such as {word}:5, or --sobol or --latin with a range"
        )
    first, last, count = numbers
    if count % 1 or not 2 <= count <= MOST:
        raise BadValue("--over", word, f"LOW:HIGH:NUMBER with a whole NUMBER of values, 2 to {MOST}")
    steps = int(count) - 1
    return name, tuple(first + (last - first) * i / steps for i in range(steps + 1))


def _asked(
    arguments: argparse.Namespace, names: set[str], program: Program
) -> tuple[HybridSystem, State | None, list[str], dict[str, float]]:
    """The system, a state from which its gait is searched for, what to solve for, and the target."""
    from spear_pin import hopping, load
    from spear_pin.gaits.targets import measures_of
    from spear_pin.studies.hop_of_another import scaled_hopping

    leg = one_leg(arguments, ["boom_x"])
    if arguments.what == "hop":
        system = hopping(load("spear_ii", locked=["boom_x"])) if leg is None else scaled_hopping(leg)
        gait = None
        robot = write_leg(program, arguments, system.robot, ["boom_x"])
        program.let("system", program.call(hopping if leg is None else scaled_hopping, robot))
    else:
        gait = find_named_gait(arguments.what)
        system = gait.system
        write_gait(program, arguments.what)
        program.let("system", Code("gait.system"))
    wanted = solved_for(arguments, gait)
    over = [name for name in measures_of(system) if name in names]
    if over and (wanted.value is not None or len(over) > 1):
        left_out = f"a parameter; for a measure leave out {wanted.option}"
        raise BadValue("--over", over[-1], left_out if wanted.value is not None else "one measure at most")
    target = {} if wanted.value is None else {wanted.measure: wanted.value}
    return system, None if gait is None else gait.state, [wanted.solved] if target or over else [], target


def _check_names(system: HybridSystem, axes: Axes) -> None:
    """Refuse a misspelt name, before anything is missed that is not installed."""
    from spear_pin.gaits.targets import measures_of
    from spear_pin.hybrid.parameters import with_parameters
    from spear_pin.model.variants import parameters_of

    robots = parameters_of(system.robot)
    measures = measures_of(system)
    for name in [name for name in axes if name not in (*robots, *measures)]:
        try:
            with_parameters(system, {name: axes[name][0]})
        except UnknownName as error:
            raise UnknownName("parameter", name, (*error.valid, *robots, *measures)) from None
        except SpearError:
            pass  # the name is known; what its values do, each point tells


def _text(summary: dict[str, Any], vary: list[str], told: list[tuple[str, str]], dataset: Any) -> str:
    share = 100.0 * summary["converged"] / summary["points"]
    rows = [
        ("points", f"{summary['points']}"),
        ("gaits found", f"{summary['converged']} ({share:.1f} %), {summary['stable']} of them stable"),
    ]
    others = {reason: count for reason, count in summary["reasons"].items() if reason != "converged"}
    rows += [("" if i else "not found", f"{count} {reason}") for i, (reason, count) in enumerate(others.items())]
    if summary["converged"]:
        largest = dataset["largest_multiplier"]
        rows.append(("largest multiplier", f"{float(largest.min()):.4f} to {float(largest.max()):.4f}"))
        for name in vary:
            solved = dataset[name]
            rows.append((name.replace("_", " "), f"{float(solved.min()):.4f} to {float(solved.max()):.4f}"))
    return align_lines([*rows, *told])
