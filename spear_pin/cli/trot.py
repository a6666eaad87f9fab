"""`spear trot`."""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_simulation, check_simulation
from spear_pin.cli.bound_in_space import check_push, list_checks_in_space, list_push, play_pushed, sections
from spear_pin.cli.legs import name_robot
from spear_pin.cli.output import progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import Rows, write_motion
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait

TROT, PACE, PRONK = "trot", "pace", "pronk"
GOES = {"trotting": TROT, "pacing": PACE, "pronking": PRONK}  # what a kind of gait is called
DRAWN = 4  # strides


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear trot pace --push 0.2", "stabilise the pace that ships, and push it sideways by 0.2 m/s")
    summary = "simulate this package's trot, pace or pronk in 3-D, with pushes"
    parser = add_command(commands, "trot", run, summary, example)
    parser.add_argument(
        "gait",
        nargs="?",
        default=TROT,
        metavar="GAIT",
        help=f"{TROT}, {PACE}, {PRONK} or a saved gait (default: {TROT}); a gait with feedback is simulated as it is",
    )
    parser.add_argument(
        "--push",
        type=float,
        default=0.0,
        metavar="M/S",
        help="lateral velocity added at the start, to the left (default: 0)",
    )
    add_simulation(parser, 10, "strides", "trot.html, trot.svg, trot.npz and trot_steady.json", "trot.html")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Hold the gait by feedback, simulate it and write its files."""
    check_simulation(arguments)
    check_push(arguments.push)
    from spear_pin.gaits.feedback import regulate
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.spatial.law import INPUTS
    from spear_pin.gaits.spatial.trot_law import TrotLaw
    from spear_pin.hybrid.event_feedback import feedback_of
    from spear_pin.studies.bound.in_space import multipliers_of, summarize_in_space
    from spear_pin.viz.plots.space import space_summary

    gait, found, program = _gait(arguments.gait), None, Program()
    named = program.let("gait", program.call(Gait.load, arguments.gait))
    in_a_stride = 2 if gait.system.mirrored_toes else 1
    if feedback_of(gait.system) is None:
        inputs = None if isinstance(gait.system.law, TrotLaw) else INPUTS
        with progress() as show:
            show("finding feedback")
            found = regulate(gait, inputs)
        gait = found.gait
        program.let("gait", Code(f"{program.call(regulate, named, inputs=inputs)}.gait"))
    trajectory, end = play_pushed(arguments, program, gait, arguments.push, in_a_stride)
    figures = summarize_in_space(gait, trajectory)
    figures |= {
        "gait": arguments.gait,
        "goes": GOES[gait.system.kind],
        "push": arguments.push,
        "in_a_stride": in_a_stride,
        "cycles": figures["cycles"] // in_a_stride,
        "stride_time": in_a_stride * figures["period"],
        **multipliers_of(gait, found),
    }
    title = f"{name_robot(gait.system.robot)} {gait.system.kind} at {figures['speed']:.2f} m/s"
    saved = [] if found is None else [gait.save(arguments.out / "trot_steady.json")]
    plot = partial(space_summary, cycles=DRAWN * in_a_stride)
    return write_motion(
        arguments, "trot", gait, trajectory, end, figures, _rows, title=title, program=program, plot=plot, saved=saved
    )


def _gait(name: str) -> Gait:
    """A trot, a pace or a pronk that ships, or was saved.

    Raises:
        UnknownName: none of that name ships.
        BadFile: it is no saved gait.
        BadValue: it is another gait.
    """
    from spear_pin.gaits.gait import Gait

    gait = Gait.load(name)
    if gait.system.kind not in GOES:
        raise BadValue("GAIT", name, f"{TROT}, {PACE}, {PRONK}, or the file of a saved trot, pace or pronk")
    return gait


def _rows(summary: dict[str, Any]) -> Rows:
    by = "half a stride" if summary["in_a_stride"] == 2 else "a stride"
    return [
        ("gait", f"{summary['gait']}, a {summary['goes']} in space"),
        ("speed", f"{summary['speed']:.4f} m/s, a stride in {summary['stride_time']:.4f} s"),
        ("fixed point", f"residual {summary['residual']:.1e}, by {by}"),
        *sections(summary, by),
        *list_push(summary),
        *list_checks_in_space(summary, by),
    ]
