"""Recovery of bounding gaits from pushes in mid-flight: `python -m benchmarks.recovery`, Markdown on stdout.

Each push is given in the middle of a flight, and the run goes on in the full automaton.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks import markdown
from spear_pin import Gait
from spear_pin.gaits.feedback import add_feedback, speed_regulated
from spear_pin.gaits.library import names
from spear_pin.studies.basin import airborne, midway, push_moment, recover

HEADS = "flight | push | strides to 1 % | error at the section, first and last | ended | domains beside the four"
STRIDES = 25
FLIGHT_SHARE = 0.5
DEGREE = math.pi / 180.0
PUSHES: tuple[tuple[str, str, float, str], ...] = (
    ("v", "torso_x", 0.3, "m/s"),
    ("v", "torso_x", -0.3, "m/s"),
    ("v", "pitch", 0.8, "rad/s"),
    ("v", "pitch", -0.8, "rad/s"),
    ("q", "pitch", 2.0 * DEGREE, "rad"),
    ("q", "pitch", -2.0 * DEGREE, "rad"),
    ("v", "torso_z", 0.15, "m/s"),
    ("v", "torso_z", -0.15, "m/s"),
)


def stabilised(gait: Gait, scheme: str, weight: float = 0.2) -> Gait:
    """The gait with event feedback: "regulated", "speed" or "none"."""
    if scheme == "regulated":
        return add_feedback(gait, weight=weight)
    return speed_regulated(gait) if scheme == "speed" else gait


def recoveries(gait: Gait, strides: int = STRIDES) -> Iterator[dict[str, Any]]:
    """Outcome of each push in each flight."""
    for phase in airborne(gait):
        moment = midway(gait, phase)
        for part, name, size, unit in PUSHES:
            found = recover(gait, push_moment(gait, moment, **{part: {name: size}}), strides)
            yield {
                "phase": phase,
                "push": f"{'d' if part == 'v' else ''}{name}",
                "size": size,
                "unit": unit,
                "strides": found.strides,
                "crossings": len(found.errors),
                "first_error": float(found.errors[0]) if len(found.errors) else None,
                "last_error": float(found.errors[-1]) if len(found.errors) else None,
                "reason": found.reason,
                "message": found.message,
                "domains": list(found.domains),
            }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gait", default="long_stride", choices=names())
    parser.add_argument("--scheme", default="regulated", choices=("regulated", "speed", "none"))
    parser.add_argument("--weight", type=float, default=0.2, help="of the inputs of the regulator")
    parser.add_argument("--strides", type=int, default=STRIDES)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    gait = stabilised(Gait.load(given.gait), given.scheme, given.weight)
    radius = float(np.abs(gait.multipliers[0]))
    if given.json:
        found = list(recoveries(gait, given.strides))
        print(json.dumps({"gait": given.gait, "scheme": given.scheme, "radius": radius, "pushes": found}, indent=1))
        return
    print(f"{given.gait}, {given.scheme}: largest multiplier {radius:.4f}\n")
    markdown.begin(*HEADS.split(" | "))
    for row in recoveries(gait, given.strides):
        errors = f"{row['first_error']:.3g}, {row['last_error']:.1e}" if row["crossings"] else "did not get there"
        lost = "" if row["reason"] == "complete" else f"after {row['crossings']} crossings: {row['message']}"
        cells = (
            row["phase"],
            f"{row['push']} {row['size']:+.3g} {row['unit']}",
            row["strides"] if row["strides"] is not None else "no",
            errors,
            lost,
            ", ".join(row["domains"]),
        )
        markdown.row(*cells)


if __name__ == "__main__":
    main()
