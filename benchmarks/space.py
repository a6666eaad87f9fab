"""Measures the planar gaits in three dimensions: `python -m benchmarks.space [--write]`.

For each gait whose feet lift off by the knee it gives residual, lateral motion and energy ledger of a stride, and the
cost of a stride against the plane's in the same run. It also gives the largest lateral multiplier without feedback, and
with feedback once per stride to one input. With `--write` the table goes into docs/results/space.md. It takes some
minutes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from spear_pin import Gait, SpatialLaw
from spear_pin.gaits import library
from spear_pin.gaits.orbits.balance import across, regulated
from spear_pin.gaits.orbits.embedding import embedded
from spear_pin.hybrid.periodic import eigenvalues, residual, return_map
from spear_pin.hybrid.result import Run

PAGE = Path(__file__).parents[1] / "docs" / "results" / "space.md"
HEADS = "gait | residual | lateral motion | ledger, J | cost of a stride | fall sideways | with one input"
ACROSS = [1, 3, 5]
REPEATS = 3


def main() -> None:
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="put the table into docs/results/space.md")
    arguments = parser.parse_args()
    rows = [HEADS, " | ".join(["---"] * (HEADS.count("|") + 1))]
    for name in library.names():
        if Gait.load(name).system.law.lift_off == "knee":
            rows.append(_row(name))
            print(rows[-1], flush=True)
    if arguments.write:
        table = "\n".join(f"| {row} |" for row in rows)
        text = PAGE.read_text(encoding="utf-8")
        head, _, rest = text.partition("| gait |")
        after = rest.partition("\n\n")[2]
        PAGE.write_text(f"{head}{table}\n\n{after}", encoding="utf-8")


def _row(name: str) -> str:
    plane = Gait.load(name)
    system, state = embedded(plane, SpatialLaw(plane.system.law))
    run, spatial = _timed(lambda: return_map(system, state))
    _, planar = _timed(lambda: return_map(plane.system, plane.state))
    drift = max(float(np.abs(part[ACROSS]).max()) for part in run.state)
    ledger = abs(float(run.change[0] - run.work[0].sum()))
    gait = Gait(system, state, {}, residual(system, state), np.array([np.nan + 0j]), {})
    linear = across(gait, ("posterior_adduction",))
    fall, held = eigenvalues(linear.A)[0].real, abs(regulated(linear)[1][0])
    sizes = " | ".join(f"{size:.0e}" for size in (gait.residual, drift, ledger))
    return f"{name} | {sizes} | {spatial / planar:.1f} times | {fall:.3f} | {held:.3f}"


def _timed(function: Callable[[], Run]) -> tuple[Run, float]:
    """The result, and the least CPU time of some calls, in s."""
    seconds = []
    for _ in range(REPEATS):
        begun = time.process_time()
        result = function()
        seconds.append(time.process_time() - begun)
    return result, min(seconds)


if __name__ == "__main__":
    main()
