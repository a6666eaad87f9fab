"""Options that name another robot, and which leg of it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import ROBOT, add_repair
from spear_pin.cli.given import refuse
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue, UnknownName, require

if TYPE_CHECKING:
    from collections.abc import Sequence

    from spear_pin.model.robot import Robot
    from spear_pin.model.settings import Settings

NAMES = {"spear_ii": "SPEAR-II", "q_spear": "Q-SPEAR", "q_spear_full": "Q-SPEAR", "hoppy": "HOPPY"}
OPTIONS = ("leg", "bends", "body", "repair")
SEEN = 1e-3  # modulus of a multiplier, below which it is counted, not written
SIDE = "needed if the file does not tell"
SIDES = "1 if posterior and anterior knees point forward, -1 if backward"
BODY = "mass that the leg carries (default: its share of the trunk)"


def add_leg(parser: Any, what: str) -> None:
    """Declare --robot, --leg, --bends, --body and --repair; `one_leg` reads them. None unless they are given.

    Args:
        parser: of the command.
        what: the command does with it, in words.
    """
    group = parser.add_argument_group("another robot", f"{what}; the output says what is assumed")
    group.add_argument("--robot", metavar="ROBOT", help=ROBOT)
    group.add_argument("--leg", metavar="NAME", help="name of the leg (default: the robot's first)")
    group.add_argument("--bends", type=int, metavar="±1", help=f"1 if its knee points forward, -1 if backward; {SIDE}")
    group.add_argument("--body", type=float, metavar="KG", help=BODY)
    add_repair(group)


def add_plane(parser: Any, what: str) -> None:
    """Declare --robot, --bends and --repair; `in_the_plane` reads them. None unless they are given.

    Args:
        parser: of the command.
        what: the command does with it, in words.
    """
    group = parser.add_argument_group("another quadruped in its sagittal plane", what)
    group.add_argument("--robot", metavar="ROBOT", help=ROBOT)
    group.add_argument("--bends", type=int, nargs=2, metavar="±1", help=f"{SIDES}; {SIDE}")
    add_repair(group)


def add_cut(parser: Any) -> None:
    """Declare --leg, --plane, --bends and --body; `load_or_cut` reads them. None unless they are given."""
    group = parser.add_argument_group(
        "part of the robot", "its joints get the names and signs of SPEAR-II (--leg) or Q-SPEAR (--plane)"
    )
    part = group.add_mutually_exclusive_group()
    part.add_argument("--leg", metavar="NAME", help="take this leg, on a slider")
    part.add_argument("--plane", action="store_true", default=None, help="take a quadruped in its sagittal plane")
    group.add_argument(
        "--bends", type=int, nargs="+", metavar="±1", help=f"1 if a knee points forward, -1 if backward; {SIDE}"
    )
    group.add_argument("--body", type=float, metavar="KG", help=BODY)


def in_the_plane(arguments: argparse.Namespace, option: str = "--robot", otherwise: str = "") -> Robot | None:
    """A quadruped in its sagittal plane, as of `add_plane`; None if no robot is named.

    Args:
        arguments: those of `add_plane`.
        option: names the robot in errors.
        otherwise: what a robot without a free trunk can do, in words that end an error.

    Raises:
        UnknownName: there is no such robot.
        BadValue: an option goes with --robot only, the trunk is fixed, or the robot has not two pairs of legs of hip
            and knee.
    """
    from spear_pin.model.fitting import CannotFloat

    try:
        robot = _loaded(arguments, "free")
    except CannotFloat as error:
        fixed = f"the root of its file, {error.root!r}, is fixed (spear robots lists quadrupeds){otherwise}"
        raise BadValue(option, arguments.robot, f"a quadruped whose trunk is free: {fixed}") from None
    if robot is None:
        return None
    plane = _plane(robot, arguments.bends)
    if unknown := [leg.knee for leg in plane.legs if not leg.side]:
        expected = f"1 or -1 for each pair, 1 if {' and '.join(unknown)} point forward as they flex"
        raise BadValue("--bends", None, f"{expected}: the file of {robot.name} does not say")
    return plane


def one_leg(arguments: argparse.Namespace, locked: list[str]) -> Robot | None:
    """The leg as a monopod, or the robot itself if its file has `[reach]`; None if no robot is named.

    Raises:
        UnknownName: there is no such robot, or it has no such leg.
        BadValue: an option goes with --robot only, or the robot has no leg of hip and knee.
    """
    if arguments.robot is not None:
        _check_body(arguments.body)
    robot = _loaded(arguments, "fixed")
    if robot is None or robot.reach is None:
        return None if robot is None else _leg(robot, arguments.leg, arguments.bends, arguments.body, locked)
    refuse(arguments, "to be left out: [reach] of the robot's file is about one leg", *OPTIONS[:3])
    return robot


def load_or_cut(source: str, arguments: argparse.Namespace, options: dict[str, Any]) -> Robot:
    """A robot, or the part of it that `add_cut` asks for.

    Args:
        source: its name, or the path of its file.
        arguments: those of `add_cut`.
        options: of `load`; of a part's robot every joint has a motor, unless they or its TOML file say which.

    Raises:
        UnknownName: there is no such robot, or it has no such leg.
        BadValue: there is no such part, or an option does not go with it.
    """
    from spear_pin import load

    sides = arguments.bends or []
    if arguments.body is not None and arguments.leg is None:
        raise BadValue("--body", arguments.body, "only with --leg")
    if arguments.leg is None and arguments.plane is None:
        if sides:
            raise BadValue("--bends", sides[0], "only with --leg or --plane")
        return load(source, **options)
    _check_body(arguments.body)
    wanted, base = (1, "fixed") if arguments.plane is None else (2, "free")
    if sides and len(sides) != wanted:
        raise BadValue("--bends", sides, f"{wanted} number{'s' if wanted > 1 else ''}, each 1 or -1")
    robot = load(source, **options | _left_open(source, base, options))
    if arguments.leg is None:
        return _plane(robot, sides or None)
    return _leg(robot, arguments.leg, sides[0] if sides else None, arguments.body, [])


def write_leg(program: Program, arguments: argparse.Namespace, robot: Robot, locked: list[str]) -> Code:
    """Write the Python of `one_leg`, or that of SPEAR-II if no robot is named.

    Args:
        program: to which lines are added.
        arguments: those of `add_leg`.
        robot: what `one_leg` returned, or SPEAR-II.
        locked: joints of it that are locked.

    Returns:
        What the robot is called.
    """
    from spear_pin import load

    if arguments.robot is None or robot.source == "spear_ii":
        return program.let("robot", program.call(load, "spear_ii", locked=locked))
    whole = _write_load(program, arguments, "fixed")
    if robot.cut is None:
        return program.let("robot", whole)
    return write_monopod(program, whole, robot, locked, arguments.body, sided=arguments.bends is not None)


def write_monopod(
    program: Program, whole: Code, robot: Robot, locked: list[str], body: float | None, *, sided: bool
) -> Code:
    """Write how a leg was cut out of a robot, and return what it is called.

    Args:
        program: to which lines are added.
        whole: source of the robot out of which it was cut.
        robot: the leg.
        locked: joints of it that are locked.
        body: mass that it carries, in kg; None for its share.
        sided: whether to say on which side its knee is.
    """
    from dataclasses import replace

    from spear_pin import monopod

    assert robot.cut is not None
    leg, options = robot.cut.legs[0][0], dict[str, Any](locked=locked)
    options |= {} if body is None else {"body": body}
    if not sided:
        return program.let("robot", program.call(monopod, whole, leg.name, **options))
    whole = program.let("whole", whole)
    named = Code(f"next(leg for leg in whole.legs if leg.name == {program.source(leg.name)})")
    bent = program.let("leg", program.call(replace, named, side=leg.side))
    return program.let("robot", program.call(monopod, whole, bent, **options))


def write_plane(program: Program, arguments: argparse.Namespace) -> Code:
    """Write the Python of `in_the_plane`, where a robot is named, and return what the robot is called."""
    return write_sagittal(program, _write_load(program, arguments, "free"), arguments.bends)


def write_sagittal(program: Program, whole: Code, sides: Sequence[int] | None = None) -> Code:
    """Write how a robot was cut in its sagittal plane, with knees on these sides, and return what it is called."""
    from dataclasses import replace

    from spear_pin import sagittal

    if sides is None:
        return program.let("robot", program.call(sagittal, whole))
    whole, side = program.let("whole", whole), f"{program.name(replace)}(leg, side=side * leg.knee_sign)"
    pairs = f"zip({program.name(sagittal)}(whole).cut.legs, {list(sides)}, strict=True)"
    sided = program.let("pairs", Code(f"[[{side} for leg in pair] for pair, side in {pairs}]"))
    return program.let("robot", program.call(sagittal, whole, sided))


def write_cut(
    program: Program, source: str, arguments: argparse.Namespace, options: dict[str, Any], robot: Robot
) -> Code:
    """Write the Python of `load_or_cut`, and return what the robot is called.

    Args:
        program: to which lines are added.
        source: name of the robot, or path of its file.
        arguments: those of `add_cut`.
        options: of `load`.
        robot: what `load_or_cut` returned.
    """
    from spear_pin import load

    if arguments.leg is not None or arguments.plane is not None:
        base = "fixed" if arguments.plane is None else "free"
        whole = program.call(load, source, **options | _left_open(source, base, options))
        if arguments.plane is not None:
            return write_sagittal(program, whole, arguments.bends)
        return write_monopod(program, whole, robot, [], arguments.body, sided=bool(arguments.bends))
    return program.let("robot", program.call(load, source, **options))


def _write_load(program: Program, arguments: argparse.Namespace, base: str) -> Code:
    from spear_pin import load

    return program.call(load, arguments.robot, **_unsaid(arguments.robot, base), repair=bool(arguments.repair))


def _plane(robot: Robot, sides: Sequence[int] | None) -> Robot:
    """A quadruped in its sagittal plane, its knees on the sides that its legs have, or on others."""
    from dataclasses import replace

    from spear_pin import sagittal

    if sides is None:
        return sagittal(robot)
    if not set(sides) <= {-1, 1}:
        raise BadValue("--bends", sides, "1 or -1, for the posterior and for the anterior knees")
    cut = sagittal(robot).cut
    pairs = zip(() if cut is None else cut.legs, sides, strict=True)
    return sagittal(robot, [[replace(leg, side=side * leg.knee_sign) for leg in pair] for pair, side in pairs])


def _leg(robot: Robot, name: str | None, side: int | None, body: float | None, locked: list[str]) -> Robot:
    """A leg of a robot as a monopod, the first unless one is named."""
    from dataclasses import replace

    from spear_pin import monopod
    from spear_pin.model.legs import lacking_legs

    names = [leg.name for leg in robot.legs]
    if not names:
        raise BadValue("robot", robot.source, lacking_legs(robot))
    if robot.arm is not None:
        raise BadValue("robot", robot.source, "one whose leg goes round no post, such as hoppy_leg")
    if name is not None and name not in names:
        raise UnknownName("leg", name, names)
    leg = robot.legs[0 if name is None else names.index(name)]
    own = leg.side if side is None else side * leg.knee_sign
    if own not in (-1, 1):
        expected = f"1 if {leg.knee} points forward as it flexes, -1 if backward: the file of {robot.name} does not say"
        raise BadValue("--bends", side, expected if not leg.side else "1 or -1")
    return monopod(robot, replace(leg, side=own), "share" if body is None else body, locked)


def _check_body(body: float | None) -> None:
    if body is not None:
        require("--body", body, lambda mass: mass >= 0, "a finite number >= 0, in kg")


def _loaded(arguments: argparse.Namespace, base: str) -> Robot | None:
    """The robot that is named, every joint of it with a motor unless its TOML file says which."""
    if arguments.robot is None:
        refuse(arguments, "only with --robot", *OPTIONS)
        return None
    from spear_pin import load

    return load(arguments.robot, repair=bool(arguments.repair), **_unsaid(arguments.robot, base))


def _unsaid(source: str, base: str) -> dict[str, Any]:
    """Options of `load` for a robot that is cut, as far as its TOML file does not say them."""
    from spear_pin.model.loading import sidecar_of

    said = sidecar_of(source)
    if said.reach:  # its motors are not on all joints
        return {}
    unsaid: dict[str, Any] = {"base": base} if said.base is None else {}
    return unsaid | ({"motors": "all"} if said.motors is None else {})


def _left_open(source: str, base: str, options: dict[str, Any]) -> dict[str, Any]:
    """What `_unsaid` returns, without what options say."""
    return {name: value for name, value in _unsaid(source, base).items() if options.get(name) is None}


def name_robot(robot: Robot) -> str:
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
    if robot.settings.path:
        lines.append(f"{robot.settings.path} says: {_said(robot.settings)}")
    if not robot.model.armature.any():
        lines.append("rotors without inertia: the file names none")
    what, own = ("the leg", "SPEAR-II") if robot.cut.kind == "monopod" else ("the plane", "Q-SPEAR")
    lines.append(f"springs, gains and torques that neither a file nor an option gives: {own}'s, scaled")
    return [("" if i else what, line) for i, line in enumerate(lines)]


def _said(settings: Settings) -> str:
    """What a TOML file says of springs, motors and gears, in words."""
    alike: dict[str, list[str]] = {}
    for joint in settings.springs:
        alike.setdefault("a spring", []).append(joint)
    if not alike:
        alike["no springs"] = []
    for joint, motor in settings.motors.items():
        alike.setdefault(motor.name, []).append(joint)
    for joint, gear in settings.gears.items():
        numbers = [f"a ratio of {gear.ratio:g}"] if gear.ratio is not None else []
        numbers += [f"a rotor of {gear.rotor:g} kg·m²"] if gear.rotor is not None else []
        alike.setdefault(" and ".join(numbers), []).append(joint)
    if not (settings.motors or settings.gears):
        alike["no motors"] = []
    return "; ".join(f"{what} at the {' and the '.join(joints)}" if joints else what for what, joints in alike.items())


def list_doubts(doubts: Sequence[str]) -> list[tuple[str, str]]:
    """What makes a gait implausible, a line each."""
    return [("" if i else "implausible", doubt) for i, doubt in enumerate(doubts)]


def stability(multipliers: Any, doubts: Sequence[str], kind: str | None = None) -> str:
    """Say whether a gait is stable, and of one that is implausible that too.

    Args:
        multipliers: all of them, the largest first.
        doubts: what makes the gait implausible.
        kind: whether the largest one is "along" or "lateral", if that is known.
    """
    largest = abs(complex(multipliers[0]))
    of_kind = "" if kind is None else f", {kind}"
    said = f"largest {largest:.4f}{of_kind}: {'stable' if largest < 1 else 'unstable'}"
    return f"{said} as computed, but implausible, see below" if doubts else said


def of_the_section(
    name: str, multipliers: Any, kinds: Sequence[str | None], doubts: Sequence[str] = (), by: str = ""
) -> list[tuple[str, str]]:
    """Rows with a verdict, and moduli of all multipliers of a section in space that it follows from.

    Args:
        name: of the rows, such as "with feedback".
        multipliers: all of them, the largest first.
        kinds: of each "along" or "lateral", or None where these are one.
        doubts: what makes the gait implausible.
        by: what a cycle is, where it is not a stride.
    """
    moduli = [abs(complex(each)) for each in multipliers]
    rows = [(name, stability(multipliers, doubts, kinds[0]) + (f", by {by}" if by else ""))]
    for kind in dict.fromkeys(kinds):
        own = [size for size, of in zip(moduli, kinds, strict=True) if of == kind]
        seen = [f"{size:.3f}" for size in own if size >= SEEN]
        small = [f"{len(own) - len(seen)} below {SEEN:g}"] if len(seen) < len(own) else []
        rows.append(("", f"{kind or 'all'}: {', '.join([*seen, *small])}"))
    return rows
