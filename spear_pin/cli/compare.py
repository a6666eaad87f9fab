"""`spear compare`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_cycles, add_open, add_out, check_out
from spear_pin.cli.legs import add_leg, one_leg, write_leg
from spear_pin.cli.output import align_lines, join_lines, progress
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait
    from spear_pin.viz.compare import Comparison

PAGE = "compare.html"
CYCLES = 4


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear compare stiffness=40 stiffness=60 --open", "compare SPEAR-II's hop with two springs")
    summary = "tabulate gaits, springs or robots, and how they differ"
    parser = add_command(commands, "compare", run, summary, example)
    parser.more = "items"
    parser.add_argument(
        "items",
        nargs="*",
        metavar="A B",
        help="two to six items, the first is the reference; each is a gait by name or path (.json), a motion (.npz),"
        " a robot by name or path, or a spring, such as stiffness=40,damping=1",
    )
    parser.add_argument("--names", nargs="+", default=[], metavar="NAME", help="a name for each item")
    parser.add_argument("--gait", "--of", dest="of", metavar="GAIT", help="put springs into this gait")
    parser.add_argument(
        "--flight-time", type=float, metavar="S", help="flight time of the hop that springs are put into (default: 0.2)"
    )
    add_cycles(parser, CYCLES, "cycles")
    add_leg(parser, "springs are put into the hop of one of its legs")
    add_out(parser, PAGE)
    add_open(parser, PAGE)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Compare, and write the page."""
    check_out(arguments)
    if arguments.names and len(arguments.items) < len(arguments.names):
        raise BadValue(
            "A B", " ".join(arguments.items), "as many items as names, in front of --names: A B --names NAME NAME"
        )
    from spear_pin.viz.compare import compare

    with progress() as show:
        show("comparing")
        program = Program()
        of, written = _hop_or_gait(arguments, program)
        found = compare(*arguments.items, names=arguments.names, cycles=arguments.cycles, of=of)
    options = {"names": arguments.names, "cycles": arguments.cycles, "of": written}
    program.let("comparison", program.call(compare, *arguments.items, **options))
    program.do(program.method(Code("comparison"), "save", PAGE))
    page: Path = found.save(arguments.out / PAGE)
    return {
        **as_json(found),
        "files": [str(page)],
        "opened": page,
        "text": text(found) + "\n\n" + align_lines([("files", str(page))]),
        "python": str(program),
    }


def _hop_or_gait(arguments: argparse.Namespace, program: Program) -> tuple[Gait | None, Code | None]:
    """Find the gait into which springs are put, if options name it, and write the Python for it."""
    leg, given = one_leg(arguments, ["boom_x"]), {"--robot": arguments.robot, "--flight-time": arguments.flight_time}
    for option, value in given.items():
        if value is not None and arguments.of is not None:
            raise BadValue(option, value, "to be left out with --gait, which already has a robot and a flight time")
        if value is not None and not any("=" in item for item in arguments.items):
            raise BadValue(option, value, "only with springs to compare, such as stiffness=40 stiffness=60")
    if arguments.of is not None:
        from spear_pin.gaits.gait import Gait

        return Gait.load(arguments.of), program.let("gait", program.call(Gait.load, arguments.of))
    if leg is None and arguments.flight_time is None:
        return None, None
    from spear_pin.studies.comparison.sides import usual_hop

    named = None if leg is None else write_leg(program, arguments, leg, ["boom_x"])
    hop = program.let("hop", program.call(usual_hop, leg=named, flight_time=arguments.flight_time))
    return usual_hop(leg, arguments.flight_time), hop


def as_json(found: Comparison) -> dict[str, Any]:
    """A comparison in JSON's terms; what a side does not have is null."""
    return {
        "sides": [
            {
                "label": side.label,
                "kind": side.kind,
                "robot": side.robot.name,
                "multipliers": None if side.gait is None else side.gait.multipliers,
                "stable": None if side.gait is None else side.gait.stable,
            }
            for side in found.sides
        ],
        "said": found.said,
        "measures": [
            {
                "group": row.group,
                "measure": row.name,
                "unit": row.unit,
                "values": row.values,
                "differences": row.changes,
                "percent": row.shares,
            }
            for row in found.measures
        ],
        "parameters": [{"parameter": each.name, "values": each.values} for each in found.differences],
        "notes": [note for side in found.sides for note in side.notes],
    }


def text(found: Comparison) -> str:
    """A comparison as a table."""
    from spear_pin.viz.compare.words import change, number, parameters, percent

    labels = [side.label for side in found.sides]
    head = ["", labels[0], *(part for label in labels[1:] for part in (label, "difference", "%")), ""]
    others = range(1, len(labels))
    rows = [
        [
            row.name,
            number(row.values[0]),
            *(part for i in others for part in (number(row.values[i]), change(row.changes[i]), percent(row.shares[i]))),
            row.unit,
        ]
        for row in found.measures
    ]
    differing = [[each.name, *parameters(each)] for each in found.differences]
    parts = [join_lines([*found.said, *(note for side in found.sides for note in side.notes)]), _table([head, *rows])]
    if differing:
        parts.append(_table([["parameters that differ", *labels], *differing]))
    return "\n\n".join(part for part in parts if part)


def _table(rows: list[list[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(
            cell.rjust(width) if i else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    )
    return join_lines(line.rstrip() for line in lines)
