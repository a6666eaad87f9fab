"""`spear dynamics`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, add_loading, add_robot, gather_loading
from spear_pin.cli.legs import add_cut, load_or_cut, rests_on, write_cut
from spear_pin.cli.output import join_lines
from spear_pin.cli.python_lines import Program
from spear_pin.errors import SpearError, list_names


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = (
        "spear dynamics my_robot.urdf",
        "check that this file loads, and print the robot's mass matrix and gravity with all coordinates zero",
    )
    parser = add_command(
        commands, "dynamics", run, "check that a robot's file loads; print mass matrix and gravity", example
    )
    add_robot(parser)
    parser.add_argument(
        "--q",
        type=float,
        nargs="+",
        metavar="Q",
        help="coordinates, in m and rad, in the order that the output names (default: zero)",
    )
    parser.add_argument("--v", type=float, nargs="+", metavar="V", help="velocities, in m/s and rad/s (default: zero)")
    add_loading(parser)
    add_cut(parser)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Evaluate the terms of the equations of motion."""
    import numpy as np
    import pinocchio as pin

    robot = load_or_cut(arguments.robot, arguments, gather_loading(arguments))
    program = Program()
    named = write_cut(program, arguments.robot, arguments, gather_loading(arguments), robot)
    for option, names in (("q", robot.configuration), ("v", robot.coordinates)):
        given = getattr(arguments, option)
        if given is not None and len(given) != len(names):
            has = f"{len(given)} number{'s' if len(given) > 1 else ''}"
            raise SpearError(f"--{option} has {has}; expected {len(names)} ({list_names(names, 8)})")
    q = pin.neutral(robot.model) if arguments.q is None else np.array(arguments.q)
    v = np.zeros(robot.nv) if arguments.v is None else np.array(arguments.v)
    result: dict[str, Any] = {
        "robot": robot.name,
        "coordinates": robot.coordinates,
        "q": q,
        "v": v,
        "D": robot.mass_matrix(q),
        "C": robot.coriolis_matrix(q, v),
        "G": robot.gravity(q),
        "bias": robot.bias(q, v),
        "B": robot.actuation_matrix,
        "J": {toe: robot.toe_jacobian(q, toe) for toe in robot.toes},
        "J_dot_v": {toe: robot.toe_drift(q, v, toe) for toe in robot.toes},
        "toe_position": {toe: robot.toe_position(q, toe) for toe in robot.toes},
    }
    if robot.loops:
        loops = {"gap": robot.loop_gap(q), "A": robot.loop_jacobian(q), "A_dot_v": robot.loop_drift(q, v)}
        result |= {f"loops_{name}": value for name, value in loops.items()}
    if robot.cut is not None:
        result["cut"] = str(robot.cut)
    lines = [f"{robot.name}: {', '.join(robot.coordinates)}  (SI units, radians)"]
    with np.printoptions(precision=6, suppress=True):
        for key, value in [item for item in list(result.items())[2:] if item[0] != "cut"]:
            by_toe = {f" {toe}": array for toe, array in value.items()} if isinstance(value, dict) else {"": value}
            for label, array in by_toe.items():
                lines += (
                    [f"{key}{label} =", *str(array).split("\n")] if array.ndim == 2 else [f"{key}{label} = {array}"]
                )
    lines += [f"{name}: {said}" if name else said for name, said in rests_on(robot)]
    place, speed = program.let("q", q.tolist()), program.let("v", v.tolist())
    for name, given in (("mass_matrix", [place]), ("coriolis_matrix", [place, speed]), ("gravity", [place])):
        program.show(program.method(named, name, *given))
    return result | {"text": join_lines(lines), "python": str(program)}
