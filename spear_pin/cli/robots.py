"""`spear robots`."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.cli.arguments import Commands, add_command
from spear_pin.cli.output import join_lines


def add(commands: Commands) -> None:
    """Declare the command."""
    example = ("spear robots", "list the robots of this package, and those of example-robot-data if that is installed")
    add_command(commands, "robots", run, "list the robots in this package, by name", example)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Name the robots, and say what they are."""
    rows = [*_shipped(), *_examples()]
    lines = [f"{'robot':<28}{'DoF':>4}{'motors':>8}{'mass':>11}  what it is"]
    for row in rows:
        motors = "-" if row["motors"] is None else row["motors"]
        head = f"{row['name']:<28}{row['degrees_of_freedom']:>4}{motors:>8}{row['mass']:>8.2f} kg"
        what = f"{row['summary']} ({row['source']})" if row["summary"] else row["source"]
        lines.append(f"{head}  {what}")
    return {"robots": rows, "text": join_lines(lines)}


def _shipped() -> list[dict[str, Any]]:
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
    return rows


def _examples() -> list[dict[str, Any]]:
    """Those of the other package, read but not loaded: there are many."""
    from spear_pin.model.examples import example_robots, outline, source_of_examples

    rows: list[dict[str, Any]] = []
    for name, path in example_robots().items():
        found = outline(path)
        if found.links:
            unsaid = {"motors": None, "coordinates": None, "toes": None, "summary": None}
            rows.append(
                {
                    "name": name,
                    "degrees_of_freedom": found.degrees_of_freedom,
                    "mass": found.mass,
                    "source": source_of_examples(),
                    **unsaid,
                }
            )
    return rows
