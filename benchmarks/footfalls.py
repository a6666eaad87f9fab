"""Finds gaits in 3-D by collocation, from footfalls and speed alone: `python -m benchmarks.footfalls`.

For each gait it gives how it closes, unknowns, iterations, CPU time to build and to solve, the stride, its effort and
cost of transport, and how well it obeys mechanics between its nodes. It takes some minutes on one core, and needs the
extra `optimize`.
"""

from __future__ import annotations

import argparse
import math

from benchmarks import markdown
from spear_pin import load
from spear_pin.gaits.footfalls.collocate import collocate
from spear_pin.gaits.footfalls.course import CollocatedGait
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from tests.gaits.footfalls.checking import violations

HEADS = (
    "footfalls | closes | unknowns | iterations | build, s | solve, s | stride, s | effort, N²·m·s |"
    " lacking force | slip, mm"
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
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    robot = load("q_spear_full", base="chain")
    markdown.begin(*HEADS.split(" | "))
    for name, request in REQUESTS.items():
        markdown.row(row(name, collocate(robot, request)))


def row(name: str, gait: CollocatedGait) -> str:
    """A line of the table."""
    request, solution, found = gait.request, gait.solution, violations(gait)
    closes = "mirrored half" if request.footfalls.mirrored else "turned" if request.turn else "whole"
    unknowns = sum(len(value) for value in solution.values.values())
    built, solved = gait.seconds
    numbers = f"{unknowns:,} | {gait.iterations} | {built:.1f} | {solved:.1f} | {gait.period:.3f}"
    numbers += f" | {gait.effort_per_distance:.0f}"
    return f"{name} | {closes} | {numbers} | {found.motion:.3f} | {1e3 * found.slip:.1f}"


if __name__ == "__main__":
    main()
