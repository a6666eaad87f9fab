"""Measures which pushes in three dimensions a bound survives: `python -m benchmarks.recovered [--write]`.

`long_stride`, balanced by ten inputs with the heading kept, is pushed to the left and rolled at its section. An entry
is the lateral deviation after ten strides, over the one at the beginning, or why the motion ends and in which stride.
With `--write` the map goes into docs/results/space.md.
"""

from __future__ import annotations

import argparse
import math

import numpy as np

from benchmarks.overlap import HEADING, PAGE, left_of
from spear_pin import Gait
from spear_pin.gaits.orbits.balance import balanced
from spear_pin.gaits.orbits.embedding import embedded
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.periodic import residual

PUSHES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # m/s
ROLLS = (-10.0, -5.0, 0.0, 5.0, 10.0)  # °


def main() -> None:
    """Print the map, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="put the map into docs/results/space.md")
    arguments = parser.parse_args()
    system, state = embedded(Gait.load("long_stride"))
    straight = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
    steady = balanced(straight, ACROSS, heading=HEADING)
    heads = " | ".join(["rolled to the right by", *(f"pushed by {push:g} m/s" for push in PUSHES)])
    rows = [heads, " | ".join(["---"] * (len(PUSHES) + 1))]
    for roll in ROLLS:
        entries = [left_of(steady, (math.radians(roll), push, 0.0)) if roll or push else "0" for push in PUSHES]
        rows.append(" | ".join([f"{roll:g}°", *entries]))
        print(rows[-1], flush=True)
    if arguments.write:
        table = "\n".join(f"| {row} |" for row in rows)
        text = PAGE.read_text(encoding="utf-8")
        head, _, rest = text.partition("| rolled to the right by |")
        PAGE.write_text(f"{head}{table}\n\n{rest.partition(chr(10) * 2)[2]}", encoding="utf-8")


if __name__ == "__main__":
    main()
