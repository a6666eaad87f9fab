"""`spear measures`."""

from __future__ import annotations

import argparse
import textwrap
from typing import Any

from spear_pin.cli.arguments import Commands, add_command
from spear_pin.cli.output import joined

WIDTH = 110  # characters of a line
PLACES = "A word in capitals stands for the name of a joint, toe, phase or event of the robot."


def add(commands: Commands) -> None:
    """Declare the command."""
    example = ("spear measures", "list what --keep, --minimize and --over take: peak torques, work, heights")
    add_command(commands, "measures", run, "list the measures of a cycle, with their units and meanings", example)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """List the measures."""
    from spear_pin.gaits.measures.catalogue import CATALOGUE

    rows = [{"name": each.pattern, "unit": each.unit, "meaning": each.text} for each in CATALOGUE]
    wide = max(len(row["name"]) for row in rows)
    lines = [f"{'measure':<{wide}}  {'unit':<9}meaning"]
    for row in rows:
        head = f"{row['name']:<{wide}}  {'' if row['unit'] == '1' else row['unit']:<9}"
        first, *more = textwrap.wrap(row["meaning"], WIDTH - len(head))
        lines += [head + first, *(" " * len(head) + line for line in more)]
    return {"measures": rows, "text": joined([*lines, "", PLACES])}
