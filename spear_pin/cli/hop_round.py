"""`spear hop --robot hoppy`: a leg on a boom that goes round a post."""

from __future__ import annotations

import argparse
import math
from typing import Any

from spear_pin.cli.legs import name_robot, stability
from spear_pin.cli.output import iterations
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.writing import Rows, list_checks, play, write_motion


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Find the hop, simulate it and write its files.

    Raises:
        NoGait: it has none.
    """
    from dataclasses import replace

    from spear_pin import Contact, find_gait, load
    from spear_pin.gaits.round_hopping import round_hopping
    from spear_pin.studies.round_hop import summarize_round

    program = Program()
    robot = load(arguments.robot, repair=bool(arguments.repair))
    named = program.let("robot", program.call(load, arguments.robot, repair=bool(arguments.repair)))
    system = round_hopping(robot)
    made = program.let("system", program.call(round_hopping, named))
    if arguments.friction is not None:
        contact, law = Contact(friction=arguments.friction), replace(system.law, unlimited_friction=False)
        changed = program.change(Code(f"{made}.law"), system.law, law)
        made = program.let("system", program.call(round_hopping, named, changed, contact=contact))
        system = round_hopping(robot, law, contact=contact)
    with iterations() as tell:
        gait = find_gait(system, on_iteration=tell)
    program.let("gait", program.call(find_gait, made))
    trajectory, end = play(arguments, program, gait, "hop")
    figures = {**summarize_round(gait, trajectory), "friction": arguments.friction}
    title = f"{name_robot(robot)} hopping round its post"
    return write_motion(arguments, "hop", gait, trajectory, end, figures, _rows, title=title, program=program)


def _rows(summary: dict[str, Any]) -> Rows:
    turn, peaks = math.degrees(summary["turn"]), summary["peak_torque"]
    way = "to the left" if turn > 0 else "to the right"
    limit = "no limit" if summary["friction"] is None else f"of {summary['friction']:g}, {summary['slips']} slips"
    return [
        ("round the post", f"{abs(turn):.2f}° a hop {way}, {abs(summary['speed']):.4f} m/s"),
        ("flight, stance", f"{summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s"),
        *([("apex of the hip", f"{summary['apex_height']:.4f} m")] if summary["apex_height"] is not None else []),
        ("peak ground force", f"{summary['peak_force']:.1f} N"),
        ("friction used", f"{summary['friction_used']:.2f}, of impacts {summary['friction_at_impact']:.2f}; {limit}"),
        ("toe along the boom", f"{1e3 * summary['sway']:.1f} mm in stance, freely"),
        ("peak torques", ", ".join(f"{joint} {torque:.2f} N·m" for joint, torque in peaks.items())),
        ("multipliers", ", ".join(f"{value:.4f}" for value in summary["multipliers"])),
        ("", stability(summary["multipliers"], summary["implausible"])),
        ("fixed point", f"residual {summary['residual']:.1e}"),
        *list_checks(summary, "hop"),
    ]
