"""Files, figures and text of what a command found: of a motion that it simulated, or of a study."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.endings import lost, notes_of, patience, show_ending
from spear_pin.cli.legs import list_doubts
from spear_pin.cli.output import align_lines, list_rows, shows
from spear_pin.cli.python_lines import Code, Program
from spear_pin.words import show_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.measures.catalogue import Measure
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.hybrid.result import State
    from spear_pin.hybrid.trajectory import Trajectory
    from spear_pin.model.robot import Robot

Rows = Sequence[tuple[str, str]]


def play(
    arguments: argparse.Namespace,
    program: Program,
    gait: Gait,
    cycle: str,
    *,
    of: int = 1,
    system: tuple[HybridSystem, Code] | None = None,
    state: tuple[State, Code] | None = None,
    in_space: bool = False,
    remedy: str = "",
) -> tuple[Trajectory, str | None]:
    """Simulate a gait as --cycles, --rtol and --max-step say, and write the line of Python that does.

    Args:
        arguments: of the command.
        program: Python so far, in which the gait is called "gait".
        gait: the gait.
        cycle: what is counted, "hop" or "stride".
        of: cycles of the automaton that make one.
        system: what is simulated, with its source, where it is not the gait's own system.
        state: where it begins, with its source, where that is not the gait's own state.
        in_space: whether it takes the patience of three dimensions.
        remedy: what to try where no cycle is whole.

    Returns:
        The motion, and after how many cycles and why it is lost; None if it is not.

    Raises:
        SpearError: no cycle is whole.
    """
    from spear_pin import simulate

    cycles = of * arguments.cycles
    options: dict[str, Any] = {"rtol": arguments.rtol, "max_step": arguments.max_step}
    played, named = system or (gait.system, Code("gait.system"))
    begun, place = state or (gait.state, Code("gait.state"))
    program.let("trajectory", program.call(simulate, named, place, cycles=cycles, **options))
    if in_space:
        options["max_evaluations"] = patience(cycles)
    trajectory = simulate(played, begun, cycles, **options)
    return trajectory, lost(trajectory, cycle, of, remedy)


def write_motion(
    arguments: argparse.Namespace,
    stem: str,
    gait: Gait,
    trajectory: Trajectory,
    end: str | None,
    figures: dict[str, Any],
    rows: Callable[[dict[str, Any]], Rows],
    *,
    title: str,
    program: Program,
    told: Rows = (),
    plot: Callable[[Trajectory], Figure] | None = None,
    saved: Sequence[Path] = (),
) -> dict[str, Any]:
    """Write samples, page and plots of a motion, and what there is to print of it.

    Args:
        arguments: of the command, with its --out.
        stem: of the files.
        gait: the gait that was simulated.
        trajectory: the motion.
        end: after how many cycles it is lost, and why; None if it is not.
        figures: numbers by name.
        rows: how they read.
        title: of the page.
        program: Python that does the same.
        told: rows after these.
        plot: draws the plots.
        saved: files that are written already; with --save the gait is another.

    Returns:
        What a command returns.
    """
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import save_figure

    robot = gait.system.robot
    if getattr(arguments, "save", False):
        saved = [*saved, gait.save(arguments.out / f"{stem}.json")]
    samples = trajectory.save(arguments.out / f"{stem}.npz")
    summary = {"lost": end, **figures, **plausibility(gait, trajectory)}
    if robot.cut is not None:
        summary["cut"] = str(robot.cut)
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / f"{stem}.html", arguments.out / f"{stem}.svg"
    pictures: dict[Path, Callable[[Path], object]] = {
        page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary))
    }
    if plot is not None:
        draw = plot
        pictures[plots] = lambda path: save_figure(draw(trajectory), path)
    files = [page, samples, *list(pictures)[1:], *saved]
    last = [*told, *list_doubts(summary["implausible"]), *shows(shown), *list_rows(arguments.out, stem, files)]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": pictures,
        "opened": page,
        "text": align_lines([*show_ending(end), *rows(summary), *_added(robot, summary["measures"]), *last]),
        "python": str(program),
    }


def _added(robot: Robot, measures: dict[str, float]) -> Rows:
    """Rows of the measures that commands show behind their own figures."""
    from spear_pin.gaits.measures.catalogue import added, describe_measure, unit_on

    def said(each: Measure, name: str) -> str:
        place, unit = name.removeprefix(each.kind).replace("_", " "), show_unit(unit_on(robot, each, name))
        return f"{place} {measures[name]:.4g} {unit}".strip()

    rows = []
    for each in added():
        own = [name for name in measures if describe_measure(name) is each]
        rows.append((each.kind.replace("_", " ").lower(), ", ".join(said(each, name) for name in own)))
    return rows


def write_study(
    arguments: argparse.Namespace,
    stem: str,
    table: str,
    picture: Figure,
    figures: dict[str, Any],
    texts: Sequence[str],
    *,
    program: Program,
    told: Rows = (),
    saved: Sequence[Path] = (),
) -> dict[str, Any]:
    """Write table and picture of a study, and what there is to print of it.

    Args:
        arguments: of the command, with its --out.
        stem: of the files.
        table: what was found, as JSON.
        picture: the same, drawn.
        figures: numbers by name.
        texts: how they read, in paragraphs.
        program: Python that does the same.
        told: rows before those of the files.
        saved: files that are written already.

    Returns:
        What a command returns.
    """
    from spear_pin.files import write_text
    from spear_pin.viz.plots import save_figure

    path, drawn = arguments.out / f"{stem}.json", arguments.out / f"{stem}.svg"
    files = [write_text(path, table + "\n"), save_figure(picture, drawn), *saved]
    return figures | {
        "files": [str(path) for path in files],
        "opened": drawn,
        "text": "\n\n".join([*texts, align_lines([*told, *list_rows(arguments.out, stem, files)])]),
        "python": str(program),
    }


def list_checks(summary: dict[str, Any], cycle: str) -> Rows:
    """Rows that say how exact a motion is, and how long it is, in these cycles."""
    return [
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a {cycle}"),
        ("simulated", f"{summary['cycles']} {cycle}s ({summary['reason']})"),
    ]
