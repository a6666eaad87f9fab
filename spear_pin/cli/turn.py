"""`spear turn`."""

from __future__ import annotations

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_options, add_simulation, check_simulation
from spear_pin.cli.bound_in_space import list_checks_in_space
from spear_pin.cli.gaits import BOUND, bounding_gait
from spear_pin.cli.given import given, refuse
from spear_pin.cli.legs import name_robot, of_the_section
from spear_pin.cli.output import progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import Rows, play, write_motion
from spear_pin.errors import BadValue
from spear_pin.words import significant

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait

ANGLE = 4.0  # ° a stride
STEEPEST = 50.0  # ° a stride
DRAWN = 4  # strides


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear turn turn_9 --open", "simulate a turn of 9° a stride that ships, and open a page that plays it")
    parser = add_command(commands, "turn", run, "find and simulate a bound that turns in 3-D", example)
    parser.add_argument(
        "gait",
        nargs="?",
        metavar="GAIT",
        help=f"a bounding gait by name or path (default: {BOUND}); a gait that turns already is simulated as it is",
    )
    add_options(
        parser.add_mutually_exclusive_group(),
        float,
        rate=("DEG_PER_S", None, "yaw rate to the left: the angle divided by the period of the straight gait"),
        angle=("DEG", None, f"angle by which a stride turns to the left (default: {ANGLE:g}); negative: right"),
    )
    add_simulation(parser, 20, "strides", "turn.html, turn.svg, turn.npz and turn.json", "turn.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Find the gait, simulate it and write its files."""
    check_simulation(arguments)
    for name, value in given(arguments, "rate", "angle").items():
        if not (math.isfinite(value) and value):
            raise BadValue(f"--{name}", value, "a finite number other than 0, in °")
    from spear_pin.gaits.gait import Gait
    from spear_pin.studies.bound.turn import summarize_turn
    from spear_pin.viz.plots.space import space_summary

    program, saved = Program(), _saved(arguments)
    if saved is None:
        with progress() as show:
            name, gait = _found(arguments, program, show)
    else:
        name, gait = arguments.gait, saved
        program.let("gait", program.call(Gait.load, name))
    trajectory, end = play(arguments, program, gait, "stride", in_space=True)
    figures = {"gait": name, **summarize_turn(gait, trajectory)}
    side, rate = _side(figures), significant(math.degrees(abs(figures["rate"])))
    title = f"{name_robot(gait.system.robot)} turning {side} by {rate}°/s at {figures['speed']:.2f} m/s"
    kept = [gait.save(arguments.out / "turn.json")] if saved is None else []
    plot = partial(space_summary, cycles=DRAWN)
    return write_motion(
        arguments, "turn", gait, trajectory, end, figures, _rows, title=title, program=program, plot=plot, saved=kept
    )


def _saved(arguments: argparse.Namespace) -> Gait | None:
    """A gait in space that was saved, if it is one that is named."""
    from spear_pin.gaits import library
    from spear_pin.gaits.gait import Gait
    from spear_pin.model.chain import CHAIN

    path = arguments.gait
    if path is None or (Path(path).suffix != ".json" and path not in library.TURNS):
        return None
    gait = Gait.load(path)
    if gait.system.robot.coordinates[: len(CHAIN)] != CHAIN:
        return None
    refuse(arguments, f"to be left out with {path}, which has its own turn", "rate", "angle")
    return gait


def _found(arguments: argparse.Namespace, program: Program, show: Any) -> tuple[str, Gait]:
    """The name of a gait of the plane, and the gait in space that turns, with adductions that are free in stance."""
    import numpy as np

    from spear_pin import SpatialLaw, in_space
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.embedding import embed
    from spear_pin.gaits.orbits.turning import find_turn
    from spear_pin.hybrid.periodic import residual

    name, plane = bounding_gait(BOUND if arguments.gait is None else arguments.gait, None)
    angle = ANGLE if arguments.angle is None else arguments.angle
    if arguments.rate is not None:
        angle = arguments.rate * plane.period
    if abs(angle) > STEEPEST:
        option, given = ("--angle", angle) if arguments.rate is None else ("--rate", arguments.rate)
        raise BadValue(option, given, f"a turn within ±{STEEPEST:g}° a stride, not {angle:.3g}°")
    law = SpatialLaw(plane.system.law, adduction_stiffness=0.0, adduction_damping=0.0)
    system, state = embed(plane, law)
    straight = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
    free = {"adduction_stiffness": law.adduction_stiffness, "adduction_damping": law.adduction_damping}
    plane_code = program.let("plane", program.call(Gait.load, name))
    law_code = program.let("law", program.call(SpatialLaw, Code(f"{plane_code}.system.law"), **free))
    in_3d = program.let("straight", program.call(in_space, plane_code, law_code))
    program.let("gait", program.call(find_turn, in_3d, math.radians(angle)))
    show("finding out what leads it into a turn")

    def tell(stride: int, change: float) -> None:
        show(f"leading it into the turn: stride {stride}, changes by {change:.1e}; then it is solved for")

    def further(reached: float) -> None:
        show(f"turning by {math.degrees(reached):.3g}° a stride so far")

    return name, find_turn(straight, math.radians(angle), on_stride=tell, on_turn=further)


def _side(summary: dict[str, Any]) -> str:
    return "left" if summary["turn"] > 0 else "right"


def _rows(summary: dict[str, Any]) -> Rows:
    turn, rate, roll, drift = (math.degrees(summary[name]) for name in ("turn", "rate", "mean_roll", "drift"))
    values = summary["multipliers"]
    name = "with feedback" if summary["feedback"] else "without feedback"
    return [
        ("gait", f"{summary['gait']}, turning to the {_side(summary)}"),
        ("turn", f"{significant(abs(turn), 4)}° a stride, {significant(abs(rate), 4)}°/s"),
        ("speed", f"{summary['speed']:.4f} m/s, a stride in {summary['period']:.4f} s"),
        ("radius", f"{summary['radius']:.3f} m"),
        ("lateral acceleration", f"{summary['lateral_acceleration']:.3f} m/s²"),
        ("roll", f"{roll:.2f}° to the right in the mean, {math.degrees(summary['largest_roll']):.2f}° at most"),
        ("drift", f"{drift:.2f}° from the heading to the way, to the left"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *of_the_section(name, values, [None] * len(values), summary["implausible"]),
        *list_checks_in_space(summary),
    ]
