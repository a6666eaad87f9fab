"""Request of a command for a bounding gait: a shipped gait's, or Q-SPEAR's scaled, and the options that change it."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import FREE, Parser, add_options, number_or_free
from spear_pin.cli.legs import add_plane, in_the_plane, write_plane
from spear_pin.cli.motors import EFFICIENCY
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.request import Request
    from spear_pin.model.motor import Drive
    from spear_pin.model.robot import Robot

GAIT = "least_effort"  # of which the request is, unless another is named
MOTORS = 2  # of a joint of the quadruped in the plane, whose legs are pairs
OF_SPRINGS, PER_LEG = ("stiffness", "hardening", "preload"), "_per_leg"
RATIO, BUS = 15.0, 48.0  # of the knee's gearbox; in V


def add_request(parser: Parser) -> None:
    """Declare the gait and the options that `make_request` reads."""
    parser.add_argument(
        "gait",
        nargs="?",
        metavar="GAIT",
        help=f"a gait that ships: it sets what the options below leave out (default: {GAIT})",
    )
    parser.allow_abbrev = False  # --stiffness would be taken for --stiffness-per-leg
    parser.add_argument("--speed", type=float, metavar="M/S", help="mean forward speed")
    parser.add_argument(
        "--minimize",
        "--objective",
        dest="objective",
        metavar="MEASURE",
        help="minimise effort_per_distance, hip, cost_of_transport, peak, electrical or violation",
    )
    parser.add_argument(
        "--lift-off", metavar="RULE", help="lift off when the knee is back at 40° (knee) or at zero force (force)"
    )
    add_options(
        parser,
        float,
        friction=("MU", None, "largest friction coefficient that the gait may use"),
        clearance=("M", None, "least height of the toe in the air during the other's stance"),
        minimum_stride=("S", None, "least duration of a stride"),
        minimum_knee_torque=("N·m", None, "least torque |ū| of a knee motor"),
        hip_torque=("N·m", None, "largest torque of a hip motor"),
    )
    of_a_leg = "of one leg's knee spring"
    parser.add_argument(
        "--stiffness-per-leg", type=number_or_free, metavar="N·m/RAD", help=f"stiffness {of_a_leg}, or free"
    )
    add_options(
        parser,
        float,
        hardening_per_leg=("N·m/RAD³", None, f"hardening {of_a_leg}"),
        preload_per_leg=("N·m", None, f"preload {of_a_leg}"),
    )
    parser.add_argument("--knee-touchdown", type=number_or_free, metavar="DEG", help="knee angle at touchdown, or free")
    parser.add_argument(
        "--knee-motor", metavar="NAME", help="stay within the envelope of this motor, whose rotor turns with the knee"
    )
    add_options(
        parser,
        float,
        ratio=("N", None, f"ratio of the gearbox of --knee-motor (default: {RATIO:g})"),
        bus=("V", None, f"voltage of the supply of --knee-motor (default: {BUS:g})"),
        hip_distance=("M", None, "distance of posterior and anterior hips (default: 0.7)"),
    )
    add_plane(parser, "Q-SPEAR's constraints are scaled to it, and the limits of its joints are kept")


def make_request(arguments: argparse.Namespace, program: Program) -> tuple[Robot, Request]:
    """The robot, and a shipped gait's request, or another robot's, with the options in the place of its own.

    Args:
        arguments: those of `add_request`.
        program: to which the lines are added that make both, called "robot" and "request".

    Returns:
        The robot, varied if options say so, and the request; torques and stiffnesses are those of a pair of legs.

    Raises:
        BadValue: if an option is out of range, or another one is missing.
        UnknownName: if there is no such gait, objective or motor.
    """
    from dataclasses import replace

    from spear_pin.errors import UnknownName
    from spear_pin.gaits import library
    from spear_pin.gaits.library import REQUESTS
    from spear_pin.gaits.request import FLEXED, OBJECTIVES, Request
    from spear_pin.model.loading import load
    from spear_pin.model.scale import scale_of
    from spear_pin.model.variants import vary
    from spear_pin.studies.bound.of_another import springs_of

    shipped = GAIT if arguments.gait is None else arguments.gait
    if shipped not in REQUESTS:
        raise UnknownName("gait", shipped, REQUESTS)
    if arguments.robot is not None and arguments.gait is not None:
        raise BadValue(
            "gait", arguments.gait, "to be left out with --robot: the requests of shipped gaits are Q-SPEAR's"
        )
    if arguments.objective is not None and arguments.objective not in OBJECTIVES:
        raise UnknownName("objective", arguments.objective, OBJECTIVES)
    names = ("speed", "objective", "lift_off", "friction", "clearance", "minimum_stride")
    changes: dict[str, Any] = {name: getattr(arguments, name) for name in names}
    for option in ("minimum_knee_torque", "hip_torque", *(f"{name}{PER_LEG}" for name in OF_SPRINGS)):
        value, name = getattr(arguments, option), option.removesuffix(PER_LEG)
        if value is not None and not (0 <= value < math.inf or (value == FREE and name == "stiffness")):
            raise BadValue(f"--{option.replace('_', '-')}", value, "a finite number >= 0")
        changes[name] = None if value is None else MOTORS * value
    if arguments.knee_touchdown is not None:
        if arguments.knee_touchdown != FREE and not 0 < arguments.knee_touchdown <= math.degrees(FLEXED):
            expected = f"a number > 0, at most {math.degrees(FLEXED):.1f}, in degrees, or free"
            raise BadValue("--knee-touchdown", arguments.knee_touchdown, expected)
        changes["knee_touchdown"] = math.radians(arguments.knee_touchdown)
    given: dict[str, Any] = {
        name: None if value == FREE else value for name, value in changes.items() if value is not None
    }
    other = in_the_plane(arguments)
    robot = load("q_spear") if other is None else other
    named = program.let("robot", program.call(load, "q_spear")) if other is None else write_plane(program, arguments)
    changed = {} if arguments.hip_distance is None else {"hip_distance": arguments.hip_distance}
    drive = _knee_drive(arguments)
    if drive is not None:
        rotor = drive.motor.known("rotor_inertia")
        changed |= {"knee_ratio": drive.gearbox.ratio, "knee_rotor": rotor}
        given["knee_drive"] = drive
    elif arguments.objective in ("electrical", "violation"):
        raise BadValue("--knee-motor", None, f"a motor, which the objective {arguments.objective!r} needs")
    if changed:
        robot, named = vary(robot, **changed), program.let("robot", program.call(vary, named, **changed))
    if other is None:
        base, written = REQUESTS[shipped], Code(f"REQUESTS[{program.source(shipped)}]")
        program.take(library.__name__, "REQUESTS")
    else:
        base = Request.scaled(robot, **springs_of(robot))
        written = program.call(Request.scaled, named, **springs_of(robot))
    request = replace(base, **given)
    request.check(scale_of(robot))
    program.let("request", program.change(written, base, request))
    return robot, request


def _knee_drive(arguments: argparse.Namespace) -> Drive | None:
    from spear_pin.model.catalogue import motor
    from spear_pin.model.motor import Drive, Gearbox

    if arguments.knee_motor is None:
        for name in ("ratio", "bus"):
            if getattr(arguments, name) is not None:
                raise BadValue("--knee-motor", None, f"a motor, which --{name} needs")
        return None
    ratio = RATIO if arguments.ratio is None else arguments.ratio
    bus = BUS if arguments.bus is None else arguments.bus
    drive = Drive(motor(arguments.knee_motor), Gearbox(ratio, EFFICIENCY), bus)
    for quantity in ("torque_constant", "resistance"):
        drive.motor.known(quantity)
    return drive
