"""Speed of gaits in space, on one core: `python -m benchmarks.space_speed`, Markdown on stdout; some minutes.

The reference engine runs the first cycles, then they are compiled: all these are a row of their own. All times are CPU
time, of repeated calls the median.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
import warnings
from collections.abc import Callable

import numpy as np

from benchmarks.markdown import begin, row
from spear_pin import Gait, find_gait, in_space, simulate_many
from spear_pin.hybrid.lanes.runner import RARE
from spear_pin.hybrid.periodic import multipliers, return_map
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import CYCLES, Recorder

LANES, COLUMNS, REPEATS = 64, 16, 5
GAITS = {"trot": "half a stride", "turn_9": "a stride"}
FASTER = 1.01  # times the trot's speed
FARTHER = math.radians(9.1)  # a stride, of turn_9, which turns by 9°


def spent(call: Callable[[], object]) -> float:
    """CPU time of a call, in s."""
    begun = time.process_time()
    call()
    return time.process_time() - begun


def usual(call: Callable[[], object]) -> float:
    """CPU time of a repeated call, in s, the median."""
    return statistics.median(spent(call) for _ in range(REPEATS))


def cycles(gait: Gait, lanes: int) -> None:
    """Runs a cycle of lanes."""
    simulate_many(gait.system, *(np.tile(part, (lanes, 1)) for part in gait.state))


def differ(gait: Gait, columns: int) -> None:
    """Differentiates a cycle along some directions."""
    recorder, y = Recorder(gait.system), np.concatenate(gait.state)
    directions = np.eye(len(y), columns)
    differentiate_cycle(gait.system, recorder, y, directions, np.zeros((len(recorder.numbers), columns)))


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    warnings.simplefilter("ignore")
    begin("what", "CPU time")
    row("`in_space(long_stride)`, compiled in it", f"{spent(lambda: in_space(Gait.load('long_stride'))):.1f} s")
    for name, cycle in GAITS.items():
        gait = Gait.load(name)
        first = spent(lambda gait=gait: [cycles(gait, 1) for _ in range(RARE + 1)])
        alone = usual(lambda gait=gait: cycles(gait, 1))
        row(f"{name}: the first {RARE + 1} cycles, in which it is compiled", f"{first:.1f} s")
        row(f"{name}: {cycle}", f"{1e3 * alone:.1f} ms")
        cycles(gait, LANES)
        each = usual(lambda gait=gait: cycles(gait, LANES)) / LANES
        row(f"{name}: a lane of {LANES}", f"{1e3 * each:.1f} ms")
        for _ in range(CYCLES + 1):
            differ(gait, COLUMNS)
        columns = usual(lambda gait=gait: differ(gait, COLUMNS))
        row(f"{name}: {COLUMNS} exact columns", f"{columns / alone:.1f} strides")
        row(f"{name}: multipliers", f"{usual(lambda gait=gait: multipliers(gait.system, gait.state)):.2f} s")
    trot, turn = Gait.load("trot"), Gait.load("turn_9")
    speed = FASTER * trot.system.measures["mean_speed"](return_map(trot.system, trot.state))
    faster = {"mean_speed": speed}
    found = spent(lambda: find_gait(trot.system, ["posterior_hip_torque"], faster, guess=trot.state))
    row(f"trot: `find_gait` at {FASTER:g} times its speed", f"{found:.1f} s")
    found = spent(lambda: find_gait(turn.system, ["posterior_adduction"], {"turn": FARTHER}, guess=turn.state))
    row(f"turn_9: `find_gait` at {math.degrees(FARTHER):.1f}° a stride", f"{found:.1f} s")


if __name__ == "__main__":
    main()
