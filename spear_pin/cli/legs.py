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
    group.add_argument("--robot", metavar="ROBOT", help="name of a robot, or path of a URDF, MJCF or TOML file")
    group.add_argument("--leg", metavar="NAME", help="which of its legs (default: the first)")
    group.add_argument("--side", type=int, metavar="±1", help="to which its knee flexes, where the file does not tell")
    group.add_argument("--body", type=float, metavar="KG", help="mass on the slider (default: the leg's share)")
    group.add_argument("--repair", action="store_true", default=None, help="mend inertias that are not possible")


def one_leg(arguments: argparse.Namespace, locked: list[str]) -> Robot | None:
    """The leg as a monopod, every joint of it with a motor unless its TOML file says which; None if no robot is named.

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
    if arguments.body is not None:
        require("--body", arguments.body, lambda mass: mass >= 0, "a finite number >= 0, in kg")
    from dataclasses import replace

    from spear_pin import load, monopod
    from spear_pin.model.loading import sidecar_of

    said = sidecar_of(arguments.robot)
    unsaid: dict[str, Any] = {"base": "fixed"} if said.base is None else {}
    unsaid |= {"motors": "all"} if said.motors is None else {}
    robot = load(arguments.robot, repair=bool(arguments.repair), **unsaid)
    names = [leg.name for leg in robot.legs]
    if not names:
        raise BadValue("--robot", arguments.robot, "a robot with a leg: a hip and a knee about the y axis, and a toe")
    if arguments.leg is not None and arguments.leg not in names:
        raise UnknownName("leg", arguments.leg, names)
    leg = robot.legs[0 if arguments.leg is None else names.index(arguments.leg)]
    side = leg.side if arguments.side is None else arguments.side
    if side not in (-1, 1):
        expected = f"1 or -1: {robot.name} does not tell to which side {leg.knee} flexes"
        raise BadValue("--side", arguments.side, expected if not leg.side else "1 or -1")
    return monopod(robot, replace(leg, side=side), "share" if arguments.body is None else arguments.body, locked)
