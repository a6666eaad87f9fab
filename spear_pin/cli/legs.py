"""Options that name another robot, and which leg of it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.errors import BadValue, UnknownName, require

if TYPE_CHECKING:
    from spear_pin.model.robot import Robot

OPTIONS = ("leg", "side", "body", "repair")


def add_leg(parser: Any) -> None:
    """Declare --robot, --leg, --side, --body and --repair; `one_leg` reads them. None is said by default."""
    group = parser.add_argument_group("another robot, of which one leg hops; what it rests on is printed")
    group.add_argument("--robot", metavar="ROBOT", help="name of a robot, or path of a URDF or MJCF file")
    group.add_argument("--leg", metavar="NAME", help="which of its legs (default: the first)")
    group.add_argument("--side", type=int, metavar="±1", help="to which its knee flexes, where the file does not tell")
    group.add_argument("--body", type=float, metavar="KG", help="mass on the slider (default: the leg's share)")
    group.add_argument("--repair", action="store_true", default=None, help="mend inertias that are not possible")


def one_leg(arguments: argparse.Namespace, locked: list[str]) -> Robot | None:
    """The leg as a monopod, every joint of it with a motor; None where no other robot is named.

    Raises:
        UnknownName: there is no such robot, or it has no such leg.
        BadValue: an option goes with --robot only, or the robot has no leg of hip and knee.
    """
    given = {name: value for name in OPTIONS if (value := getattr(arguments, name)) is not None}
    if arguments.robot is None:
        if given:
            name, value = next(iter(given.items()))
            raise BadValue(f"--{name}", value, "to go with --robot")
        return None
    if arguments.side not in (None, 1, -1):
        raise BadValue("--side", arguments.side, "1 or -1")
    if arguments.body is not None:
        require("--body", arguments.body, lambda mass: mass >= 0, "a finite number >= 0, in kg")
    from spear_pin import load, monopod
    from spear_pin.model.legs import find_legs

    robot = load(arguments.robot, base="fixed", motors="all", repair=bool(arguments.repair))
    names = [leg.name for leg in robot.legs]
    if not names:
        raise BadValue("--robot", arguments.robot, "a robot with a leg: a hip and a knee about the y axis, and a toe")
    if arguments.leg is not None and arguments.leg not in names:
        raise UnknownName("leg", arguments.leg, names)
    name = arguments.leg or names[0]
    sides = None if arguments.side is None else {name: arguments.side}
    leg = next(leg for leg in find_legs(robot, sides=sides) if leg.name == name)
    if not leg.side:
        expected = f"1 or -1: {robot.name} does not tell to which side {leg.knee} flexes"
        raise BadValue("--side", arguments.side, expected)
    return monopod(robot, leg, "share" if arguments.body is None else arguments.body, locked)
