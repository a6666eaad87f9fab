"""Measures which pushes in three dimensions a bound survives: `python -m benchmarks.recovered`.

`long_stride`, balanced by ten inputs with the heading kept, is pushed to the left and rolled at its section. An entry
is the lateral deviation after ten strides, over the one at the beginning, or why the motion ends and in which stride.
"""

from __future__ import annotations

import argparse
import math

import numpy as np

from benchmarks.markdown import begin, row
from benchmarks.overlap import HEADING, left_of
from spear_pin import Gait
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.periodic import residual

PUSHES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # m/s
ROLLS = (-10.0, -5.0, 0.0, 5.0, 10.0)  # °


def main() -> None:
    """Print the map."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    system, state = embed(Gait.load("long_stride"))
    straight = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
    steady = add_feedback(straight, ACROSS, heading=HEADING)
    begin("rolled to the right by", *(f"pushed by {push:g} m/s" for push in PUSHES))
    for roll in ROLLS:
        entries = [left_of(steady, (math.radians(roll), push, 0.0)) if roll or push else "0" for push in PUSHES]
        row(f"{roll:g}°", *entries)


if __name__ == "__main__":
    main()
