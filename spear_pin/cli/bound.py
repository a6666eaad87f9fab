"""`spear bound`."""

from __future__ import annotations

import argparse
import math
from functools import partial
from typing import TYPE_CHECKING, Any

from spear_pin.cli import bound_in_space
from spear_pin.cli.arguments import Commands, add_command, add_simulation, check_simulation
from spear_pin.cli.durations import usual
from spear_pin.cli.gaits import BOUND, bounding_gait
from spear_pin.cli.legs import add_plane, in_the_plane, name_robot, rests_on, stability, write_plane
from spear_pin.cli.output import iterations, join_lines, progress
from spear_pin.cli.python_lines import Program
from spear_pin.cli.writing import Rows, list_checks, play, write_motion
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear bound least_effort --open", "simulate a gait that ships, and open a page that plays it")
    parser = add_command(
        commands, "bound", run, "find and simulate a quadruped's 2-D or 3-D bound, with pushes", example
    )
    one = f"a gait by name or path (default: {BOUND})"
    parser.add_argument("gait", nargs="?", default=argparse.SUPPRESS, action=Once, metavar="GAIT", help=one)
    parser.add_argument("--gait", action=Once, metavar="GAIT", help="the gait, given as an option instead")
    parser.add_argument("--list", action="store_true", help="list the bounding gaits that ship, and do nothing else")
    parser.add_argument(
        "--speed",
        type=float,
        metavar="M/S",
        help="continue the gait to this mean speed, at most 1 m/s from its own; for another robot, search for a gait of"
        f" this speed (default: Q-SPEAR's, scaled); takes {usual('bound', 'speed')}",
    )
    bound_in_space.add(parser)
    add_plane(parser, f"a search finds its bound; it needs casadi and takes {usual('bound', 'robot')}")
    parser.output.add_argument(
        "--save",
        action="store_true",
        help="write the gait to bound.json too, or bound_in_space.json with --space, for GAIT and Gait.load",
    )
    add_simulation(parser, 5, "strides", "bound.html, bound.svg and bound.npz", "bound.html")


