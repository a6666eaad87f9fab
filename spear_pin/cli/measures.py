"""`spear measures`."""

from __future__ import annotations

import argparse
import textwrap
from typing import Any

from spear_pin.cli.arguments import Commands, add_command
from spear_pin.cli.output import join_lines
from spear_pin.words import show_unit

WIDTH, WIDE = 110, 28  # characters of a line, and of a name in it
PLACES = (
    "Words in capitals stand for a joint, toe, phase or event, N for a number. Searches take all without (*).\n"
    "Of joints that slide, angles are in m, speeds in m/s and torques in N."
)
MARGINS = "Designs take margin_EVENT as well: how far an event's guard stays from zero."


def add(commands: Commands) -> None:
    """Declare the command."""
    example = ("spear measures", "list names for --keep, --minimize and --over: peak torques, work, heights, ...")
    add_command(commands, "measures", run, "list the measures of a cycle, with their units and meanings", example)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """List the measures."""
    from spear_pin.gaits.measures.catalogue import CATALOGUE

    rows, lines = list[dict[str, Any]](), [f"{'measure':<{WIDE}}{'unit':<9}meaning"]
    for each in CATALOGUE:
        target = each.wanted
        rows.append({"name": each.pattern, "unit": each.unit, "meaning": each.text, "target": target})
        head = f"{each.pattern:<{WIDE}}{show_unit(each.unit):<9}"
        first, *more = textwrap.wrap(each.text + ("" if target else " (*)"), WIDTH - len(head))
        lines += [head + first, *(" " * len(head) + line for line in more)]
    return {"measures": rows, "text": join_lines([*lines, "", *PLACES.splitlines(), MARGINS])}
