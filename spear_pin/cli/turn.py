"""`spear turn`."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_simulation, check_simulation
from spear_pin.cli.bound_in_space import joint_in_words
from spear_pin.cli.endings import ended, lost, notes_of, patience
from spear_pin.cli.gaits import BOUND, bounding_gait
from spear_pin.cli.legs import called, doubted, of_the_section
from spear_pin.cli.output import aligned, listed, progress, shows
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
    parser = add_command(commands, "turn", run, "find a bounding gait that turns in 3-D and simulate it", example)
    parser.add_argument(
        "gait",
        nargs="?",
        metavar="GAIT",
        help=f"a bounding gait by name or path (default: {BOUND}); one that turns already is simulated as it is",
    )
    by = parser.add_mutually_exclusive_group()
    by.add_argument(
        "--rate", type=float, metavar="DEG_PER_S", help="yaw rate to the left, by the period of the straight gait"
    )
    by.add_argument(
        "--angle",
        type=float,
        metavar="DEG",
        help=f"angle by which a stride turns to the left (default: {ANGLE:g}); negative: right",
    )
    add_simulation(parser, 20, "strides", "turn.html, turn.svg, turn.npz and turn.json", "turn.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Find the gait, simulate it and write its files."""
    check_simulation(arguments)
    for name in ("rate", "angle"):
        given = getattr(arguments, name)
        if given is not None and not (math.isfinite(given) and given):
            raise BadValue(f"--{name}", given, "a finite number other than 0, in °")
    from spear_pin import simulate
    from spear_pin.studies.bound.turn import summarize_turn
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.space import space_summary

    saved = _saved(arguments)
    with progress() as show:
        name, gait = (arguments.gait, saved) if saved is not None else _found(arguments, show)
        show(f"simulating {arguments.cycles} strides")
        most = patience(arguments.cycles)
        options = {"max_step": arguments.max_step, "max_evaluations": most, "progress": False}
        trajectory = simulate(gait.system, gait.state, arguments.cycles, arguments.rtol, **options)
    end = lost(trajectory, "stride")
    files = [] if saved is not None else [gait.save(arguments.out / "turn.json")]
    samples = trajectory.save(arguments.out / "turn.npz")
    summary = {"gait": name, "lost": end, **summarize_turn(gait, trajectory), **plausibility(gait, trajectory)}
    robot = gait.system.robot
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / "turn.html", arguments.out / "turn.svg"
    side, rate = _side(summary), significant(math.degrees(abs(summary["rate"])))
    title = f"{called(robot)} turning {side} by {rate}°/s at {summary['speed']:.2f} m/s"
    files = [page, samples, plots, *files]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": {
            page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary)),
            plots: lambda path: save_figure(space_summary(trajectory, DRAWN), path),
        },
        "opened": page,
        "text": _text(
            summary, [*doubted(summary["implausible"]), *shows(shown), *listed(arguments.out, "turn", files)]
        ),
    }


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
    for name in ("rate", "angle"):
        if getattr(arguments, name) is not None:
            raise BadValue(f"--{name}", getattr(arguments, name), f"none with {path}, which turns as it was found")
    return gait


def _found(arguments: argparse.Namespace, show: Any) -> tuple[str, Gait]:
    """The name of a gait of the plane, and the gait in space that turns, with adductions that are free in stance."""
    import numpy as np

    from spear_pin import SpatialLaw
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.embedding import embedded
    from spear_pin.gaits.orbits.turning import turning
    from spear_pin.hybrid.periodic import residual

    name, plane = bounding_gait(BOUND if arguments.gait is None else arguments.gait, None)
    angle = ANGLE if arguments.angle is None else arguments.angle
    if arguments.rate is not None:
        angle = arguments.rate * plane.period
    if abs(angle) > STEEPEST:
        option, given = ("--angle", angle) if arguments.rate is None else ("--rate", arguments.rate)
        raise BadValue(option, given, f"within ±{STEEPEST:g}° a stride")
    law = SpatialLaw(plane.system.law, adduction_stiffness=0.0, adduction_damping=0.0)
    system, state = embedded(plane, law)
    straight = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
    show("finding out what leads it into a turn")

    def tell(stride: int, change: float) -> None:
        show(f"leading it into the turn: stride {stride}, changes by {change:.1e}; then it is solved for")

    def further(reached: float) -> None:
        show(f"turning by {math.degrees(reached):.3g}° a stride so far")

    return name, turning(straight, math.radians(angle), on_stride=tell, on_turn=further)


def _side(summary: dict[str, Any]) -> str:
    return "left" if summary["turn"] > 0 else "right"


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    turn, rate, roll, drift = (math.degrees(summary[name]) for name in ("turn", "rate", "mean_roll", "drift"))
    values = summary["multipliers"]
    name = "with feedback" if summary["feedback"] else "without feedback"
    rows = [
        *ended(summary["lost"]),
        ("gait", f"{summary['gait']}, turning to the {_side(summary)}"),
        ("turn", f"{significant(abs(turn), 4)}° a stride, {significant(abs(rate), 4)}°/s"),
        ("speed", f"{summary['speed']:.4f} m/s, a stride in {summary['period']:.4f} s"),
        ("radius", f"{summary['radius']:.3f} m"),
        ("lateral acceleration", f"{summary['lateral_acceleration']:.3f} m/s²"),
        ("roll", f"{roll:.2f}° to the right in the mean, {math.degrees(summary['largest_roll']):.2f}° at most"),
        ("drift", f"{drift:.2f}° from the heading to the way, to the left"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *of_the_section(name, values, [None] * len(values), summary["implausible"]),
        *((part, joint_in_words(summary["joints"][part])) for part in ("adduction", "hip", "knee")),
        ("friction used", f"{summary['friction_used']:.2f}, across {summary['friction_used_across']:.2f}"),
        ("slips", f"{summary['slips']}"),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a stride"),
        ("simulated", f"{summary['cycles']} strides ({summary['reason']})"),
        *files,
    ]
    return aligned(rows)
