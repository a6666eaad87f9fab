"""Options that name another robot, and which leg of it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.errors import BadValue, UnknownName, require

if TYPE_CHECKING:
    from collections.abc import Sequence

    from spear_pin.model.robot import Robot

NAMES = {"spear_ii": "SPEAR-II", "q_spear": "Q-SPEAR"}
OPTIONS = ("leg", "side", "body", "repair")


def add_leg(parser: Any) -> None:
    """Declare --robot, --leg, --side, --body and --repair; `one_leg` reads them. None is said by default."""
    group = parser.add_argument_group("another robot, of which one leg hops; what it rests on is printed")
    group.add_argument("--robot", metavar="ROBOT", help="name of a robot, or path of a URDF, MJCF or TOML file")
    group.add_argument("--leg", metavar="NAME", help="which of its legs (default: the first)")
    group.add_argument(
        "--side", type=int, metavar="±1", help="where its knee points, 1 forward, if the file does not tell"
    )
    group.add_argument("--body", type=float, metavar="KG", help="mass on the slider (default: the leg's share)")
    group.add_argument("--repair", action="store_true", default=None, help="mend inertias that are not possible")


def add_plane(parser: Any, what: str) -> None:
    """Declare --robot, --side and --repair; `in_the_plane` reads them. None is said by default.

    Args:
        parser: of the command.
        what: the command does with it, in words.
    """
    group = parser.add_argument_group(f"another quadruped, {what} in its sagittal plane")
    group.add_argument("--robot", metavar="ROBOT", help="name of a robot, or path of a URDF, MJCF or TOML file")
    group.add_argument(
        "--side",
        type=int,
        nargs=2,
        metavar="±1",
        help="where the posterior and the anterior knees point, 1 forward, where the file does not tell",
    )
    group.add_argument("--repair", action="store_true", default=None, help="mend inertias that are not possible")


def in_the_plane(arguments: argparse.Namespace) -> Robot | None:
    """A quadruped in its sagittal plane, as of `add_plane`; None if no robot is named.

    Raises:
        UnknownName: there is no such robot.
        BadValue: an option goes with --robot only, or the robot has not two pairs of legs of hip and knee.
    """
    robot = _loaded(arguments, "free")
    if robot is None:
        return None
    from dataclasses import replace

    from spear_pin import sagittal

    if arguments.side is None:
        return sagittal(robot)
    if not set(arguments.side) <= {-1, 1}:
        raise BadValue("--side", arguments.side, "1 or -1, for the posterior and for the anterior knees")
    cut = sagittal(robot).cut
    pairs = zip(() if cut is None else cut.legs, arguments.side, strict=True)
    return sagittal(robot, [[replace(leg, side=side * leg.knee_sign) for leg in pair] for pair, side in pairs])


def one_leg(arguments: argparse.Namespace, locked: list[str]) -> Robot | None:
    """The leg as a monopod, as of `add_leg`; None if no robot is named.

    Raises:
        UnknownName: there is no such robot, or it has no such leg.
        BadValue: an option goes with --robot only, or the robot has no leg of hip and knee.
    """
    if arguments.body is not None and arguments.robot is not None:
        require("--body", arguments.body, lambda mass: mass >= 0, "a finite number >= 0, in kg")
    robot = _loaded(arguments, "fixed")
    if robot is None:
        return None
    from dataclasses import replace

    from spear_pin import monopod

    names = [leg.name for leg in robot.legs]
    if not names:
        raise BadValue("--robot", arguments.robot, "a robot with a leg: a hip and a knee about the y axis, and a toe")
    if arguments.leg is not None and arguments.leg not in names:
        raise UnknownName("leg", arguments.leg, names)
    leg = robot.legs[0 if arguments.leg is None else names.index(arguments.leg)]
    side = leg.side if arguments.side is None else arguments.side * leg.knee_sign
    if side not in (-1, 1):
        expected = f"1 if {leg.knee} points forward as it flexes, -1 if backward: {robot.name} does not tell"
        raise BadValue("--side", arguments.side, expected if not leg.side else "1 or -1")
    return monopod(robot, replace(leg, side=side), "share" if arguments.body is None else arguments.body, locked)


def _loaded(arguments: argparse.Namespace, base: str) -> Robot | None:
    """The robot that is named, every joint of it with a motor unless its TOML file says which."""
    given = {name: value for name in OPTIONS if (value := getattr(arguments, name, None)) is not None}
    if arguments.robot is None:
        if given:
            name, value = next(iter(given.items()))
            raise BadValue(f"--{name}", value, "to go with --robot")
        return None
    from spear_pin import load
    from spear_pin.model.loading import sidecar_of

    said = sidecar_of(arguments.robot)
    unsaid: dict[str, Any] = {"base": base} if said.base is None else {}
    unsaid |= {"motors": "all"} if said.motors is None else {}
    return load(arguments.robot, repair=bool(arguments.repair), **unsaid)


def called(robot: Robot) -> str:
    """A robot as titles name it: one that was cut out of another as that one."""
    cut = robot.cut
    if cut is None:
        return NAMES.get(robot.name, robot.name)
    return f"{cut.of}, leg {cut.legs[0][0].name}," if cut.kind == "monopod" else cut.of


def rests_on(robot: Robot) -> list[tuple[str, str]]:
    """What was cut out of another robot, and what is not known of it; nothing for a robot as it is."""
    if robot.cut is None:
        return []
    lines = [line.strip() for line in str(robot.cut).splitlines()]
    if robot.settings is not None:
        said = [f"a spring at the {joint}" for joint in robot.settings.springs]
        said += [f"{motor.name} at the {joint}" for joint, motor in robot.settings.motors.items()]
        lines.append(f"{robot.settings.path} says: {', '.join(said) or 'no springs, nor motors'}")
    if not robot.model.armature.any():
        lines.append("rotors without inertia: the file names none")
    what = "the leg" if robot.cut.kind == "monopod" else "the plane"
    return [("" if i else what, line) for i, line in enumerate(lines)]


def doubted(doubts: Sequence[str]) -> list[tuple[str, str]]:
    """What makes a gait implausible, a line each."""
    return [("" if i else "implausible", doubt) for i, doubt in enumerate(doubts)]


def stability(multipliers: Any, doubts: Sequence[str]) -> str:
    """Whether a gait is stable, in words; of one that is implausible that is said with it."""
    largest = abs(multipliers[0])
    said = f"largest {largest:.4f}: {'stable' if largest < 1 else 'unstable'}"
    return f"{said} as computed, but implausible, see below" if doubts else said
