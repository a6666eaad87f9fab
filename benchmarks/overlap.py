"""Measures how results depend on the duration of an impact: `python -m benchmarks.overlap`.

For durations from 0 to 20 ms it gives the residual of a turn that ships, and what is left of a push after ten strides,
with feedback to ten inputs.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace

import numpy as np

from benchmarks.markdown import begin, row
from spear_pin import Gait, simulate
from spear_pin.arrays import Array
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.periodic import residual
from spear_pin.hybrid.symmetry import ROLL, YAW, Y, Z, mirror_of

HEADS = "impacts last, ms | residual of `turn_9` | left of a push after ten strides"
WINDOWS = (0.0, 0.002, 0.005, 0.010, 0.020)  # s
STRIDES, HEADING = 10, 30.0
PUSH = math.radians(5.0), 0.2, math.radians(10.0)  # rad of roll, m/s to the left, rad/s of yaw rate


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    system, state = embed(Gait.load("long_stride"))
    straight = Gait(system, state, {}, residual(system, state), np.ones(1, complex), {})
    steady, turn = add_feedback(straight, ACROSS, heading=HEADING), Gait.load("turn_9")
    begin(*HEADS.split(" | "))
    for window in WINDOWS:
        off = residual(replace(turn.system, overlap=window), turn.state)
        row(f"{1e3 * window:.0f}", f"{off:.0e}", left_of(steady, PUSH, window))


def left_of(gait: Gait, push: tuple[float, float, float], window: float | None = None) -> str:
    """Give the lateral deviation after ten strides of a push, over the one before, or why the motion ends.

    Args:
        gait: balanced.
        push: roll, in rad, speed to the left, in m/s, and yaw rate, in rad/s.
        window: how long impacts last, in s; by default as in the gait's system.
    """
    q, v = (part.copy() for part in gait.state)
    q[ROLL], v[Y], v[YAW] = push
    system = gait.system if window is None else replace(gait.system, overlap=window)
    q[Z] -= min(system.ground.foot(system.robot, q, toe)[0] for toe in system.section_toes)
    motion = simulate(system, (q, v), STRIDES, progress=False)
    if motion.reason != "complete":
        return f"{motion.reason}, stride {motion.cycles + 1}"
    return f"{_across(system, motion.q[-1], motion.v[-1]) / _across(system, q, v):.4f}"


def _across(system: HybridSystem, q: Array, v: Array) -> float:
    """Largest antisymmetric part of a state, the heading with it, but not where the robot is."""
    mirror = mirror_of(system.robot)
    parts = [(part - mirror(part)) / 2.0 for part in (q, v)]
    parts[0][Y] = 0.0
    return float(np.abs(np.concatenate(parts)).max())


if __name__ == "__main__":
    main()
