"""`spear bound --space`."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from spear_pin.cli.endings import ended, lost, notes_of, patience
from spear_pin.cli.legs import called, doubted, of_the_section, rests_on
from spear_pin.cli.output import aligned, listed, progress, shows
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.balance import Balance
    from spear_pin.hybrid.result import State

KIND = "bounding_in_space"  # of a gait
STEM = "bound_in_space"  # of its files
HARDEST = 1e3  # m/s of a push
HEADING = 30.0  # weight of the yaw, where the heading is to be kept


def add(parser: argparse.ArgumentParser) -> None:
    """Declare what goes with --space."""
    group = parser.add_argument_group("three dimensions", "feedback once a stride keeps the robot upright")
    group.add_argument("--space", action="store_true", help="simulate the gait in 3-D")
    group.add_argument(
        "--push", type=float, metavar="M/S", help="lateral velocity added at the start, to the left (default: 0)"
    )
    group.add_argument(
        "--keep-heading", action="store_true", help="return to the heading too, with ten inputs instead of one"
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
    if arguments.speed and not arguments.robot:
        raise BadValue("--speed", arguments.speed, "none with --space of Q-SPEAR")
    check_push(arguments.push)


def check_push(push: float | None) -> None:
    """Refuse a push that is no number, or beyond any robot's speed.

    Raises:
        BadValue: it is.
    """
    if push is not None and not abs(push) <= HARDEST:
        raise BadValue("--push", push, f"a finite number within ±{HARDEST:g}, in m/s")


def run(
    arguments: argparse.Namespace, find: Callable[[argparse.Namespace], tuple[str, Gait, list[tuple[str, str]]]]
) -> dict[str, Any]:
    """Simulate a gait of the plane in space, or a saved one in space, and write its files.

    Args:
        arguments: of the command.
        find: the gait of the plane, what it is called, and what there is to say of it.
    """
    from spear_pin import simulate
    from spear_pin.hybrid.symmetry import asymmetry
    from spear_pin.studies.bound.in_space import multipliers_of, summarize_in_space
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened
    from spear_pin.viz.plots import save_figure
    from spear_pin.viz.plots.space import space_summary

    name, gait, found, told = str(arguments.gait), _saved(arguments), None, list[tuple[str, str]]()
    if gait is None:
        name, plane, notes = find(arguments)
        gait, told = _straight(plane), [*notes, *rests_on(plane.system.robot)]
    if not gait.system.law.feedback:
        found = _held(gait, arguments.keep_heading)
        gait = found.gait
    push = arguments.push or 0.0
    cycles, most = arguments.cycles, patience(arguments.cycles)
    trajectory = simulate(
        gait.system, pushed(gait, push), cycles, arguments.rtol, max_step=arguments.max_step, max_evaluations=most
    )
    end = lost(trajectory, "stride", remedy="a smaller --push" if push else "")
    samples = trajectory.save(arguments.out / f"{STEM}.npz")
    saved = [gait.save(arguments.out / f"{STEM}.json")] if arguments.save else []
    robot = gait.system.robot
    summary = {
        "gait": name,
        "push": push,
        "lost": end,
        "asymmetry": asymmetry(robot, gait.state),
        "inputs": _inputs(gait),
        **summarize_in_space(gait, trajectory),
        **multipliers_of(gait, found),
        **plausibility(gait, trajectory),
    }
    shown = shortened(robot, trajectory)
    page, plots = arguments.out / f"{STEM}.html", arguments.out / f"{STEM}.svg"
    title = f"{called(robot)} bounding in space at {summary['speed']:.2f} m/s"
    files = [page, samples, plots, *saved]
    told += [*doubted(summary["implausible"]), *shows(shown), *listed(arguments.out, STEM, files)]
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": {
            page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary)),
            plots: lambda path: save_figure(space_summary(trajectory), path),
        },
        "opened": page,
        "text": _text(summary, told),
    }


def _saved(arguments: argparse.Namespace) -> Gait | None:
    """A saved bound in space, if one is named.

    Raises:
        BadValue: an option does not go with it.
    """
    from spear_pin.gaits.gait import Gait

    if arguments.robot is not None or not str(arguments.gait).endswith(".json"):
        return None
    gait = Gait.load(arguments.gait)
    if gait.system.kind != KIND:
        return None
    if arguments.keep_heading and gait.system.law.feedback:
        raise BadValue("--keep-heading", True, f"none with {arguments.gait}, which has feedback already")
    return gait


def _straight(plane: Gait) -> Gait:
    """A gait of the plane in space; the multipliers of Q-SPEAR's are left to what finds feedback for it."""
    import numpy as np

    from spear_pin import in_space
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.embedding import embedded
    from spear_pin.hybrid.periodic import residual, return_map

    if plane.system.robot.cut is not None:
        with progress() as show:
            show("finding the gait in space, which takes some minutes")
            return in_space(plane)
    system, state = embedded(plane)
    durations = {phase: seconds for phase, seconds in return_map(system, state).durations.items() if seconds > 0.0}
    return Gait(system, state, {}, residual(system, state), np.ones(1, complex), durations)


def _held(gait: Gait, heading: bool) -> Balance:
    """A gait with feedback that keeps it upright, and on its heading if that is asked for."""
    from spear_pin.gaits.orbits.balance import balance
    from spear_pin.gaits.spatial.law import ACROSS

    with progress() as show:
        show("finding feedback, and how it falls sideways without")
        return balance(gait, ACROSS if heading else ("posterior_adduction",), heading=HEADING if heading else 0.0)


def _inputs(gait: Gait) -> list[str]:
    """Inputs that the feedback of a gait acts on."""
    from spear_pin.gaits.spatial.law import INPUTS

    return [name for name, row in zip(INPUTS, gait.system.law.feedback, strict=True) if any(row)]


def pushed(gait: Gait, speed: float) -> State:
    """The state of a gait, moving to the left besides, by a speed in m/s."""
    q, v = (part.copy() for part in gait.state)
    v[1] += speed
    return q, v


def joint_in_words(of: dict[str, float]) -> str:
    """Range, speed, torque and power of a joint, as of `summarize_in_space`."""
    angle = math.degrees(of["range"])
    return f"{angle:.1f}° of range, {of['speed']:.2f} rad/s, {of['torque']:.1f} N·m, {of['power']:.1f} W"


def sections(summary: dict[str, Any], by: str = "") -> list[tuple[str, str]]:
    """Rows with all multipliers without feedback, where they are known, and with it; `by` as of `of_the_section`."""
    rows, doubts = [], [] if summary["push"] else summary["implausible"]  # of a push they say nothing of the gait
    if summary["multipliers_without_feedback"] is not None:
        alone, kinds = summary["multipliers_without_feedback"], summary["kinds_without_feedback"]
        rows = of_the_section("without feedback", alone, kinds, by=by)
    held = of_the_section("with feedback", summary["multipliers"], summary["kinds"], doubts, by)
    return [*rows, *held]


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    inputs = summary["inputs"]
    by = inputs[0].replace("_", " ") if len(inputs) == 1 else f"{len(inputs)} inputs"
    rows = [
        *ended(summary["lost"]),
        ("gait", f"{summary['gait']}, in space"),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("left and right", f"differ by {summary['asymmetry']:.1e}"),
        *sections(summary),
        ("feedback", f"once a stride to {by}"),
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
