"""Motors of joints on the command line: `--motor JOINT=MOTOR`, with `--bus` behind gears on a supply."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from spear_pin.cli.pairs import once, words

if TYPE_CHECKING:
    from spear_pin.model.motor import Drive, Motor
    from spear_pin.model.robot import Robot


EFFICIENCY = 0.83  # of gears of which none is given: a two-stage GP 52 C's
GEARS = f"efficiency of these motors' gears (default: {EFFICIENCY}, of a two-stage GP 52 C); needs --bus"


def add_motors(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    group = parser.add_argument_group("motors")
    group.add_argument(
        "--motor",
        type=words,
        action="extend",
        default=[],
        metavar="JOINT=MOTOR",
        help="motors of joints, such as knee=ec_60_flat_100w_48v, for their heat, and with --bus for their electricity"
        " and torque reserve; knee=help lists the catalogue",
    )
    group.add_argument("--bus", type=float, metavar="V", help="voltage of the supply of --motor")
    group.add_argument("--efficiency", type=float, metavar="X", help=GEARS)


def check_motors(arguments: argparse.Namespace) -> None:
    """Refuse a supply or gears that are none, or go without what they are of, before anything is computed.

    Raises:
        BadValue: the option is named.
    """
    from spear_pin.errors import BadValue, require

    if arguments.bus is not None:
        require("--bus", arguments.bus, lambda volts: 0.0 < volts < float("inf"), "a number > 0, in V")
        if not arguments.motor:
            raise BadValue("--bus", arguments.bus, "only with --motor JOINT=MOTOR")
    if arguments.efficiency is not None:
        require("--efficiency", arguments.efficiency, lambda eta: 0.0 < eta <= 1.0, "a number in (0, 1]")
        if arguments.bus is None:
            raise BadValue("--efficiency", arguments.efficiency, "only with --bus, the supply of --motor")


def motors(arguments: argparse.Namespace, robot: Robot) -> dict[str, Motor | Drive]:
    """Motors of the catalogue, by joint, or drives of them where there is a supply.

    Args:
        arguments: of the command.
        robot: whose gears they are behind.

    Raises:
        UnknownName: there is no motor, or no joint with one, of a name.
        BadValue: a joint is given two.
    """
    from spear_pin.model.catalogue import motor
    from spear_pin.model.motor import Drive, Gearbox

    found = {joint: motor(name) for joint, name in once(arguments.motor, "--motor").items()}
    if arguments.bus is None:
        return {**found}
    efficiency = EFFICIENCY if arguments.efficiency is None else arguments.efficiency
    return {
        joint: Drive(each, Gearbox(robot.gear_ratio(joint), efficiency), arguments.bus) for joint, each in found.items()
    }
