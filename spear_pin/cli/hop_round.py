"""`spear hop --robot hoppy`: a leg on a boom that goes round a post."""

from __future__ import annotations

import argparse
import math
from typing import Any

from spear_pin.cli.endings import ended, lost, notes_of
from spear_pin.cli.legs import called, doubted, stability
from spear_pin.cli.output import aligned, iterations, listed, shows
from spear_pin.errors import BadValue

# what `hop` declares of another law, with what it has where nothing is said
OTHERS = {
    "flight_time": None,
    "stance_torque": None,
    "knee": 1.0,
    "frequency": None,
    "stiffness": None,
    "damping": None,
    "hardening": None,
    "preload": None,
    "slope": 0.0,
    "free_x": False,
    "foot_placement": 0.0,
    "hardware": False,
    "current_limit": None,
    "bandwidth": None,
    "noise": None,
    "losses": None,
    "seed": None,
    "leg": None,
    "side": None,
    "body": None,
}


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Find the hop, simulate it and write its files.

    Raises:
        BadValue: an option was given that its law does not have.
        NoGait: it has none.
    """
    from dataclasses import replace

    from spear_pin import Contact, find_gait, load, simulate
    from spear_pin.gaits.round_hopping import round_hopping
    from spear_pin.studies.joint_limits import plausibility
    from spear_pin.studies.round_hop import summarize_round
    from spear_pin.viz.playback.trajectory import read_times
    from spear_pin.viz.player import record, shortened

    for name, unsaid in OTHERS.items():
        if (value := getattr(arguments, name)) != unsaid:
            expected = "to be left out: a robot that goes round a post has its own law and spring"
            raise BadValue(f"--{name.replace('_', '-')}", value, expected)
    robot = load(arguments.robot, repair=bool(arguments.repair))
    system = round_hopping(robot)
    if arguments.friction is not None:
        contact = Contact(friction=arguments.friction)
        system = round_hopping(robot, replace(system.law, unlimited_friction=False), contact=contact)
    with iterations() as tell:
        gait = find_gait(system, on_iteration=tell)
    trajectory = simulate(gait.system, gait.state, arguments.cycles, arguments.rtol, max_step=arguments.max_step)
    end = lost(trajectory, "hop")
    samples = trajectory.save(arguments.out / "hop.npz")
    saved = [gait.save(arguments.out / "hop.json")] if arguments.save else []
    summary = {"lost": end, **summarize_round(gait, trajectory), **plausibility(gait, trajectory)}
    summary |= {"friction": arguments.friction}
    shown = shortened(robot, trajectory)
    page = arguments.out / "hop.html"
    files = [page, samples, *saved]
    title = f"{called(robot)} hopping round its post"
    return summary | {
        "shown": read_times(shown)[[0, -1]],
        "files": [*map(str, files)],
        "pictures": {page: lambda path: record(robot, shown, path, title=title, notes=notes_of(summary))},
        "opened": page,
        "text": _text(summary, [*doubted(summary["implausible"]), *shows(shown), *listed(arguments.out, "hop", files)]),
    }


def _text(summary: dict[str, Any], files: list[tuple[str, str]]) -> str:
    turn, peaks = math.degrees(summary["turn"]), summary["peak_torque"]
    way = "to the left" if turn > 0 else "to the right"
    limit = "no limit" if summary["friction"] is None else f"of {summary['friction']:g}, {summary['slips']} slips"
    rows = [
        *ended(summary["lost"]),
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
        ("energy ledger", f"closes to {summary['energy_residual']:.1e} J a hop"),
        ("simulated", f"{summary['cycles']} hops ({summary['reason']})"),
        *files,
    ]
    return aligned(rows)
