"""`spear payoff`."""

from __future__ import annotations

import argparse
import math
import os
import warnings
from collections.abc import Callable, Sequence
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import (
    Commands,
    add_command,
    add_open,
    add_options,
    add_out,
    add_repair,
    add_robot,
    add_workers,
    check_out,
)
from spear_pin.cli.given import name_options, refuse, write_typed
from spear_pin.cli.legs import BODY, SIDE, in_the_plane, name_robot, one_leg, rests_on, write_leg, write_plane
from spear_pin.cli.motors import EFFICIENCY
from spear_pin.cli.output import align_lines, progress
from spear_pin.cli.pairs import RANGE, once, ranges
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue, RobotWarning, SpearError, UnknownName, require
from spear_pin.words import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from spear_pin.model.motor import Drive
    from spear_pin.model.robot import Robot
    from spear_pin.studies.payoff import Answer, SearchEnd, Study
    from spear_pin.studies.payoff.verdict import Judgement

QUADRUPED, LEG = "q_spear", "spear_ii"  # robots that are in the plane as they ship


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear payoff solo12 --leg FL", "ask whether a spring in the knee saves energy when this leg hops")
    summary = "tell if a fixed or a switched spring in the knee saves energy"
    parser = add_command(commands, "payoff", run, summary, example)
    add_robot(parser)
    parser.add_argument(
        "--leg",
        metavar="NAME",
        help="let this leg hop in place; help lists the legs (default: a quadruped bounds, a robot with one leg hops)",
    )
    parser.add_argument(
        "--bends",
        type=int,
        nargs="+",
        metavar="±1",
        help=f"1 if a knee points forward, -1 if backward: one number with --leg, else two, posterior first; {SIDE}",
    )
    parser.add_argument("--body", type=float, metavar="KG", help=f"{BODY}; for hops")
    add_repair(parser)
    four = "(default: four, by the robot's size)"
    parser.add_argument("--speeds", type=numbers, metavar="A,B,...", help=f"speeds of bounds, in m/s {four}")
    parser.add_argument("--flight-times", type=numbers, metavar="A,B,...", help=f"flight times of hops, in s {four}")
    parser.add_argument(
        "--stiffnesses",
        type=numbers,
        metavar="A,B,...",
        help="stiffnesses of a leg's spring, in N·m/rad, or N/m along a path (default: five around the optimum)",
    )
    parser.add_argument(
        "--spring",
        metavar="NAME",
        help="spring of the TOML file, such as one along a path; for hops (default: the only one, or the knee's)",
    )
    parser.add_argument(
        "--over",
        type=ranges,
        action="extend",
        default=[],
        metavar=RANGE,
        help="choose these numbers, too, at each point: knee_motor_size=0.5:3 of a shipped leg, with the motor's mass,"
        " or of the spring's path, cable.end_z=0.04:0.06; for hops",
    )
    motors = parser.add_argument_group(
        "motors", "by default those of the robot's TOML file, else motors of the catalogue scaled to the robot"
    )
    for part in ("knee", "hip"):
        motors.add_argument(
            f"--{part}-motor",
            metavar="NAME",
            help=f"motor of a {part}, from the catalogue, instead of the default; help lists them",
        )
        motors.add_argument(
            f"--{part}-ratio",
            type=float,
            metavar="N",
            help=f"ratio of its gearbox; needs --{part}-motor (default: the file's)",
        )
    add_options(
        motors,
        float,
        efficiency=("X", None, f"efficiency of these motors' gears (default: {EFFICIENCY})"),
        bus=("V", None, "voltage of the motors' supply (default: their nominal voltage)"),
    )
    add_workers(parser, None, "one for each processor")
    add_out(parser, "payoff.html, its pictures and gaits, and payoff.jsonl, from which an interrupted study goes on,")
    add_open(parser, "payoff.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Search, and write the page."""
    check_out(arguments)
    for name in ("speeds", "flight_times", "stiffnesses"):
        values = getattr(arguments, name)
        if values is not None and (values[0] <= 0 or list(values) != sorted(set(values))):
            raise BadValue(
                f"--{name.replace('_', '-')}",
                write_typed(values),
                "numbers > 0, each greater than the one before",
            )
    if arguments.workers is not None and arguments.workers < 1:
        raise BadValue("--workers", arguments.workers, "a whole number, at least 1")
    check_motors(arguments)

    from spear_pin import load
    from spear_pin.files import write_text
    from spear_pin.model.legs import WITHOUT_LOOPS
    from spear_pin.model.loading import sidecar_of
    from spear_pin.studies.payoff import answer, rests_of
    from spear_pin.viz.payoff import as_json, render
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.payoff import FIGURES

    if sidecar_of(arguments.robot).loops:
        raise BadValue("robot", arguments.robot, WITHOUT_LOOPS)
    hop = arguments.leg is not None or len(_legs(arguments)) == 1
    robot, study_of, speeds = (_hops if hop else _bounds)(arguments)
    with name_options(bus="--bus"):
        drives = make_drives(arguments, robot)
    program = Program()
    given = {"speeds": speeds, "stiffnesses": arguments.stiffnesses, "drives": drives or None, "bus": arguments.bus}
    given |= {"over": once(arguments.over, "--over") or None, "spring": arguments.spring}
    own = {name: value for name, value in given.items() if value is not None} | {
        "n_jobs": arguments.workers or os.cpu_count()
    }
    if hop:
        named = write_leg(program, arguments, robot, ["boom_x"])
    elif robot.cut is None:
        named = program.let("robot", program.call(load, arguments.robot))
    else:
        named = write_plane(program, arguments)
    store = program.call(Path, arguments.out / "payoff.jsonl")
    program.let("study", program.call(study_of, named, store, **own))
    program.show(Code(f"{program.call(answer, Code('study'))}.sentence"))
    with progress() as show, name_options(over="--over", bus="--bus", spring="--spring"):
        study = study_of(robot, arguments.out / "payoff.jsonl", **{"drives": {}} | own, tell=show)
    found = answer(study)
    name = name_robot(robot).removesuffix(",")
    of_robot = [(label, text) for label, text in rests_on(robot) if not text.startswith("rotors without")]
    rests = [*rests_of(study), *of_robot]
    files = {"page": arguments.out / "payoff.html"}

    @cache
    def drawn() -> dict[str, Figure]:
        return {key: draw(study) for key, draw in FIGURES.items()}

    def write(path: Path) -> None:
        write_text(path, render(study, found, name, rests, drawn()))

    def save(key: str, path: Path) -> None:
        save_figure(drawn()[key], path)

    pictures: dict[Path, Callable[[Path], object]] = {files["page"]: write}
    for key in FIGURES:
        pictures[arguments.out / f"payoff_{key}.svg"] = partial(save, key)
    saved = _save(study, arguments.out)
    listed = [*pictures, *saved, arguments.out / "payoff.jsonl"]
    return {
        **as_json(study, found),
        "robot": name,
        "files": [str(path) for path in listed],
        "pictures": pictures,
        "opened": files["page"],
        "text": _text(study, found, rests, listed),
        "python": str(program),
    }


def _legs(arguments: argparse.Namespace) -> list[str]:
    """The names of the robot's legs, of which one alone can but hop; warnings are for when it is loaded to be used."""
    from spear_pin import load

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        return [leg.name for leg in load(arguments.robot, repair=bool(arguments.repair)).legs]


def _bounds(arguments: argparse.Namespace) -> tuple[Robot, Callable[..., Study], Sequence[float] | None]:
    """The robot in its sagittal plane, its study, and the speeds that were asked for."""
    from spear_pin import load
    from spear_pin.gaits.collocation import casadi
    from spear_pin.studies.payoff import bounds

    refuse(arguments, "only with --leg", "body", "flight_times", "over", "spring")
    casadi()
    if arguments.robot == QUADRUPED:
        refuse(arguments, f"to be left out: the sides of {QUADRUPED} are known", "bends")
        return load(QUADRUPED), bounds, arguments.speeds
    if arguments.bends is not None and len(arguments.bends) != 2:
        raise BadValue(
            "--bends", arguments.bends, "two numbers, for the posterior and for the anterior knees; with --leg one"
        )
    robot = in_the_plane(arguments, "robot", f"; for hops of one leg type --leg {_legs(arguments)[0]}")
    assert robot is not None
    return robot, bounds, arguments.speeds


def _hops(arguments: argparse.Namespace) -> tuple[Robot, Callable[..., Study], Sequence[float] | None]:
    """The leg on its slider, its study, and the flight times that were asked for."""
    from spear_pin import load
    from spear_pin.studies.payoff import hops

    refuse(arguments, "to be left out for one leg: for a hop give --flight-times", "speeds")
    if arguments.robot == LEG:
        refuse(arguments, f"to be left out: {LEG} is one leg", "leg", "bends", "body")
        return load(LEG, locked=["boom_x"]), hops, arguments.flight_times
    bends, *more = arguments.bends or [None]
    if more:
        raise BadValue("--bends", arguments.bends, "one number with --leg")
    robot = one_leg(argparse.Namespace(**vars(arguments) | {"bends": bends}), ["boom_x"])
    assert robot is not None
    return robot, hops, arguments.flight_times


def numbers(word: str) -> tuple[float, ...]:
    """Read numbers between commas."""
    try:
        values = tuple(number(part) for part in word.split(","))
    except ValueError:
        values = ()
    if not values or not all(map(math.isfinite, values)):
        raise argparse.ArgumentTypeError(
            f"{word!r} is no list of numbers; expected finite numbers separated by commas, such as 1.5,2"
        )
    return values


def check_motors(arguments: argparse.Namespace) -> None:
    """Refuse options of motors that can be none or that nothing uses, before a robot is loaded."""
    from spear_pin.model.catalogue import MOTORS, motor

    for name in ("bus", "efficiency", "knee_ratio", "hip_ratio"):
        value = getattr(arguments, name)
        if value is not None:
            require(f"--{name.replace('_', '-')}", value, lambda x: x > 0, "a number > 0")
    named = {part: getattr(arguments, f"{part}_motor") for part in ("knee", "hip")}
    for part, name in named.items():
        if name is None:
            if getattr(arguments, f"{part}_ratio") is not None:
                raise BadValue(f"--{part}-motor", None, f"a value, which --{part}-ratio needs")
            continue
        if name not in MOTORS:
            raise UnknownName("motor", name, MOTORS)
        motor(name).check_known()
    if arguments.efficiency is not None and not any(named.values()):
        raise BadValue("--efficiency", arguments.efficiency, "only with --knee-motor or --hip-motor")


def make_drives(arguments: argparse.Namespace, robot: Robot) -> dict[str, Drive]:
    """Make the drives that options name; a gear ratio that is not given is the one in the robot's file."""
    from spear_pin.model.catalogue import motor
    from spear_pin.model.motor import Drive, Gearbox
    from spear_pin.studies.payoff.motors import ratio_of, supply_voltage

    found = {}
    for part in ("knee", "hip"):
        name, ratio = getattr(arguments, f"{part}_motor"), getattr(arguments, f"{part}_ratio")
        if name is None:
            continue
        ratio = ratio or ratio_of(robot, part)
        if ratio is None:
            raise BadValue(f"--{part}-ratio", None, f"a value, as {robot.source} has no gear ratio of its {part}s")
        own = motor(name)
        bus = supply_voltage(own, arguments.bus)
        found[part] = Drive(own, Gearbox(ratio, arguments.efficiency or EFFICIENCY), bus)
    return found


def _save(study: Study, out: Path) -> list[Path]:
    """Write the best gaits, where their robot can be told in a file."""
    saved = []
    for kind, finding in study.best.items():
        try:
            saved.append(study.gait(finding).save(out / f"payoff_{kind}.json"))
        except SpearError:
            continue
    return saved


def _text(study: Study, found: Answer, rests: list[tuple[str, str]], files: list[Path]) -> str:
    from spear_pin.studies.payoff.figures import most

    words = study.gaits.words

    def said(finding: SearchEnd) -> str:
        figures = finding.figures
        assert figures is not None
        knee, hip = (most(figures.peak, part) for part in ("knee", "hip"))
        unstable = ": unstable" if figures.multiplier > 1.0 else ""
        spring = f"{figures.stiffness:.3g} {words.unit}, " if finding.point.kind != "none" else ""
        spring += f"{words.of_numbers(figures.chosen)}, " * bool(figures.chosen)
        return (
            f"{figures.cost:.4f}, {study.gaits.energy(study.robot, figures):.3g} J:"
            f" {spring}peak knee {knee:.3g}, hip {hip:.3g} N·m,"
            f" heat {max(figures.heat.values()):.2f} of continuous, multiplier {figures.multiplier:.3f}{unstable}"
        )

    def share(saved: Judgement, kind: str) -> str:
        value = saved.saving[kind]
        if math.isnan(value):
            return f"{kind} unknown"
        return f"{kind} {100 * value:.1f} %" + (", not sure" if saved.pays[kind] is None else "")

    rows = [("answer", found.sentence)]
    rows += [(f"best, {kind}", said(each)) for kind, each in study.best.items()]
    rows += [
        ("" if i else "saved", f"{words.pace.format(speed)}: {', '.join(share(saved, kind) for kind in saved.saving)}")
        for i, (speed, saved) in enumerate(found.by_speed.items())
    ]
    spread = "one search each found the best points"
    if not math.isnan(found.spread):
        spread = f"starts of the best points, each with one stiffness, differ by {100 * found.spread:.2g} %"
    mesh = "none of them was found" if math.isnan(found.mesh) else f"they change by {100 * found.mesh:.2g} %"
    rows.append(("doubt", f"{spread}, {mesh} on a finer mesh"))
    rows += [("" if i else "beware", caution) for i, caution in enumerate(found.cautions)]
    rows += rests[:2]
    failed = sum(1 for each in study.searches if each.reason)
    rows.append(("searches", f"{len(study.searches)}, {failed} without a gait; {study.seconds:.0f} s of a processor"))
    rows.append(("files", ", ".join(map(str, files))))
    return align_lines(rows)
