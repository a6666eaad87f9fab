"""Measures the planar gaits in three dimensions: `python -m benchmarks.space`.

For each gait whose feet lift off by the knee it gives residual, lateral motion and energy ledger of a stride, and the
cost of a stride against the plane's in the same run. It also gives the largest lateral multiplier without feedback, and
with feedback once per stride to one input. It takes some minutes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from benchmarks.markdown import begin, row
from spear_pin import Gait, SpatialLaw
from spear_pin.gaits import library
from spear_pin.gaits.feedback import UPRIGHT, quadratic_gains
from spear_pin.gaits.inputs import inputs_of
from spear_pin.gaits.linear import linear
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.hybrid.periodic import eigenvalues, residual, return_map
from spear_pin.hybrid.result import Run

HEADS = "gait | residual | lateral motion | ledger, J | cost of a stride | fall sideways | with one input"
ACROSS = [1, 3, 5]
REPEATS = 3


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    begin(*HEADS.split(" | "))
    for name in library.names():
        if Gait.load(name).system.law.lift_off == "knee":
            row(_row(name))


def _row(name: str) -> str:
    plane = Gait.load(name)
    system, state = embed(plane, SpatialLaw(plane.system.law))
    run, spatial = _timed(lambda: return_map(system, state))
    _, planar = _timed(lambda: return_map(plane.system, plane.state))
    drift = max(float(np.abs(part[ACROSS]).max()) for part in run.state)
    ledger = abs(float(run.change[0] - run.work[0].sum()))
    gait = Gait(system, state, {}, residual(system, state), np.array([np.nan + 0j]), {})
    across = linear(gait, UPRIGHT, lateral=True)
    gains = quadratic_gains(across.A, across.B, [each.one for each in inputs_of(system, UPRIGHT)], 0.2)
    fall, held = eigenvalues(across.A)[0].real, abs(eigenvalues(across.A - across.B @ gains)[0])
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
