"""The leg that is pushed down: SPEAR-II's, or one of another robot, with or without its knee's motor."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from spear_pin.cli.legs import name_robot, one_leg, write_leg
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.model.pinned import PinnedLeg
    from spear_pin.model.robot import Robot

FLEXION = (-0.2, 2.5)  # rad: of a knee of which the file does not say how far it turns


def add_drive(parser: argparse._ActionsContainer) -> None:
    """Declare --ratio and --no-motor; `pinned_leg` reads them."""
    drive = parser.add_mutually_exclusive_group()
    drive.add_argument("--ratio", type=float, metavar="N", help="ratio of the knee's gearbox (default: 15)")
    drive.add_argument("--no-motor", action="store_true", help="the belt is off: no rotor turns with the knee")


def add_spring(parser: argparse._ActionsContainer) -> None:
    """Declare --static-rest and --unilateral."""
    text = "the rest angle is where the leg rests under gravity, not where the spring is slack"
    parser.add_argument("--static-rest", action="store_true", help=text)
    parser.add_argument("--unilateral", action="store_true", help="let the spring pull only")


def pinned_leg(arguments: argparse.Namespace, program: Program) -> tuple[PinnedLeg, Robot | None]:
    """Load the leg as --robot, --ratio and --no-motor say, and write the Python for it, which calls it "leg".

    Returns:
        The leg, and the robot out of which it is cut; None for SPEAR-II.
    """
    from spear_pin.model.pinned import pin_toe
    from spear_pin.studies.push_test import spear_ii

    if arguments.ratio is not None and not 0 < arguments.ratio < math.inf:
        raise BadValue("--ratio", arguments.ratio, "a number > 0")
    other = one_leg(arguments, ["boom_x"])
    if other is None:
        ratio = None if arguments.no_motor else 15.0 if arguments.ratio is None else arguments.ratio
        program.let("leg", program.call(spear_ii, ratio=ratio))
        return spear_ii(ratio), None
    named = write_leg(program, arguments, other, ["boom_x"])
    geared = _geared(other, arguments, program, named)
    span = None if _limited(geared) else FLEXION
    program.let("leg", program.call(pin_toe, named, span=span))
    return pin_toe(geared, span=span), other


def _limited(robot: Robot) -> bool:
    """Whether the file says how far the knee may turn; some say turns of it."""
    return max(map(abs, robot.limits["knee"].position)) < 2.0 * math.pi


def _geared(robot: Robot, arguments: argparse.Namespace, program: Program, named: Code) -> Robot:
    """Change another robot's leg as --ratio and --no-motor say, and write the Python for it.

    Raises:
        BadValue: its rotors have no inertia, so that no ratio changes anything.
    """
    from spear_pin.model.variants import vary

    if arguments.no_motor:
        program.let(named, program.call(vary, named, knee_rotor=0.0))
        return vary(robot, knee_rotor=0.0)
    if arguments.ratio is None:
        return robot
    if not robot.model.armature[robot.index("knee")]:
        raise BadValue(
            "--ratio", arguments.ratio, f"to be left out: the knee of {name_robot(robot)} has a rotor without inertia"
        )
    program.let(named, program.call(vary, named, knee_ratio=arguments.ratio))
    return vary(robot, knee_ratio=arguments.ratio)
