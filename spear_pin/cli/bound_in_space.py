"""`spear bound --space`."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from spear_pin.cli.legs import name_robot, of_the_section, rests_on
from spear_pin.cli.output import progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import Rows, play, write_motion
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.feedback import Regulated
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.trajectory import Trajectory

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
        "--keep-heading", action="store_true", help="return to the heading too; feedback then has ten inputs, not one"
    )


def check(arguments: argparse.Namespace) -> None:
    """Refuse what has no meaning in space, or only there.

    Raises:
        BadValue: it was given.
    """
    if not arguments.space:
        for name in ("push", "keep_heading"):
            if getattr(arguments, name):
                option = f"--{name.replace('_', '-')}"
                raise BadValue(option, getattr(arguments, name), "only with --space")
        return
    if arguments.speed and not arguments.robot:
        raise BadValue("--speed", arguments.speed, "to be left out with --space: name a gait of that speed by --gait")
    check_push(arguments.push)


def check_push(push: float | None) -> None:
    """Refuse a push that is no number, or beyond any robot's speed.

    Raises:
        BadValue: it is.
    """
    if push is not None and not abs(push) <= HARDEST:
        raise BadValue("--push", push, f"a finite number within ±{HARDEST:g}, in m/s")


def run(
    arguments: argparse.Namespace,
    find: Callable[[argparse.Namespace, Program], tuple[str, Gait, list[tuple[str, str]]]],
) -> dict[str, Any]:
    """Simulate a gait of the plane in space, or a saved one in space, and write its files.

    Args:
        arguments: of the command.
        find: the gait of the plane, what it is called, and what there is to say of it; it writes the Python for it.
    """
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.event_feedback import feedback_of
    from spear_pin.hybrid.symmetry import asymmetry
    from spear_pin.studies.bound.in_space import multipliers_of, summarize_in_space
    from spear_pin.viz.plots.space import space_summary

    name, gait, found, told = str(arguments.gait), _saved(arguments), None, list[tuple[str, str]]()
    program = Program()
    if gait is None:
        name, plane, notes = find(arguments, program)
        gait, told = _straight(plane, program), [*notes, *rests_on(plane.system.robot)]
    else:
        program.let("gait", program.call(Gait.load, name))
    if feedback_of(gait.system) is None:
        found = _held(gait, arguments.keep_heading, program)
        gait = found.gait
    push = arguments.push or 0.0
    trajectory, end = play_pushed(arguments, program, gait, push)
    figures = {
        "gait": name,
        "push": push,
        "asymmetry": asymmetry(gait.system.robot, gait.state),
        "inputs": _inputs(gait),
        **summarize_in_space(gait, trajectory),
        **multipliers_of(gait, found),
    }
    title, plot = f"{name_robot(gait.system.robot)} bounding in space at {figures['speed']:.2f} m/s", space_summary
    return write_motion(
        arguments, STEM, gait, trajectory, end, figures, _rows, title=title, program=program, told=told, plot=plot
    )


def _saved(arguments: argparse.Namespace) -> Gait | None:
    """A saved bound in space, if one is named.

    Raises:
        BadValue: an option does not go with it.
    """
    from spear_pin.gaits.gait import Gait
    from spear_pin.hybrid.event_feedback import feedback_of

    if arguments.robot is not None or not str(arguments.gait).endswith(".json"):
        return None
    gait = Gait.load(arguments.gait)
    if gait.system.kind != KIND:
        return None
    if arguments.keep_heading and feedback_of(gait.system) is not None:
        raise BadValue("--keep-heading", True, f"to be left out with {arguments.gait}, which already has feedback")
    return gait


def _straight(plane: Gait, program: Program) -> Gait:
    """Put a gait of the plane into space; the multipliers of Q-SPEAR's are left to what finds feedback for it."""
    import numpy as np

    from spear_pin import in_space
    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.orbits.embedding import embed
    from spear_pin.hybrid.periodic import residual, return_map

    program.let("gait", program.call(in_space, Code("gait")))
    if plane.system.robot.cut is not None:
        with progress() as show:
            show("finding the gait in space, which takes some minutes")
            return in_space(plane)
    system, state = embed(plane)
    durations = {phase: seconds for phase, seconds in return_map(system, state).durations.items() if seconds > 0.0}
    return Gait(system, state, {}, residual(system, state), np.ones(1, complex), durations)


def _held(gait: Gait, heading: bool, program: Program) -> Regulated:
    """Find feedback that keeps a gait upright, and on its heading if that is asked for."""
    from spear_pin.gaits.feedback import regulate
    from spear_pin.gaits.spatial.law import ACROSS

    inputs, weight = (ACROSS, HEADING) if heading else (("posterior_adduction",), 0.0)
    program.let("gait", Code(f"{program.call(regulate, Code('gait'), inputs, heading=weight)}.gait"))
    with progress() as show:
        show("finding feedback, and how it falls sideways without")
        return regulate(gait, inputs, heading=weight)


def _inputs(gait: Gait) -> list[str]:
    """Inputs that the feedback of a gait acts on."""
    from spear_pin.hybrid.event_feedback import feedback_of

    feedback = feedback_of(gait.system)
    return [] if feedback is None else list(feedback.inputs)


def play_pushed(
    arguments: argparse.Namespace, program: Program, gait: Gait, push: float, of: int = 1
) -> tuple[Trajectory, str | None]:
    """Simulate strides of so many cycles, from the gait's state with a push to the left in m/s; see `play`."""
    if not push:
        return play(arguments, program, gait, "stride", of=of, in_space=True)
    q, v = (part.copy() for part in gait.state)
    v[1] += push
    program.let("q, v", Code("(part.copy() for part in gait.state)"))
    program.do(Code(f"v[1] += {push!r}"))
    pushed, remedy = ((q, v), Code("(q, v)")), "a smaller --push"
    return play(arguments, program, gait, "stride", of=of, state=pushed, in_space=True, remedy=remedy)


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


def list_push(summary: dict[str, Any]) -> Rows:
    """Rows with a push, and what is left of it at the end."""
    return [
        ("push", f"{summary['push']:g} m/s to the left" if summary["push"] else "none"),
        ("at the end", f"{summary['aside']:.3f} m aside, heading {math.degrees(summary['heading']):.2f}°"),
        ("largest roll", f"{math.degrees(summary['largest_roll']):.2f}°"),
    ]


def list_checks_in_space(summary: dict[str, Any], by: str = "a stride") -> Rows:
    """Rows with friction, joints and energies of a motion in space; `by` is a cycle of the automaton."""
    return [
        ("friction used", f"{summary['friction_used']:.2f}, across {summary['friction_used_across']:.2f}"),
        ("slips", f"{summary['slips']}"),
        *((part, joint_in_words(summary["joints"][part])) for part in ("adduction", "hip", "knee")),
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J in {by}"),
        ("simulated", f"{summary['cycles']} strides ({summary['reason']})"),
    ]


def _rows(summary: dict[str, Any]) -> Rows:
    inputs = summary["inputs"]
    by = inputs[0].replace("_", " ") if len(inputs) == 1 else f"{len(inputs)} inputs"
    return [
        ("gait", f"{summary['gait']}, in space"),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        ("left and right", f"differ by {summary['asymmetry']:.1e}"),
        *sections(summary),
        ("feedback", f"once a stride to {by}"),
        *list_push(summary),
        *list_checks_in_space(summary),
    ]