class Once(argparse.Action):
    """Stores a value that an argument or an option may give, and refuses a second one."""

    def __call__(self, parser: Any, namespace: argparse.Namespace, values: Any, option_string: Any = None) -> None:
        """Store the value."""
        first = getattr(namespace, self.dest, None)
        if first is not None:
            raise argparse.ArgumentError(self, f"{first!r} and {values!r} are given; give one gait")
        setattr(namespace, self.dest, values)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Simulate the gait and write its files, or list the gaits."""
    if arguments.list:
        return _shipped()
    bound_in_space.check(arguments)
    if arguments.space:
        check_simulation(arguments)
        return bound_in_space.run(arguments, _gait)
    from spear_pin.studies.bound import summarize
    from spear_pin.viz.plots.bound import bound_summary

    if arguments.speed is not None and not 0 < arguments.speed < math.inf:
        raise BadValue("--speed", arguments.speed, "a number > 0, in m/s")
    check_simulation(arguments)
    program = Program()
    name, gait, notes = _gait(arguments, program)
    trajectory, end = play(arguments, program, gait, "stride")
    robot = gait.system.robot
    figures = {"gait": name, **summarize(gait, trajectory)}
    if robot.cut is not None:
        figures |= _searched(gait, figures["friction_used"])
    title, plot = f"{name_robot(robot)} bounding at {figures['speed']:.2f} m/s", partial(bound_summary, gait=gait)
    told = [*notes, *_of_the_search(figures), *rests_on(robot)]
    return write_motion(
        arguments, "bound", gait, trajectory, end, figures, _rows, title=title, program=program, told=told, plot=plot
    )


def _gait(arguments: argparse.Namespace, program: Program) -> tuple[str, Gait, list[tuple[str, str]]]:
    """A gait that is named or searched for, what it is called, and what there is to say of the search."""
    from spear_pin.gaits.gait import Gait
    from spear_pin.studies.bound import at_speed, bound_of

    robot = in_the_plane(arguments)
    if robot is None:
        name, gait = bounding_gait(BOUND if arguments.gait is None else arguments.gait, arguments.speed)
        named = program.let("gait", program.call(Gait.load, name))
        if arguments.speed is not None:
            with iterations() as tell:
                gait = at_speed(gait, arguments.speed, on_iteration=tell)
            program.let("gait", program.call(at_speed, named, arguments.speed))
        return name, gait, []
    if arguments.gait is not None:
        raise BadValue(
            "--gait", arguments.gait, "to be left out with --robot, which searches for a bound of that robot"
        )
    notes: list[tuple[str, str]] = []
    with progress() as show:
        show(f"searching for a bound of {name_robot(robot)}")
        gait = bound_of(
            robot, arguments.speed, on_attempt=lambda speed, why: notes.append((f"at {speed:.2f} m/s", why))
        )
    program.let("gait", program.call(bound_of, write_plane(program, arguments), speed=arguments.speed))
    return name_robot(robot), gait, notes


def _searched(gait: Gait, friction: float) -> dict[str, Any]:
    """What a search for a bound was given, and what of it holds the gait."""
    from spear_pin.gaits.request import Request
    from spear_pin.studies.bound import list_active_bounds, springs_of

    robot = gait.system.robot
    asked = Request.scaled(robot, **springs_of(robot))
    return {"held_by": list_active_bounds(gait, asked, friction)}


def _of_the_search(summary: dict[str, Any]) -> list[tuple[str, str]]:
    if "held_by" not in summary:
        return []
    spring = ("springs", f"{summary['stiffness_per_leg']:.3g} N·m/rad in each knee")
    return [spring, ("held by", "; ".join(summary["held_by"]) or "no bound of the search")]


def _shipped() -> dict[str, Any]:
    """The bounding gaits that ship, by what is written of them: nothing is loaded that computes."""
    from spear_pin.gaits import library

    rows: list[dict[str, Any]] = [
        {
            "name": name,
            "speed": library.REQUESTS[name].speed,
            "lift_off": written["law"]["lift_off"],
            "largest_multiplier": abs(complex(*written["multipliers"][0])),
            "residual": written["residual"],
        }
        for name, written in library.written().items()
        if written["kind"] == "bounding"
    ]
    width = max(len("gait"), *(len(row["name"]) for row in rows)) + 2
    lines = [f"{'gait':<{width}}{'speed':>10}  {'lift-off by':<13}{'largest multiplier':<20}residual"]
    for row in rows:
        head = f"{row['name']:<{width}}{row['speed']:>6.2f} m/s  {row['lift_off']:<13}"
        lines.append(f"{head}{row['largest_multiplier']:<20.4f}{row['residual']:.1e}")
    return {"gaits": rows, "text": join_lines(lines)}


def _rows(summary: dict[str, Any]) -> Rows:
    def legs(key: str, form: str, unit: str) -> str:
        return ", ".join(format(summary[key][leg], form) for leg in ("posterior", "anterior")) + unit

    def torques(key: str, part: str) -> str:
        return ", ".join(f"{summary[key][f'{leg}_{part}']:.1f}" for leg in ("posterior", "anterior"))

    rule = {
        "knee": f"when the knee is back at {math.degrees(summary['knee_rest']):.0f}°",
        "force": "when the normal force is zero",
    }[summary["lift_off"]]
    return [
        ("gait", summary["gait"]),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("stride", f"{summary['stride']:.4f} m in {summary['period']:.4f} s"),
        *((phase.replace("_", " "), f"{time:.4f} s") for phase, time in summary["durations"].items()),
        ("lift-off", f"{rule}; force there {legs('lift_off_force', '.1f', ' N')} (posterior, anterior)"),
        ("peak normal force", legs("peak_force", ".0f", " N")),
        ("friction used", f"{summary['friction_used']:.2f}; at impact {legs('friction_at_impact', '.2f', '')}"),
        ("clearance", f"{legs('clearance', '.3f', ' m')}{'' if summary['scuff_free'] else '; a toe scuffs'}"),
        ("knee motor, peak", f"{torques('peak_torque_stance', 'knee')} N·m in stance"),
        ("", f"{torques('peak_torque_swing', 'knee')} N·m in swing"),
        ("hip motor, peak", f"{torques('peak_torque_stance', 'hip')} N·m in stance"),
        ("", f"{torques('peak_torque_swing', 'hip')} N·m in swing"),
        ("motors", f"net {summary['work']:.2f} J a stride; impacts lose {summary['impact_loss']:.2f} J"),
        ("cost of transport", f"{summary['cost_of_transport']:.3f} (absolute work of the motors)"),
        ("multipliers", stability(summary["multipliers"], summary["implausible"])),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *list_checks(summary, "stride"),
    ]
