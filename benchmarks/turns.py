"""Measures the turns that ship, and what their adductions do: `python -m benchmarks.turns`.

For each turn it gives the angle, the speed of the straight gait, rate, speed on the circle, radius, residual and
largest multiplier. Then come range, speed, torque and power of adductions and knees, torque of the hips and friction
used, over three strides. "Mirrored" is the residual of the mirror image, which turns to the right.
"""

from __future__ import annotations

import argparse
import math

from benchmarks.markdown import table
from spear_pin import Gait, simulate
from spear_pin.gaits import library
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import residual
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.studies.bound.turn import summarize_turn

HEADS = (
    "° a stride | straight, m/s | °/s | m/s | radius, m | residual | mirrored | multiplier | "
    "adduction: range, ° | rad/s | N·m | W | knee: range, ° | rad/s | N·m | W | hip, N·m | friction: all, lateral"
)
STRIDES = 3


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    table(HEADS.split(" | "), ([_row(name)] for name in library.TURNS))


def _row(name: str) -> str:
    gait = Gait.load(name)
    of = summarize_turn(gait, simulate(gait.system, gait.state, STRIDES, progress=False))
    mirror = mirror_of(gait.system.robot)
    right = with_parameters(gait.system, {each: -parameter(gait.system, each) for each in ACROSS})
    mirrored = residual(right, (mirror(gait.state[0]), mirror(gait.state[1])))
    joints = of["joints"]
    figures = [
        f"{math.degrees(of['turn']):.0f} | {library.TURNS[name][1]:.2f}",
        f"{math.degrees(of['rate']):.1f} | {of['speed']:.2f} | {of['radius']:.2f}",
        f"{residual(gait.system, gait.state):.0e} | {mirrored:.0e} | {of['largest_multiplier']:.3f}",
        *(
            f"{math.degrees(joints[part]['range']):.1f} | {joints[part]['speed']:.2f} | {joints[part]['torque']:.1f} "
            f"| {joints[part]['power']:.0f}"
            for part in ("adduction", "knee")
        ),
        f"{joints['hip']['torque']:.0f}",
        f"{of['friction_used']:.2f}, {of['friction_used_across']:.2f}",
    ]
    return " | ".join(figures)


if __name__ == "__main__":
    main()
