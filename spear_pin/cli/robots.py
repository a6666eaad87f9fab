"""`spear robots`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command


def add(commands: Commands) -> None:
    """Declare the command."""
    add_command(commands, "robots", run, "list the robots that ship")


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Name the robots, and say what they are."""
    from spear_pin.model.loading import ROBOTS, load

    rows = []
    for name, shipped in ROBOTS.items():
        robot = load(name)
        rows.append(
            {
                "name": name,
                "degrees_of_freedom": robot.nv,
                "motors": robot.nu,
                "mass": robot.mass,
                "coordinates": robot.coordinates,
                "toes": robot.toes,
                "summary": shipped.summary,
                "source": shipped.provenance,
            }
        )
    lines = [f"{'robot':<14}{'DoF':>4}{'motors':>8}{'mass':>11}  what it is"]
    for row in rows:
        head = f"{row['name']:<14}{row['degrees_of_freedom']:>4}{row['motors']:>8}{row['mass']:>8.2f} kg"
        lines.append(f"{head}  {row['summary']} ({row['source']})")
    return {"robots": rows, "text": "\n".join(lines)}
