"""Cost of the hybrid layer, as ratios in one run: `python -m benchmarks.cost`, JSON on stdout.

The stance right-hand side with its ledger against a bare `pin.forwardDynamics` on the same model, and
one hop against a bare `solve_ivp` loop on a lean hand-written right-hand side (`benchmarks/lean.py`).
Timings alternate; medians are of the ratios. Agreement comes first.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
import pinocchio as pin

from benchmarks.lean import lean_hop
from spear_pin import find_gait, hopping, load, simulate
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.periodic import return_map

ROUNDS = 15


def timed(function: Callable[[], object], repeats: int) -> float:
    """Seconds a call, over `repeats` calls."""
    begin = time.perf_counter()
    for _ in range(repeats):
        function()
    return (time.perf_counter() - begin) / repeats


def compare(ours: Callable[[], object], other: Callable[[], object], repeats: tuple[int, int]) -> dict[str, float]:
    """Median times and the median ratio of interleaved rounds."""
    ours(), other()
    pairs = [(timed(ours, repeats[0]), timed(other, repeats[1])) for _ in range(ROUNDS)]
    return {
        "ours_us": 1e6 * statistics.median(a for a, _ in pairs),
        "other_us": 1e6 * statistics.median(b for _, b in pairs),
        "ratio": statistics.median(a / b for a, b in pairs),
        "ratio_min": min(a / b for a, b in pairs),
        "ratio_max": max(a / b for a, b in pairs),
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rtol", type=float, default=1e-8)
    rtol = parser.parse_args().rtol
    robot = load("spear_ii", locked=["boom_x"])
    gait = find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2}, rtol=1e-12)
    q, v = gait.state

    held = {"knee_touchdown": q[2], "taut": 1.0, "flexing": 1.0, "compressing": 1.0, "limited": 0.0, "speed": 0.0}
    flow = Flow(gait.system, gait.system.domains[0], held)
    y = np.concatenate([q, v, np.zeros(5)])
    model, data = robot.model, robot.model.createData()
    tau, jacobian, drift = np.array([0.0, 0.0, 8.0]), robot.toe_jacobian(q, "toe"), robot.toe_drift(q, v, "toe")
    rhs = compare(
        lambda: flow(0.0, y), lambda: pin.forwardDynamics(model, data, q, v, tau, jacobian, drift), (2000, 5000)
    )

    lean = lean_hop(gait, rtol)
    errors = {
        "ours": float(
            np.abs(np.concatenate(return_map(gait.system, gait.state, rtol).state) - np.concatenate(gait.state)).max()
        ),
        "lean": float(np.abs(np.concatenate(lean()) - np.concatenate(gait.state)).max()),
    }
    hop = compare(lambda: return_map(gait.system, gait.state, rtol), lean, (3, 3))
    sampled = compare(lambda: simulate(gait.system, gait.state, 1, rtol, progress=False), lean, (3, 3))
    json.dump(
        {"rtol": rtol, "state_error": errors, "stance_rhs": rhs, "hop": hop, "hop_sampled": sampled},
        sys.stdout,
        indent=1,
    )
    print()


if __name__ == "__main__":
    main()
