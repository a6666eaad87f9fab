"""`spear bound --space`."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.legs import called, rests_on
from spear_pin.cli.output import aligned, listed, progress, shows
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.result import State

HEADING = 30.0  # weight of the yaw, where the heading is to be kept


def add(parser: argparse.ArgumentParser) -> None:
    """Declare what goes with --space."""
    group = parser.add_argument_group("in space; kept upright by feedback once a stride")
    group.add_argument("--space", action="store_true", help="bound in three dimensions")
    group.add_argument(
        "--push", type=float, metavar="M/S", help="sideways, to the left, at the begin (default: 0); with --space"
    )
    group.add_argument(
        "--keep-heading", action="store_true", help="turn back too, by ten inputs instead of one; with --space"
    )


def check(arguments: argparse.Namespace) -> None:
    """Refuse what has no meaning in space, or only there.

    Raises:
        BadValue: it was given.
    """
    if not arguments.space:
        for name in ("push", "keep_heading"):
            if getattr(arguments, name):
                raise BadValue(f"--{name.replace('_', '-')}", getattr(arguments, name), "none without --space")
        return
    if arguments.save:
        raise BadValue("--save", arguments.save, "none with --space")
    if arguments.speed and not arguments.robot:
        raise BadValue("--speed", arguments.speed, "none with --space of Q-SPEAR")
    if arguments.push is not None and not math.isfinite(arguments.push):
        raise BadValue("--push", arguments.push, "a finite number, in m/s")


def run(arguments: argparse.Namespace, name: str, plane: Gait, notes: list[tuple[str, str]]) -> dict[str, Any]:
    """Simulate a gait of the plane in space and write its files.

    Args:
        arguments: of the command.
        name: of the gait.
        plane: it.
        notes: what there is to say of it.
    """
    import numpy as np

    from spear_pin import in_space, simulate
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.balance import across, balanced
    from spear_pin.gaits.orbits.embedding import embedded
    from spear_pin.gaits.spatial.law import ACROSS
    from spear_pin.hybrid.periodic import eigenvalues, residual
    from spear_pin.hybrid.symmetry import asymmetry
    from spear_pin.studies.bound.in_space import summarize_in_space
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.space import space_summary

    inputs = ACROSS if arguments.keep_heading else ("posterior_adduction",)
    with progress() as show:
        if plane.system.robot.cut is None:
            system, state = embedded(plane)
            gait = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
        else:
            show("finding the gait in space, which takes some minutes")
            gait = in_space(plane)
        show("finding out how it falls sideways")
        falls = eigenvalues(across(gait, ()).A)
        show("finding feedback")
        gait = balanced(gait, inputs, heading=HEADING if arguments.keep_heading else 0.0)
    trajectory = simulate(
        gait.system, pushed(gait, arguments.push or 0.0), arguments.cycles, arguments.rtol, max_step=arguments.max_step
    )
    samples = trajectory.save(arguments.out / "bound_in_space.npz")
    summary = {
        "gait": name,
        "push": arguments.push or 0.0,
        "asymmetry": asymmetry(gait.system.robot, gait.state),
        "inputs": list(inputs),
        "multipliers_without_feedback": falls,
        **summarize_in_space(gait, trajectory),
    }
    robot = gait.system.robot
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / "bound_in_space.html", arguments.out / "bound_in_space.svg"
    title = f"{called(plane.system.robot)} bounding in space at {summary['speed']:.2f} m/s"
    files = [page, samples, plots]
    told = [*notes, *rests_on(plane.system.robot), *shows(shown), *listed(arguments.out, "bound_in_space", files)]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": {
            page: lambda path: record(robot, shown, path, title=title),
            plots: lambda path: save_figure(space_summary(trajectory), path),
        },
        "opened": page,
        "text": _text(summary, told),
    }


def pushed(gait: Gait, speed: float) -> State:
    """The state of a gait, moving to the left besides, by a speed in m/s."""
    q, v = (part.copy() for part in gait.state)
    v[1] += speed
    return q, v


def joint_in_words(of: dict[str, float]) -> str:
    """Range, speed, torque and power of a joint, as of `summarize_in_space`."""
    angle = math.degrees(of["range"])
    return f"{angle:.1f}° of range, {of['speed']:.2f} rad/s, {of['torque']:.1f} N·m, {of['power']:.1f} W"


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    fall, held = abs(summary["multipliers_without_feedback"][0]), abs(summary["multipliers"][0])
    inputs = summary["inputs"]
    by = inputs[0].replace("_", " ") if len(inputs) == 1 else f"{len(inputs)} inputs"
    rows = [
        ("gait", f"{summary['gait']}, in space"),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("left and right", f"differ by {summary['asymmetry']:.1e}"),
        ("across", f"largest multiplier {fall:.3f}: {'upright by itself' if fall < 1 else 'falls sideways'}"),
        ("with feedback", f"{held:.3f}, once a stride to {by}"),
        ("push", f"{summary['push']:g} m/s to the left"),
        ("at the end", f"{summary['aside']:.3f} m aside, heading {math.degrees(summary['heading']):.2f}°"),
        ("largest roll", f"{math.degrees(summary['largest_roll']):.2f}°"),
        ("friction used", f"{summary['friction_used']:.2f}, across {summary['friction_used_across']:.2f}"),
        ("slips", f"{summary['slips']}"),
        *((part, joint_in_words(summary["joints"][part])) for part in ("adduction", "hip", "knee")),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a stride"),
        ("simulated", f"{summary['cycles']} strides ({summary['reason']})"),
        *files,
    ]
    return aligned(rows)
