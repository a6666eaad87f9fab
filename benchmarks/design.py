"""Tables of docs/results/design.md: families of gaits, spring with gears and motor, least excess over an envelope.

`python -m benchmarks.design [--only families designs excess] [--json]`: Markdown on stdout, in about twenty minutes.
Needs casadi.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks import markdown
from spear_pin import Gait, load
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.library import REQUESTS
from spear_pin.gaits.optimize import search
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.variants import vary
from spear_pin.studies.design import against, codesign, electrical_cost, family, points, smallest_violation

ROBOT = load("q_spear")
KNEE_GEARS, BUS = Gearbox(15.0, 0.83), 48.0  # V
MOTORS = ("ec_60_flat_100w_48v", "ec_90_flat_260w", "assumed_600w")
RATIOS = (6.0, 8.0, 10.0, 12.0, 15.0, 20.0)
STARTS = {"least_effort": 20, "long_stride": 6}
BRANCHES: tuple[tuple[str, tuple[float, ...]], ...] = (  # each leads away from the reference, in small steps
    ("hip_distance", (0.65, 0.6, 0.55)),
    ("hip_distance", (0.75, 0.8, 0.849)),
    ("torso_inertia", (1.6, 1.05)),
    ("torso_inertia", (3.0, 4.2)),
    ("knee_ratio", (10.0, 7.5)),
    ("knee_ratio", (20.0, 30.0)),
    ("hip_ratio", (90.0, 120.0)),
    ("stiffness", (56.0, 0.0)),
    ("stiffness", (200.0, 300.0, 400.0)),
)
SAME = 1e-3  # N·m: between gaits that are one
Row = dict[str, Any]


def drive(name: str) -> Drive:
    """A motor of the catalogue behind the knee's gears."""
    return Drive(motor(name), KNEE_GEARS, BUS)


def measured(gait: Gait, solution: Solution) -> Row:
    """Row of the table of families for a gait; the effort, in N²·m·s, is a metre's, of all motors."""
    return {
        "effort_per_distance": 100.0 * solution.objective / PAIR,
        "knee_peak": points(gait).peak.tolist(),
        "hip_peak": np.abs(points(gait, "hip").torque).max(axis=0).tolist(),
        "largest_multiplier": float(np.abs(gait.multipliers[0])),
        "residual": gait.residual,
    }


def families() -> Iterator[Row]:
    """The reference, the long stride, and the branches that begin at it."""
    request = REQUESTS["long_stride"]
    gait, solution = search(ROBOT, request)
    yield {"varied": "nothing"} | measured(gait, solution)
    for name, values in BRANCHES:
        for member in family(ROBOT, request, name, values, solution):
            row: Row = {"varied": name, "value": member.value / PAIR if name == "stiffness" else member.value}
            found = member.gait is not None and member.solution is not None
            yield row | (measured(member.gait, member.solution) if found else {"reason": member.reason})


def designs() -> Iterator[Row]:
    """The cheapest spring and touchdown angle for each motor and ratio."""
    request = REQUESTS["least_effort"]
    _, solution = search(ROBOT, request)
    for found in codesign(ROBOT, request, {name: drive(name) for name in MOTORS}, RATIOS, solution):
        row = {name: value for name, value in vars(found).items() if name != "gait" and value == value}
        if found.gait is not None:
            row["knee_touchdown"] = math.degrees(found.knee_touchdown)
        yield row


def excess() -> Iterator[Row]:
    """By how much the 260 W motor's envelope has to be exceeded, from several starts, in N·m."""
    knee = drive("ec_90_flat_260w")
    robot = vary(ROBOT, knee_rotor=knee.motor.known("rotor_inertia"))
    for name, starts in STARTS.items():
        seen: dict[int, float] = {}
        gait, least = smallest_violation(robot, REQUESTS[name], knee, starts, seen.__setitem__)
        yield {
            "request": name,
            "starts": starts,
            "found": sum(not math.isnan(value) for value in seen.values()),
            "same": sum(abs(value - least) < SAME for value in seen.values()),
            "excess": least,
            "cost": electrical_cost(gait, knee),
            "heating": against(points(gait), knee).heating.tolist(),
            "period": gait.period,
        }


TABLES: dict[str, tuple[Callable[[], Iterator[Row]], tuple[str, ...]]] = {
    "families": (
        families,
        ("varied", "value", "effort_per_distance", "knee_peak", "hip_peak", "largest_multiplier", "residual"),
    ),
    "designs": (designs, ("motor", "ratio", "stiffness", "knee_touchdown", "cost", "heating", "margin")),
    "excess": (excess, ("request", "starts", "found", "same", "excess", "cost", "heating", "period")),
}


def cell(value: Any) -> str:
    """A text, a number, or several, to the digits that the tables give."""
    if isinstance(value, list):
        return ", ".join(cell(item) for item in value)
    return value if isinstance(value, str) else f"{value:.4g}"


def main() -> None:
    """Search, and print Markdown or JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=TABLES, default=list(TABLES), help="which tables")
    parser.add_argument("--json", action="store_true", help="print a JSON object for each row, as it is found")
    given = parser.parse_args()
    for name in given.only:
        rows, head = TABLES[name][0](), (*TABLES[name][1], "reason")
        if not given.json:
            print(f"\n{name}\n")
            markdown.begin(*head)
        for row in rows:
            if given.json:
                print(json.dumps({"table": name} | row), flush=True)
            else:
                markdown.row(*(cell(row.get(key, "")) for key in head))


if __name__ == "__main__":
    main()
