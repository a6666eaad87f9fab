"""`spear trot`."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_simulation, check_simulation
from spear_pin.cli.bound_in_space import check_push, joint_in_words, pushed, sections
from spear_pin.cli.endings import ended, lost, notes_of, patience
from spear_pin.cli.legs import called, doubted
from spear_pin.cli.output import aligned, listed, progress, shows
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait

TROT, PACE, PRONK = "trot", "pace", "pronk"
GOES = {"trotting": TROT, "pacing": PACE, "pronking": PRONK}  # what a kind of gait is called
DRAWN = 4  # strides


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear trot pace --push 0.2", "stabilise the pace that ships, and push it sideways by 0.2 m/s")
    summary = "stabilise a trot, a pace or a pronk in 3-D and simulate it"
    parser = add_command(commands, "trot", run, summary, example)
    parser.add_argument(
        "gait",
        nargs="?",
        default=TROT,
        metavar="GAIT",
        help=f"{TROT}, {PACE}, {PRONK} or a saved gait (default: {TROT}); one with feedback is simulated as it is",
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
    from spear_pin import simulate
    from spear_pin.gaits.orbits.balance import balance
    from spear_pin.gaits.spatial.law import INPUTS
    from spear_pin.gaits.spatial.trot_law import TrotLaw
    from spear_pin.studies.bound.in_space import multipliers_of, summarize_in_space
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.space import space_summary

    gait, found = _gait(arguments.gait), None
    in_a_stride = 2 if gait.system.mirrored_toes else 1
    with progress() as show:
        if not gait.system.law.feedback:
            show("finding feedback")
            found = balance(gait, None if isinstance(gait.system.law, TrotLaw) else INPUTS)
            gait = found.gait
        show(f"simulating {arguments.cycles} strides")
        start, cycles = pushed(gait, arguments.push), in_a_stride * arguments.cycles
        most = patience(cycles)
        options = {"max_step": arguments.max_step, "max_evaluations": most, "progress": False}
        trajectory = simulate(gait.system, start, cycles, arguments.rtol, **options)
    end = lost(trajectory, "stride", in_a_stride, "a smaller --push" if arguments.push else "")
    files = [] if found is None else [gait.save(arguments.out / "trot_steady.json")]
    samples = trajectory.save(arguments.out / "trot.npz")
    figures = summarize_in_space(gait, trajectory)
    strides = {"cycles": figures["cycles"] // in_a_stride, "stride_time": in_a_stride * figures["period"]}
    summary = {
        "gait": arguments.gait,
        "goes": GOES[gait.system.kind],
        "push": arguments.push,
        "in_a_stride": in_a_stride,
        "lost": end,
        **figures,
        **strides,
        **multipliers_of(gait, found),
        **plausibility(gait, trajectory),
    }
    robot = gait.system.robot
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / "trot.html", arguments.out / "trot.svg"
    title = f"{called(robot)} {gait.system.kind} at {summary['speed']:.2f} m/s"
    files = [page, samples, plots, *files]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": {
            page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary)),
            plots: lambda path: save_figure(space_summary(trajectory, DRAWN * in_a_stride), path),
        },
        "opened": page,
        "text": _text(
            summary, [*doubted(summary["implausible"]), *shows(shown), *listed(arguments.out, "trot", files)]
        ),
    }


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
        raise BadValue("GAIT", name, f"{TROT}, {PACE}, {PRONK} or a saved one of these")
    return gait


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    by = "half a stride" if summary["in_a_stride"] == 2 else "a stride"
    rows = [
        *ended(summary["lost"]),
        ("gait", f"{summary['gait']}, a {summary['goes']} in space"),
        ("speed", f"{summary['speed']:.4f} m/s, a stride in {summary['stride_time']:.4f} s"),
        ("fixed point", f"residual {summary['residual']:.1e}, by {by}"),
        *sections(summary, by),
        ("push", f"{summary['push']:g} m/s to the left"),
        ("at the end", f"{summary['aside']:.3f} m aside, heading {math.degrees(summary['heading']):.2f}°"),
        ("largest roll", f"{math.degrees(summary['largest_roll']):.2f}°"),
        ("friction used", f"{summary['friction_used']:.2f}, across {summary['friction_used_across']:.2f}"),
        ("slips", f"{summary['slips']}"),
        *((part, joint_in_words(summary["joints"][part])) for part in ("adduction", "hip", "knee")),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J {by}"),
        ("simulated", f"{summary['cycles']} strides ({summary['reason']})"),
        *files,
    ]
    return aligned(rows)
