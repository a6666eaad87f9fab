"""`spear search`."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_out, add_seed, check_out
from spear_pin.cli.legs import list_doubts, rests_on, stability
from spear_pin.cli.output import align_lines, progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.request import GAIT, add_request, make_request
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from collections.abc import Callable

    from spear_pin.gaits.gait import Gait
    from spear_pin.gaits.request import Request

SAME = 1e-5  # between fixed points that are one


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear search long_stride --speed 2.6", "find a gait with the constraints of long_stride at 2.6 m/s")
    summary = "find a bound by optimisation, without an initial gait"
    parser = add_command(commands, "search", run, summary, example)
    add_request(parser)
    add_seed(parser, "initial guess")
    parser.add_argument(
        "--feedback",
        choices=("none", "regulated", "speed"),
        default="none",
        help="feedback that stabilises the gait (default: none)",
    )
    add_out(parser, "gait.json")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Search the gait, stabilise it and write its file."""
    from dataclasses import asdict

    from spear_pin import simulate
    from spear_pin.gaits.collocation import casadi
    from spear_pin.gaits.feedback import add_feedback, speed_regulated
    from spear_pin.gaits.objectives import in_its_unit
    from spear_pin.gaits.optimize import search
    from spear_pin.gaits.request import OBJECTIVES
    from spear_pin.hybrid.contact import Contact
    from spear_pin.model.scale import scale_of
    from spear_pin.studies.bound import summarize
    from spear_pin.studies.joint_limits import doubts, excesses

    check_out(arguments)
    if arguments.seed < 0:
        raise BadValue("--seed", arguments.seed, "a whole number >= 0")
    program = Program()
    robot, request = make_request(arguments, program)
    casadi()
    ground = Contact(friction=max(Contact().friction, request.friction))
    with progress() as show:

        def tell(iteration: int, objective: float, violation: float) -> None:
            show(f"searching: iteration {iteration}, objective {objective:.4f}, violation {violation:.1e}")

        gait, solution = search(robot, request, seed=arguments.seed, contact=ground, on_iteration=tell)
        if arguments.feedback != "none":
            show(f"designing feedback: {arguments.feedback}")
            stabilise: Callable[[Gait], Gait] = add_feedback if arguments.feedback == "regulated" else speed_regulated
            gait = stabilise(gait)
        trajectory = simulate(gait.system, gait.state, progress=False)
        figures = summarize(gait, trajectory)
    own = {} if ground == Contact() else {"contact": ground}
    named = program.call(search, Code("robot"), Code("request"), seed=arguments.seed, **own)
    program.let("gait, solution", named)
    if arguments.feedback != "none":
        program.let("gait", program.call(stabilise, Code("gait")))
    excess = [] if robot.cut is None else excesses(robot, trajectory)
    shipped = None if robot.varied or robot.cut is not None else _shipped_as(request)
    unit, meaning = OBJECTIVES[request.objective]
    summary = {
        "gait": None if robot.cut is not None else GAIT if arguments.gait is None else arguments.gait,
        "seed": arguments.seed,
        "objective": request.objective,
        "objective_value": in_its_unit(request, scale_of(robot), solution),
        "objective_unit": unit,
        "objective_meaning": meaning,
        "iterations": solution.iterations,
        "violation": max(solution.violations.values()),
        **figures,
        "feedback": arguments.feedback,
        "shipped": shipped,
        "distance_from_shipped": None if shipped is None else _distance(gait, shipped),
        "beyond_limits": [asdict(each) for each in excess],
        "implausible": doubts(gait, excess),
    }
    if robot.cut is not None:
        summary["cut"] = str(robot.cut)
    told = [*rests_on(robot), *list_doubts(summary["implausible"])]
    path = gait.save(arguments.out / "gait.json")
    text = _text(summary, [*told, ("file", str(path))])
    return summary | {"files": [str(path)], "text": text, "python": str(program)}


def _shipped_as(request: Request) -> str | None:
    """Name of the shipped gait of which just this was asked."""
    from spear_pin.gaits.library import REQUESTS

    return next((name for name, asked in REQUESTS.items() if asked == request), None)


def _distance(gait: Gait, shipped: str) -> float:
    """Largest difference of the fixed point's coordinates and velocities from a shipped one's."""
    import numpy as np

    from spear_pin.gaits.gait import Gait

    other = Gait.load(shipped)
    return float(np.abs(np.concatenate(gait.state) - np.concatenate(other.state)).max())


def _text(summary: dict[str, Any], told: list[tuple[str, str]]) -> str:
    def peak(joint: str) -> str:
        torques = [summary["peak_torque"][f"{leg}_{joint}"] for leg in ("posterior", "anterior")]
        return ", ".join(f"{torque:.1f}" for torque in torques) + " N·m (posterior, anterior)"

    rows = [
        ("minimised", f"{summary['objective']}: {summary['objective_meaning']}"),
        ("value", f"{summary['objective_value']:.6g} {summary['objective_unit'].removeprefix('1')}".rstrip()),
        ("optimiser", f"{summary['iterations']} iterations, constraints kept to {summary['violation']:.1e}"),
        ("speed", f"{summary['speed']:.4f} m/s"),
        ("stride", f"{summary['stride']:.4f} m in {summary['period']:.4f} s"),
        *((phase.replace("_", " "), f"{time:.4f} s") for phase, time in summary["durations"].items()),
        ("spring of a leg", f"{summary['stiffness_per_leg']:.2f} N·m/rad"),
        ("knee at touchdown", f"{math.degrees(summary['knee_touchdown']):.2f}°"),
        ("knee motor, peak", peak("knee")),
        ("hip motor, peak", peak("hip")),
        ("friction used", f"{summary['friction_used']:.2f}"),
        ("cost of transport", f"{summary['cost_of_transport']:.3f} (absolute work of the motors)"),
        ("feedback", summary["feedback"]),
        ("multipliers", ", ".join(f"{abs(value):.4f}" for value in summary["multipliers"][:4]) + ", ... (magnitudes)"),
        ("", stability(summary["multipliers"], summary["implausible"])),
        ("fixed point", f"residual {summary['residual']:.1e}"),
    ]
    if summary["shipped"] is not None:
        away = summary["distance_from_shipped"]
        verdict = "the same gait" if away < SAME else "another local optimum: another seed may lead to it"
        rows.append(("shipped gait", f"{summary['shipped']}: {away:.1e} from its fixed point, {verdict}"))
    return align_lines([*rows, *told])
