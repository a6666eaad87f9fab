"""Finds gaits in 3-D by collocation, from footfalls and speed alone: `python -m benchmarks.footfalls [--write]`.

For each gait it gives how it closes, unknowns, iterations, CPU time to build and to solve, the stride, its effort and
cost of transport, and how well it obeys mechanics between its nodes. With `--write` the table goes into
docs/results/space.md. It takes some minutes on one core, and needs the extra `optimize`.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from spear_pin import load
from spear_pin.gaits.footfalls.checking import violations
from spear_pin.gaits.footfalls.collocate import collocated
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS

PAGE = Path(__file__).parents[1] / "docs" / "results" / "space.md"
HEADS = (
    "footfalls | closes | unknowns | iterations | build, s | solve, s | stride, s | effort, N²·m·s |"
    " cost of transport | lacking force | slip, mm"
)
TROT = FOOTFALLS["trot"]
REQUESTS = {
    "trot, 2 m/s": FootfallRequest(footfalls=TROT, speed=2.0),
    "the same, intervals doubled": FootfallRequest(footfalls=TROT.finer(2), speed=2.0),
    "the same as a whole stride": FootfallRequest(footfalls=TROT.unfolded, speed=2.0),
    "trot, 2 m/s, turning by 15° a stride": FootfallRequest(
        footfalls=TROT.unfolded, speed=2.0, turn=math.radians(15.0)
    ),
    "trot, 2 m/s, law on the ground": FootfallRequest(footfalls=TROT, speed=2.0, law=StanceLaw()),
    "trot, 2 m/s, law": FootfallRequest(footfalls=TROT, speed=2.0, law=StanceLaw(), swing=SwingLaw()),
    "pace, 2 m/s": FootfallRequest(footfalls=FOOTFALLS["pace"], speed=2.0),
    "pace, 2 m/s, law": FootfallRequest(footfalls=FOOTFALLS["pace"], speed=2.0, law=StanceLaw(), swing=SwingLaw()),
    "pronk, 2 m/s": FootfallRequest(footfalls=FOOTFALLS["pronk"], speed=2.0),
    "pronk, 2 m/s, law": FootfallRequest(footfalls=FOOTFALLS["pronk"], law=StanceLaw(), swing=SwingLaw()),
    "bound, 2.5 m/s": FootfallRequest(footfalls=FOOTFALLS["bound"], speed=2.5),
    "bound, 2.5 m/s, law": FootfallRequest(footfalls=FOOTFALLS["bound"], speed=2.5, law=StanceLaw(), swing=SwingLaw()),
    "gallop, 3 m/s": FootfallRequest(footfalls=FOOTFALLS["gallop"], speed=3.0),
}


def main() -> None:
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="put the table into docs/results/space.md")
    arguments = parser.parse_args()
    robot = load("q_spear_full", base="chain")
    rows = [HEADS, " | ".join(["---"] * (HEADS.count("|") + 1))]
    for name, request in REQUESTS.items():
        rows.append(row(name, collocated(robot, request)))
        print(rows[-1], flush=True)
    if arguments.write:
        table = "\n".join(f"| {each} |" for each in rows)
        head, _, rest = PAGE.read_text(encoding="utf-8").partition("| footfalls |")
        after = rest.partition("\n\n")[2]
        PAGE.write_text(f"{head}{table}\n\n{after}", encoding="utf-8")


def row(name: str, gait: CollocatedGait) -> str:
    """A line of the table."""
    request, solution, found = gait.request, gait.solution, violations(gait)
    closes = "mirrored half" if request.footfalls.mirrored else "turned" if request.turn else "whole"
    unknowns = sum(len(value) for value in solution.values.values())
    built, solved = gait.seconds
    numbers = f"{unknowns:,} | {gait.iterations} | {built:.1f} | {solved:.1f} | {gait.period:.3f}"
    numbers += f" | {gait.effort_per_distance:.0f}"
    return f"{name} | {closes} | {numbers} | {gait.cost_of_transport:.3f} | {found.motion:.3f} | {1e3 * found.slip:.1f}"


if __name__ == "__main__":
    main()
