"""Options that name a leg, a log and what its columns hold, for `spear fit` and `spear replay`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import add_options, add_repair, check_out
from spear_pin.cli.gaits import find_named_gait, write_gait
from spear_pin.cli.legs import add_cut, load_or_cut, write_cut
from spear_pin.cli.pairs import one_pair, values
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import UnknownName, list_names

if TYPE_CHECKING:
    from spear_pin.hybrid.automaton import HybridSystem
    from spear_pin.studies.logs import Log, LogPhase

LEG = "leg: hop for SPEAR-II's, a robot by name or path (TOML, URDF, MJCF), or a saved gait (.json)"
QUANTITIES = "time, a joint's name for its position, and the name with _rate or _torque"
FILES = "CSV, .mat, .npz or MCAP file, or a folder of files that follow one another"


def add_leg_and_log(parser: Any, several: bool) -> None:
    """Declare LEG, LOG, --column, --unit, --settle, --set, and the options of a leg that is cut out of a robot."""
    parser.add_argument("model", metavar="LEG", help=LEG)
    more = {"nargs": "+", "metavar": "LOG"} if several else {"metavar": "LOG"}
    parser.add_argument("log", help=FILES, **more)
    data = parser.add_argument_group("log", "without these, a TOML file beside it or the columns' own names say it")
    data.add_argument(
        "--column",
        action="append",
        type=one_pair,
        default=[],
        metavar="WHAT=NAME",
        help=f"what is in a column: {QUANTITIES}",
    )
    data.add_argument(
        "--unit", action="append", type=one_pair, default=[], metavar="NAME=UNIT", help="unit of a column, by its name"
    )
    add_options(data, float, settle=("S", 0.012, "time left out after each touchdown"))
    model = parser.add_argument_group("model")
    model.add_argument(
        "--set",
        type=values,
        action="extend",
        default=[],
        metavar="NAME=VALUE",
        help="other values of the model's numbers, separated by commas",
    )
    add_repair(model)
    add_cut(parser)


def _leg_system(arguments: argparse.Namespace, program: Program) -> tuple[HybridSystem, Code]:
    """The leg as a system, and its source: of a saved gait, or of a robot with the springs of its file."""
    from spear_pin import hopping
    from spear_pin.studies.hop_of_another import scaled_hopping

    word = arguments.model
    if word.endswith(".json") or word == "hop":
        return find_named_gait(word).system, Code(f"{write_gait(program, word)}.system")
    options: dict[str, Any] = {"repair": True} if arguments.repair else {}
    robot = load_or_cut(word, arguments, options)
    build = hopping if robot.cut is None else scaled_hopping
    return build(robot), program.call(build, write_cut(program, word, arguments, options, robot))


def leg_and_logs(arguments: argparse.Namespace, program: Program) -> tuple[HybridSystem, Code, list[Log], list[Code]]:
    """The leg and the logs that are named, each with its source."""
    from spear_pin.studies.logs import Log

    check_out(arguments)
    system, leg = _leg_system(arguments, program)
    columns, units = dict(arguments.column) or None, dict(arguments.unit) or None
    valid = _quantities(system)
    for name in columns or ():
        if name not in valid:
            raise UnknownName("quantity in --column", name, valid)
    given: dict[str, Any] = {name: value for name, value in {"columns": columns, "units": units}.items() if value}
    paths = arguments.log if isinstance(arguments.log, list) else [arguments.log]
    logs = [Log.read(path, **given) for path in paths]
    names = ["log"] if len(paths) == 1 else [f"log_{i}" for i in range(1, len(paths) + 1)]
    read = [program.call(Log.read, path, **given) for path in paths]
    return system, leg, logs, [program.let(name, code) for name, code in zip(names, read, strict=True)]


def _quantities(system: HybridSystem) -> list[str]:
    """What a log may have of a leg."""
    of_joints = [f"{joint}{ending}" for joint in system.robot.coordinates for ending in ("", "_rate", "_torque")]
    return ["time", "mode", *of_joints]


def notes(
    system: HybridSystem, logs: Sequence[Log], left_out: Sequence[LogPhase], doubts: Sequence[str] = ()
) -> list[str]:
    """What has to be known, in lines."""
    lines, valid = [f"note: {remark}" for log in logs for remark in log.remarks], _quantities(system)
    for log in logs:
        if others := [name for name in log.values if name not in valid]:
            lines.append(f"note: {log.source}: not of this leg: {list_names(others, 8)}")
    lines += [
        f"note: {phase.source}: left out: {phase.name} from {phase.begin:.3f} s: {phase.left_out}" for phase in left_out
    ]
    lines += ["synthetic, not measured"] if any(log.synthetic for log in logs) else []
    return [*lines, *(f"warning: {doubt}" for doubt in doubts)]
